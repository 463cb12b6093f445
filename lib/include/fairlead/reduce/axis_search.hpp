#pragma once
// Search of one axis: beam.hpp for pieces of one component, integers for the state, float bounds.
//
// Values are in 1/1024 lattice steps against the origin of the window, times in ticks from its
// start. A hypothesis at (tick, v, s) allows rises p of a piece of h ticks with
//     |x - v - s a - (p - s h) (a / h)^2| <= radius   for every sample x at age a,
// so that lo <= (p - s h) / h^2 <= hi with running lo and hi. Fresh pieces are cubics in a / h:
// their bounds run for each length apart.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/curve/scale.hpp"
#include "fairlead/math/approx.hpp"
#include "fairlead/reduce/beam.hpp"

namespace fairlead::reduce {

template <class Kind, class BeamT, std::size_t Columns>
class AxisSearch {
  public:
    static constexpr std::size_t width = BeamT::width;
    static constexpr std::size_t open_max = BeamT::open;

    /// A vertex that a column offers.
    struct Child {
        std::int32_t s{};
        std::int16_t v{};
        std::uint16_t cost{};
        std::uint8_t parent_column{};
        std::uint8_t way{};  // how::...
        std::int8_t last_k{}, sign{};
        std::uint8_t last_code{}, last_ticks{};
    };

    /// Begins a window at a vertex whose v is the origin.
    /// @param guess the ticks at which the frame is likely to end: a fresh piece may reach it
    void seed(const curve::State<1>& state, float radius, std::int32_t guess) noexcept {
        radius_ = radius;
        guess_ = guess;
        Child c;
        c.s = state.s[0];
        c.last_k = state.last_k[0];
        c.sign = state.sign[0];
        c.last_code = state.last_code;
        c.last_ticks = state.last_ticks;
        fresh_ = state.fresh;
        column_[0] = c;
        column_count_ = 1;
        best_ = 0;
        open_count_ = 0;
        index_ = before_index_ = 0;
        back_[0][0] = {};
        for (std::size_t i = 0; i < fresh_lo_.size(); ++i)
            fresh_lo_[i] = -far_away, fresh_hi_[i] = far_away;
        open_child(c, 0, 0, 0);
        open_[0].shape = shape_of(state);
    }

    /// A sample at tick + part, value x. Hypotheses that it contradicts end.
    void sample(std::int32_t tick, float part, std::int32_t x) noexcept {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < open_count_; ++i) {
            Open& o = open_[i];
            const float age = static_cast<float>(tick - o.tick) + part;
            if (age > 0.0f &&
                !(o.shape == Shape::fresh ? bound_fresh(o, age, x) : bound(o, age, x)))
                continue;
            if (kept != i) open_[kept] = o;
            ++kept;
        }
        open_count_ = kept;
    }

    /// Offers vertices at column `index`, tick `tick`. `told`: the frame ends here at a place that
    /// it tells, so that the last k costs nothing.
    void column(std::size_t index, std::int32_t tick, const Level& level, bool end,
                bool told) noexcept {
        before_ = column_[0];
        before_index_ = index_;
        index_ = static_cast<std::uint8_t>(index);
        column_count_ = 0;
        const Cost bound = best_ + margin_cost;
        const bool many = open_count_ > 1;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < open_count_; ++i) {
            Open& o = open_[i];
            const std::int32_t h = tick - o.tick;
            if (many && o.cost + step_cost_min > bound) continue;
            if (h > 120 && !end) continue;
            const std::uint8_t code = curve::index_of(h);
            if (code != curve::code::none || end) close(o, h, code, level, end, told);
            if (kept != i) open_[kept] = o;
            ++kept;
        }
        open_count_ = kept;
    }

    /// Offers a jump from the column before: what is always possible. Call after column().
    void offer_jump(std::int32_t v, Cost jump_cost) noexcept {
        const Cost cost = before_.cost + jump_cost;
        if (column_count_ > 0 && cost >= column_[0].cost) return;
        Child c;
        c.v = static_cast<std::int16_t>(v);
        c.cost = static_cast<std::uint16_t>(cost < cost_limit ? cost : cost_limit);
        c.parent_column = before_index_;
        c.way = how::jump;
        c.sign = before_.sign;
        c.last_code = curve::code::jump;
        c.last_ticks = 1;
        place(c);
    }

    /// Lets the children of the column grow, unless the frame ends here.
    void grow(std::int32_t tick) noexcept {
        for (std::size_t i = 0; i < column_count_; ++i) {
            const Child& c = column_[i];
            back_[index_][i] = {c.v, c.parent_column, c.way};
            open_child(c, tick, index_, i);
        }
        best_ = column_[0].cost;
    }
    void record() noexcept {
        for (std::size_t i = 0; i < column_count_; ++i)
            back_[index_][i] = {column_[i].v, column_[i].parent_column, column_[i].way};
    }

    std::size_t count() const noexcept { return column_count_; }
    const Child& child(std::size_t i) const noexcept { return column_[i]; }
    const Child& before() const noexcept { return before_; }
    /// The best vertex of the column before the last one, from which a jump may lead.
    curve::State<1> before_state(bool first) const noexcept {
        return state_of(before_, first && fresh_);
    }
    bool alive() const noexcept { return open_count_ > 0; }
    Cost cost() const noexcept { return column_count_ > 0 ? column_[0].cost : before_.cost; }
    float radius() const noexcept { return radius_; }

    /// Child to end the window with: the cheapest, the seam to come included. `value` and `slope`
    /// (a tick) say where the samples go, in 1/1024 steps.
    std::size_t choose(float value, float slope) const noexcept {
        std::size_t best = 0;
        float least = far_away;
        for (std::size_t i = 0; i < column_count_; ++i) {
            const Child& c = column_[i];
            if (c.cost > column_[0].cost + margin_cost) break;
            const float off = static_cast<float>(c.v * curve::fine) - value;
            const float turn = static_cast<float>(c.s) * slope_fine - slope;
            const float seam = (off + turn * seam_ticks) / radius_;
            const float all = static_cast<float>(c.cost) + seam_weight * seam * seam;
            if (all < least) least = all, best = i;
        }
        return best;
    }

    /// State at a child, v against the origin.
    curve::State<1> state(std::size_t i) const noexcept { return state_of(column_[i], false); }

    /// Writes the pieces that lead to child i of the column, in order. @return their number.
    /// ticks: tick of each column.
    template <class Ticks, class Steps>
    std::size_t trace(std::size_t i, const Ticks& ticks, Steps& steps) const noexcept {
        std::size_t count = 0;
        for (std::size_t c = index_, s = i; c > 0 && count < Columns; ++count) {
            const Back& b = back_[c][s];
            c = b.column;
            s = b.way & how::slot;
        }
        std::size_t at = count;
        for (std::size_t c = index_, s = i; at > 0;) {
            const Back& b = back_[c][s];
            Step<1>& step = steps[--at];
            step.v[0] = b.v;
            step.ticks = static_cast<std::uint8_t>(ticks[c] - ticks[b.column]);
            step.how = b.way;
            c = b.column;
            s = b.way & how::slot;
        }
        return count;
    }

  private:
    struct Open {
        float lo, hi, s;
        std::int32_t slope;
        std::int16_t v;
        std::uint16_t cost;
        std::uint8_t tick, column, slot;
        std::int8_t last_k, sign;
        std::uint8_t last_code, last_ticks;
        Shape shape;
    };
    struct Back {
        std::int16_t v;
        std::uint8_t column, way;
    };

    static constexpr float slope_fine =
        static_cast<float>(curve::fine) / static_cast<float>(curve::slope_unit);
    static constexpr std::size_t fresh_count = curve::length_count + 1;

    static constexpr std::array<float, curve::length_count> inverse_lengths() noexcept {
        std::array<float, curve::length_count> inverse{};
        for (std::size_t i = 0; i < inverse.size(); ++i)
            inverse[i] = 1.0f / static_cast<float>(curve::lengths[i]);
        return inverse;
    }
    static constexpr auto inverse_length = inverse_lengths();

    static curve::State<1> state_of(const Child& c, bool fresh) noexcept {
        curve::State<1> state;
        state.v[0] = c.v;
        state.s[0] = c.s;
        state.last_k[0] = c.last_k;
        state.sign[0] = c.sign;
        state.last_code = c.last_code;
        state.last_ticks = c.last_ticks;
        state.fresh = fresh;
        return state;
    }

    bool bound(Open& o, float age, std::int32_t x) const noexcept {
        const float d = static_cast<float>(x - o.v * curve::fine), ahead = o.s * age;
        const float e = radius_ - (approx::absolute(d) + approx::absolute(ahead)) * rounding;
        if (!(e > 0.0f)) return false;
        const float r = d - ahead;
        const float inverse = 1.0f / (o.shape == Shape::line ? age : age * age);
        const float a = (r - e) * inverse, b = (r + e) * inverse;
        if (a > o.lo) o.lo = a;
        if (b < o.hi) o.hi = b;
        return o.lo <= o.hi;
    }

    /// The first piece after a restart: v + s a (1 - w)^2 + p w^2 (2 - w), w = a / h.
    bool bound_fresh(Open& o, float age, std::int32_t x) noexcept {
        const float d = static_cast<float>(x - o.v * curve::fine);
        bool any = false;
        for (std::size_t i = 0; i < fresh_count; ++i) {
            const bool listed = i < curve::length_count;
            const float h =
                listed ? static_cast<float>(curve::lengths[i]) : static_cast<float>(guess_);
            if (h < age || fresh_lo_[i] > fresh_hi_[i]) continue;
            const float w = age * (listed ? inverse_length[i] : 1.0f / h), rest = 1.0f - w;
            const float inverse = 1.0f / (w * w * (2.0f - w)), ahead = o.s * age * (rest * rest);
            const float e =
                radius_ - (approx::absolute(d) + approx::absolute(ahead)) * (4.0f * rounding);
            const float a = (d - ahead - e) * inverse, b = (d - ahead + e) * inverse;
            if (a > fresh_lo_[i]) fresh_lo_[i] = a;
            if (b < fresh_hi_[i]) fresh_hi_[i] = b;
            any = any || fresh_lo_[i] <= fresh_hi_[i];
        }
        return any;
    }

    void close(const Open& o, std::int32_t h, std::uint8_t index, const Level& level, bool end,
               bool told) noexcept {
        constexpr float per_step = 1.0f / static_cast<float>(curve::fine);
        float low, high;
        const bool fresh = o.shape == Shape::fresh, line = o.shape == Shape::line;
        if (fresh) {
            const std::size_t i = index != curve::code::none ? index
                                  : h == guess_              ? curve::length_count
                                                             : 99;
            if (i > curve::length_count) return;
            low = fresh_lo_[i];
            high = fresh_hi_[i];
        } else {
            const auto hf = static_cast<float>(h);
            const float h2 = line ? hf : hf * hf, ahead = o.s * hf;
            low = ahead + o.lo * h2;
            high = ahead + o.hi * h2;
        }
        const auto here = static_cast<float>(o.v);
        if (level.after > 0.0f) {
            const float bend = bend_likely * static_cast<float>(curve::fine) * level.after;
            const Reach way_on = reach(o.s, fresh || line, static_cast<float>(h),
                                       level.later - here * static_cast<float>(curve::fine),
                                       level.after, radius_ + bend * level.after);
            low = larger(low, way_on.low);
            high = smaller(high, way_on.high);
        }
        low = larger(low * per_step, level.low * per_step - here);
        high = smaller(high * per_step, level.high * per_step - here);
        // within what a vertex and a piece may hold
        low = larger(low, static_cast<float>(-window_steps_max) - here);
        high = smaller(high, static_cast<float>(window_steps_max) - here);
        low = larger(low, static_cast<float>(-curve::rise_max));
        high = smaller(high, static_cast<float>(curve::rise_max));
        if (!(low <= high)) return;
        std::int32_t first = static_cast<std::int32_t>(low), last = static_cast<std::int32_t>(high);
        if (static_cast<float>(first) < low) ++first;
        if (static_cast<float>(last) > high) --last;
        if (first > last) return;
        offer(o, h, index, first, last, end, told, level);
    }

    void offer(const Open& o, std::int32_t h, std::uint8_t index, std::int32_t first,
               std::int32_t last, bool end, bool told, const Level& level) noexcept {
        const auto& costs = code::costs<Kind, 1>;
        const bool fresh = o.shape == Shape::fresh;
        const std::int32_t predicted = curve::predicted_rise(o.slope, fresh, h);
        if (last - first > 3) {  // the four nearest to the prediction
            const std::int32_t from = predicted - 1 < last - 3 ? predicted - 1 : last - 3;
            if (from > first) first = from;
            last = first + 3;
        }
        curve::State<1> state;
        state.fresh = fresh;
        state.last_code = o.last_code;
        state.last_ticks = o.last_ticks;
        state.last_k[0] = o.last_k;
        const auto& lengths = costs.length[code::length_row(state)];
        std::uint8_t code = index, way = o.slot;
        if (o.shape == Shape::line) way |= how::line;
        if (end) {
            code = curve::code::to_end;
            way |= how::to_end;
        }
        const Cost base = o.cost + lengths[code];
        const auto& row = costs.value[code::value_row<Kind>(state, code, h, 0, false)];
        for (std::int32_t p = first; p <= last; ++p) {
            const std::int32_t k = p - predicted;
            Cost cost = base;
            if (told) {
                const float off = static_cast<float>((o.v + p) * curve::fine) - level.middle;
                cost += static_cast<Cost>(seam_weight * approx::absolute(off) / radius_);
            } else {
                cost += code::value_cost(row, k, o.sign);
            }
            add(o, p, k, h, way, code, cost);
        }
    }

    void add(const Open& o, std::int32_t p, std::int32_t k, std::int32_t h, std::uint8_t way,
             std::uint8_t code, Cost cost) noexcept {
        if (column_count_ == width && cost >= column_[width - 1].cost) return;
        if (column_count_ > 0 && cost > column_[0].cost + margin_cost) return;
        if (cost > cost_limit) return;
        Child c;
        const bool fresh = o.shape == Shape::fresh;
        c.s = curve::slope_after(o.slope, o.shape != Shape::quadratic, p, h);
        if (c.s > curve::slope_max || c.s < -curve::slope_max) return;
        c.v = static_cast<std::int16_t>(o.v + p);
        c.cost = static_cast<std::uint16_t>(cost);
        c.parent_column = o.column;
        c.way = way;
        c.last_k = fresh ? std::int8_t{0}
                         : static_cast<std::int8_t>(k > 100    ? 100
                                                    : k < -100 ? -100
                                                               : k);
        c.sign = k != 0 ? static_cast<std::int8_t>(k > 0 ? 1 : -1) : o.sign;
        c.last_code = code;
        c.last_ticks = static_cast<std::uint8_t>(h);
        place(c);
    }

    /// Puts a child into the column, sorted by cost; the same state stands there once.
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
        o.lo = -far_away;
        o.hi = far_away;
        o.s = static_cast<float>(c.s) * slope_fine;
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

    static constexpr float larger(float a, float b) noexcept { return a > b ? a : b; }
    static constexpr float smaller(float a, float b) noexcept { return a < b ? a : b; }

    std::array<Open, open_max> open_{};
    std::array<Child, width> column_{};
    std::array<std::array<Back, width>, Columns + 1> back_{};
    std::array<float, fresh_count> fresh_lo_{}, fresh_hi_{};
    Child before_{};
    Cost best_{0};
    float radius_{};
    std::int32_t guess_{};
    std::size_t open_count_{0}, column_count_{0};
    std::uint8_t index_{0}, before_index_{0};
    bool fresh_{true};
};

}  // namespace fairlead::reduce
