#pragma once
// The search of one curve: a beam over vertices, for any geometry of samples and tolerance.
//
// Values are in lattice steps against the origin of the window, times in ticks from its start. A
// hypothesis at (tick, v, s) allows, for each component, rises p of a piece of h ticks with
//     |x - v - s a - (p - s h) (a / h)^2| <= radius   for every sample x at age a,
// so that low <= (p - s h) / h^2 <= high with running low and high. What a sample is, and which of
// the rises in the box of these bounds are offered, is the geometry's: interval.hpp, ball.hpp.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/reduce/beam.hpp"

namespace fairlead::reduce {

/// Geometry: Interval or Ball. Columns: the most that a window has.
template <class Geometry, class BeamT, std::size_t Columns>
class Search : private Geometry {
    friend Geometry;

  public:
    static constexpr std::size_t n = Geometry::components;
    static constexpr std::size_t width = BeamT::width;
    static constexpr std::size_t open_max = BeamT::open;
    using Sample = typename Geometry::Sample;
    using Column = reduce::Column<n>;

    /// Begins a window at a vertex that is the origin. radius: the tolerance, in steps.
    /// @param guess the ticks at which the frame is likely to end: a fresh piece may reach it
    void seed(const curve::State<n>& state, float radius, std::int32_t guess) noexcept {
        radius_ = radius;
        fresh_ = state.fresh;
        Geometry::begin(guess);
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
        tick_ = before_tick_ = 0;
        before_ = c;
        paths_.clear();
        before_vertex_ = vertex_[0] = paths_.start;
        last_ = 0;
        open_child(c, 0, 0);
        open_[0].shape = shape_of(state);
    }

    /// A sample at tick + part. Hypotheses that it contradicts end.
    void sample(std::int32_t tick, float part, const Sample& x) noexcept {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < open_count_; ++i) {
            Open& o = open_[i];
            const float age = static_cast<float>(tick - o.tick) + part;
            if (age > 0.0f && !(o.shape == Shape::fresh ? Geometry::bound_fresh(o, age, x, radius_)
                                                        : bound(o, age, x)))
                continue;
            if (kept != i) open_[kept] = o;
            ++kept;
        }
        open_count_ = kept;
    }

    /// Offers vertices at a column; at the last one again where its tick is the same. Source:
    /// when(i) and place(i) of the samples that the window has so far, and start_tick().
    template <class Source>
    void column(const Column& at, const Source& source) noexcept {
        if (tick_ != at.tick) {
            before_ = column_[0];
            before_vertex_ = vertex_[0];
            before_tick_ = tick_;
            tick_ = static_cast<std::uint8_t>(at.tick);
        }
        last_ = static_cast<std::uint8_t>(at.last);
        column_count_ = 0;
        back_ = (at.end && end_width < width ? end_width : width) - 1;
        Geometry::begin_column(BeamT::tests);
        const Cost bound = best_ + margin_cost;
        const bool many = open_count_ > 1;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < open_count_; ++i) {
            Open& o = open_[i];
            const std::int32_t h = at.tick - o.tick;
            if (h <= 0) continue;
            if (many && o.cost + Geometry::step_cost_min > bound) continue;
            if (h > curve::lengths.back() && !at.end) continue;
            const std::uint8_t code = curve::index_of(h);
            if (code != curve::code::none || at.end) close(o, h, code, at, source);
            if (kept != i) open_[kept] = o;
            ++kept;
        }
        open_count_ = kept;
        if (column_count_ == 0 && Geometry::renew(BeamT::tests)) close_newest(at, source);
        make_room();
    }

    /// Offers a jump from the column before: what is always possible. Call after column().
    void offer_jump(const std::array<std::int32_t, n>& v, Cost jump_cost) noexcept {
        const Cost cost = before_.cost + jump_cost;
        if (column_count_ > 0 && cost >= column_[0].cost) return;
        Child c;
        for (std::size_t a = 0; a < n; ++a) c.v[a] = static_cast<std::int16_t>(v[a]);
        c.cost = static_cast<std::uint16_t>(cost < cost_limit ? cost : cost_limit);
        c.before = before_vertex_;
        c.way = how::jump;
        c.sign = before_.sign;
        c.last_code = curve::code::jump;
        c.last_ticks = 1;
        place(c);
    }

    /// Lets the children of the column grow; record() instead where the frame ends here.
    void grow(std::int32_t tick) noexcept {
        record();
        for (std::size_t i = 0; i < column_count_; ++i) open_child(column_[i], tick, i);
        best_ = column_[0].cost;
    }
    void record() noexcept {
        for (std::size_t i = 0; i < column_count_; ++i) {
            const Child& c = column_[i];
            const bool jump = (c.way & how::jump) != 0;
            const auto since = static_cast<std::uint8_t>(tick_ - before_tick_);
            vertex_[i] = paths_.add(c.before, {c.v, jump ? since : c.last_ticks, c.way});
        }
    }

    std::size_t count() const noexcept { return column_count_; }
    Cost cost() const noexcept { return column_count_ > 0 ? column_[0].cost : before_.cost; }
    Cost cost_of(std::size_t i) const noexcept { return column_[i].cost; }
    Cost before_cost() const noexcept { return before_.cost; }
    float radius() const noexcept { return radius_; }
    /// State at a child, v against the origin.
    curve::State<n> state(std::size_t i) const noexcept { return state_of(column_[i], false); }
    /// The best vertex of the column before the last one, from which a jump may lead.
    curve::State<n> before_state() const noexcept {
        return state_of(before_, fresh_ && before_vertex_ == paths_.start);
    }

    /// Child to end the window with: the cheapest, the seam to come included. `value` and `slope`
    /// (a tick) say where the samples go. told: the frame tells the value.
    std::size_t choose(const std::array<float, n>& value, const std::array<float, n>& slope,
                       bool told) const noexcept {
        std::size_t best = 0;
        float least = far_away;
        for (std::size_t i = 0; i < column_count_; ++i) {
            const Child& c = column_[i];
            if (c.cost > column_[0].cost + margin_cost) break;
            float seam = 0;
            for (std::size_t a = 0; a < n; ++a) {
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

    /// Writes the pieces that lead to child i of the column, in order, from steps[from] on.
    /// @return their number.
    template <class Steps>
    std::size_t trace(std::size_t i, Steps& steps, std::size_t from) const noexcept {
        return paths_.trace(vertex_[i], steps, from);
    }

  private:
    using Open = Hypothesis<n>;
    using Child = Vertex<n>;
    /// Room for one path with a vertex at each column, and for what goes back from hypotheses.
    static constexpr std::size_t vertices =
        Columns + 1 + open_max < 254 ? Columns + 1 + open_max : 254;
    static_assert(vertices >= Columns + 1 + width);

    static curve::State<n> state_of(const Child& c, bool fresh) noexcept {
        curve::State<n> state;
        for (std::size_t a = 0; a < n; ++a) state.v[a] = c.v[a];
        state.s = c.s;
        state.last_k = c.last_k;
        state.sign = c.sign;
        state.last_code = c.last_code;
        state.last_ticks = c.last_ticks;
        state.fresh = fresh;
        return state;
    }

    bool bound(Open& o, float age, const Sample& x) const noexcept {
        const float inverse = 1.0f / (o.shape == Shape::line ? age : age * age);
        for (std::size_t a = 0; a < n; ++a) {
            const float d = Geometry::from(x[a], o.v[a]), ahead = o.slope(a) * age;
            const float r = d - ahead, e = Geometry::room(radius_, d, ahead);
            const float low = (r - e) * inverse, high = (r + e) * inverse;
            if (low > o.low[a]) o.low[a] = low;
            if (high < o.high[a]) o.high[a] = high;
            if (!(o.low[a] <= o.high[a])) return false;
        }
        return true;
    }

    /// Long pieces took the whole budget, and none fits: the newest first.
    template <class Source>
    void close_newest(const Column& at, const Source& source) noexcept {
        for (std::size_t i = open_count_; i-- > 0 && column_count_ == 0;) {
            const std::int32_t h = at.tick - open_[i].tick;
            const std::uint8_t code = curve::index_of(h);
            if (code != curve::code::none || at.end) close(open_[i], h, code, at, source);
        }
    }

    /// Offers vertices at the end of a piece of h ticks. index: of its length, or none.
    template <class Source>
    void close(const Open& o, std::int32_t h, std::uint8_t index, const Column& at,
               const Source& source) noexcept {
        const auto& costs = code::costs<typename Geometry::Kind, n>;
        Ending<n> ending;
        ending.h = h;
        ending.before.fresh = o.shape == Shape::fresh;
        ending.before.last_code = o.last_code;
        ending.before.last_ticks = o.last_ticks;
        ending.before.last_k = o.last_k;
        ending.before.sign = o.sign;
        ending.code = index;
        if (o.shape == Shape::line) ending.way = how::line;
        if (at.end) {
            ending.code = curve::code::to_end;
            ending.way |= how::to_end;
        }
        ending.base = o.cost + costs.length[code::length_row(ending.before)][ending.code];
        if (ending.base >= worst()) return;
        for (std::size_t a = 0; a < n; ++a)
            ending.predicted[a] = curve::predicted_rise(o.slope_units(a), ending.before.fresh, h);
        Geometry::offer(*this, o, ending, at, source);
    }

    /// The rises that are possible for component a: within its bounds, those of the column and of
    /// what a vertex and a piece may hold. @return false: there is none.
    bool box(const Open& o, const Ending<n>& ending, const Column& at, std::size_t a,
             Range& range) const noexcept {
        const bool line = o.shape == Shape::line;
        const auto h = static_cast<float>(ending.h), here = static_cast<float>(o.v[a]);
        if (o.shape != Shape::fresh) {
            const float h2 = line ? h : h * h, ahead = o.slope(a) * h;
            range.low = ahead + o.low[a] * h2;
            range.high = ahead + o.high[a] * h2;
        }
        if (at.known) range.within(at.middle[a] - radius_ - here, at.middle[a] + radius_ - here);
        if (at.after > 0.0f) {
            const Range way_on =
                reach(o.slope(a), line || o.shape == Shape::fresh, h, at.later[a] - here, at.after,
                      radius_ + bend_likely * at.after * at.after);
            range.within(way_on.low, way_on.high);
        }
        range.within(static_cast<float>(-window_steps_max) - here,
                     static_cast<float>(window_steps_max) - here);
        range.within(static_cast<float>(-curve::rise_max), static_cast<float>(curve::rise_max));
        return range.whole();
    }

    Child make(const Open& o, const Ending<n>& ending, const Candidate<n>& c) const noexcept {
        Child child;
        for (std::size_t a = 0; a < n; ++a) {
            const std::int32_t k = c.k[a];
            child.v[a] = static_cast<std::int16_t>(o.v[a] + c.p[a]);
            child.s[a] =
                curve::slope_after(o.slope_units(a), o.shape != Shape::quadratic, c.p[a], ending.h);
            child.last_k[a] = ending.before.fresh ? std::int8_t{0}
                                                  : static_cast<std::int8_t>(k > 100    ? 100
                                                                             : k < -100 ? -100
                                                                                        : k);
            child.sign[a] = k != 0 ? static_cast<std::int8_t>(k > 0 ? 1 : -1) : o.sign[a];
        }
        child.cost = static_cast<std::uint16_t>(c.cost < cost_limit ? c.cost : cost_limit);
        child.before = o.vertex;
        child.way = ending.way;
        child.last_code = ending.code;
        child.last_ticks = static_cast<std::uint8_t>(ending.h);
        return child;
    }
    static bool bounded(const Child& c) noexcept {
        for (const std::int32_t s : c.s)
            if (s > curve::slope_max || s < -curve::slope_max) return false;
        return true;
    }

    /// What costs as much finds no place in the column.
    Cost worst() const noexcept {
        Cost most = cost_limit;
        if (column_count_ > back_ && column_[back_].cost < most) most = column_[back_].cost;
        if (column_count_ > 0 && column_[0].cost + margin_cost < most)
            most = column_[0].cost + margin_cost;
        return most;
    }

    static bool same(const Child& a, const Child& b) noexcept {
        if (a.last_code != b.last_code) return false;
        for (std::size_t i = 0; i < n; ++i)
            if (a.v[i] != b.v[i] || a.s[i] != b.s[i]) return false;
        return true;
    }
    /// Puts a child into the column, sorted by cost; the same state stands there once.
    void place(const Child& c) noexcept {
        std::size_t at = column_count_;
        for (std::size_t i = 0; i < column_count_; ++i) {
            const Child& other = column_[i];
            if (!same(other, c)) continue;
            if (other.cost <= c.cost) return;
            at = i;
            break;
        }
        if (at == column_count_) {
            if (column_count_ <= back_)
                ++column_count_;
            else if (column_[back_].cost <= c.cost)
                return;
            at = column_count_ - 1;
        }
        for (; at > 0 && column_[at - 1].cost > c.cost; --at) column_[at] = column_[at - 1];
        column_[at] = c;
    }

    /// Makes sure that the children of the column find room among the paths. Where nothing else
    /// helps, the column is left to a jump from the column before: one path always has room.
    void make_room() noexcept {
        if (paths_.room() >= width) return;
        for (std::size_t left = open_count_;; left /= 2) {
            drop_dearest(left);
            paths_.forget();
            paths_.keep(before_vertex_);
            for (std::size_t i = 0; i < open_count_; ++i) paths_.keep(open_[i].vertex);
            for (std::size_t i = 0; i < column_count_; ++i) paths_.keep(column_[i].before);
            if (paths_.room() >= width) return;
            if (left == 0) column_count_ = 0;
        }
    }
    void drop_dearest(std::size_t left) noexcept {
        while (open_count_ > left) drop(dearest());
    }
    std::size_t dearest() const noexcept {
        std::size_t dearest = 0;
        for (std::size_t i = 1; i < open_count_; ++i)
            if (open_[i].cost > open_[dearest].cost) dearest = i;
        return dearest;
    }
    void drop(std::size_t which) noexcept {
        for (std::size_t i = which + 1; i < open_count_; ++i) open_[i - 1] = open_[i];
        --open_count_;
    }

    void open_child(const Child& c, std::int32_t tick, std::size_t slot) noexcept {
        if (open_count_ == open_max) {  // the dearest goes; a column's best always finds room
            const std::size_t which = dearest();
            if (slot > 0 && open_[which].cost <= c.cost) return;
            drop(which);
        }
        Open& o = open_[open_count_++];
        for (std::size_t a = 0; a < n; ++a) {
            o.low[a] = -far_away;
            o.high[a] = far_away;
            o.s[a] = static_cast<float>(c.s[a]);
        }
        o.v = c.v;
        o.cost = c.cost;
        o.tick = static_cast<std::uint8_t>(tick);
        o.vertex = vertex_[slot];
        o.first = last_;
        o.last_k = c.last_k;
        o.sign = c.sign;
        o.last_code = c.last_code;
        o.last_ticks = c.last_ticks;
        o.shape = c.last_code == curve::code::jump ? Shape::line : Shape::quadratic;
    }

    std::array<Open, open_max> open_{};
    std::array<Child, width> column_{};
    Paths<n, vertices> paths_{};
    std::array<std::uint8_t, width> vertex_{};  // those of the column
    Child before_{};
    Cost best_{0};
    float radius_{};
    std::size_t open_count_{0}, column_count_{0};
    std::size_t back_{width - 1};  // place of the dearest child that the column keeps
    std::uint8_t tick_{0}, before_tick_{0}, before_vertex_{0};
    std::uint8_t last_{0};  // one behind the last sample of the column
    bool fresh_{true};
};

}  // namespace fairlead::reduce
