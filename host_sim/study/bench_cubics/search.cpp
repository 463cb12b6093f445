#include "host_sim/study/bench_cubics/search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace fairlead::sim::cubics {
namespace {

constexpr double unit = static_cast<double>(curve::cubic_unit);

struct Node {
    State state;
    double bits{}, order{};  // order: bits, and what the control points say
    int parent{-1};
    std::int32_t tick{};
    Piece piece;  // that leads to it
};

/// Interval of third derivatives that keeps the samples so far.
struct Interval {
    double low{-1e30}, high{1e30};
    std::int32_t ticks{0};
};

class Window {
  public:
    Window(const Samples& samples, std::int32_t from, std::int32_t to, std::int32_t known,
           double radius, const Costs& costs, const SearchParams& params)
        : samples_{samples},
          from_{from},
          to_{to},
          known_{known},
          radius_{radius},
          costs_{costs},
          params_{params},
          column_(static_cast<std::size_t>(to - from) + 1),
          least_(column_.size(), 1e30) {}

    std::vector<Piece> run(const State& start) {
        Node first;
        first.state = start;
        first.tick = from_;
        column_[0].push_back(first);
        for (std::int32_t t = from_; t < to_; ++t) {
            const std::vector<int> kept = keep(t);
            for (std::size_t i = 0; i < kept.size(); ++i) extend(kept[i], i);
        }
        std::vector<Piece> pieces;
        for (int i = keep(to_).at(0); store_[at(i)].parent >= 0; i = store_[at(i)].parent)
            pieces.push_back(store_[at(i)].piece);
        std::reverse(pieces.begin(), pieces.end());
        return pieces;
    }

  private:
    static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

    static bool same(const Node& a, const Node& b) {
        const State &s = a.state, &o = b.state;
        if (s.last_ticks != o.last_ticks || s.run != o.run || s.loose() != o.loose()) return false;
        const double h = s.last_ticks;
        const auto off = [](std::int64_t x, std::int64_t y, double by) {
            return std::fabs(static_cast<double>(x - y)) / by;
        };
        return off(s.at[0].p, o.at[0].p, 6 * unit) < .02 &&
               off(s.at[0].v, o.at[0].v, 2 * unit / h) < .02 &&
               off(s.at[0].a, o.at[0].a, unit / (.3 * h * h)) < .02;
    }

    /// The vertices of a column that go on: the first of the order, few of each length.
    std::vector<int> keep(std::int32_t tick) {
        auto& column = column_[at(tick - from_)];
        std::stable_sort(column.begin(), column.end(),
                         [](const Node& a, const Node& b) { return a.order < b.order; });
        std::vector<int> kept;
        std::array<std::size_t, 256> of_length{};
        const std::size_t most = (std::max)(std::size_t{2}, params_.width / 5);
        for (const Node& n : column) {
            if (kept.size() >= params_.width || n.order > column[0].order + params_.margin_bits)
                break;
            if (of_length[n.state.last_ticks] >= most) continue;
            if (std::any_of(kept.begin(), kept.end(),
                            [&](int k) { return same(n, store_[at(k)]); }))
                continue;
            ++of_length[n.state.last_ticks];
            kept.push_back(static_cast<int>(store_.size()));
            store_.push_back(n);
        }
        std::vector<Node>{}.swap(column);
        return kept;
    }

    void offer(Node&& n, double beside) {
        n.order = n.bits + beside;
        double& least = least_[at(n.tick - from_)];
        if (n.order > least + params_.margin_bits) return;
        least = (std::min)(least, n.order);
        column_[at(n.tick - from_)].push_back(n);
    }

    std::int32_t seen(std::int32_t tick) const { return (std::min)(known_, tick + params_.look); }

    void extend(int id, std::size_t rank) {
        const Node from = store_[at(id)];
        const State& s = from.state;
        const std::int32_t left = to_ - from.tick;
        Interval j;
        if (s.run == 1 || s.run == 2) {
            if (s.last_ticks <= left && narrow(from, s.last_ticks, j))
                close(from, id, s.last_code, s.last_ticks, j);
        } else if (!s.loose()) {
            bool alive = true;
            for (std::uint8_t c = 0; alive && c < curve::length_count; ++c) {
                const std::int32_t h = curve::lengths[c];
                if (s.run == 3 ? 3 * h > left : h >= left) break;
                alive = narrow(from, h, j);
                if (alive) close(from, id, c, h, j);
            }
            if (alive && s.run == 0 && left <= curve::piece_ticks_max && narrow(from, left, j))
                close(from, id, curve::code::to_end, left, j);
        }
        if (s.run == 0 && (rank < 2 || s.loose())) lines(from, id);
        if (rank == 0) jump(from, id);
    }

    /// Takes the samples up to h ticks into the interval. @return false: it is empty.
    bool narrow(const Node& from, std::int32_t h, Interval& j) const {
        const curve::CubicVertex& at = from.state.at[0];
        const double p = static_cast<double>(at.p) / (6 * unit);
        const double v = static_cast<double>(at.v) / (2 * unit);
        const double a = static_cast<double>(at.a) / unit;
        for (; j.ticks < h && j.low <= j.high; ++j.ticks) {
            const double t = j.ticks + 1, w = t * t * t / 6;
            const double off =
                samples_[this->at(from.tick) + this->at(j.ticks) + 1] - p - v * t - a * t * t / 2;
            j.low = (std::max)(j.low, (off - radius_) / w);
            j.high = (std::min)(j.high, (off + radius_) / w);
        }
        return j.low <= j.high;
    }

    double code_bits(const State& s, std::uint8_t c, std::int32_t left) const {
        const auto way = c == curve::code::to_end ? Way::to_end : Way::listed;
        double bits =
            s.run == 0 ? costs_.way[way_row(s, left)][static_cast<std::size_t>(way)] / 16. : .03;
        if (way == Way::listed && (s.run == 0 || s.run == 3))
            bits += costs_.length[length_row(s)][c] / 16.;
        return bits;
    }

    struct Choice {
        std::int32_t k;
        double bits, beside;
    };

    /// Offers vertices h ticks behind one: the control points that are cheap and near to the
    /// samples'.
    void close(const Node& from, int id, std::uint8_t c, std::int32_t h, const Interval& j) {
        const State& s = from.state;
        const double h1 = h, h2 = h1 * h1;
        const double middle = static_cast<double>(s.at[0].p) / (6 * unit) +
                              h1 * static_cast<double>(s.at[0].v) / unit +
                              11. / 6 * h2 * static_cast<double>(s.at[0].a) / unit;
        const double low = std::ceil(middle + h2 * h1 * j.low);
        const double high = std::floor(middle + h2 * h1 * j.high);
        if (!(low <= high) || std::fabs(middle) > 1e8) return;
        const std::int32_t known = seen(from.tick);
        const double wish = samples_.control(from.tick + 2 * h, h, known);
        const double here = samples_.control(from.tick + h, h, known);
        const std::int32_t predicted = curve::predicted_control(s, 0, h);
        const std::size_t row = s.run == 3 ? 0 : value_row(s, h, false);
        const double nearest = std::round((std::min)((std::max)(wish, low), high));
        std::vector<Choice> choices;
        const auto add = [&](double x) {
            if (x < low || x > high || std::fabs(x - predicted) > 1e6) return;
            const auto k = static_cast<std::int32_t>(x) - predicted;
            for (const Choice& o : choices)
                if (o.k == k) return;
            const std::int8_t sign = s.run > 0 ? std::int8_t{0} : s.sign[0];
            const double bits = s.run == 3 ? 0 : value_bits(costs_, row, k, sign);
            choices.push_back({k, bits, params_.control_weight * (x - wish) * (x - wish)});
        };
        for (int d = -3; d <= 3; ++d) add(nearest + d);
        for (int d = -1; d <= 1 && s.run != 3; ++d) add(predicted + d);
        std::stable_sort(choices.begin(), choices.end(), [](const Choice& a, const Choice& b) {
            return a.bits + a.beside < b.bits + b.beside;
        });
        if (choices.size() > params_.values) choices.resize(params_.values);
        const double code = code_bits(s, c, to_ - from.tick);
        for (const Choice& choice : choices) {
            Node n = moved(from, id, c, h, choice.k);
            if (n.parent < 0) continue;
            n.bits = from.bits + code + choice.bits;
            const double off = (static_cast<double>(n.state.at[0].p) / 6 -
                                static_cast<double>(n.state.at[0].a) * h2 / 6) /
                                   unit -
                               here;
            offer(std::move(n), choice.beside + params_.vertex_weight * off * off);
        }
    }

    /// The node behind a piece; its parent is -1 where the piece is out of bounds.
    static Node moved(const Node& from, int id, std::uint8_t c, std::int32_t h, std::int32_t k) {
        Node n;
        n.state = from.state;
        n.piece.code = c;
        n.piece.subs = static_cast<std::uint16_t>(h * curve::subs_per_tick);
        n.piece.k[0] = k;
        n.tick = from.tick + h;
        Span span;
        if (curve::step(n.state, n.piece, span)) n.parent = id;
        return n;
    }

    double break_bits(const State& s, std::int32_t left) const {
        const double told =
            costs_.way[way_row(s, left)][static_cast<std::size_t>(Way::breaks)] / 16.;
        return s.loose() ? .05 : params_.break_bits + told + .05;
    }

    void lines(const Node& from, int id) {
        const State& s = from.state;
        const double p = static_cast<double>(s.at[0].p) / (6 * unit);
        const std::int32_t left = to_ - from.tick;
        double low = -1e30, high = 1e30;
        std::int32_t ticks = 0;
        for (std::uint8_t c = 0; c <= curve::length_count; ++c) {
            const std::int32_t h = c < curve::length_count ? curve::lengths[c] : left;
            if (h > curve::piece_ticks_max || h < ticks || (c < curve::length_count && h >= left))
                continue;
            for (; ticks < h; ++ticks) {
                const double off = samples_[at(from.tick) + at(ticks) + 1] - p;
                low = (std::max)(low, (off - radius_) / (ticks + 1));
                high = (std::min)(high, (off + radius_) / (ticks + 1));
            }
            if (low > high) return;
            const double first = std::ceil(p + low * h), last = std::floor(p + high * h);
            const double middle = std::round(p + (low + high) / 2 * h);
            for (double x = (std::max)(first, middle - 1); x <= (std::min)(last, middle + 1); ++x)
                line(from, id, c, h, x);
        }
    }

    void line(const Node& from, int id, std::uint8_t c, std::int32_t h, double end) {
        const State& s = from.state;
        const std::int32_t expected = curve::predicted_end(s, 0, h);
        if (std::fabs(end - expected) > curve::cubic_k_max) return;
        const auto k = static_cast<std::int32_t>(end) - expected;
        const auto code = static_cast<std::uint8_t>(curve::code::line + c);
        Node n = moved(from, id, code, h, k);
        if (n.parent < 0) return;
        n.bits = from.bits + break_bits(s, to_ - from.tick) + costs_.line[c] / 16. +
                 value_bits(costs_, value_row(s, h, true), k, 0);
        const double next = (static_cast<double>(n.state.at[0].p) / 6 +
                             static_cast<double>(n.state.at[0].v) / 2 * h) /
                            unit;
        const double off = next - samples_.control(from.tick + 2 * h, h, seen(from.tick));
        offer(std::move(n), params_.control_weight * off * off);
    }

    /// The way that always is: a jump to the next sample.
    void jump(const Node& from, int id) {
        const State& s = from.state;
        const auto value = static_cast<std::int32_t>(std::lround(samples_[at(from.tick) + 1]));
        const std::int32_t k = value - (s.run > 0 ? 0 : curve::lattice_near(s.at[0]));
        Node n = moved(from, id, curve::code::jump, 1, k);
        if (n.parent < 0) return;
        n.bits = from.bits + plain_bits(k) + 6 + params_.break_bits;
        offer(std::move(n), params_.break_bits);
    }

    const Samples& samples_;
    std::int32_t from_, to_, known_;
    double radius_;
    const Costs& costs_;
    const SearchParams& params_;
    std::vector<std::vector<Node>> column_;
    std::vector<double> least_;
    std::vector<Node> store_;
};

}  // namespace

Samples::Samples(std::vector<double> x) : x_{std::move(x)}, sum_(1), sum1_(1), sum2_(1) {
    for (std::size_t i = 0; i < x_.size(); ++i) {
        const auto t = static_cast<double>(i);
        sum_.push_back(sum_[i] + x_[i]);
        sum1_.push_back(sum1_[i] + x_[i] * t);
        sum2_.push_back(sum2_[i] + x_[i] * t * t);
    }
}

Samples::Parabola Samples::fit(std::int32_t first, std::int32_t last, double t) const {
    const auto from = static_cast<std::size_t>(first), to = static_cast<std::size_t>(last) + 1;
    const double n = last - first + 1, middle = (first + last) / 2.0;
    const double s0 = sum_[to] - sum_[from];
    const double raw = sum1_[to] - sum1_[from], s1 = raw - middle * s0;
    const double s2 = sum2_[to] - sum2_[from] - 2 * middle * raw + middle * middle * s0;
    const double q2 = n * (n * n - 1) / 12, q4 = q2 * (3 * n * n - 7) / 20, u = t - middle;
    if (n < 2) return {s0, 0, 0};
    const double b = s1 / q2;
    if (n < 3) return {s0 / 2 + b * u, b, 0};
    const double c = (n * s2 - q2 * s0) / (n * q4 - q2 * q2);
    return {(s0 - c * q2) / n + b * u + c * u * u, b + 2 * c * u, 2 * c};
}

double Samples::control(std::int32_t t, std::int32_t h, std::int32_t known) const {
    // the second derivative is x'' of the spline's middle: c = x - h^2 / 6 x''
    const double h6 = h * h / 6.0;
    const std::int32_t half = (std::max)(h, 2);
    if (t + (std::min)(half, (std::max)(3, half / 2)) <= known) {
        const Parabola p = fit((std::max)(0, t - half), (std::min)(known, t + half), t);
        return p.value - h6 * p.bend;
    }
    // from the last samples on; their bend is damped, and fades within some ticks
    constexpr double fading = 12;
    const std::int32_t last = (std::min)(20, (std::max)(6, h));
    Parabola p = fit((std::max)(0, known - last), known, known);
    p.bend *= last / (last + 4.0);
    const double after = t - known;
    if (after < 0) return p.value + p.rate * after + p.bend * after * after / 2 - h6 * p.bend;
    const double rest = std::exp(-after / fading);
    return p.value + p.rate * after + p.bend * fading * (after - fading * (1 - rest)) -
           h6 * p.bend * rest;
}

std::vector<Piece> search(const Samples& samples, const State& start, std::int32_t from,
                          std::int32_t to, std::int32_t known, double radius, const Costs& costs,
                          const SearchParams& params) {
    return Window{samples, from, to, known, radius, costs, params}.run(start);
}

}  // namespace fairlead::sim::cubics
