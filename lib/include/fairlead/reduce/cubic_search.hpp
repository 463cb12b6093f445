#pragma once
// The search of one axis for C2 cubics: a beam over vertices, as search.hpp, with exact states.
//
// A vertex that is kept goes on by one cubic of any length: running bounds on its third derivative
// take each sample in constant time, and at a column the bounds allow some lattice values for the
// control point. A cubic decides more than the samples under it, because its control point lies h
// behind its end: a cheap one may leave no way on. So the beam is ordered by bits and by the
// squared distances of the last two control points from the estimates of cubic_guide.hpp.
// A column is offered some ticks after its samples have come: the estimates must look ahead.
//
// Bounds are floats with room for their rounding; the vertices that are kept have the exact state
// of curve/cubic_state.hpp, so that nothing adds up along a curve.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/code/cubic_pieces.hpp"
#include "fairlead/code/cubic_tables.hpp"
#include "fairlead/math/approx.hpp"
#include "fairlead/reduce/beam.hpp"

namespace fairlead::reduce {

/// Bits for a control point that is one step off its estimate: that of the piece, and the one at
/// its end.
inline constexpr float control_weight = 1.1f, vertex_weight = 0.6f;
/// Price of a break, beside what it costs, in bits; dearer vertices than by this are dropped.
inline constexpr float break_price = 40.0f, cubic_margin = 40.0f;
/// Two vertices behind pieces of one length are the same if they differ by less than this.
inline constexpr float same_vertex = 0.02f;

/// A sample behind the end of a frame: ticks from there, and steps against the origin.
struct SampleAhead {
    float after{}, x{};
};
/// A column of this search.
struct CubicColumn {
    std::int32_t tick{};  // from the window's start
    std::int32_t left{};  // ticks from here to where the frame ends, or is likely to
    bool end{};           // the frame ends here
    float middle{};       // about where the curve is there, in steps against the origin
    std::array<SampleAhead, 4> ahead{};  // the next samples, where the frame ends
    std::size_t ahead_count{0};
};

template <class BeamT, std::size_t Columns>
class CubicSearch {
  public:
    using State = curve::CubicState<1>;
    static constexpr std::size_t width = BeamT::width;
    static constexpr std::size_t open_max = BeamT::open;

    /// Begins a window in a state. origin: of all numbers; radius: the tolerance in steps.
    void seed(const State& state, std::int32_t origin, float radius) noexcept {
        radius_ = radius;
        origin_ = origin;
        paths_.clear();
        tick_ = before_tick_ = 0;
        open_count_ = child_count_ = 0;
        best_ = node_of(state, 0, 0.0f, paths_.start);
        before_ = best_;
        open_[open_count_++] = best_;
    }

    /// A sample at tick + part, in 1/1024 steps against the origin. Hypotheses that it contradicts
    /// end.
    void sample(std::int32_t tick, float part, std::int32_t x) noexcept {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < open_count_; ++i) {
            Node& o = open_[i];
            const float age = static_cast<float>(tick - o.tick) + part;
            if (age > 0.0f && !bound(o, age, x)) continue;
            if (kept != i) open_[kept] = o;
            ++kept;
        }
        open_count_ = kept;
    }

    /// Offers vertices at a column. guide: CubicGuide of the samples that are known.
    template <class Guide>
    void column(const CubicColumn& at, const Guide& guide) noexcept {
        before_ = best_;
        before_tick_ = tick_;
        tick_ = static_cast<std::uint8_t>(at.tick);
        child_count_ = 0;
        make_room();
        for (auto& w : wish_) w.known = false;
        std::size_t kept = 0;
        for (std::size_t i = 0; i < open_count_; ++i) {
            const std::int32_t h = at.tick - open_[i].tick;
            if (h > curve::lengths.back() && !at.end) continue;
            if (kept != i) open_[kept] = open_[i];
            if (h > 0) close(kept, h, at, guide);
            ++kept;
        }
        open_count_ = kept;
    }
    /// Is a jump from the column before of use, if it costs these bits?
    bool jump_helps(float bits) const noexcept {
        return child_count_ == 0 ||
               children_[0].order > before_.bits + before_.price + bits + 2.0f * break_price;
    }
    /// The vertex before the last column, from which a jump may lead.
    const State& before_state() const noexcept { return before_.state; }
    /// The way by a jump to a state at rest.
    void offer_jump(const State& to, float bits) noexcept {
        Child c;
        c.bits = before_.bits + bits;
        c.price = before_.price + break_price;
        c.order = c.bits + c.price + break_price;
        c.jump = true;
        c.ticks = 1;
        jump_ = to;
        place(c);
    }
    /// Keeps the children of the column. end: the frame ends there, and the first one is its end.
    void keep(bool end) noexcept {
        std::array<Node, width> fresh;
        std::size_t count = 0;
        for (std::size_t i = 0; i < child_count_ && (!end || count == 0); ++i) {
            const Child& c = children_[i];
            Node n;
            if (c.jump)
                n = node_of(jump_, tick_, c.bits, paths_.start);
            else if (!follow(c, n))
                continue;
            n.price = c.price;
            const auto since = static_cast<std::uint8_t>(tick_ - before_tick_);
            const auto aim = static_cast<std::int16_t>(
                c.jump ? curve::lattice_near(n.state.at[0]) - origin_ : c.aim);
            const std::uint8_t way = c.jump
                                         ? how::jump
                                         : static_cast<std::uint8_t>((c.line ? how::line : 0) |
                                                                     (c.to_end ? how::to_end : 0));
            n.vertex = paths_.add(c.jump ? before_.vertex : open_[c.parent].vertex,
                                  {{aim}, c.jump ? since : c.ticks, way});
            fresh[count++] = n;
        }
        if (count == 0) return;  // all were refused: the frame's check gives it up
        best_ = fresh[0];
        for (std::size_t i = 0; i < count && !end; ++i) open(fresh[i], i == 0);
    }

    /// Bits of the best path so far.
    float bits() const noexcept { return best_.bits; }
    const State& state() const noexcept { return best_.state; }
    /// The pieces of the best path, in order. @return their number.
    template <class Steps>
    std::size_t trace(Steps& steps) const noexcept {
        return paths_.trace(best_.vertex, steps, 0);
    }

  private:
    /// A vertex that is kept, and the hypothesis that begins there.
    struct Node {
        State state{};
        std::int32_t base{};     // the lattice value next to it, against the origin
        float part{}, v{}, a{};  // against base; in steps and ticks
        float low{}, high{};     // bounds of the third derivative, or of a line's slope
        float bits{}, price{};   // of the path, and of its breaks beside
        std::uint8_t tick{}, vertex{};
    };
    struct Child {
        float bits{}, price{}, order{}, p{}, v{}, a{};
        std::int32_t aim{};  // control point, or end of a line; against the origin
        std::uint8_t parent{}, ticks{}, code{};
        bool to_end{}, line{}, jump{};
    };
    struct Wish {
        float next{}, here{};
        bool known{false};
    };
    static constexpr std::size_t vertices =
        Columns + 1 + open_max < 254 ? Columns + 1 + open_max : 254;
    static_assert(vertices >= Columns + 1 + width);

    Node node_of(const State& state, std::int32_t tick, float bits,
                 std::uint8_t vertex) const noexcept {
        Node n;
        n.state = state;
        const std::int32_t near_by = curve::lattice_near(state.at[0]);
        n.base = near_by - origin_;
        n.part = curve::part_of<float>(state.at[0], near_by);
        constexpr float unit = 1.0f / static_cast<float>(curve::cubic_unit);
        n.v = static_cast<float>(state.at[0].v) * (unit * 0.5f);
        n.a = static_cast<float>(state.at[0].a) * unit;
        n.low = -far_away;
        n.high = far_away;
        n.bits = bits;
        n.tick = static_cast<std::uint8_t>(tick);
        n.vertex = vertex;
        return n;
    }

    bool bound(Node& o, float age, std::int32_t x) const noexcept {
        const float d =
            static_cast<float>(x - o.base * curve::fine) * (1.0f / curve::fine) - o.part;
        const bool line = o.state.loose();
        const float ahead = line ? 0.0f : age * (o.v + age * o.a * 0.5f);
        const float lost =
            approx::absolute(d) + approx::absolute(o.part) +
            (line ? 0.0f : age * (approx::absolute(o.v) + age * approx::absolute(o.a)));
        const float e = radius_ - lost * rounding;
        const float inverse = line ? 1.0f / age : 6.0f / (age * age * age);
        const float low = (d - ahead - e) * inverse, high = (d - ahead + e) * inverse;
        if (low > o.low) o.low = low;
        if (high < o.high) o.high = high;
        return o.low <= o.high;
    }

    template <class Guide>
    void close(std::size_t parent, std::int32_t h, const CubicColumn& at,
               const Guide& guide) noexcept {
        const Node& o = open_[parent];
        const State& s = o.state;
        const std::uint8_t index = curve::index_of(h);
        if (index == curve::code::none && !at.end) return;
        if (s.loose()) return close_line(parent, h, index, at, guide);
        if (s.run > 0 && index == curve::code::none) return;
        if ((s.run == 1 || s.run == 2) && h != s.last_ticks) return;
        if (s.run == 3 && 2 * h > at.left) return;
        Child c;
        c.parent = static_cast<std::uint8_t>(parent);
        c.ticks = static_cast<std::uint8_t>(h);
        c.to_end = at.end && s.run == 0;
        c.code = c.to_end ? curve::code::to_end : index;
        c.bits = o.bits + code_bits(s, c.code, at.left + h);
        c.price = o.price;
        if (c.bits + c.price > worst()) return;
        const std::size_t slot = index == curve::code::none ? curve::length_count : index;
        Wish& wish = wish_[slot];
        if (!wish.known) {
            const auto t = static_cast<float>(at.tick), ticks = static_cast<float>(h);
            wish = {guide.control(t + ticks, ticks), guide.control(t, ticks), true};
        }
        offer_cubics(o, c, h, wish, at);
    }
    /// The control points that are cheap and near to the estimate.
    void offer_cubics(const Node& o, Child c, std::int32_t ticks, const Wish& wish,
                      const CubicColumn& column) noexcept {
        const State& s = o.state;
        const auto h = static_cast<float>(ticks), base = static_cast<float>(o.base);
        const float h2 = h * h, h3 = h2 * h, hv = h * o.v, h2a = h2 * o.a;
        const float middle = o.part + 2.0f * hv + (11.0f / 6.0f) * h2a;
        float low = middle + h3 * o.low, high = middle + h3 * o.high;
        constexpr auto most = static_cast<float>(window_steps_max);
        if (low < -most - base) low = -most - base;
        if (high > most - base) high = most - base;
        if (!(low <= high)) return;
        const Range range{low, high};
        const std::int32_t first = range.first(), last = range.last();
        if (first > last) return;
        const std::int32_t expected = predicted(o, ticks, hv, h2a);
        float aim = wish.next - base;
        if (aim < static_cast<float>(first)) aim = static_cast<float>(first);
        if (aim > static_cast<float>(last)) aim = static_cast<float>(last);
        const auto nearest = static_cast<std::int32_t>(aim < 0.0f ? aim - 0.5f : aim + 0.5f);
        // the control point at the vertex does not depend on the piece's own
        const float off = o.part + base + hv + h2a * (1.0f / 3.0f) - wish.here;
        const float beside = vertex_weight * off * off;
        const std::size_t row =
            s.run > 0 ? (s.run == 3 ? 0 : code::cubic_run_row(s.run, ticks))
                      : code::cubic_value_row(s.last_k[0], s.before_k[0],
                                              static_cast<std::int64_t>(h2a * 1024.0f), ticks,
                                              s.last_ticks);
        const Ending e{o, column, c, h, middle, wish.next - base, beside, expected, row};
        for (std::int32_t d = -2; d <= 2; ++d)
            if (nearest + d >= first && nearest + d <= last) offer(e, nearest + d);
        for (std::int32_t d = -1; d <= 1 && s.run != 3; ++d) {
            const std::int32_t at = expected + d;
            if (at >= first && at <= last && (at < nearest - 2 || at > nearest + 2)) offer(e, at);
        }
    }
    struct Ending {
        const Node& from;
        const CubicColumn& column;
        Child child;
        float h, middle, wish, beside;
        std::int32_t expected;
        std::size_t row;
    };
    void offer(const Ending& e, std::int32_t aim) noexcept {
        const State& s = e.from.state;
        Child c = e.child;
        const float off = static_cast<float>(aim) - e.wish;
        const std::int32_t k = aim - e.expected;
        if (s.run != 3)
            c.bits += static_cast<float>(code::value_cost(code::cubic_costs<1>.value[e.row], k,
                                                          s.run > 0 ? std::int8_t{0} : s.sign[0])) *
                      (1.0f / 16.0f);
        c.order = c.bits + c.price + e.beside + control_weight * off * off;
        if (c.order > worst()) return;
        const float h = e.h, j = (static_cast<float>(aim) - e.middle) / (h * h * h);
        const Node& o = e.from;
        c.aim = o.base + aim;
        c.p = static_cast<float>(o.base) + o.part +
              h * (o.v + h * (o.a * 0.5f + h * j * (1.0f / 6.0f)));
        c.v = o.v + h * (o.a + h * j * 0.5f);
        c.a = o.a + h * j;
        constexpr auto v_max = static_cast<float>(curve::cubic_velocity_max - 1);
        constexpr auto a_max = static_cast<float>(curve::cubic_acceleration_max - 1);
        if (!(approx::absolute(c.v) < v_max && approx::absolute(c.a) < a_max)) return;
        if (e.column.ahead_count > 0 && !goes_on(c, e.column)) c.order += break_price;
        place(c);
    }
    /// Is there a cubic from this end of a frame that holds the next samples?
    bool goes_on(const Child& c, const CubicColumn& column) const noexcept {
        float low = -far_away, high = far_away;
        for (std::size_t i = 0; i < column.ahead_count && low <= high; ++i) {
            const float t = column.ahead[i].after, inverse = 6.0f / (t * t * t);
            const float off = column.ahead[i].x - c.p - t * (c.v + t * c.a * 0.5f);
            const float l = (off - radius_) * inverse, h = (off + radius_) * inverse;
            if (l > low) low = l;
            if (h < high) high = h;
        }
        return low <= high;
    }
    /// In float, but for runs: k may be one off where a half is near.
    std::int32_t predicted(const Node& o, std::int32_t h, float hv, float h2a) const noexcept {
        const State& s = o.state;
        const std::int32_t base = origin_ + o.base;
        if (s.run == 3) return 0;
        if (s.run > 0) return curve::predicted_control(s, 0, h) - base;
        const std::size_t ratio = curve::length_ratio(h, s.last_ticks);
        const float rise =
            o.part + static_cast<float>(curve::axis_weights.travel[ratio]) * (1.0f / 64.0f) * hv +
            static_cast<float>(curve::axis_weights.bend[ratio]) * (1.0f / 64.0f) * h2a;
        if (!(approx::absolute(rise) < 1e6f)) return 1000000;
        return static_cast<std::int32_t>(rise < 0.0f ? rise - 0.5f : rise + 0.5f);
    }
    static float code_bits(const State& s, std::uint8_t c, std::int32_t left) noexcept {
        const auto& costs = code::cubic_costs<1>;
        const auto way = c == curve::code::to_end ? code::Way::to_end : code::Way::listed;
        code::Cost cost = 0;
        if (s.run == 0)
            cost += costs.way[code::cubic_way_row(s.last_code, s.last_ticks, left)]
                             [static_cast<std::size_t>(way)];
        if (way == code::Way::listed && (s.run == 0 || s.run == 3))
            cost += costs.length[code::cubic_length_row(s.last_code, s.run > 0)][c];
        return static_cast<float>(cost) * (1.0f / 16.0f);
    }
    /// Behind a jump: a straight line.
    template <class Guide>
    void close_line(std::size_t parent, std::int32_t h, std::uint8_t index, const CubicColumn& at,
                    const Guide& guide) noexcept {
        const Node& o = open_[parent];
        Range range{o.part + static_cast<float>(h) * o.low,
                    o.part + static_cast<float>(h) * o.high};
        const float base = static_cast<float>(o.base);
        range.within(-static_cast<float>(window_steps_max) - base,
                     static_cast<float>(window_steps_max) - base);
        if (!range.whole() || range.first() > range.last()) return;
        float to = at.middle - base;
        if (to < static_cast<float>(range.first())) to = static_cast<float>(range.first());
        if (to > static_cast<float>(range.last())) to = static_cast<float>(range.last());
        const auto nearest = static_cast<std::int32_t>(to < 0.0f ? to - 0.5f : to + 0.5f);
        const auto& costs = code::cubic_costs<1>;
        const float slope = o.v * static_cast<float>(h);
        const auto expected = static_cast<std::int32_t>(slope < 0.0f ? slope - 0.5f : slope + 0.5f);
        Child c;
        c.parent = static_cast<std::uint8_t>(parent);
        c.ticks = static_cast<std::uint8_t>(h);
        c.to_end = at.end;
        c.line = true;
        c.code = at.end ? curve::code::to_end : index;
        c.aim = o.base + nearest;
        c.p = static_cast<float>(c.aim);
        c.v = static_cast<float>(nearest) / static_cast<float>(h);
        const std::size_t row = code::cubic_line_row(h);
        c.bits =
            o.bits + static_cast<float>(costs.line[c.code] +
                                        code::value_cost(costs.value[row], nearest - expected, 0)) *
                         (1.0f / 16.0f);
        c.price = o.price;
        const auto ticks = static_cast<float>(h);
        const float off =
            c.p + c.v * ticks - guide.control(static_cast<float>(at.tick) + ticks, ticks);
        c.order = c.bits + c.price + control_weight * off * off;
        if (c.order <= worst() && approx::absolute(c.v) < 8000.0f) place(c);
    }

    /// What is dearer finds no place.
    float worst() const noexcept {
        float most = far_away;
        if (child_count_ == width) most = children_[width - 1].order;
        if (child_count_ > 0 && children_[0].order + cubic_margin < most)
            most = children_[0].order + cubic_margin;
        return most;
    }
    static bool same(const Child& a, const Child& b) noexcept {
        if (a.ticks != b.ticks || a.jump != b.jump || a.line != b.line) return false;
        const auto h = static_cast<float>(a.ticks);
        return approx::absolute(a.p - b.p) < same_vertex &&
               approx::absolute(a.v - b.v) * h < same_vertex &&
               approx::absolute(a.a - b.a) * (0.3f * h * h) < same_vertex;
    }
    /// Puts a child into the column, which is sorted; the same vertex stands there once, and few of
    /// one length.
    void place(const Child& c) noexcept {
        constexpr std::size_t alike_max = width > 10 ? width / 5 : 2;
        std::size_t alike = 0, out = child_count_;
        for (std::size_t i = 0; i < child_count_; ++i) {
            const Child& o = children_[i];
            if (o.ticks != c.ticks) continue;
            ++alike;
            if (same(o, c)) {
                if (o.order <= c.order) return;
                out = i;
                alike = 0;
                break;
            }
            if (alike >= alike_max) {
                if (o.order <= c.order) return;
                out = i;
            }
        }
        if (out == child_count_) {
            if (child_count_ < width)
                ++child_count_;
            else if (children_[width - 1].order <= c.order)
                return;
            out = child_count_ - 1;
        }
        for (; out > 0 && children_[out - 1].order > c.order; --out)
            children_[out] = children_[out - 1];
        children_[out] = c;
    }

    /// The exact vertex at the end of a piece. @return false: out of bounds.
    bool follow(const Child& c, Node& n) const noexcept {
        State s = open_[c.parent].state;
        curve::Piece<1> piece;
        curve::CubicSpan<1> span;
        piece.code = c.line ? static_cast<std::uint8_t>(c.code + curve::code::line) : c.code;
        piece.subs = static_cast<std::uint16_t>(c.ticks * curve::subs_per_tick);
        piece.k[0] = origin_ + c.aim -
                     (c.line ? curve::predicted_end(s, 0, c.ticks)
                             : curve::predicted_control(s, 0, c.ticks));
        if (!curve::step(s, piece, span)) return false;
        n = node_of(s, tick_, c.bits, paths_.start);
        return true;
    }

    void open(const Node& n, bool first) noexcept {
        if (open_count_ == open_max) {
            const std::size_t which = dearest();
            if (!first && open_[which].bits + open_[which].price <= n.bits + n.price) return;
            drop(which);
        }
        open_[open_count_++] = n;
    }
    /// Makes sure that the children of a column find room among the paths. Where nothing else
    /// helps, the column is left to a jump from the column before: one path always has room.
    void make_room() noexcept {
        if (paths_.room() >= width) return;
        for (std::size_t left = open_count_;; left /= 2) {
            while (open_count_ > left) drop(dearest());
            paths_.forget();
            paths_.keep(before_.vertex);
            for (std::size_t i = 0; i < open_count_; ++i) paths_.keep(open_[i].vertex);
            if (paths_.room() >= width || left == 0) return;
        }
    }
    std::size_t dearest() const noexcept {
        std::size_t most = 0;
        for (std::size_t i = 1; i < open_count_; ++i)
            if (open_[i].bits + open_[i].price > open_[most].bits + open_[most].price) most = i;
        return most;
    }
    void drop(std::size_t which) noexcept {
        for (std::size_t i = which + 1; i < open_count_; ++i) open_[i - 1] = open_[i];
        --open_count_;
    }

    std::array<Node, open_max> open_{};
    std::array<Child, width> children_{};
    std::array<Wish, curve::length_count + 1> wish_{};
    Paths<1, vertices> paths_{};
    Node best_{}, before_{};  // of the last column and of the one before
    State jump_{};
    float radius_{};
    std::int32_t origin_{0};
    std::size_t open_count_{0}, child_count_{0};
    std::uint8_t tick_{0}, before_tick_{0};
};

}  // namespace fairlead::reduce
