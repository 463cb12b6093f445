#pragma once
// A channel of vectors: D axes, each with a search of its own, and the samples they share.
//
// All times are ticks of the frame being gathered. The Reducer (reducer.hpp) says when a column is
// due and where the frame ends; the channel turns samples into lattice numbers, keeps the axes'
// searches, and gives the committed pieces in coding order.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/per_axis.hpp"
#include "fairlead/code/pieces.hpp"
#include "fairlead/curve/scale.hpp"
#include "fairlead/reduce/extent.hpp"
#include "fairlead/reduce/interval.hpp"
#include "fairlead/reduce/jump_walk.hpp"
#include "fairlead/reduce/samples.hpp"
#include "fairlead/reduce/seam.hpp"
#include "fairlead/reduce/search.hpp"

namespace fairlead::reduce {

/// What a channel says of a committed frame.
template <std::size_t D>
struct VectorSegment : Extent {
    std::array<curve::State<1>, D> start{};
    std::array<std::int32_t, D> end_v{};  // absolute lattice values at end_tick
};

template <std::size_t D, class Kind, class BeamT, std::size_t Window>
class VectorChannel {
    static_assert(D >= 1 && D <= vector_components_max, "a frame holds one step of 5 axes");
    static_assert(Window >= 4 && Window <= 240, "a window holds 4 to 240 records");

  public:
    using Value = std::array<float, D>;
    using Segment = VectorSegment<D>;
    using PieceType = curve::Piece<1>;
    static constexpr std::size_t parts = D;  // searches, each with a list of pieces
    static constexpr std::size_t components = 1;
    using KindType = Kind;
    static constexpr std::size_t window = Window;
    /// Bits that one column can add to a window, at most: a jump of each axis with a part for each
    /// of the closest samples.
    static constexpr Cost column_bits_max = D * jump_bits_max(1);
    /// Bits that tell where a curve starts: values, and the frame's jump to that time.
    static constexpr Cost start_bits_max = 9 + 27 * D + 79;
    /// What the next column may add, with `more` samples than there are now, and what the start of
    /// the curve costs.
    Cost next_column_bits(std::size_t more) const noexcept {
        const std::size_t samples = samples_.count() - column_samples_ + more;
        return static_cast<Cost>(D) * jump_bits_max(1, samples > 0 ? samples : 1) +
               (starts_ ? start_bits_max : 0);
    }

    /// tolerance: largest error of each axis, in the values' unit; > 0.
    void configure(const PerAxis<D>& tolerance) noexcept {
        for (std::size_t a = 0; a < D; ++a) {
            Lattice& l = lattice_[a];
            l.scale = curve::Scale::of_step(1.2f * tolerance[a]);
            const float steps = tolerance[a] / l.scale.template step<float>();
            l.full_radius = steps * static_cast<float>(curve::fine);
            // samples are rounded to 1/2, and floats
            l.radius = l.full_radius * (1.0f - 0x1p-20f) - 1.0f;
        }
    }
    const curve::Scale& scale(std::size_t axis = 0) const noexcept { return lattice_[axis].scale; }

    bool active() const noexcept { return active_; }
    /// Has the curve begun in this frame?
    bool starts() const noexcept { return starts_; }
    bool stalled() const noexcept { return stalled_; }
    std::int32_t start_tick() const noexcept { return start_tick_; }
    std::int32_t column_tick() const noexcept { return column_tick_; }
    /// Tick of the newest sample, rounded up: where a curve without a successor ends.
    std::int32_t last_tick() const noexcept { return newest_.tick + (newest_.part > 0.0f ? 1 : 0); }
    const curve::Moment& newest() const noexcept { return newest_; }

    /// A curve begins at this sample's tick. guess: ticks at which the frame is likely to end.
    void start(const curve::Moment& at, const Value& value, std::int32_t guess) noexcept {
        for (std::size_t a = 0; a < D; ++a) {
            state_[a] = {};
            state_[a].v[0] = nearest(a, value);
        }
        active_ = starts_ = true;
        open_window(at.tick, guess);
        keep(at, value);
        column_samples_ = first_samples_ = samples_.count_to(at.tick);
        bound(at, value);
    }

    /// Can the window hold this value? Where not, the frame must end before it; in a window that
    /// has just begun the value then stalls the channel until the next column, where it jumps.
    bool reaches(const Value& value) const noexcept {
        constexpr std::int64_t most = std::int64_t{window_steps_max} << curve::fine_bits;
        for (std::size_t a = 0; a < D; ++a) {
            const std::int64_t x = from_origin(a, value);
            if (x > most || x < -most) return false;
        }
        return true;
    }

    /// A sample of an active channel, behind newest(). `column`: the tick of the column that is due
    /// with it, or -1. end: the frame ends there, with a seam as asked.
    void push(const curve::Moment& at, const Value& value, std::int32_t column, bool end,
              Seam asked) noexcept {
        const bool told = end && asked == Seam::restart;
        const bool first = column >= 0 && (at.tick > column || (at.tick == column && at.part > 0));
        if (first) offer(column, end, told, &at, &value);
        keep(at, value);
        bound(at, value);
        if (column >= 0 && !first) offer(column, end, told, nullptr, nullptr);
    }

    /// Upper bound in 1/16 bit of what the window costs where it ends at the last column.
    Cost cost() const noexcept {
        Cost sum = 0;
        for (const auto& s : search_) sum += s.cost();
        return sum;
    }

    /// The curve ends at this tick, before the frame does; -1: where the window began, so that the
    /// frame holds nothing of it.
    void end_at(std::int32_t tick) noexcept {
        last_ = true;
        end_tick_ = tick;
    }
    /// Makes sure of a vertex at `tick`, where the frame ends; no column is behind it. @return the
    /// seam that the channel can grant: a vector grants what is asked.
    Seam close(std::int32_t tick, Seam asked) noexcept {
        const std::int32_t to = last_ ? end_tick_ : tick;
        if (column_tick_ < to) offer(to, true, asked == Seam::restart && !last_, nullptr, nullptr);
        return asked;
    }
    /// Commits the window, after close(), and begins the next at `tick`, where samples behind it
    /// are searched again.
    void commit(std::int32_t tick, Seam seam, std::int32_t guess) noexcept {
        cursor_ = {};
        check_ = {};
        segment_ = {};
        if (!active_) return;
        const std::int32_t to = last_ ? end_tick_ : tick;
        segment_.present = last_ ? to >= start_tick_ : to > start_tick_;
        if (segment_.present) commit_present(to, seam);
        samples_.commit(to < 0 ? 0 : to);
        newest_.tick -= tick;
        starts_ = starts_ && !segment_.present;
        active_ = !last_;
        last_ = false;
        if (!active_) return;
        open_window(0, guess);
        for (std::size_t i = 0; i < samples_.count(); ++i)
            bound(samples_.when(i), samples_.value(i));
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

    // ---- the way on where a committed frame is not right: steps over its samples

    /// Gives up the committed pieces; what follows is cut() into stretches.
    void give_up() noexcept { whole_ = segment_; }
    /// The tick at or behind the `count`-th committed sample behind tick `from`; none: INT32_MAX.
    std::int32_t tick_of(std::int32_t from, std::size_t count) const noexcept {
        return samples_.old_tick(old_count_to(0, from) + count - 1);
    }
    /// From here on next() gives the steps of a stretch of the frame, from these states on.
    void cut(const Stretch& stretch, const curve::State<1>* now) noexcept {
        static_cast<Extent&>(segment_) = whole_.within(stretch);
        cursor_ = {};
        hard_ = exact_ = true;
        if (!segment_.present) return;
        const std::size_t n = old_count_to(0, segment_.end_tick);
        const bool some = n > old_count_to(0, segment_.start_tick);
        const auto ticks = static_cast<std::uint8_t>(segment_.end_tick - segment_.start_tick);
        for (std::size_t a = 0; a < D; ++a) {
            if (!segment_.starts) segment_.start[a] = now[a];
            segment_.end_v[a] = some ? nearest(a, samples_.old_value(n - 1))  //
                                     : segment_.start[a].v[0];
            steps_[a][0] = {{0}, ticks, how::jump};
            step_count_[a] = ticks > 0 ? 1 : 0;
        }
    }
    /// The stretch up to this tick has left.
    void drop_to(std::int32_t tick) noexcept { samples_.release_first(old_count_to(0, tick)); }
    /// Does the committed frame go on from these states?
    bool begins_at(const curve::State<1>* states) const noexcept {
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
    void resume(const curve::State<1>* states, std::int32_t guess) noexcept {
        if (!active_) return;
        for (std::size_t a = 0; a < D && goes_on(); ++a) state_[a] = states[a];
        open_window(start_tick_, guess);
        column_samples_ = first_samples_ = samples_.count_to(start_tick_);
        for (std::size_t i = 0; i < samples_.count(); ++i)
            bound(samples_.when(i), samples_.value(i));
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
            if (c.walk.next(Source{*this, axis, true}, piece)) {
                static_cast<void>(curve::step(c.state, piece));
                return true;
            }
            c.jumping = false;
        }
        if (c.step >= step_count_[axis]) return false;
        const Step<1>& step = steps_[axis][c.step++];
        const std::int32_t to = c.tick + step.ticks;
        const std::size_t first = c.sample;
        c.sample = old_count_to(first, to);
        const std::uint8_t code = code_of(step.how, step.ticks);
        if (code == curve::code::jump) {
            const std::int32_t end = segment_.start[axis].v[0] + step.v[0];
            c.walk = JumpWalk<1>{c.state.v, {hard_ ? segment_.end_v[axis] : end}, c.tick, to, first,
                                 c.sample};
            c.jumping = true;
            c.tick = to;
            return next_part(axis, piece);
        }
        piece = {};
        piece.code = code;
        piece.subs = static_cast<std::uint16_t>(step.ticks * curve::subs_per_tick);
        piece.k[0] = segment_.start[axis].v[0] + step.v[0] - c.state.v[0] -
                     curve::predicted_rise(c.state.s[0], c.state.fresh, step.ticks);
        c.tick = to;
        static_cast<void>(curve::step(c.state, piece));
        return true;
    }

    /// Compares some samples of the committed frame with its curve, as a decoder draws it: the
    /// proof of each frame, in portions. Uses next(): rewind() before coding. @return true: all are
    /// done; failures() counts samples outside the tolerance, which the search's margin excludes.
    bool check(std::size_t samples) noexcept {
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

  private:
    using Search = reduce::Search<Interval<Kind>, BeamT, Window + 1>;
    using Column = typename Search::Column;

    /// Of one axis: the lattice of its vertices, and its tolerance in 1/1024 step: what the search
    /// may use, and all of it.
    struct Lattice {
        curve::Scale scale{256, -8};
        float radius{}, full_radius{};
    };
    /// Where the samples go at the end of a window: value and slope a tick, in steps.
    struct Line {
        std::array<std::array<float, 1>, D> value{}, slope{};
    };
    struct Cursor {
        std::size_t axis{0}, step{0}, sample{0};
        std::int32_t tick{0};
        bool begun{false}, jumping{false};
        curve::State<1> state{};
        JumpWalk<1> walk{};
    };
    struct Check {
        std::size_t axis{0}, sample{0};
        std::int32_t from{0}, to{0};  // of the piece, sub-ticks of the frame
        std::int32_t v{};             // at its start
        curve::Polynomial<float> c{};
    };

    /// A constant's box: the lattice values that hold all samples added.
    struct Box {
        const VectorChannel& channel;
        std::size_t axis;
        bool old;
        std::int64_t low{INT64_MIN}, high{INT64_MAX};

        bool add(std::size_t i) noexcept {
            const Value& value = old ? channel.samples_.old_value(i) : channel.samples_.value(i);
            const Lattice& lattice = channel.lattice_[axis];
            const std::int64_t x = lattice.scale.to_fine(value[axis]);
            const auto e = static_cast<std::int32_t>(
                old && channel.exact_ ? lattice.full_radius * exact_part : lattice.radius);
            const std::int64_t l = x - e > low ? x - e : low, h = x + e < high ? x + e : high;
            if (ceiling(l) > (h >> curve::fine_bits)) return false;
            low = l;
            high = h;
            return true;
        }
        bool holds(const std::array<std::int32_t, 1>& v) const noexcept {
            const std::int64_t x = std::int64_t{v[0]} * curve::fine;
            return low <= x && x <= high;
        }
        std::array<std::int32_t, 1> value() const noexcept {
            const std::int64_t first = ceiling(low), last = high >> curve::fine_bits;
            return {static_cast<std::int32_t>(first + (last - first) / 2)};
        }
        static std::int64_t ceiling(std::int64_t x) noexcept {
            return (x + curve::fine - 1) >> curve::fine_bits;
        }
    };
    /// Samples of one axis, of the window or of the committed frame.
    struct Source {
        const VectorChannel& channel;
        std::size_t axis;
        bool old;
        struct Fit : Box {
            bool add(const Source&, std::size_t i) noexcept { return Box::add(i); }
        };
        Fit fit() const noexcept { return {{channel, axis, old}}; }
        curve::Moment when(std::size_t i) const noexcept {
            return old ? channel.samples_.old_when(i) : channel.samples_.when(i);
        }
    };

    bool holds(Check& k) noexcept {
        const curve::Moment at = samples_.old_when(k.sample);
        const std::int32_t start = segment_.start_tick * curve::subs_per_tick;
        if (k.sample == 0) k = {k.axis, 0, start, start, segment_.start[k.axis].v[0], {}};
        const auto behind = [&at](std::int32_t subs) {
            const auto whole = static_cast<float>(at.tick * curve::subs_per_tick - subs);
            return whole * (1.0f / static_cast<float>(curve::subs_per_tick)) + at.part;
        };
        for (std::size_t i = 0; i <= Window * jump_parts_max && behind(k.to) > 0.0f; ++i) {
            const bool goes_on = cursor_.begun && cursor_.axis == k.axis;
            const curve::State<1> before = goes_on ? cursor_.state : segment_.start[k.axis];
            PieceType piece;
            if (!next(k.axis, piece)) return false;
            const std::int32_t end = cursor_.state.v[0];
            k.v = piece.code == curve::code::jump ? end : before.v[0];
            k.c = curve::polynomial<float>(piece.code, before.fresh, before.s[0],
                                           static_cast<float>(end - k.v),
                                           piece.subs / curve::subs_per_tick);
            k.from = k.to;
            k.to += piece.subs;
        }
        const curve::Polynomial<float>& c = k.c;
        const std::int64_t x = lattice_[k.axis].scale.to_fine(samples_.old_value(k.sample)[k.axis]);
        const std::int64_t off = x - std::int64_t{k.v} * curve::fine;
        if (off > INT32_MAX || off < -INT32_MAX) return false;
        const auto d = static_cast<float>(static_cast<std::int32_t>(off));
        const float t = behind(k.from), fine = static_cast<float>(curve::fine);
        const float rise = c.rise(t) * fine;
        // what floats lose here, in 2^-21 of the numbers involved, and the rounding of the sample
        // to 1/2: the search keeps back more than that for the same
        const float terms =
            approx::absolute(c.c1) + t * (approx::absolute(c.c2) + t * approx::absolute(c.c3));
        const float lost = (approx::absolute(d) + t * terms * fine) * (rounding * 0.25f) + 0.6f;
        return approx::absolute(d - rise) + lost <= lattice_[k.axis].full_radius;
    }
    bool next_part(std::size_t axis, PieceType& piece) noexcept {
        if (!cursor_.walk.next(Source{*this, axis, true}, piece)) return false;
        static_cast<void>(curve::step(cursor_.state, piece));
        return true;
    }
    std::size_t old_count_to(std::size_t i, std::int32_t tick) const noexcept {
        for (std::size_t n = 0; i < samples_.old_count() && n <= Window; ++n, ++i) {
            const curve::Moment at = samples_.old_when(i);
            if (at.tick > tick || (at.tick == tick && at.part > 0.0f)) break;
        }
        return i;
    }

    std::int32_t nearest(std::size_t a, const Value& value) const noexcept {
        const std::int64_t x = lattice_[a].scale.to_fine(value[a]);
        return static_cast<std::int32_t>((x + curve::fine / 2) >> curve::fine_bits);
    }
    std::int64_t from_origin(std::size_t a, const Value& value) const noexcept {
        return lattice_[a].scale.to_fine(value[a]) - std::int64_t{state_[a].v[0]} * curve::fine;
    }
    std::int32_t relative(std::size_t a, const Value& value) const noexcept {
        return static_cast<std::int32_t>(from_origin(a, value));
    }
    float steps(std::size_t a, const Value& value) const noexcept {
        return static_cast<float>(relative(a, value)) * (1.0f / curve::fine);
    }

    void open_window(std::int32_t tick, std::int32_t guess) noexcept {
        start_tick_ = column_tick_ = tick;
        columns_ = 0;
        stalled_ = false;
        column_samples_ = first_samples_ = 0;
        for (std::size_t a = 0; a < D; ++a)
            search_[a].seed(state_[a], lattice_[a].radius * (1.0f / curve::fine), guess);
    }
    void keep(const curve::Moment& at, const Value& value) noexcept {
        samples_.push(at, value);
        newest_ = at;
    }
    void bound(const curve::Moment& at, const Value& value) noexcept {
        if (!reaches(value)) stalled_ = true;
        if (stalled_) return;
        for (std::size_t a = 0; a < D; ++a)
            search_[a].sample(at.tick - start_tick_, at.part, {relative(a, value)});
    }

    /// Samples that are not behind a column. later: as for offer(); all others are before it.
    std::size_t samples_to(std::int32_t tick, const curve::Moment* later) const noexcept {
        return later != nullptr ? samples_.count() : samples_.count_to(tick);
    }
    /// A column at `tick`. later: the sample behind it that made it due, not yet kept; null where
    /// the newest sample is at or before the tick, or none is known.
    void offer(std::int32_t tick, bool end, bool told, const curve::Moment* later,
               const Value* later_value) noexcept {
        if (columns_ >= Window + 1) return;
        const std::int32_t from = column_tick_;
        column_tick_ = tick;
        ++columns_;
        const std::size_t last = samples_to(tick, later);
        Column at;
        at.tick = tick - start_tick_;
        at.last = last;
        at.end = end;
        if (told) at.told = &at.middle;
        for (std::size_t a = 0; a < D; ++a) {
            Search& search = search_[a];
            if (stalled_) continue;
            surround(at, a, tick, later, later_value);
            search.column(at, Source{*this, a, false});
            offer_jump(a, from, tick, last, at.middle[0]);
            if (end)
                search.record();
            else
                search.grow(tick - start_tick_);
        }
        column_samples_ = last;
    }

    /// Where axis a should be at a column: at the interpolated neighbours, on the way to the later.
    void surround(Column& column, std::size_t a, std::int32_t tick, const curve::Moment* later,
                  const Value* later_value) const noexcept {
        const std::size_t last = column.last;
        const bool ahead = later != nullptr && reaches(*later_value);
        float& middle = column.middle[0];
        middle = last > 0 ? steps(a, samples_.value(last - 1)) : 0.0f;
        column.known = false;
        column.after = 0;
        if (ahead) {
            column.later[0] = steps(a, *later_value);
            column.after = static_cast<float>(later->tick - tick) + later->part;
            if (last == 0) middle = column.later[0];
        }
        if (last == 0) return;
        const curve::Moment at = samples_.when(last - 1);
        const float gone = static_cast<float>(tick - at.tick) - at.part;
        if (gone > 0.0f) {
            if (!ahead) {  // on from the last two samples, a little way
                if (last < 2 || gone > 0.2f || !reaches(samples_.value(last - 2))) return;
                const curve::Moment n = samples_.when(last - 2);
                const float apart = static_cast<float>(at.tick - n.tick) + (at.part - n.part);
                middle += (middle - steps(a, samples_.value(last - 2))) * (gone / apart);
            } else {
                middle += (column.later[0] - middle) * (gone / (gone + column.after));
            }
        }
        column.known = true;
    }

    /// Offers the jump from the column before, where it may be cheaper than what there is.
    void offer_jump(std::size_t a, std::int32_t from, std::int32_t tick, std::size_t last,
                    float middle) noexcept {
        auto& search = search_[a];
        curve::State<1> state = search.before_state();
        if (search.count() > 0) {
            const float rise = middle - static_cast<float>(state.v[0]);
            const Cost least = search.before_cost() + jump_code_cost_min + code::tick_cost +
                               code::jump_value_cost(static_cast<std::int32_t>(rise));
            if (search.cost() <= least) return;
        }
        const std::int32_t target =
            state_[a].v[0] + static_cast<std::int32_t>(middle < 0 ? middle - 0.5f : middle + 0.5f);
        state.v[0] += state_[a].v[0];
        JumpWalk<1> walk{state.v, {target}, from, tick, column_samples_, last};
        code::Counter counter;
        curve::Piece<1> piece;
        const Source source{*this, a, false};
        const std::size_t most = jump_parts(last - column_samples_);
        for (std::size_t i = 0; i < most && walk.next(source, piece); ++i)
            static_cast<void>(code::code_piece<Kind>(counter, code::costs<Kind, 1>, state, piece,
                                                     piece.subs, code::End::coded));
        search.offer_jump({walk.v()[0] - state_[a].v[0]}, counter.cost());
    }
    void commit_present(std::int32_t to, Seam seam) noexcept {
        segment_.start_tick = start_tick_;
        segment_.end_tick = to;
        segment_.starts = starts_;
        segment_.ends = last_;
        segment_.start = state_;
        hard_ = stalled_;
        exact_ = false;
        const Line line = trend(to);
        const std::size_t n = samples_.count_to(to);
        for (std::size_t a = 0; a < D; ++a) commit_axis(a, to, n, line, last_);
        for (auto& s : state_) {
            if (seam == Seam::restart) s.forget(true);
            if (seam == Seam::independent) s.forget(false);
        }
    }
    void commit_axis(std::size_t a, std::int32_t tick, std::size_t samples, const Line& line,
                     bool last) noexcept {
        auto& search = search_[a];
        if (stalled_) {  // one jump from the start of the window, of any size
            const Value& newest = samples_.value(samples_.count() - 1);
            JumpWalk<1> walk{state_[a].v, {nearest(a, newest)}, start_tick_,
                             tick,        first_samples_,       samples};
            curve::Piece<1> piece;
            const Source source{*this, a, false};
            const std::size_t most = jump_parts(samples - first_samples_);
            for (std::size_t i = 0; i < most && walk.next(source, piece); ++i)
                static_cast<void>(curve::step(state_[a], piece));
            steps_[a][0] = {{0}, static_cast<std::uint8_t>(tick - start_tick_), how::jump};
            step_count_[a] = 1;
        } else {
            const std::size_t best = last ? 0 : search.choose(line.value[a], line.slope[a], false);
            step_count_[a] = search.trace(best, steps_[a], 0);
            curve::State<1> state = search.state(best);
            state.v[0] += state_[a].v[0];
            state_[a] = state;
        }
        segment_.end_v[a] = state_[a].v[0];
    }

    /// Least squares over the newest samples of the window, extrapolated to `tick`.
    Line trend(std::int32_t tick) const noexcept {
        constexpr std::size_t most = 12;
        Line line;
        const std::size_t count = samples_.count(), n = count < most ? count : most;
        if (n == 0 || stalled_) return line;
        float t[most]{}, st = 0, stt = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const curve::Moment at = samples_.when(count - 1 - i);
            t[i] = static_cast<float>(at.tick - tick) + at.part;
            st += t[i];
            stt += t[i] * t[i];
        }
        const auto m = static_cast<float>(n);
        const float det = m * stt - st * st;
        for (std::size_t a = 0; a < D; ++a) {
            const float newest = steps(a, samples_.value(count - 1));
            float sx = 0, stx = 0;
            for (std::size_t i = 0; i < n; ++i) {
                const float x = steps(a, samples_.value(count - 1 - i)) - newest;
                sx += x;
                stx += t[i] * x;
            }
            line.slope[a][0] = n > 2 && det > 0.0f ? (m * stx - st * sx) / det : 0.0f;
            line.value[a][0] = newest - line.slope[a][0] * t[0];
        }
        return line;
    }

    Samples<Value, Window> samples_{};
    std::array<Search, D> search_{};
    std::array<std::array<Step<1>, Window + 1>, D> steps_{};
    std::array<std::size_t, D> step_count_{};
    std::array<curve::State<1>, D> state_{};  // where the window began; v is its origin
    Segment segment_{};
    Extent whole_{};  // of a frame that was given up
    Cursor cursor_{};
    Check check_{};
    std::array<Lattice, D> lattice_{};
    curve::Moment newest_{};
    std::int32_t start_tick_{0}, column_tick_{0}, end_tick_{0};
    std::size_t columns_{0}, column_samples_{0}, first_samples_{0};
    std::uint32_t failures_{0};
    bool active_{false}, starts_{false}, stalled_{false}, last_{false}, hard_{false},
        exact_{false};  // hard: a step of any size; exact: of a frame that was given up
};

}  // namespace fairlead::reduce
