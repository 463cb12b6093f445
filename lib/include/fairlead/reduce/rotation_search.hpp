#pragma once
// Search of rotations: beam.hpp for pieces of three components in a chart about an anchor.
//
// Places are floats in lattice steps. Running bounds hold for each component apart, so that they
// are necessary; before a vertex is offered, the whole piece is compared with the samples in the
// ball of the tolerance. These comparisons are the dear part: the cheapest candidates come first,
// and a budget a column bounds them.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/curve/rotation.hpp"
#include "fairlead/reduce/beam.hpp"

namespace fairlead::reduce {

using Place = std::array<float, 3>;

template <class Kind, class BeamT, std::size_t Columns>
class RotationSearch {
  public:
    static constexpr std::size_t width = BeamT::width;
    static constexpr std::size_t open_max = BeamT::open;
    static constexpr int tries_max = 6;   // candidates of a hypothesis that are compared
    static constexpr int offers_max = 3;  // of these, how many it may offer
    static constexpr int budget = 300;    // comparisons with samples a column, once it has a child
    static constexpr int budget_hard = 600;

    struct Child {
        std::array<std::int32_t, 3> s{};
        std::array<std::int16_t, 3> v{};
        std::uint16_t cost{};
        std::uint8_t parent_column{}, way{};
        std::array<std::int8_t, 3> last_k{}, sign{};
        std::uint8_t last_code{}, last_ticks{};
    };

    /// Begins a window at a vertex at the anchor.
    void seed(const curve::State<3>& state, float radius) noexcept {
        radius_ = radius;
        fresh_ = state.fresh;
        Child c;
        c.s = state.s;
        c.last_k = state.last_k;
        c.sign = state.sign;
        c.last_code = state.last_code;
        c.last_ticks = state.last_ticks;
        column_[0] = c;
        column_count_ = 1;
        best_ = 0;
        open_count_ = 0;
        index_ = before_index_ = 0;
        back_[0][0] = {};
        open_child(c, 0, 0, 0);
        open_[0].shape = shape_of(state);
    }

    void sample(std::int32_t tick, float part, const Place& y) noexcept {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < open_count_; ++i) {
            Open& o = open_[i];
            const float age = static_cast<float>(tick - o.tick) + part;
            if (age > 0.0f && o.shape != Shape::fresh && !bound(o, age, y)) continue;
            if (kept != i) open_[kept] = o;
            ++kept;
        }
        open_count_ = kept;
    }

    /// Where a column is and what surrounds it. `samples(i)` and `when(i)` are those of the window,
    /// first(column) the first one behind a column; `last` is one behind the last sample.
    struct At {
        std::size_t index{};
        std::int32_t tick{};
        std::size_t last{};
        Place middle{};
        bool known{};   // middle bounds the vertex
        Place later{};  // the sample behind the column, this many ticks; 0: none
        float after{};
        bool end{};
        const Place* told{};  // where the frame ends, if it tells that
    };

    template <class Source>
    void column(const At& at, const Source& source) noexcept {
        if (index_ != at.index) {  // else the same column again
            before_ = column_[0];
            before_index_ = index_;
            index_ = static_cast<std::uint8_t>(at.index);
        }
        column_count_ = 0;
        work_ = 0;
        const Cost bound = best_ + margin_cost;
        const bool many = open_count_ > 1;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < open_count_; ++i) {
            Open& o = open_[i];
            const std::int32_t h = at.tick - o.tick;
            if (h <= 0) continue;
            if (many && o.cost + 2 * step_cost_min > bound) continue;
            if (h > 120 && !at.end) continue;
            const std::uint8_t code = curve::index_of(h);
            if (code != curve::code::none || at.end) close(o, h, code, at, source);
            if (kept != i) open_[kept] = o;
            ++kept;
        }
        open_count_ = kept;
    }

    void offer_jump(const std::array<std::int32_t, 3>& v, Cost jump_cost) noexcept {
        const Cost cost = before_.cost + jump_cost;
        if (column_count_ > 0 && cost >= column_[0].cost) return;
        Child c;
        for (std::size_t a = 0; a < 3; ++a) c.v[a] = static_cast<std::int16_t>(v[a]);
        c.cost = static_cast<std::uint16_t>(cost < cost_limit ? cost : cost_limit);
        c.parent_column = before_index_;
        c.way = how::jump;
        c.sign = before_.sign;
        c.last_code = curve::code::jump;
        c.last_ticks = 1;
        place(c);
    }
    void grow(std::int32_t tick) noexcept {
        record();
        for (std::size_t i = 0; i < column_count_; ++i) open_child(column_[i], tick, index_, i);
        best_ = column_[0].cost;
    }
    void record() noexcept {
        for (std::size_t i = 0; i < column_count_; ++i)
            back_[index_][i] = {column_[i].v, column_[i].parent_column, column_[i].way};
    }

    std::size_t count() const noexcept { return column_count_; }
    Cost cost() const noexcept { return column_count_ > 0 ? column_[0].cost : before_.cost; }
    Cost cost_of(std::size_t i) const noexcept { return column_[i].cost; }
    Cost before_cost() const noexcept { return before_.cost; }
    float radius() const noexcept { return radius_; }
    curve::State<3> state(std::size_t i) const noexcept { return state_of(column_[i], false); }
    bool jumped(std::size_t i) const noexcept { return (column_[i].way & how::jump) != 0; }
    curve::State<3> before_state(bool first) const noexcept {
        return state_of(before_, first && fresh_);
    }

    std::size_t choose(const Place& value, const Place& slope, bool told) const noexcept {
        std::size_t best = 0;
        float least = far_away;
        for (std::size_t i = 0; i < column_count_; ++i) {
            const Child& c = column_[i];
            if (c.cost > column_[0].cost + margin_cost) break;
            float seam = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const float off = told ? 0.0f : static_cast<float>(c.v[a]) - value[a];
                const float turn = static_cast<float>(c.s[a]) * slope_steps - slope[a];
                const float x = (off + turn * seam_ticks) / radius_;
                seam += x * x;
            }
            const float all = static_cast<float>(c.cost) + seam_weight * seam;
            if (all < least) least = all, best = i;
        }
        return best;
    }

    template <class Ticks, class Steps>
    std::size_t trace(std::size_t i, const Ticks& ticks, Steps& steps,
                      std::size_t from) const noexcept {
        std::size_t count = 0;
        for (std::size_t c = index_, s = i; c > 0 && count < Columns; ++count) {
            const Back& b = back_[c][s];
            c = b.column;
            s = b.way & how::slot;
        }
        std::size_t at = count;
        for (std::size_t c = index_, s = i; at > 0;) {
            const Back& b = back_[c][s];
            --at;
            if (from + at < steps.size())
                steps[from + at] = {b.v, static_cast<std::uint8_t>(ticks[c] - ticks[b.column]),
                                    b.way};
            c = b.column;
            s = b.way & how::slot;
        }
        return count;
    }

  private:
    struct Open {
        std::array<float, 3> lo, hi, s;
        std::array<std::int32_t, 3> slope;
        std::array<std::int16_t, 3> v;
        std::uint16_t cost;
        std::uint8_t tick, column, slot;
        std::array<std::int8_t, 3> last_k, sign;
        std::uint8_t last_code, last_ticks;
        Shape shape;
    };
    struct Back {
        std::array<std::int16_t, 3> v;
        std::uint8_t column, way;
    };
    struct Candidate {
        Cost cost;
        std::array<std::int32_t, 3> p, k;
    };
    static constexpr float slope_steps = 1.0f / static_cast<float>(curve::slope_unit);

    static curve::State<3> state_of(const Child& c, bool fresh) noexcept {
        curve::State<3> state;
        for (std::size_t a = 0; a < 3; ++a) state.v[a] = c.v[a];
        state.s = c.s;
        state.last_k = c.last_k;
        state.sign = c.sign;
        state.last_code = c.last_code;
        state.last_ticks = c.last_ticks;
        state.fresh = fresh;
        return state;
    }

    bool bound(Open& o, float age, const Place& y) const noexcept {
        const float inverse = 1.0f / (o.shape == Shape::line ? age : age * age);
        for (std::size_t a = 0; a < 3; ++a) {
            const float r = y[a] - static_cast<float>(o.v[a]) - o.s[a] * age;
            const float low = (r - radius_) * inverse, high = (r + radius_) * inverse;
            if (low > o.lo[a]) o.lo[a] = low;
            if (high < o.hi[a]) o.hi[a] = high;
            if (!(o.lo[a] <= o.hi[a])) return false;
        }
        return true;
    }

    template <class Source>
    void close(const Open& o, std::int32_t h, std::uint8_t index, const At& at,
               const Source& source) noexcept {
        const auto& costs = code::costs<Kind, 3>;
        const curve::State<3> state = open_state(o);
        const auto& lengths = costs.length[code::length_row(state)];
        const bool fresh = o.shape == Shape::fresh, line = o.shape == Shape::line;
        std::uint8_t code = index, way = o.slot;
        if (line) way |= how::line;
        if (at.end) {
            code = curve::code::to_end;
            way |= how::to_end;
        }
        const Cost base = o.cost + lengths[code];
        if (base >= worst()) return;
        if (at.told != nullptr) {
            close_told(o, h, code, way, base, at, source);
            return;
        }
        std::array<std::int32_t, 3> first, last, predicted;
        Candidate middle{};
        const auto hf = static_cast<float>(h);
        for (std::size_t a = 0; a < 3; ++a) {
            float low = -far_away, high = far_away;
            if (!fresh) {
                const float h2 = line ? hf : hf * hf;
                low = o.s[a] * hf + o.lo[a] * h2;
                high = o.s[a] * hf + o.hi[a] * h2;
            }
            const auto here = static_cast<float>(o.v[a]);
            if (at.known || fresh) {
                low = larger(low, at.middle[a] - radius_ - here);
                high = smaller(high, at.middle[a] + radius_ - here);
            }
            if (at.after > 0.0f) {
                const Reach way_on = reach(o.s[a], fresh || line, hf, at.later[a] - here, at.after,
                                           radius_ + bend_likely * at.after * at.after);
                low = larger(low, way_on.low);
                high = smaller(high, way_on.high);
            }
            low = larger(low, static_cast<float>(-window_steps_max) - here);
            high = smaller(high, static_cast<float>(window_steps_max) - here);
            if (!(low <= high)) return;
            std::int32_t f = static_cast<std::int32_t>(low), l = static_cast<std::int32_t>(high);
            if (static_cast<float>(f) < low) ++f;
            if (static_cast<float>(l) > high) --l;
            if (f > l) return;
            middle.p[a] = nearest((low + high) * 0.5f);
            if (l - f > 2) {
                f = middle.p[a] - 1;
                l = middle.p[a] + 1;
            }
            first[a] = f;
            last[a] = l;
            predicted[a] = curve::predicted_rise(o.slope[a], fresh, h);
        }
        std::array<Candidate, tries_max + 1> candidates;
        int n = cheapest(state, code, h, base, first, last, predicted, candidates);
        if (n ==
            tries_max) {  // none of the cheapest may fit: the middle of the bounds is likely to
            price(middle, state, code, h, base, predicted);
            candidates[tries_max] = middle;
            ++n;
        }
        int offered = 0;
        for (int i = 0; i < n && offered < offers_max; ++i) {
            const Candidate& c = candidates[static_cast<std::size_t>(i)];
            if (i == tries_max && offered > 0) break;
            if (c.cost >= worst()) break;
            if (work_ > (column_count_ > 0 ? budget : budget_hard)) break;
            const Place p{static_cast<float>(c.p[0]), static_cast<float>(c.p[1]),
                          static_cast<float>(c.p[2])};
            const Child child = make(o, c, h, way, code);
            if (!leads_on(child, at) || !fits(o, p, h, at, source)) continue;
            add(child, c);
            ++offered;
        }
    }

    template <class Source>
    void close_told(const Open& o, std::int32_t h, std::uint8_t code, std::uint8_t way, Cost base,
                    const At& at, const Source& source) noexcept {
        Place p;
        const auto hf = static_cast<float>(h);
        for (std::size_t a = 0; a < 3; ++a) {
            p[a] = (*at.told)[a] - static_cast<float>(o.v[a]);
            const float bend = (p[a] - o.s[a] * hf) / (o.shape == Shape::line ? hf : hf * hf);
            if (o.shape != Shape::fresh && (bend < o.lo[a] || bend > o.hi[a])) return;
        }
        if (work_ > (column_count_ > 0 ? budget : budget_hard)) return;
        if (!fits(o, p, h, at, source)) return;
        Candidate c{base, {}, {}};
        Child child = make(o, c, h, way, code);
        for (std::size_t a = 0; a < 3; ++a)
            child.s[a] = curve::slope_onto(o.slope[a], o.shape != Shape::quadratic, p[a], h);
        place(child);
    }

    /// The cheapest candidates in the box, in order of cost. @return their number.
    int cheapest(const curve::State<3>& state, std::uint8_t code, std::int32_t h, Cost base,
                 const std::array<std::int32_t, 3>& first, const std::array<std::int32_t, 3>& last,
                 const std::array<std::int32_t, 3>& predicted,
                 std::array<Candidate, tries_max + 1>& candidates) const noexcept {
        const auto& costs = code::costs<Kind, 3>;
        const Cost most = worst();
        const auto row = [&](std::size_t a, bool before) -> const auto& {
            return costs.value[code::value_row<Kind>(state, code, h, a, before)];
        };
        const std::array<const std::uint8_t(*)[code::value_symbols], 5> rows{
            &row(0, false), &row(1, false), &row(1, true), &row(2, false), &row(2, true)};
        int n = 0;
        Candidate c;
        for (c.p[0] = first[0]; c.p[0] <= last[0]; ++c.p[0]) {
            c.k[0] = c.p[0] - predicted[0];
            const Cost one = base + code::value_cost(*rows[0], c.k[0], state.sign[0]);
            if (one >= most) continue;
            const bool some = c.k[0] != 0;
            for (c.p[1] = first[1]; c.p[1] <= last[1]; ++c.p[1]) {
                c.k[1] = c.p[1] - predicted[1];
                const Cost two =
                    one + code::value_cost(some ? *rows[2] : *rows[1], c.k[1], state.sign[1]);
                if (two >= most) continue;
                const bool any = some || c.k[1] != 0;
                for (c.p[2] = first[2]; c.p[2] <= last[2]; ++c.p[2]) {
                    c.k[2] = c.p[2] - predicted[2];
                    c.cost =
                        two + code::value_cost(any ? *rows[4] : *rows[3], c.k[2], state.sign[2]);
                    if (c.cost < most) n = insert(candidates, n, c);
                }
            }
        }
        return n;
    }
    static int insert(std::array<Candidate, tries_max + 1>& all, int n,
                      const Candidate& c) noexcept {
        int i = n;
        if (n == tries_max) {
            if (all[tries_max - 1].cost <= c.cost) return n;
            i = tries_max - 1;
        } else {
            ++n;
        }
        for (; i > 0 && all[static_cast<std::size_t>(i - 1)].cost > c.cost; --i)
            all[static_cast<std::size_t>(i)] = all[static_cast<std::size_t>(i - 1)];
        all[static_cast<std::size_t>(i)] = c;
        return n;
    }

    static void price(Candidate& c, const curve::State<3>& state, std::uint8_t code, std::int32_t h,
                      Cost base, const std::array<std::int32_t, 3>& predicted) noexcept {
        c.cost = base;
        bool before = false;
        for (std::size_t a = 0; a < 3; ++a) {
            c.k[a] = c.p[a] - predicted[a];
            const auto& row =
                code::costs<Kind, 3>.value[code::value_row<Kind>(state, code, h, a, before)];
            c.cost += code::value_cost(row, c.k[a], state.sign[a]);
            before = before || c.k[a] != 0;
        }
    }

    /// Does the piece that rises by p in h ticks hold all samples behind its start?
    template <class Source>
    bool fits(const Open& o, const Place& p, std::int32_t h, const At& at,
              const Source& source) noexcept {
        std::array<curve::Polynomial<float>, 3> c;
        const auto hf = static_cast<float>(h);
        for (std::size_t a = 0; a < 3; ++a) {
            const float ahead = o.s[a] * hf, i2 = 1.0f / (hf * hf);
            if (o.shape == Shape::line)
                c[a] = {p[a] / hf, 0.0f, 0.0f};
            else if (o.shape == Shape::fresh)
                c[a] = {o.s[a], 2.0f * (p[a] - ahead) * i2, (ahead - p[a]) * i2 / hf};
            else
                c[a] = {o.s[a], (p[a] - ahead) * i2, 0.0f};
        }
        const float limit = radius_ * radius_;
        for (std::size_t i = at.last, first = source.first(o.column); i > first; --i) {
            ++work_;
            const curve::Moment m = source.when(i - 1);
            const float t = static_cast<float>(m.tick - source.start_tick() - o.tick) + m.part;
            const Place& y = source.place(i - 1);
            float n = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const float bend = o.shape == Shape::fresh ? c[a].c2 + t * c[a].c3 : c[a].c2;
                const float e = (y[a] - static_cast<float>(o.v[a])) - t * (c[a].c1 + t * bend);
                n += e * e;
            }
            if (!(n <= limit)) return false;
        }
        return true;
    }

    Child make(const Open& o, const Candidate& c, std::int32_t h, std::uint8_t way,
               std::uint8_t code) const noexcept {
        Child n;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::int32_t k = c.k[a];
            n.v[a] = static_cast<std::int16_t>(o.v[a] + c.p[a]);
            n.s[a] = curve::slope_after(o.slope[a], o.shape != Shape::quadratic, c.p[a], h);
            n.last_k[a] = o.shape == Shape::fresh ? std::int8_t{0}
                                                  : static_cast<std::int8_t>(k > 100    ? 100
                                                                             : k < -100 ? -100
                                                                                        : k);
            n.sign[a] = k != 0 ? static_cast<std::int8_t>(k > 0 ? 1 : -1) : o.sign[a];
        }
        n.cost = static_cast<std::uint16_t>(c.cost < cost_limit ? c.cost : cost_limit);
        n.parent_column = o.column;
        n.way = way;
        n.last_code = code;
        n.last_ticks = static_cast<std::uint8_t>(h);
        return n;
    }
    /// Does the vertex leave a way to the sample behind it?
    bool leads_on(const Child& n, const At& at) const noexcept {
        if (!(at.after > 0.0f)) return true;
        const float most = radius_ + bend_likely * at.after * at.after;
        float sum = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const float there =
                static_cast<float>(n.v[a]) + static_cast<float>(n.s[a]) * slope_steps * at.after;
            sum += (at.later[a] - there) * (at.later[a] - there);
        }
        return sum <= most * most;
    }
    void add(const Child& n, const Candidate& c) noexcept {
        for (std::size_t a = 0; a < 3; ++a) {
            if (n.s[a] > curve::slope_max || n.s[a] < -curve::slope_max) return;
            if (c.p[a] > curve::rise_max || c.p[a] < -curve::rise_max) return;
        }
        place(n);
    }
    Cost worst() const noexcept {
        Cost most = cost_limit;
        if (column_count_ == width && column_[width - 1].cost < most)
            most = column_[width - 1].cost;
        if (column_count_ > 0 && column_[0].cost + margin_cost < most)
            most = column_[0].cost + margin_cost;
        return most;
    }
    static curve::State<3> open_state(const Open& o) noexcept {
        curve::State<3> state;
        state.fresh = o.shape == Shape::fresh;
        state.last_code = o.last_code;
        state.last_ticks = o.last_ticks;
        state.last_k = o.last_k;
        state.sign = o.sign;
        return state;
    }

    void place(const Child& c) noexcept {
        std::size_t at = column_count_;
        for (std::size_t i = 0; i < column_count_; ++i) {
            const Child& other = column_[i];
            if (other.v != c.v || other.s != c.s || other.last_code != c.last_code) continue;
            if (other.cost <= c.cost) return;
            at = i;
            break;
        }
        if (at == column_count_) {
            if (column_count_ < width)
                ++column_count_;
            else if (column_[width - 1].cost <= c.cost)
                return;
            at = column_count_ - 1;
        }
        for (; at > 0 && column_[at - 1].cost > c.cost; --at) column_[at] = column_[at - 1];
        column_[at] = c;
    }

    void open_child(const Child& c, std::int32_t tick, std::size_t index,
                    std::size_t slot) noexcept {
        if (open_count_ == open_max) {  // the dearest goes; a column's best always finds room
            std::size_t dearest = 0;
            for (std::size_t i = 1; i < open_count_; ++i)
                if (open_[i].cost > open_[dearest].cost) dearest = i;
            if (slot > 0 && open_[dearest].cost <= c.cost) return;
            for (std::size_t i = dearest + 1; i < open_count_; ++i) open_[i - 1] = open_[i];
            --open_count_;
        }
        Open& o = open_[open_count_++];
        for (std::size_t a = 0; a < 3; ++a) {
            o.lo[a] = -far_away;
            o.hi[a] = far_away;
            o.s[a] = static_cast<float>(c.s[a]) * slope_steps;
        }
        o.slope = c.s;
        o.v = c.v;
        o.cost = c.cost;
        o.tick = static_cast<std::uint8_t>(tick);
        o.column = static_cast<std::uint8_t>(index);
        o.slot = static_cast<std::uint8_t>(slot);
        o.last_k = c.last_k;
        o.sign = c.sign;
        o.last_code = c.last_code;
        o.last_ticks = c.last_ticks;
        o.shape = c.last_code == curve::code::jump ? Shape::line : Shape::quadratic;
    }

    static constexpr std::int32_t nearest(float x) noexcept {
        return static_cast<std::int32_t>(x < 0 ? x - 0.5f : x + 0.5f);
    }
    static constexpr float larger(float a, float b) noexcept { return a > b ? a : b; }
    static constexpr float smaller(float a, float b) noexcept { return a < b ? a : b; }

    std::array<Open, open_max> open_{};
    std::array<Child, width> column_{};
    std::array<std::array<Back, width>, Columns + 1> back_{};
    Child before_{};
    Cost best_{0};
    float radius_{};
    std::size_t open_count_{0}, column_count_{0};
    int work_{0};
    std::uint8_t index_{0}, before_index_{0};
    bool fresh_{true};
};

}  // namespace fairlead::reduce
