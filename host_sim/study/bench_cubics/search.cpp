#include "host_sim/study/bench_cubics/search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace fairlead::sim::cubics {
namespace {

constexpr double unit = static_cast<double>(curve::cubic_unit);

/// State of a component in steps and ticks.
double value_of(const curve::CubicVertex& at) { return static_cast<double>(at.p) / (6 * unit); }
double rate_of(const curve::CubicVertex& at) { return static_cast<double>(at.v) / (2 * unit); }
double bend_of(const curve::CubicVertex& at) { return static_cast<double>(at.a) / unit; }

template <std::size_t N>
struct Node {
    Place<N> place;
    std::shared_ptr<const Chart<N>> chart;  // null: to be made about the place's anchor
    double bits{}, order{};                 // order: bits, and what the control points say
    int parent{-1};
    std::int32_t tick{};
    Piece<N> piece;            // that leads to it
    int only{-1};              // code of the one length that goes on, or -1
    curve::GridQuat anchor{};  // of the run that begins here
    const State<N>& state() const { return place.chart; }
};

/// Interval of third derivatives that keeps the samples so far, of each component.
template <std::size_t N>
struct Interval {
    Interval() {
        low.fill(-1e30);
        high.fill(1e30);
    }
    std::array<double, N> low, high;
    std::int32_t ticks{0};
    bool empty() const {
        for (std::size_t c = 0; c < N; ++c)
            if (low[c] > high[c]) return true;
        return false;
    }
};

/// A value tried for one component of a piece.
struct Choice {
    std::int32_t k;
    double bits, beside;
};
/// One choice for each component.
template <std::size_t N>
struct Choices {
    std::array<const Choice*, N> of;
    double order;
};

template <std::size_t N>
class Window {
  public:
    Window(const Subject<N>& subject, const Stretch& stretch, const Costs& costs,
           const SearchParams& params)
        : subject_{subject},
          stretch_{stretch},
          end_{stretch.to + (stretch.commit < 0 ? 0 : curve::piece_ticks_max)},
          costs_{costs},
          params_{params},
          column_(static_cast<std::size_t>(end_ - stretch.from) + 1),
          least_(column_.size(), 1e30) {}

    Found<N> run(const Place<N>& start) {
        begin(start);
        for (std::int32_t t = stretch_.from; t < stretch_.to; ++t) {
            const std::vector<int> kept = keep(t);
            for (std::size_t i = 0; i < kept.size(); ++i) extend(kept[i], i);
        }
        Found<N> found;
        for (int i = last(); i >= 0; i = store_[at(i)].parent) {
            if (store_[at(i)].parent < 0)
                found.anchor = store_[at(i)].anchor;
            else
                found.pieces.push_back(store_[at(i)].piece);
        }
        std::reverse(found.pieces.begin(), found.pieces.end());
        cut(found.pieces);
        return found;
    }

  private:
    static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }
    std::vector<Node<N>>& column(std::int32_t tick) { return column_[at(tick - stretch_.from)]; }
    bool counts_pieces() const { return params_.piece_bits >= 0; }

    void begin(const Place<N>& start) {
        Node<N> first;
        first.place = start;
        first.tick = stretch_.from;
        if constexpr (N == 3) {
            if (subject_.rotates() && start.chart.run == 3) return anchors(first);
        }
        first.chart = chart_of(first);
        column(stretch_.from).push_back(first);
    }

    std::shared_ptr<const Chart<N>> chart_of(const Node<N>& n) const {
        return subject_.chart(n.place.anchor, n.tick, stretch_.known);
    }

    /// A run begins about a rotation of the grid near its first control point: one node for each
    /// length and each such rotation.
    void anchors(const Node<N>& start) {
        const auto chart = chart_of(start);
        for (std::uint8_t c = 0; c < curve::length_count; ++c) {
            const std::int32_t h = curve::lengths[c];
            if (3 * h > stretch_.to - stretch_.from) break;
            std::array<double, 3> wish;
            for (std::size_t i = 0; i < 3; ++i)
                wish[i] =
                    chart->x[i].control(start.tick + 2 * h, h, seen(start.tick)) * subject_.step();
            const auto q = wide(start.place.anchor) * exp_of(wish);
            const auto nearest =
                curve::to_grid(normalised(Quat{static_cast<float>(q.w), static_cast<float>(q.x),
                                               static_cast<float>(q.y), static_cast<float>(q.z)}),
                               static_cast<float>(subject_.step()));
            for (int way = 0; way < 7; ++way) {
                Node<N> n = start;
                n.anchor = nearest;
                if (way > 0) {
                    auto& x = n.anchor.n[at((way - 1) / 2)];
                    x = static_cast<std::int16_t>(x + (way % 2 == 0 ? 1 : -1));
                }
                if (!begin_run(n.place, n.anchor, subject_.step())) continue;
                n.chart = chart_of(n);
                n.only = c;
                column(n.tick).push_back(n);
            }
        }
        starts_ = column(start.tick).size();
        if (starts_ > 0) return;
        Node<N> n = start;  // too short for a run: a jump leads out
        n.anchor = curve::to_grid(start.place.anchor, static_cast<float>(subject_.step()));
        if (!begin_run(n.place, n.anchor, subject_.step())) return;
        n.chart = chart_of(n);
        column(n.tick).push_back(n);
    }

    bool same(const Node<N>& a, const Node<N>& b) const {
        const State<N>&s = a.state(), &o = b.state();
        if (s.last_ticks != o.last_ticks || s.run != o.run || s.loose() != o.loose()) return false;
        if (!curve::same(a.place.anchor, b.place.anchor)) return false;
        const double h = s.last_ticks;
        for (std::size_t c = 0; c < N; ++c)
            if (!(std::fabs(static_cast<double>(s.at[c].p - o.at[c].p)) / (6 * unit) < .02 &&
                  std::fabs(static_cast<double>(s.at[c].v - o.at[c].v)) / (2 * unit / h) < .02 &&
                  std::fabs(static_cast<double>(s.at[c].a - o.at[c].a)) / (unit / (.3 * h * h)) <
                      .02))
                return false;
        return true;
    }

    /// The vertices of a column that go on: the first of the order, few of each length. All begins
    /// of a run go on.
    std::vector<int> keep(std::int32_t tick) {
        auto& found = column(tick);
        const std::size_t begins = tick == stretch_.from ? starts_ : 0;
        std::vector<std::size_t> order(found.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return found[a].order < found[b].order;
        });
        std::vector<int> kept;
        std::array<std::size_t, 256> of_length{};
        const std::size_t width = (std::max)(params_.width, begins);
        const std::size_t most = (std::max)({std::size_t{2}, params_.width / 5, begins});
        for (const std::size_t i : order) {
            const Node<N>& n = found[i];
            if (kept.size() >= width || n.order > found[order[0]].order + params_.margin_bits)
                break;
            if (of_length[n.state().last_ticks] >= most) continue;
            if (begins == 0 && std::any_of(kept.begin(), kept.end(),
                                           [&](int k) { return same(n, store_[at(k)]); }))
                continue;
            ++of_length[n.state().last_ticks];
            kept.push_back(static_cast<int>(store_.size()));
            store_.push_back(n);
        }
        std::vector<Node<N>>{}.swap(found);
        return kept;
    }

    /// The end of the best path. Where pieces may end behind `to`, what they save there counts.
    int last() {
        if (stretch_.commit < 0) {
            const auto kept = keep(stretch_.to);
            return kept.empty() ? -1 : kept[0];
        }
        const Node<N>* best = nullptr;
        double least = 1e300;
        for (std::int32_t t = stretch_.to; t <= end_; ++t)
            for (const Node<N>& n : column(t)) {
                const double more = n.order - (t - stretch_.to) * params_.piece_bits / 40;
                if (more < least) least = more, best = &n;
            }
        if (best == nullptr) return -1;
        store_.push_back(*best);
        return static_cast<int>(store_.size()) - 1;
    }

    /// Drops the pieces that end behind the tick to which they are committed, but for the first;
    /// and none of an open run.
    void cut(std::vector<Piece<N>>& pieces) const {
        if (stretch_.commit < 0) return;
        std::int32_t tick = stretch_.from;
        std::size_t n = 0;
        while (n < pieces.size()) {
            tick += pieces[n].subs / curve::subs_per_tick;
            if (n > 0 && tick > stretch_.commit) break;
            ++n;
        }
        pieces.resize(n);
    }

    /// Order of the dearest vertex that a column still takes.
    double dearest(std::int32_t tick) const {
        return least_[at(tick - stretch_.from)] + params_.margin_bits;
    }

    bool offer(Node<N>&& n, double beside) {
        n.order = n.bits + beside;
        double& least = least_[at(n.tick - stretch_.from)];
        if (n.order > least + params_.margin_bits) return false;
        least = (std::min)(least, n.order);
        column(n.tick).push_back(std::move(n));
        return true;
    }

    std::int32_t seen(std::int32_t tick) const {
        return (std::min)(stretch_.known, tick + params_.look);
    }

    void extend(int id, std::size_t rank) {
        if (!store_[at(id)].chart) store_[at(id)].chart = chart_of(store_[at(id)]);
        const Node<N> from = store_[at(id)];
        const State<N>& s = from.state();
        // the first piece is committed, so that it must not end behind what is known
        const std::int32_t left = (from.parent < 0 ? stretch_.to : end_) - from.tick;
        Interval<N> j;
        if (s.run == 1 || s.run == 2) {
            if (s.last_ticks <= left && narrow(from, s.last_ticks, j))
                close(from, id, s.last_code, s.last_ticks, j);
        } else if (from.only >= 0) {
            const std::int32_t h = curve::lengths[at(from.only)];
            if (narrow(from, h, j)) close(from, id, static_cast<std::uint8_t>(from.only), h, j);
        } else if (!s.loose()) {
            bool alive = true;
            for (std::uint8_t c = 0; alive && c < curve::length_count; ++c) {
                const std::int32_t h = curve::lengths[c];
                if (s.run == 3            ? 3 * h > stretch_.to - from.tick
                    : stretch_.commit < 0 ? h >= left
                                          : h > left)
                    break;
                alive = narrow(from, h, j);
                if (alive) close(from, id, c, h, j);
            }
            if (alive && s.run == 0 && stretch_.commit < 0 && left <= curve::piece_ticks_max &&
                narrow(from, left, j))
                close(from, id, curve::code::to_end, left, j);
        }
        if (s.run == 0 && (rank < 2 || s.loose())) lines(from, id);
        if (rank == 0) jump(from, id);
    }

    /// Takes the samples up to h ticks into the interval; samples that are not known bind nothing.
    /// @return false: it is empty.
    bool narrow(const Node<N>& from, std::int32_t h, Interval<N>& j) const {
        for (; j.ticks < h && !j.empty(); ++j.ticks) {
            const std::int32_t tick = from.tick + j.ticks + 1;
            if (tick > stretch_.known) continue;
            const double t = j.ticks + 1, w = t * t * t / 6;
            for (std::size_t c = 0; c < N; ++c) {
                const curve::CubicVertex& s = from.state().at[c];
                const double off =
                    from.chart->x[c][tick] - value_of(s) - rate_of(s) * t - bend_of(s) * t * t / 2;
                j.low[c] = (std::max)(j.low[c], (off - stretch_.radius) / w);
                j.high[c] = (std::min)(j.high[c], (off + stretch_.radius) / w);
            }
        }
        return !j.empty();
    }

    /// Are all samples under a rotation's piece within the ball? An axis, and the axes of a
    /// position, have their interval.
    bool inside_ball(const Node<N>& from, const Span<N>& span, std::int32_t h) const {
        if (!subject_.rotates()) return true;
        std::array<curve::Polynomial<double>, N> cubic;
        std::array<double, N> start;
        for (std::size_t c = 0; c < N; ++c) {
            start[c] = value_of(span.start[c]);
            cubic[c] = curve::cubic<double>(span.start[c], span.j[c]);
        }
        for (std::int32_t t = (std::min)(h, stretch_.known - from.tick); t >= 1; --t) {
            double off = 0;
            for (std::size_t c = 0; c < N; ++c) {
                const double e = start[c] + cubic[c].rise(static_cast<double>(t)) -
                                 from.chart->x[c][from.tick + t];
                off += e * e;
            }
            if (off > stretch_.radius * stretch_.radius) return false;
        }
        return true;
    }

    double code_bits(const State<N>& s, std::uint8_t c, std::int32_t left) const {
        if (counts_pieces()) return params_.piece_bits;
        const auto way = c == curve::code::to_end ? Way::to_end : Way::listed;
        double bits =
            s.run == 0 ? costs_.way[way_row(s, left)][static_cast<std::size_t>(way)] / 16. : .03;
        if (way == Way::listed && (s.run == 0 || s.run == 3))
            bits += costs_.length[length_row(s)][c] / 16.;
        return bits;
    }
    double k_bits(const State<N>& s, std::size_t c, std::size_t row, std::int32_t k,
                  bool line) const {
        return counts_pieces() ? 0 : value_bits(costs_, row, k, told_sign(s, c, line));
    }

    /// Control points of one component that are cheap and near to the samples'.
    std::vector<Choice> control_points(const Node<N>& from, std::size_t c, std::int32_t h,
                                       const Interval<N>& j) const {
        const State<N>& s = from.state();
        const double h1 = h, h2 = h1 * h1;
        const double middle =
            value_of(s.at[c]) + 2 * h1 * rate_of(s.at[c]) + 11. / 6 * h2 * bend_of(s.at[c]);
        const double low = std::ceil(middle + h2 * h1 * j.low[c]);
        const double high = std::floor(middle + h2 * h1 * j.high[c]);
        std::vector<Choice> choices;
        if (!(low <= high) || std::fabs(middle) > 1e8) return choices;
        const std::int32_t predicted = curve::predicted_control(s, c, h);
        const bool told = s.run == 3;
        const double wish = from.chart->x[c].control(from.tick + 2 * h, h, seen(from.tick));
        const std::size_t row = told ? 0 : value_row(s, c, h, false, false);
        const double nearest = std::round((std::min)((std::max)(wish, low), high));
        const auto add = [&](double x) {
            if (x < low || x > high || std::fabs(x - predicted) > 1e6) return;
            const auto k = static_cast<std::int32_t>(x) - predicted;
            for (const Choice& o : choices)
                if (o.k == k) return;
            const double bits = told ? 0 : k_bits(s, c, row, k, false);
            choices.push_back({k, bits, params_.control_weight * (x - wish) * (x - wish)});
        };
        if (told && subject_.rotates()) {
            add(0);  // the anchor is the control point
        } else {
            for (int d = -3; d <= 3; ++d) add(nearest + d);
            for (int d = -1; d <= 1 && !told && !counts_pieces(); ++d) add(predicted + d);
            for (int d = 1; d < 8 && counts_pieces(); ++d)
                add(std::floor(low + (high - low) * d / 8));
        }
        std::stable_sort(choices.begin(), choices.end(), [](const Choice& a, const Choice& b) {
            return a.bits + a.beside < b.bits + b.beside;
        });
        const std::size_t most = N == 1 ? params_.values : 4;
        if (choices.size() > most) choices.resize(most);
        return choices;
    }

    /// Offers vertices h ticks behind one.
    void close(const Node<N>& from, int id, std::uint8_t c, std::int32_t h, const Interval<N>& j) {
        const State<N>& s = from.state();
        std::array<std::vector<Choice>, N> choices;
        std::vector<Choices<N>> all{{}};
        all[0].order = 0;
        for (std::size_t i = 0; i < N; ++i) {
            choices[i] = control_points(from, i, h, j);
            std::vector<Choices<N>> next;
            for (const Choices<N>& before : all)
                for (const Choice& choice : choices[i]) {
                    next.push_back(before);
                    next.back().of[i] = &choice;
                    next.back().order += choice.bits + choice.beside;
                }
            all.swap(next);
        }
        if (N > 1)
            std::stable_sort(all.begin(), all.end(),
                             [](const auto& a, const auto& b) { return a.order < b.order; });
        std::array<double, N> here;
        for (std::size_t i = 0; i < N; ++i)
            here[i] = from.chart->x[i].control(from.tick + h, h, seen(from.tick));
        const double code = code_bits(s, c, end_ - from.tick);
        const double most = dearest(from.tick + h);
        std::size_t made = 0, tried = 0;
        for (const Choices<N>& chosen : all) {
            if (made >= params_.values || ++tried > 3 * params_.values) break;
            if (from.bits + code + chosen.order > most) break;
            std::array<std::int32_t, N> k;
            double bits = 0, beside = 0;
            bool moved_before = false;
            for (std::size_t i = 0; i < N; ++i) {
                k[i] = chosen.of[i]->k;
                beside += chosen.of[i]->beside;
                bits += i == 0 || s.run == 3
                            ? chosen.of[i]->bits
                            : k_bits(s, i, value_row(s, i, h, false, moved_before), k[i], false);
                moved_before = moved_before || k[i] != 0;
            }
            Span<N> span;
            State<N> end;
            Node<N> n = moved(from, id, c, h, k, span, end);
            if (n.parent < 0 || !inside_ball(from, span, h)) continue;
            n.bits = from.bits + code + bits;
            for (std::size_t i = 0; i < N; ++i) {
                const double off = value_of(end.at[i]) - bend_of(end.at[i]) * h * h / 6 - here[i];
                beside += params_.vertex_weight * off * off;
            }
            offer(std::move(n), beside);
            ++made;
        }
    }

    /// The node behind a piece; its parent is -1 where the piece is out of bounds. end: its state
    /// in the chart of the piece.
    Node<N> moved(const Node<N>& from, int id, std::uint8_t c, std::int32_t h,
                  const std::array<std::int32_t, N>& k, Span<N>& span, State<N>& end) const {
        Node<N> n;
        n.place = from.place;
        n.chart = from.chart;
        n.piece.code = c;
        n.piece.subs = static_cast<std::uint16_t>(h * curve::subs_per_tick);
        n.piece.k = k;
        n.tick = from.tick + h;
        if (!curve::step(n.place.chart, n.piece, span)) return n;
        end = n.place.chart;
        if (!settle(n.place, subject_.rotates(), subject_.step(), params_.chart_rad)) return n;
        if (!curve::same(n.place.anchor, from.place.anchor)) n.chart = nullptr;
        n.parent = id;
        return n;
    }

    double break_bits(const State<N>& s, std::int32_t left) const {
        const double told =
            costs_.way[way_row(s, left)][static_cast<std::size_t>(Way::breaks)] / 16.;
        return s.loose() ? .05 : params_.break_bits + told + .05;
    }

    void lines(const Node<N>& from, int id) {
        const std::int32_t left = (from.parent < 0 ? stretch_.to : end_) - from.tick;
        std::array<double, N> p, low, high;
        for (std::size_t c = 0; c < N; ++c) p[c] = value_of(from.state().at[c]);
        low.fill(-1e30);
        high.fill(1e30);
        std::int32_t ticks = 0;
        for (std::uint8_t c = 0; c <= curve::length_count; ++c) {
            const bool listed = c < curve::length_count;
            const std::int32_t h = listed ? curve::lengths[c] : left;
            if (h > curve::piece_ticks_max || h < ticks ||
                (listed && (stretch_.commit < 0 ? h >= left : h > left)))
                continue;
            if (!listed && stretch_.commit >= 0) return;
            bool empty = false;
            for (; ticks < h; ++ticks) {
                if (from.tick + ticks + 1 > stretch_.known) continue;
                for (std::size_t i = 0; i < N; ++i) {
                    const double off = from.chart->x[i][from.tick + ticks + 1] - p[i];
                    low[i] = (std::max)(low[i], (off - stretch_.radius) / (ticks + 1));
                    high[i] = (std::min)(high[i], (off + stretch_.radius) / (ticks + 1));
                    empty = empty || low[i] > high[i];
                }
            }
            if (empty) return;
            if (from.bits + break_bits(from.state(), left) > dearest(from.tick + h)) continue;
            std::array<double, N> first, most;
            for (std::size_t i = 0; i < N; ++i) {
                const double middle = std::round(p[i] + (low[i] + high[i]) / 2 * h);
                first[i] = (std::max)(std::ceil(p[i] + low[i] * h), middle - 1);
                most[i] = (std::min)(std::floor(p[i] + high[i] * h), middle + 1);
            }
            each_end(first, most, [&](const auto& end) { line(from, id, c, h, end); });
        }
    }

    /// Calls visit for all whole ends between first and most.
    template <class Visit>
    static void each_end(const std::array<double, N>& first, const std::array<double, N>& most,
                         const Visit& visit) {
        for (std::size_t i = 0; i < N; ++i)
            if (first[i] > most[i]) return;
        std::array<double, N> x = first;
        while (true) {
            visit(x);
            std::size_t i = 0;
            while (i < N && ++x[i] > most[i]) x[i] = first[i], ++i;
            if (i == N) return;
        }
    }

    void line(const Node<N>& from, int id, std::uint8_t c, std::int32_t h,
              const std::array<double, N>& to) {
        const State<N>& s = from.state();
        std::array<std::int32_t, N> k;
        double bits = 0;
        bool moved_before = false;
        for (std::size_t i = 0; i < N; ++i) {
            const std::int32_t expected = curve::predicted_end(s, i, h);
            if (std::fabs(to[i] - expected) > curve::cubic_k_max) return;
            k[i] = static_cast<std::int32_t>(to[i]) - expected;
            bits += k_bits(s, i, value_row(s, i, h, true, moved_before), k[i], true);
            moved_before = moved_before || k[i] != 0;
        }
        Span<N> span;
        State<N> end;
        Node<N> n =
            moved(from, id, static_cast<std::uint8_t>(curve::code::line + c), h, k, span, end);
        if (n.parent < 0 || !inside_ball(from, span, h)) return;
        const double code = counts_pieces() ? params_.piece_bits : costs_.line[c] / 16.;
        n.bits = from.bits + break_bits(s, end_ - from.tick) + code + bits;
        double beside = 0;
        for (std::size_t i = 0; i < N; ++i) {
            const double next = value_of(end.at[i]) + rate_of(end.at[i]) * h;
            const double off =
                next - from.chart->x[i].control(from.tick + 2 * h, h, seen(from.tick));
            beside += params_.control_weight * off * off;
        }
        offer(std::move(n), beside);
    }

    /// The way that always is: a jump to the next sample. Of an axis the nearest value; of a
    /// rotation one whose distance is within the tolerance.
    void jump(const Node<N>& from, int id) {
        const State<N>& s = from.state();
        std::array<double, N> first, most;
        for (std::size_t i = 0; i < N; ++i) {
            first[i] = most[i] = std::round(from.chart->x[i][from.tick + 1]);
            if (!(std::fabs(first[i]) < 1e9)) return;
        }
        each_end(first, most, [&](const std::array<double, N>& to) {
            std::array<std::int32_t, N> k;
            double bits = 6;
            for (std::size_t i = 0; i < N; ++i) {
                k[i] = static_cast<std::int32_t>(to[i]) -
                       (s.run > 0 ? 0 : curve::lattice_near(s.at[i]));
                bits += plain_bits(k[i]);
            }
            Span<N> span;
            State<N> end;
            Node<N> n = moved(from, id, curve::code::jump, 1, k, span, end);
            if (n.parent < 0 || !inside_ball(from, span, 1)) return;
            n.bits = from.bits + bits + params_.break_bits;
            offer(std::move(n), params_.break_bits);
        });
    }

    const Subject<N>& subject_;
    const Stretch stretch_;
    std::int32_t end_;  // ticks: no piece ends behind
    const Costs& costs_;
    const SearchParams& params_;
    std::vector<std::vector<Node<N>>> column_;
    std::vector<double> least_;
    std::vector<Node<N>> store_;
    std::size_t starts_{0};
};

}  // namespace

bool rebase(Place<3>& place, double step) {
    curve::CubicRotation r{place.anchor, place.chart};
    if (!curve::rebase(r, static_cast<float>(step))) return false;
    place = {r.chart, r.anchor};
    return true;
}

template <std::size_t N>
bool settle(Place<N>& place, bool rotates, double step, float chart_rad) {
    if constexpr (N == 3) {
        if (!rotates || place.chart.run != 0 || place.chart.phase != 0) return true;
        const Vec3 theta = curve::chart_angle(place.chart.at, static_cast<float>(step));
        if (dot(theta, theta) > chart_rad * chart_rad) return rebase(place, step);
    }
    return true;
}

bool begin_run(Place<3>& place, const curve::GridQuat& anchor, double step) {
    curve::CubicRotation r{place.anchor, place.chart};
    const auto step_f = static_cast<float>(step);
    if (!curve::begin_run(r, curve::from_grid(anchor, step_f), step_f)) return false;
    place = {r.chart, r.anchor};
    return true;
}

/// Pieces at which the curve breaks, but for the line behind a jump.
template <std::size_t N>
std::size_t breaks_of(const std::vector<Piece<N>>& pieces, bool loose) {
    std::size_t breaks = 0;
    for (const Piece<N>& p : pieces) {
        const bool jump = p.code == curve::code::jump;
        if ((jump || curve::is_line(p.code)) && !loose) ++breaks;
        loose = jump;
    }
    return breaks;
}

template <std::size_t N>
Found<N> search(const Subject<N>& subject, const Place<N>& start, const Stretch& stretch,
                const Costs& costs, const SearchParams& params) {
    Found<N> found = Window<N>{subject, stretch, costs, params}.run(start);
    const bool loose = start.chart.loose();
    std::size_t breaks = breaks_of(found.pieces, loose);
    SearchParams wider = params;
    for (int again = 0; again < params.repeats && breaks > 0; ++again) {
        wider.width *= 4;
        wider.values *= 2;
        wider.margin_bits *= 2;
        Found<N> other = Window<N>{subject, stretch, costs, wider}.run(start);
        const std::size_t fewer = breaks_of(other.pieces, loose);
        if (fewer >= breaks) continue;
        found = std::move(other);
        breaks = fewer;
    }
    return found;
}

template bool settle(Place<1>&, bool, double, float);
template bool settle(Place<3>&, bool, double, float);
template Found<1> search(const Subject<1>&, const Place<1>&, const Stretch&, const Costs&,
                         const SearchParams&);
template Found<3> search(const Subject<3>&, const Place<3>&, const Stretch&, const Costs&,
                         const SearchParams&);

}  // namespace fairlead::sim::cubics
