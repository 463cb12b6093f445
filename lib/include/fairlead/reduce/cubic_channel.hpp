#pragma once
// A channel of vectors whose curves are C2 cubics: D axes, each with a search of its own.
//
// It serves the Reducer as vector_channel.hpp does. Two things differ. A column is searched `lag`
// ticks after its samples have come, because a cubic must look ahead. And when a frame is
// committed, the columns that are left are searched in the pushes that follow (check()), while new
// samples come: so the end of a frame is chosen by a search that knows what follows it. The next
// window begins when that is done, from the exact state at the frame's end.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/per_axis.hpp"
#include "fairlead/curve/scale.hpp"
#include "fairlead/reduce/cubic_guide.hpp"
#include "fairlead/reduce/cubic_search.hpp"
#include "fairlead/reduce/extent.hpp"
#include "fairlead/reduce/jump_walk.hpp"
#include "fairlead/reduce/samples.hpp"
#include "fairlead/reduce/seam.hpp"
#include "fairlead/reduce/vector_channel.hpp"

namespace fairlead::reduce {

/// What a channel says of a committed frame.
template <std::size_t D>
struct CubicSegment : Extent {
    std::array<curve::CubicState<1>, D> start{};
    std::array<std::int32_t, D> first{};  // first control points, where a run begins
};

template <std::size_t D, class BeamT, std::size_t Window>
class CubicChannel {
    static_assert(D >= 1 && D <= vector_components_max, "a frame holds one step of 5 axes");
    static_assert(Window >= 4 && Window <= 240, "a window holds 4 to 240 records");

  public:
    using Value = std::array<float, D>;
    using Segment = CubicSegment<D>;
    using PieceType = curve::Piece<1>;
    using State = curve::CubicState<1>;
    using KindType = curve::Cubics;
    static constexpr std::size_t parts = D;  // searches, each with a list of pieces
    static constexpr std::size_t components = 1;
    static constexpr std::size_t window = Window;
    /// Ticks that a column's search knows ahead; columns searched at a push, at most, while a
    /// window is open and behind a commit.
    static constexpr std::int32_t lag = 12;
    static constexpr std::size_t columns_a_push = 2, columns_behind = 3;
    /// The same where a frame must leave in one push, before the column of its end.
    static constexpr std::size_t columns_at_once = 1;
    static constexpr Cost column_bits_max = D * jump_bits_max(1);
    static constexpr Cost start_bits_max = 9 + 27 * D + 79;
    /// About what the next column may add.
    Cost next_column_bits(std::size_t) const noexcept {
        return static_cast<Cost>(D) * 40 + (starts_ ? start_bits_max : 0);
    }

    /// tolerance: largest error of each axis, in the values' unit; > 0.
    void configure(const PerAxis<D>& tolerance) noexcept {
        for (std::size_t a = 0; a < D; ++a) {
            Lattice& l = lattice_[a];
            l.scale = curve::Scale::of_step(cubic_step * tolerance[a]);
            const float steps = tolerance[a] / l.scale.template step<float>();
            l.full_radius = steps * static_cast<float>(curve::fine);
            l.radius = l.full_radius * (1.0f - 0x1p-18f) * BeamT::trust - 1.0f;
        }
    }
    const curve::Scale& scale(std::size_t axis = 0) const noexcept { return lattice_[axis].scale; }

    bool active() const noexcept { return active_; }
    /// Has the curve begun in this frame?
    bool starts() const noexcept { return starts_; }
    bool stalled() const noexcept { return stalled_; }
    std::int32_t start_tick() const noexcept { return start_tick_; }
    /// Tick of the newest sample, rounded up: where a curve without a successor ends.
    std::int32_t last_tick() const noexcept { return ceiling(newest_); }
    const curve::Moment& newest() const noexcept { return newest_; }

    /// A curve begins at this sample's tick. guess: ticks at which the frame is likely to end.
    void start(const curve::Moment& at, const Value& value, std::int32_t guess) noexcept {
        for (std::size_t a = 0; a < D; ++a) {
            origin_[a] = nearest(a, value);
            state_[a] = State::begin({origin_[a]});
        }
        active_ = starts_ = true;
        stalled_ = false;
        start_tick_ = at.tick;
        guess_ = at.tick + guess;
        sum_ = {};
        keep(at, value);
        if (!finishing_) open_window();
    }

    /// Can the window hold this value?
    bool reaches(const Value& value) const noexcept {
        constexpr std::int64_t most = std::int64_t{window_steps_max} << curve::fine_bits;
        for (std::size_t a = 0; a < D; ++a) {
            const std::int64_t x = to_fine(a, value) - fine_origin(a);
            if (x > most || x < -most) return false;
        }
        return true;
    }

    /// A sample of an active channel, behind newest().
    void push(const curve::Moment& at, const Value& value, std::int32_t, bool, Seam) noexcept {
        if (!reaches(value)) stalled_ = true;
        keep(at, value);
        if (finishing_ || stalled_) return;
        for (std::size_t i = 0; i < columns_a_push; ++i)
            if (!advance(at.tick - lag, -1, false)) return;
    }

    /// About what the window costs where it ends now, in 1/16 bit. Of the ticks that are not
    /// searched yet, as much as of those before, and half again. A frame for which this was too
    /// little leaves as steps (wire/encoder.hpp).
    Cost cost() const noexcept {
        const std::int32_t ticks = finishing_ || stalled_ ? 0 : tick_ - start_tick_;
        float bits = 0;
        for (const auto& s : search_)
            if (ticks > 0) bits += s.bits();
        float rate = rate_;
        if (ticks >= lag / 2 && bits > rate * static_cast<float>(ticks))
            rate = bits / static_cast<float>(ticks);
        const std::int32_t ahead = newest_.tick + 1 - start_tick_ - ticks;
        return static_cast<Cost>(16.0f * (bits + 1.5f * rate * static_cast<float>(ahead)));
    }

    /// The curve ends at this tick, before the frame does; -1: where the window began, so that the
    /// frame holds nothing of it.
    void end_at(std::int32_t tick) noexcept {
        last_ = true;
        end_tick_ = tick;
    }
    /// The frame ends at a tick. @return the seam: what is asked is granted.
    Seam close(std::int32_t, Seam asked) noexcept { return asked; }
    /// Commits the window: its search goes on in check(). The next begins at `tick`.
    void commit(std::int32_t tick, Seam seam, std::int32_t guess) noexcept {
        cursor_ = {};
        check_ = {};
        segment_ = {};
        if (!active_) return;
        const std::int32_t to = last_ ? end_tick_ : tick;
        segment_.present = last_ ? to >= start_tick_ : to > start_tick_;
        if (segment_.present) {
            segment_.start_tick = start_tick_;
            segment_.end_tick = to;
            segment_.starts = starts_;
            segment_.ends = last_;
            segment_.start = state_;
        }
        hard_ = stalled_;
        exact_ = false;
        seam_ = seam;
        old_origin_ = origin_;
        samples_.commit(to < 0 ? 0 : to);
        newest_.tick -= tick;
        starts_ = starts_ && !segment_.present;
        active_ = !last_;
        last_ = stalled_ = false;
        start_tick_ = 0;
        guess_ = tick > lag ? tick : guess;  // frames are mostly as long as the one before
        behind_ = to;
        const bool some = samples_.old_count() > 0;
        for (std::size_t a = 0; a < D && some; ++a)
            origin_[a] = nearest(a, samples_.old_value(samples_.old_count() - 1).value);
        finishing_ = segment_.present && segment_.end_tick > segment_.start_tick;
        if (finishing_ && hard_) finish_hard();
        if (segment_.present && !finishing_ && !hard_) settle();
        if (!finishing_ && active_) open_window();
        for (std::size_t i = 0; i < samples_.count(); ++i)
            if (active_ && !reaches(samples_.value(i).value)) stalled_ = true;
    }
    void release() noexcept { samples_.release(); }
    void stop() noexcept {
        active_ = last_ = false;
        samples_.drop();
    }
    /// Forgets the committed frame too.
    void reset() noexcept {
        stop();
        segment_ = {};
        finishing_ = stalled_ = starts_ = false;
        samples_.clear();
    }

    // ---- the committed frame
    const Segment& segment() const noexcept { return segment_; }
    void rewind() noexcept { cursor_ = {}; }
    /// Components of its steps, about the work to code them.
    std::size_t size() const noexcept {
        std::size_t all = 0;
        for (const std::size_t n : step_count_) all += n;
        return all;
    }

    /// Searches what is left of the committed frame, then compares its samples with its curve as a
    /// decoder draws it, each in portions. Where all must be done at once, because the next frame
    /// ends already, few columns are searched and then the last. @return true: all are done;
    /// failures() counts samples outside the tolerance.
    bool check(std::size_t samples) noexcept {
        const bool all = samples >= check_all;
        for (std::size_t i = 0; finishing_; ++i) {
            if (i == columns_behind && !all) return false;
            const bool hurry = i >= (all ? columns_at_once : columns_behind);
            if (!advance(segment_.end_tick, segment_.end_tick, hurry)) finish();
            if (!finishing_ && !all) return false;
        }
        Check& k = check_;
        for (; k.axis < D; ++k.axis, k.sample = 0) {
            for (; k.sample < samples_.old_count(); ++k.sample) {
                if (samples-- == 0) return false;
                if (segment_.present && !holds(k)) ++failures_;
            }
        }
        return true;
    }
    std::uint32_t failures() const noexcept { return failures_; }

    // ---- the way on where a committed frame is not right: steps over its samples

    void give_up() noexcept {
        whole_ = segment_;
        finishing_ = false;
    }
    /// The tick at or behind the `count`-th committed sample behind tick `from`; none: INT32_MAX.
    std::int32_t tick_of(std::int32_t from, std::size_t count) const noexcept {
        return samples_.old_tick(old_count_to(0, from) + count - 1);
    }
    /// From here on next() gives the steps of a stretch of the frame, from these states on.
    void cut(const Stretch& stretch, const State* now) noexcept {
        static_cast<Extent&>(segment_) = whole_.within(stretch);
        cursor_ = {};
        hard_ = exact_ = true;
        if (!segment_.present) return;
        const std::size_t n = old_count_to(0, segment_.end_tick);
        const bool some = n > old_count_to(0, segment_.start_tick);
        const auto ticks = static_cast<std::uint8_t>(segment_.end_tick - segment_.start_tick);
        for (std::size_t a = 0; a < D; ++a) {
            if (!segment_.starts) segment_.start[a] = now[a];
            segment_.first[a] = curve::lattice_near(segment_.start[a].at[0]);
            target_[a] = some ? nearest(a, samples_.old_value(n - 1).value)
                              : curve::lattice_near(segment_.start[a].at[0]);
            steps_[a][0] = {{0}, ticks, how::jump};
            step_count_[a] = ticks > 0 ? 1 : 0;
        }
    }
    /// The stretch up to this tick has left.
    void drop_to(std::int32_t tick) noexcept { samples_.release_first(old_count_to(0, tick)); }
    /// Does the committed frame go on from these states?
    bool begins_at(const State* states) const noexcept {
        bool all = true;
        for (std::size_t a = 0; a < D && segment_.present && !segment_.starts; ++a)
            all = all && curve::same(segment_.start[a], states[a]);
        return all;
    }
    /// Does the window go on with a curve of the committed frame?
    bool goes_on() const noexcept {
        return active_ && !starts_ && segment_.present && !segment_.ends;
    }
    /// The window begins anew: where it goes on with a curve of the frame from these states, else
    /// from its own. Its samples are searched again.
    void resume(const State* states, std::int32_t guess) noexcept {
        if (!active_) return;
        for (std::size_t a = 0; a < D && goes_on(); ++a) state_[a] = states[a];
        guess_ = start_tick_ + guess;
        for (std::size_t a = 0; a < D; ++a) origin_[a] = curve::lattice_near(state_[a].at[0]);
        stalled_ = false;
        open_window();
        for (std::size_t i = 0; i < samples_.count(); ++i)
            if (!reaches(samples_.value(i).value)) stalled_ = true;
    }

    /// The next piece of axis `axis` in coding order; false behind the last one. Axes one after the
    /// other, from axis 0.
    bool next(std::size_t axis, PieceType& piece) noexcept {
        Cursor& c = cursor_;
        if (axis >= D) return false;
        if (!c.begun || c.axis != axis) {
            c = {};
            c.begun = true;
            c.axis = axis;
            c.state = segment_.start[axis];
            c.tick = segment_.start_tick;
            c.sample = old_count_to(0, segment_.start_tick);
        }
        if (c.jumping) {
            if (next_part(axis, piece)) return true;
            c.jumping = false;
        }
        if (c.step >= step_count_[axis]) return false;
        const Step<1>& step = steps_[axis][c.step++];
        const std::int32_t to = c.tick + step.ticks;
        const std::size_t first = c.sample;
        c.sample = old_count_to(first, to);
        const std::int32_t aim = old_origin_[axis] + step.v[0];
        const std::uint8_t code = code_of(step.how, step.ticks);
        if (code == curve::code::jump) {
            c.walk = JumpWalk<1>{
                {jump_base(c.state)}, {hard_ ? target_[axis] : aim}, c.tick, to, first, c.sample};
            c.jumping = true;
            c.tick = to;
            return next_part(axis, piece);
        }
        piece = {};
        piece.code = code;
        piece.subs = static_cast<std::uint16_t>(step.ticks * curve::subs_per_tick);
        piece.k[0] =
            aim - (curve::is_line(code) ? curve::predicted_end(c.state, 0, step.ticks)
                                        : curve::predicted_control(c.state, 0, step.ticks));
        c.tick = to;
        return curve::step(c.state, piece, c.span);
    }

  private:
    using Search = CubicSearch<BeamT, Window + 1>;
    /// A step is so many tolerances: where bytes are fewest.
    static constexpr float cubic_step = 1.35f;

    struct Lattice {
        curve::Scale scale{256, -8};
        float radius{}, full_radius{};  // 1/1024 step
    };
    /// A sample, and the sums of those before it, in 1/1024 steps modulo 2^32.
    struct Held {
        Value value{};
        std::array<std::uint32_t, D> before{};
    };
    struct Cursor {
        std::size_t axis{0}, step{0}, sample{0};
        std::int32_t tick{0};
        bool begun{false}, jumping{false};
        State state{};
        curve::CubicSpan<1> span{};  // of the last piece
        JumpWalk<1> walk{};
    };
    struct Check {
        std::size_t axis{0}, sample{0};
        std::int32_t from{0}, to{0};  // of the piece, sub-ticks of the frame
        std::int32_t v{};             // near its start
        float part{};                 // its start against v
        curve::Polynomial<float> c{};
    };

    /// A constant's box: the lattice values that hold all samples added.
    struct Box {
        const CubicChannel& channel;
        std::size_t axis;
        bool old;
        std::int64_t low{INT64_MIN}, high{INT64_MAX};

        bool add(std::size_t i) noexcept {
            const Held& held = old ? channel.samples_.old_value(i) : channel.samples_.value(i);
            const Lattice& lattice = channel.lattice_[axis];
            const std::int64_t x = lattice.scale.to_fine(held.value[axis]);
            const auto e = static_cast<std::int32_t>(
                old && channel.exact_ ? lattice.full_radius * exact_part : lattice.radius);
            const std::int64_t l = x - e > low ? x - e : low, h = x + e < high ? x + e : high;
            if (up(l) > (h >> curve::fine_bits)) return false;
            low = l;
            high = h;
            return true;
        }
        bool holds(const std::array<std::int32_t, 1>& v) const noexcept {
            const std::int64_t x = std::int64_t{v[0]} * curve::fine;
            return low <= x && x <= high;
        }
        std::array<std::int32_t, 1> value() const noexcept {
            const std::int64_t first = up(low), last = high >> curve::fine_bits;
            return {static_cast<std::int32_t>(first + (last - first) / 2)};
        }
        static std::int64_t up(std::int64_t x) noexcept {
            return (x + curve::fine - 1) >> curve::fine_bits;
        }
    };
    /// Samples of one axis, of the window or of the committed frame.
    struct Source {
        const CubicChannel& channel;
        std::size_t axis;
        bool old;
        struct Fit : Box {
            bool add(const Source&, std::size_t i) noexcept { return Box::add(i); }
        };
        Fit fit() const noexcept { return {{channel, axis, old}}; }
        curve::Moment when(std::size_t i) const noexcept { return channel.when(i, old); }
    };
    /// All samples that are known to a search, for its guide: of a committed frame, those behind it
    /// too, if the curve goes on there.
    class View {
      public:
        View(const CubicChannel& channel, std::size_t axis, bool old) noexcept
            : channel_{channel},
              axis_{axis},
              base_{old ? 0 : channel.samples_.old_count()},
              behind_{old ? channel.samples_.old_count() : SIZE_MAX},
              size_{channel.count(old)},
              from_{old ? channel.segment_.start_tick : channel.start_tick_} {
            if (old && channel.goes_on()) size_ += channel.samples_.count();
        }
        std::size_t size() const noexcept { return size_; }
        float time(std::size_t i) const noexcept {
            const curve::Moment at = channel_.samples_.old_when(base_ + i);
            const std::int32_t shift = i < behind_ ? 0 : channel_.behind_;
            return static_cast<float>(at.tick + shift - from_) + at.part;
        }
        std::uint32_t before(std::size_t i) const noexcept { return held(i).before[axis_]; }
        std::uint32_t value(std::size_t i) const noexcept {
            if (i + 1 < size_) return before(i + 1) - before(i);
            return static_cast<std::uint32_t>(channel_.to_fine(axis_, held(i).value));
        }
        /// Against an origin, in 1/1024 steps.
        std::int32_t relative(std::size_t i, std::int32_t origin) const noexcept {
            return static_cast<std::int32_t>(value(i) -
                                             static_cast<std::uint32_t>(origin) *
                                                 static_cast<std::uint32_t>(curve::fine));
        }
        /// The same in steps.
        float steps(std::size_t i, std::int32_t origin) const noexcept {
            return static_cast<float>(relative(i, origin)) *
                   (1.0f / static_cast<float>(curve::fine));
        }

      private:
        const Held& held(std::size_t i) const noexcept {
            return channel_.samples_.old_value(base_ + i);
        }
        const CubicChannel& channel_;
        std::size_t axis_, base_, behind_, size_;
        std::int32_t from_;
    };

    static std::int32_t ceiling(const curve::Moment& at) noexcept {
        return at.tick + (at.part > 0.0f ? 1 : 0);
    }
    curve::Moment when(std::size_t i, bool old) const noexcept {
        return old ? samples_.old_when(i) : samples_.when(i);
    }
    std::size_t count(bool old) const noexcept {
        return old ? samples_.old_count() : samples_.count();
    }
    std::int64_t to_fine(std::size_t a, const Value& value) const noexcept {
        return lattice_[a].scale.to_fine(value[a]);
    }
    std::int64_t fine_origin(std::size_t a) const noexcept {
        return std::int64_t{origin_[a]} * curve::fine;
    }
    std::int32_t nearest(std::size_t a, const Value& value) const noexcept {
        return static_cast<std::int32_t>((to_fine(a, value) + curve::fine / 2) >> curve::fine_bits);
    }
    static std::int32_t jump_base(const State& s) noexcept {
        return s.run > 0 ? 0 : curve::lattice_near(s.at[0]);
    }
    std::size_t old_count_to(std::size_t i, std::int32_t tick) const noexcept {
        for (std::size_t n = 0; i < samples_.old_count() && n <= Window; ++n, ++i) {
            const curve::Moment at = samples_.old_when(i);
            if (at.tick > tick || (at.tick == tick && at.part > 0.0f)) break;
        }
        return i;
    }

    void keep(const curve::Moment& at, const Value& value) noexcept {
        Held held{value, sum_};
        samples_.push(at, held);
        for (std::size_t a = 0; a < D; ++a)
            sum_[a] += static_cast<std::uint32_t>(to_fine(a, value));
        newest_ = at;
    }
    /// The searches begin at the window's start; state_ is known.
    void open_window() noexcept {
        tick_ = start_tick_;
        columns_ = done_ = 0;
        for (std::size_t a = 0; a < D; ++a)
            search_[a].seed(state_[a], origin_[a], lattice_[a].radius * (1.0f / curve::fine));
        // the first samples of a curve stand at its start
        while (done_ < samples_.count() && ceiling(samples_.when(done_)) <= start_tick_) ++done_;
    }

    /// Searches the next column that is not behind `most`. end: the tick where the frame ends, of a
    /// committed one; else -1. hurry: the end itself is the next column. @return false: there is
    /// none, or it was the last.
    bool advance(std::int32_t most, std::int32_t end, bool hurry) noexcept {
        const bool old = end >= 0;
        if (old && tick_ >= end) return false;
        std::int32_t tick = done_ < count(old) ? ceiling(when(done_, old)) : end;
        if (old && (hurry || columns_ >= Window || tick > end)) tick = end;
        if (tick > most || tick <= tick_ || (!old && columns_ >= Window)) return false;
        const std::size_t first = done_;
        while (done_ < count(old) && ceiling(when(done_, old)) <= tick) ++done_;
        const std::int32_t from = old ? segment_.start_tick : start_tick_;
        const std::int32_t last = old ? end : guess_;
        CubicColumn at{tick - from, last > tick ? last - tick : 1, tick == end, 0};
        if (at.end) at.left = 0;
        for (std::size_t a = 0; a < D; ++a) search_axis(a, at, first, from, old);
        tick_ = tick;
        ++columns_;
        return !at.end;
    }
    void search_axis(std::size_t a, CubicColumn at, std::size_t first, std::int32_t from,
                     bool old) noexcept {
        Search& search = search_[a];
        const std::int32_t origin = old ? old_origin_[a] : origin_[a];
        const View view{*this, a, old};
        for (std::size_t i = first; i < done_; ++i) {
            const curve::Moment m = when(i, old);
            search.sample(m.tick - from, m.part, view.relative(i, origin));
        }
        const CubicGuide<View> guide{view, origin};
        at.middle = middle(view, at.tick, origin, search.state());
        if (at.end) look_ahead(view, at, origin);
        search.column(at, guide);
        offer_jump(a, at, first, from, old, origin);
        search.keep(at.end);
    }
    /// The samples that are known behind the end of a frame.
    void look_ahead(const View& view, CubicColumn& at, std::int32_t origin) const noexcept {
        for (std::size_t i = done_; i < view.size() && at.ahead_count < at.ahead.size(); ++i) {
            const float after = view.time(i) - static_cast<float>(at.tick);
            if (after >= 0.01f) at.ahead[at.ahead_count++] = {after, view.steps(i, origin)};
        }
    }
    /// About where the curve is at a tick: between the samples before and behind it.
    float middle(const View& view, std::int32_t tick, std::int32_t origin,
                 const State& before) const noexcept {
        if (done_ == 0) return static_cast<float>(curve::lattice_near(before.at[0]) - origin);
        const float last = view.steps(done_ - 1, origin);
        const float gone = static_cast<float>(tick) - view.time(done_ - 1);
        if (!(gone > 0.0f) || done_ >= view.size()) return last;
        const float next = view.steps(done_, origin),
                    apart = view.time(done_) - view.time(done_ - 1);
        const bool reached = approx::absolute(next) < static_cast<float>(window_steps_max);
        return reached ? last + (next - last) * (gone / apart) : last;
    }
    /// Offers the jump from the column before, where it may help.
    void offer_jump(std::size_t a, const CubicColumn& at, std::size_t first, std::int32_t from,
                    bool old, std::int32_t origin) noexcept {
        Search& search = search_[a];
        if (!search.jump_helps(20.0f)) return;
        State state = search.before_state();
        const float middle = at.middle < 0 ? at.middle - 0.5f : at.middle + 0.5f;
        JumpWalk<1> walk{{jump_base(state)},
                         {origin + static_cast<std::int32_t>(middle)},
                         tick_,
                         at.tick + from,
                         first,
                         done_};
        const Source source{*this, a, old};
        const std::size_t most = jump_parts(done_ - first);
        code::Counter counter;
        curve::Piece<1> piece;
        curve::CubicSpan<1> span;
        for (std::size_t i = 0; i < most && walk.next(source, piece); ++i)
            if (!code::code_cubic(counter, code::cubic_costs<1>, state, piece, piece.subs, span))
                return;
        search.offer_jump(state, static_cast<float>(counter.cost()) * (1.0f / 16.0f));
    }

    /// The search of the committed frame is done: its steps, and the state behind it.
    void finish() noexcept {
        finishing_ = false;
        float bits = 0;
        for (std::size_t a = 0; a < D; ++a) {
            bits += search_[a].bits();
            step_count_[a] = search_[a].trace(steps_[a]);
            if (goes_on()) state_[a] = search_[a].state();
        }
        rate_ = bits / static_cast<float>(segment_.end_tick - segment_.start_tick);
        settle();
        if (active_) open_window();
    }
    /// A window with a value out of reach: one jump from its start, of any size.
    void finish_hard() noexcept {
        finishing_ = false;
        for (std::size_t a = 0; a < D; ++a) {
            const std::size_t n = samples_.old_count();
            target_[a] = n > 0 ? nearest(a, samples_.old_value(n - 1).value)
                               : curve::lattice_near(segment_.start[a].at[0]);
            steps_[a][0] = {
                {0}, static_cast<std::uint8_t>(segment_.end_tick - segment_.start_tick), how::jump};
            step_count_[a] = 1;
            PieceType piece;
            for (std::size_t i = 0; i < Window * jump_parts_max && next(a, piece); ++i) continue;
            if (goes_on()) state_[a] = cursor_.state;
        }
        cursor_ = {};
        settle();
    }
    /// The frame's steps and the state behind them are known: what its seam and its run need.
    void settle() noexcept {
        for (std::size_t a = 0; a < D; ++a) {
            if (goes_on() && seam_ == Seam::restart) state_[a].restart();
            segment_.first[a] = curve::lattice_near(segment_.start[a].at[0]);
            if (segment_.end_tick == segment_.start_tick) step_count_[a] = 0;
            if (step_count_[a] > 0 && segment_.start[a].run == 3 &&
                (steps_[a][0].how & how::jump) == 0)
                segment_.first[a] = old_origin_[a] + steps_[a][0].v[0];
        }
    }

    bool next_part(std::size_t axis, PieceType& piece) noexcept {
        if (!cursor_.walk.next(Source{*this, axis, true}, piece)) return false;
        return curve::step(cursor_.state, piece, cursor_.span);
    }
    bool holds(Check& k) noexcept {
        const curve::Moment at = samples_.old_when(k.sample);
        const std::int32_t start = segment_.start_tick * curve::subs_per_tick;
        if (k.sample == 0) {
            const curve::CubicVertex& from = segment_.start[k.axis].at[0];
            k = {k.axis, 0, start, start, curve::lattice_near(from), 0, {}};
            k.part = curve::part_of<float>(from, k.v);
        }
        const auto behind = [&at](std::int32_t subs) {
            const auto whole = static_cast<float>(at.tick * curve::subs_per_tick - subs);
            return whole * (1.0f / static_cast<float>(curve::subs_per_tick)) + at.part;
        };
        for (std::size_t i = 0; i <= Window * jump_parts_max && behind(k.to) > 0.0f; ++i) {
            PieceType piece;
            if (!next(k.axis, piece)) return false;
            const curve::CubicVertex& from = cursor_.span.start[0];
            k.v = curve::lattice_near(from);
            k.part = curve::part_of<float>(from, k.v);
            k.c = curve::cubic<float>(from, cursor_.span.j[0]);
            k.from = k.to;
            k.to += piece.subs;
        }
        const curve::Polynomial<float>& c = k.c;
        const std::int64_t x = to_fine(k.axis, samples_.old_value(k.sample).value);
        const std::int64_t off = x - std::int64_t{k.v} * curve::fine;
        if (off > INT32_MAX || off < -INT32_MAX) return false;
        const auto d = static_cast<float>(static_cast<std::int32_t>(off));
        const float t = behind(k.from), fine = static_cast<float>(curve::fine);
        const float rise = (k.part + c.rise(t)) * fine;
        const float terms =
            approx::absolute(c.c1) + t * (approx::absolute(c.c2) + t * approx::absolute(c.c3));
        const float lost =
            (approx::absolute(d) + (1.0f + t * terms) * fine) * (rounding * 0.25f) + 0.6f;
        return approx::absolute(d - rise) + lost <= lattice_[k.axis].full_radius;
    }

    Samples<Held, Window> samples_{};
    std::array<Search, D> search_{};
    std::array<std::array<Step<1>, Window + 1>, D> steps_{};
    std::array<std::size_t, D> step_count_{};
    std::array<State, D> state_{};  // where the window begins; known but for finishing_
    std::array<std::int32_t, D> origin_{}, old_origin_{}, target_{};
    std::array<std::uint32_t, D> sum_{};
    Segment segment_{};
    Extent whole_{};  // of a frame that was given up
    Cursor cursor_{};
    Check check_{};
    std::array<Lattice, D> lattice_{};
    curve::Moment newest_{};
    std::int32_t start_tick_{0}, tick_{0}, end_tick_{0}, guess_{0}, behind_{0};
    std::size_t columns_{0}, done_{0};  // of the search that goes on; samples taken
    float rate_{4.0f * D};              // bits a tick of the last frame
    std::uint32_t failures_{0};
    Seam seam_{};
    bool active_{false}, starts_{false}, stalled_{false}, last_{false};
    bool finishing_{false};            // the committed frame's search is not done
    bool hard_{false}, exact_{false};  // a step of any size; of a frame that was given up
};

/// The channel of D axes by the kind of its pieces.
template <std::size_t D, class Kind, class BeamT, std::size_t Window>
struct VectorOf {
    using Type = VectorChannel<D, Kind, BeamT, Window>;
};
template <std::size_t D, class BeamT, std::size_t Window>
struct VectorOf<D, curve::Cubics, BeamT, Window> {
    using Type = CubicChannel<D, BeamT, Window>;
};

/// What the code of a jump behind a jump costs, by kind and number of components, in 1/16 bit.
template <class Kind, std::size_t N>
inline constexpr std::size_t jump_cost =
    code::costs<Kind, N>.length[curve::code::jump][curve::code::jump];
template <std::size_t N>
inline constexpr std::size_t jump_cost<curve::Cubics, N> = 16 * code::break_jump_bits;

}  // namespace fairlead::reduce
