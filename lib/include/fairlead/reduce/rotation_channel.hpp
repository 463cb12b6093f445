#pragma once
// A channel of orientations: one search of three components in a chart about an anchor.
//
// The counterpart of vector_channel.hpp. Where a sample is too far from the anchor, the window is
// committed at its last column and goes on in a chart about the vertex there; the frame does not
// end. A chart reaches every rotation, so that a jump holds any sample and nothing stalls.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/per_axis.hpp"
#include "fairlead/code/pieces.hpp"
#include "fairlead/curve/scale.hpp"
#include "fairlead/reduce/ball.hpp"
#include "fairlead/reduce/extent.hpp"
#include "fairlead/reduce/jump_walk.hpp"
#include "fairlead/reduce/samples.hpp"
#include "fairlead/reduce/seam.hpp"
#include "fairlead/reduce/search.hpp"

namespace fairlead::reduce {

/// What a channel says of a committed frame.
struct RotationSegment : Extent {
    curve::RotationState start{};
    curve::GridQuat start_grid{};  // start.anchor, where `starts`
    curve::GridQuat end_grid{};    // where the frame tells its end: the anchor behind it
    std::array<float, 3> told{};   // likewise: its place in the last chart of the frame
};

/// Finer tolerances do not fit the 16 bits of a chart and float orientations.
inline constexpr float rotation_tolerance_min_rad = 1.2e-4f;

template <class Kind, class BeamT, std::size_t Window>
class RotationChannel {
    static_assert(Window >= 4 && Window <= 240, "a window holds 4 to 240 records");

  public:
    using Value = Quat;
    using Segment = RotationSegment;
    using PieceType = curve::Piece<3>;
    using KindType = Kind;
    static constexpr std::size_t window = Window;
    static constexpr std::size_t parts = 1;
    static constexpr std::size_t components = 3;
    static constexpr Cost column_bits_max = jump_bits_max(3);
    static constexpr Cost start_bits_max = 51 + 79;  // a place of the grid, and the frame's jump
    Cost next_column_bits(std::size_t more) const noexcept {
        const std::size_t samples = samples_.count() - newest_column_.samples + more;
        return jump_bits_max(3, samples > 0 ? samples : 1) + (starts_ ? start_bits_max : 0);
    }

    /// tolerance: largest angle between sample and curve, rad; >= rotation_tolerance_min_rad.
    void configure(const PerAxis<1>& tolerance) noexcept {
        const float tolerance_rad = tolerance[0];
        scale_ = curve::Scale::of_step(0.9f * tolerance_rad);
        step_ = scale_.template step<float>();
        full_radius_ = tolerance_rad / step_;
        // float places and anchors are off by less than 2 urad, the polynomials by 2^-20 of it
        check_radius_ = full_radius_ - 1.5e-6f / step_;
        radius_ = (full_radius_ * (1.0f - 0x1p-12f) - 2e-6f / step_) * BeamT::trust;
    }
    const curve::Scale& scale(std::size_t = 0) const noexcept { return scale_; }
    float step() const noexcept { return step_; }
    /// The state at the start of the open frame.
    const curve::RotationState& frame_state() const noexcept { return start_; }

    bool active() const noexcept { return active_; }
    /// Has the curve begun in this frame?
    bool starts() const noexcept { return starts_; }
    bool stalled() const noexcept { return false; }
    std::int32_t start_tick() const noexcept { return frame_tick_; }
    std::int32_t column_tick() const noexcept { return column_tick_; }
    std::int32_t last_tick() const noexcept { return newest_.tick + (newest_.part > 0.0f ? 1 : 0); }
    bool reaches(const Value&) const noexcept { return true; }

    void start(const curve::Moment& at, const Value& q, std::int32_t) noexcept {
        state_ = {};
        start_grid_ = curve::to_grid(normalised(q), step_);
        state_.anchor = curve::from_grid(start_grid_, step_);
        start_ = state_;
        active_ = starts_ = true;
        spent_ = 0;
        step_count_ = 0;
        frame_tick_ = at.tick;
        open_window(at.tick);
        keep(at, q);
        mark_first(at.tick);
        bound(samples_.count() - 1);
    }

    void push(const curve::Moment& at, const Value& q, std::int32_t column, bool end,
              Seam asked) noexcept {
        const bool told = end && asked != Seam::carry;
        const bool first = column >= 0 && (at.tick > column || (at.tick == column && at.part > 0));
        if (far_ && column >= 0 && columns_ > 0 && !held_) rechart();
        const Place y = curve::place(state_.anchor, q, step_);
        if (first) offer(column, end, told, &at, &y);
        keep(at, q);
        bound(samples_.count() - 1);
        if (column >= 0 && !first) offer(column, end, told, nullptr, nullptr);
    }

    Cost cost() const noexcept { return spent_ + search_.cost(); }

    void end_at(std::int32_t tick) noexcept {
        last_ = true;
        end_tick_ = tick;
    }
    Seam close(std::int32_t tick, Seam asked) noexcept {
        const std::int32_t to = last_ ? end_tick_ : tick;
        const bool tell = asked != Seam::carry && !last_ && to > frame_tick_;
        if (column_tick_ < to)
            offer(to, true, tell, nullptr, nullptr);
        else if (tell && !told_)
            offer_again();
        return asked;
    }
    void commit(std::int32_t tick, Seam seam, std::int32_t) noexcept {
        cursor_ = {};
        check_ = {};
        segment_ = {};
        if (!active_) return;
        const std::int32_t to = last_ ? end_tick_ : tick;
        segment_.present = last_ ? to >= frame_tick_ : to > frame_tick_;
        if (segment_.present) commit_present(to, seam);
        samples_.commit(to < 0 ? 0 : to);
        newest_.tick -= tick;
        starts_ = starts_ && !segment_.present;
        active_ = !last_;
        last_ = false;
        if (!active_) return;
        start_ = state_;
        spent_ = 0;
        step_count_ = segment_.present ? step_count_ : 0;
        frame_tick_ = 0;
        open_window(0);
        replace(segment_.present ? old_anchor_ : state_.anchor);
    }
    void release() noexcept {
        samples_.release();
        held_ = false;
    }
    void stop() noexcept {
        active_ = last_ = false;
        samples_.drop();
    }
    void reset() noexcept {
        stop();
        segment_ = {};
        samples_.clear();
        held_ = false;
    }

    // ---- the committed frame
    const Segment& segment() const noexcept { return segment_; }
    void rewind() noexcept { cursor_ = {}; }
    std::size_t size() const noexcept { return 3 * frame_steps_; }

    // ---- the way on where a committed frame is not right: as in VectorChannel

    /// Where the frame moved its chart, samples are in charts about different anchors: all go into
    /// the first.
    void give_up() noexcept {
        whole_ = segment_;
        cursor_ = {};
        old_anchor_ = segment_.start.anchor;
        Quat anchor = old_anchor_;
        std::size_t from = 0;
        PieceType piece;
        for (std::size_t n = 0; n <= Window * jump_parts_max && next(0, piece); ++n) {
            if (piece.code != curve::code::rebase) continue;
            rechart_old(from, cursor_.sample, anchor);
            from = cursor_.sample;
            anchor = cursor_.state.anchor;
        }
        rechart_old(from, samples_.old_count(), anchor);
    }
    std::int32_t tick_of(std::int32_t from, std::size_t count) const noexcept {
        return samples_.old_tick(old_count_to(0, from) + count - 1);
    }
    /// told: a curve that goes on ends on a place of the grid.
    void cut(const Stretch& stretch, const curve::RotationState* now, bool told) noexcept {
        static_cast<Extent&>(segment_) = whole_.within(stretch);
        cursor_ = {};
        exact_ = true;
        if (!segment_.present) return;
        if (!segment_.starts) segment_.start = *now;
        const std::size_t first = old_count_to(0, segment_.start_tick);
        const std::size_t n = old_count_to(first, segment_.end_tick);
        const auto ticks = static_cast<std::uint8_t>(segment_.end_tick - segment_.start_tick);
        steps_[0] = {{}, ticks, how::jump};
        frame_steps_ = ticks > 0 ? 1 : 0;
        frame_told_ = told && !segment_.ends;
        const Place y = n > first ? Source{*this, true}.place(n - 1) : Place{};
        for (std::size_t a = 0; a < 3; ++a)
            steps_[0].v[a] = static_cast<std::int16_t>(nearest(y[a]));
        if (!frame_told_) return;
        PieceType piece;  // to the end, whose place on the grid stands before the pieces
        cursor_.state = segment_.start;
        for (std::size_t i = 0; i <= Window * jump_parts_max && next(0, piece); ++i) continue;
        segment_.end_grid = curve::to_grid(place_of(cursor_.state), step_);
        cursor_ = {};
    }
    void drop_to(std::int32_t tick) noexcept { samples_.release_first(old_count_to(0, tick)); }
    bool begins_at(const curve::RotationState* state) const noexcept {
        return !segment_.present || segment_.starts || curve::same(segment_.start, *state);
    }
    bool goes_on() const noexcept {
        return active_ && !starts_ && segment_.present && !segment_.ends;
    }
    void resume(const curve::RotationState* state, std::int32_t) noexcept {
        if (!active_) return;
        const Quat old = state_.anchor;
        if (goes_on()) {
            start_ = state_ = *state;
            spent_ = 0;
        }
        const std::int32_t tick = start_tick_;  // where the chart began, which may have moved
        open_window(tick);
        mark_first(tick);
        replace(old);
    }

    bool next(std::size_t, PieceType& piece) noexcept {
        Cursor& c = cursor_;
        if (!c.begun) {
            c = {};
            c.begun = true;
            c.state = segment_.start;
            c.tick = segment_.start_tick;
            c.sample = old_count_to(0, c.tick);
        }
        if (c.jumping && next_part(piece)) return true;
        c.jumping = false;
        if (c.rebase) {
            c.rebase = false;
            piece = {};
            piece.code = curve::code::rebase;
            curve::rebase(c.state, step_);
            return true;
        }
        if (c.step >= frame_steps_) return false;
        const Step<3>& step = steps_[c.step++];
        const std::int32_t to = c.tick + step.ticks;
        const std::size_t first = c.sample;
        c.sample = old_count_to(first, to);
        c.rebase = (step.how & how::rebase) != 0;
        const std::uint8_t code = code_of(step.how, step.ticks);
        if (code == curve::code::jump) {
            c.walk = JumpWalk<3>{
                c.state.chart.v, {step.v[0], step.v[1], step.v[2]}, c.tick, to, first, c.sample};
            c.tick = to;
            c.jumping = true;
            return next_part(piece);
        }
        piece = {};
        piece.code = code;
        piece.subs = static_cast<std::uint16_t>(step.ticks * curve::subs_per_tick);
        c.tick = to;
        if (c.step == frame_steps_ && frame_told_) return true;  // ends where the frame tells
        for (std::size_t a = 0; a < 3; ++a)
            piece.k[a] = step.v[a] - c.state.chart.v[a] -
                         curve::predicted_rise(c.state.chart.s[a], c.state.chart.fresh, step.ticks);
        static_cast<void>(curve::step(c.state.chart, piece));
        return true;
    }
    /// As VectorChannel::check().
    bool check(std::size_t samples) noexcept {
        Check& k = check_;
        for (; k.sample < samples_.old_count(); ++k.sample) {
            if (samples-- == 0) return false;
            if (segment_.present && !holds(k)) ++failures_;
        }
        return true;
    }
    std::uint32_t failures() const noexcept { return failures_; }

  private:
    using Search = reduce::Search<Ball<Kind>, BeamT, Window + 1>;
    using Column = typename Search::Column;

    struct Line {
        Place value{}, slope{};
    };
    /// A column: its tick in the frame, and one behind the last sample at or before it.
    struct Mark {
        std::int32_t tick{};
        std::size_t samples{};
    };
    struct Cursor {
        std::size_t step{0}, sample{0};
        std::int32_t tick{0};
        bool begun{false}, jumping{false}, rebase{false};
        curve::RotationState state{};
        JumpWalk<3> walk{};
    };
    struct Check {
        std::size_t sample{0};
        std::int32_t from{0}, to{0};  // of the piece, sub-ticks of the frame
        Place v{};                    // at its start
        std::array<curve::Polynomial<float>, 3> c{};
    };
    /// A constant's ball: the lattice place nearest to the first sample, as long as it holds.
    struct Source {
        const RotationChannel& channel;
        bool old;  // of the committed frame, else of the window
        struct Fit {
            std::array<std::int32_t, 3> v{};
            float limit{};
            bool some{false};
            const Source* source{};
            std::size_t first{0}, count{0};
            bool add(const Source& from, std::size_t i) noexcept {
                const Place y = from.place(i);
                if (!some) {
                    for (std::size_t a = 0; a < 3; ++a) v[a] = nearest(y[a]);
                    some = true;
                    source = &from;
                    first = i;
                }
                if (!in_ball(y, v)) return false;
                ++count;
                return true;
            }
            bool in_ball(const Place& y, const std::array<std::int32_t, 3>& at) const noexcept {
                float n = 0;
                for (std::size_t a = 0; a < 3; ++a) {
                    const float e = y[a] - static_cast<float>(at[a]);
                    n += e * e;
                }
                return n <= limit;
            }
            bool holds(const std::array<std::int32_t, 3>& at) const noexcept {
                for (std::size_t i = 0; i < count; ++i)
                    if (!in_ball(source->place(first + i), at)) return false;
                return true;
            }
            std::array<std::int32_t, 3> value() const noexcept { return v; }
        };
        Fit fit() const noexcept {
            Fit fit;
            const bool exact = old && channel.exact_;
            const float radius = exact ? channel.full_radius_ * exact_part : channel.radius_;
            fit.limit = radius * radius;
            return fit;
        }
        curve::Moment when(std::size_t i) const noexcept {
            return old ? channel.samples_.old_when(i) : channel.samples_.when(i);
        }
        Place place(std::size_t i) const noexcept {
            if (!old) return channel.samples_.value(i);
            const Place& y = channel.samples_.old_value(i);
            return channel.exact_
                       ? channel.moved(channel.segment_.start.anchor, channel.old_anchor_, y)
                       : y;
        }
    };
    /// Samples of the window, as the search compares them.
    struct Seen {
        const RotationChannel& channel;
        curve::Moment when(std::size_t i) const noexcept { return channel.samples_.when(i); }
        const Place& place(std::size_t i) const noexcept { return channel.samples_.value(i); }
        std::int32_t start_tick() const noexcept { return channel.start_tick_; }
    };

    bool holds(Check& k) noexcept {
        const curve::Moment at = samples_.old_when(k.sample);
        if (k.sample == 0) k.from = k.to = segment_.start_tick * curve::subs_per_tick;
        const auto behind = [&at](std::int32_t subs) {
            const auto whole = static_cast<float>(at.tick * curve::subs_per_tick - subs);
            return whole * (1.0f / static_cast<float>(curve::subs_per_tick)) + at.part;
        };
        for (std::size_t i = 0; i <= Window * jump_parts_max && behind(k.to) > 0.0f; ++i) {
            const curve::State<3> before =
                cursor_.begun ? cursor_.state.chart : segment_.start.chart;
            PieceType piece;
            if (!next(0, piece)) return false;
            k.from = k.to;
            k.to += piece.subs;
            const bool jump = piece.code == curve::code::jump;
            const bool told = frame_told_ && !jump && cursor_.step == frame_steps_;
            for (std::size_t a = 0; a < 3; ++a) {
                const auto v = static_cast<float>(jump ? cursor_.state.chart.v[a] : before.v[a]);
                const float end =
                    told ? segment_.told[a] : static_cast<float>(cursor_.state.chart.v[a]);
                k.v[a] = v;
                k.c[a] = curve::polynomial<float>(piece.code, before.fresh, before.s[a], end - v,
                                                  piece.subs / curve::subs_per_tick);
            }
        }
        const float t = behind(k.from);
        const Place& y = samples_.old_value(k.sample);
        float sum = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const float e = (y[a] - k.v[a]) - k.c[a].rise(t);
            sum += e * e;
        }
        return sum <= check_radius_ * check_radius_;
    }
    bool next_part(PieceType& piece) noexcept {
        Cursor& c = cursor_;
        if (!c.walk.next(Source{*this, true}, piece)) return false;
        static_cast<void>(curve::step(c.state.chart, piece));
        return true;
    }
    std::size_t old_count_to(std::size_t i, std::int32_t tick) const noexcept {
        for (std::size_t n = 0; i < samples_.old_count() && n <= Window + between_max; ++n, ++i) {
            const curve::Moment at = samples_.old_when(i);
            if (at.tick > tick || (at.tick == tick && at.part > 0.0f)) break;
        }
        return i;
    }

    void open_window(std::int32_t tick) noexcept {
        start_tick_ = column_tick_ = tick;
        before_ = newest_column_ = {tick, 0};
        first_samples_ = 0;
        columns_ = 0;
        told_ = far_ = false;
        search_.seed(state_.chart, radius_, 0);
    }
    /// The window begins behind the samples up to this tick.
    void mark_first(std::int32_t tick) noexcept {
        first_samples_ = samples_.count_to(tick);
        newest_column_.samples = first_samples_;
    }
    void keep(const curve::Moment& at, const Quat& q) noexcept {
        const Place y = curve::place(state_.anchor, q, step_);
        far_ = far_ || is_far(y);
        samples_.push(at, y);
        newest_ = at;
    }
    bool is_far(const Place& y) const noexcept {
        const float most = curve::chart_angle_max / step_;
        return y[0] * y[0] + y[1] * y[1] + y[2] * y[2] > most * most;
    }
    void bound(std::size_t i) noexcept {
        const curve::Moment at = samples_.when(i);
        search_.sample(at.tick - start_tick_, at.part, samples_.value(i));
    }
    /// A place in the chart about `from`, in the chart about `to`.
    Place moved(const Quat& to, const Quat& from, const Place& y) const noexcept {
        const Vec3 theta{y[0] * step_, y[1] * step_, y[2] * step_};
        return curve::place(to, from * from_rotation_vector(theta), step_);
    }
    /// Samples of the window go into the chart about the new anchor, and are searched.
    void replace(const Quat& old_anchor) noexcept {
        for (std::size_t i = 0; i < samples_.count(); ++i) {
            if (i < first_samples_) continue;
            samples_.value(i) = moved(state_.anchor, old_anchor, samples_.value(i));
            bound(i);
        }
    }
    /// Samples [from, to) of a frame that was given up, from the chart about this anchor.
    void rechart_old(std::size_t from, std::size_t to, const Quat& anchor) noexcept {
        for (std::size_t i = from; i < to && !curve::same(anchor, old_anchor_); ++i)
            samples_.old_value(i) = moved(old_anchor_, anchor, samples_.old_value(i));
    }
    /// The rotation at a vertex.
    Quat place_of(const curve::RotationState& state) const noexcept {
        return normalised(state.anchor *
                          curve::chart_exp(curve::chart_angle(state.chart.v, step_)));
    }
    static std::int32_t nearest(float x) noexcept {
        return static_cast<std::int32_t>(x < 0 ? x - 0.5f : x + 0.5f);
    }
    /// Commits the window at its last column and goes on about the vertex there; a column follows
    /// in the same push, so that a frame never ends where a chart begins. The memory for steps must
    /// be free of those of a frame that has not left.
    void rechart() noexcept {
        const Line line = trend(column_tick_);
        const std::size_t best = search_.choose(line.value, line.slope, false);
        step_count_ += search_.trace(best, steps_, step_count_);
        if (step_count_ > 0) steps_[step_count_ - 1].how |= how::rebase;
        const std::uint8_t row = search_.state(best).last_code;
        spent_ += search_.cost_of(best) + code::costs<Kind, 3>.length[row][curve::code::rebase];
        state_.chart = search_.state(best);
        const Quat old = state_.anchor;
        curve::rebase(state_, step_);
        const std::int32_t tick = column_tick_;
        open_window(tick);
        mark_first(tick);
        replace(old);
    }

    /// A column at `tick`. later: the sample behind it that made it due, not yet kept; or null.
    void offer(std::int32_t tick, bool end, bool told, const curve::Moment* later,
               const Place* later_place) noexcept {
        if (columns_ >= Window + 1) return;
        column_tick_ = tick;
        ++columns_;
        const std::size_t last = later != nullptr ? samples_.count() : samples_.count_to(tick);
        before_ = newest_column_;
        newest_column_ = {tick, last};
        Column at;
        at.tick = tick - start_tick_;
        at.last = last;
        at.end = end;
        if (later != nullptr) {
            at.later = *later_place;
            at.after = static_cast<float>(later->tick - tick) + later->part;
        }
        middle_at(at, tick);
        if (told) tell(at);
        search_.column(at, Seen{*this});
        offer_jump(at.middle);
        if (end)
            search_.record();
        else
            search_.grow(tick - start_tick_);
    }
    /// The last column again, as the end of a frame that tells it: what has not died since closes
    /// on the place of the grid, or a jump leads there.
    void offer_again() noexcept {
        Column at;
        at.tick = column_tick_ - start_tick_;
        at.last = newest_column_.samples;
        at.end = true;
        middle_at(at, column_tick_);
        tell(at);
        search_.column(at, Seen{*this});
        offer_jump(at.middle);
        search_.record();
    }
    /// The frame ends at the place of the grid nearest to where the samples are; or where the curve
    /// began, if that is within half of the tolerance: mostly the origin of the stream's absolute
    /// places, which costs fewest bits.
    void tell(Column& at) noexcept {
        const Place& y = at.middle;
        const Quat q =
            state_.anchor * from_rotation_vector(Vec3{y[0] * step_, y[1] * step_, y[2] * step_});
        end_grid_ = curve::to_grid(normalised(q), step_);
        const Place begin =
            curve::place(state_.anchor, curve::from_grid(start_grid_, step_), step_);
        const Vec3 apart{begin[0] - y[0], begin[1] - y[1], begin[2] - y[2]};
        if (dot(apart, apart) <= 0.25f * radius_ * radius_) end_grid_ = start_grid_;
        end_anchor_ = curve::from_grid(end_grid_, step_);
        target_ = curve::place(state_.anchor, end_anchor_, step_);
        at.told = &target_;
        told_ = true;
    }

    void middle_at(Column& at, std::int32_t tick) const noexcept {
        at.middle = at.later;
        if (at.last == 0) return;
        at.middle = samples_.value(at.last - 1);
        const curve::Moment m = samples_.when(at.last - 1);
        const float gone = static_cast<float>(tick - m.tick) - m.part;
        at.known = true;
        if (!(gone > 0.0f)) return;
        if (!(at.after > 0.0f)) {  // on from the last two samples, a little way
            if (at.last < 2 || at.last < first_samples_ + 2 || gone > 0.2f) {
                at.known = false;
                return;
            }
            const curve::Moment n = samples_.when(at.last - 2);
            const float apart = static_cast<float>(m.tick - n.tick) + (m.part - n.part);
            const Place& before = samples_.value(at.last - 2);
            for (std::size_t a = 0; a < 3; ++a)
                at.middle[a] += (at.middle[a] - before[a]) * (gone / apart);
            return;
        }
        for (std::size_t a = 0; a < 3; ++a)
            at.middle[a] += (at.later[a] - at.middle[a]) * (gone / (gone + at.after));
    }

    /// Offers the jump from the column before the newest one, where it may be cheaper than what
    /// there is.
    void offer_jump(const Place& middle) noexcept {
        curve::State<3> state = search_.before_state();
        if (search_.count() > 0) {
            Cost least = search_.before_cost() + jump_code_cost_min + code::tick_cost;
            for (std::size_t a = 0; a < 3; ++a)
                least += code::jump_value_cost(static_cast<std::int32_t>(middle[a]) - state.v[a]);
            if (search_.cost() <= least) return;
        }
        std::array<std::int32_t, 3> target;
        for (std::size_t a = 0; a < 3; ++a) target[a] = nearest(middle[a]);
        const std::size_t first = before_.samples, last = newest_column_.samples;
        JumpWalk<3> walk{state.v, target, before_.tick, newest_column_.tick, first, last};
        code::Counter counter;
        curve::Piece<3> piece;
        const Source source{*this, false};
        for (std::size_t i = 0; i < jump_parts(last - first) && walk.next(source, piece); ++i)
            static_cast<void>(code::code_piece<Kind>(counter, code::costs<Kind, 3>, state, piece,
                                                     piece.subs, code::End::coded));
        search_.offer_jump(walk.v(), counter.cost());
    }

    void commit_present(std::int32_t to, Seam seam) noexcept {
        segment_.start_tick = frame_tick_;
        segment_.end_tick = to;
        segment_.starts = starts_;
        segment_.ends = last_;
        segment_.start = start_;
        segment_.start_grid = start_grid_;
        const bool told = seam != Seam::carry && !last_;
        const Line line = trend(to);
        const std::size_t best = last_ ? 0 : search_.choose(line.value, line.slope, told);
        step_count_ += search_.trace(best, steps_, step_count_);
        frame_steps_ = step_count_;
        frame_told_ = told;
        held_ = true;
        exact_ = false;
        step_count_ = 0;
        old_anchor_ = state_.anchor;
        state_.chart = search_.state(best);
        if (told) {
            segment_.end_grid = end_grid_;
            segment_.told = target_;
            curve::land(state_, end_anchor_, curve::place(state_.anchor, end_anchor_, step_),
                        step_);
            state_.chart.forget(seam == Seam::restart);
        } else {
            curve::rebase(state_, step_);
        }
    }
    Line trend(std::int32_t tick) const noexcept {
        constexpr std::size_t back = 6;
        Line line;
        const std::size_t count = samples_.count();
        if (count == 0) return line;
        const std::size_t some = count > first_samples_ ? count - 1 - first_samples_ : 0;
        const std::size_t n = some < back ? some : back;
        const curve::Moment a = samples_.when(count - 1 - n), b = samples_.when(count - 1);
        const float all = static_cast<float>(b.tick - a.tick) + (b.part - a.part);
        const float gone = static_cast<float>(tick - b.tick) - b.part;
        for (std::size_t c = 0; c < 3; ++c) {
            const float rise = samples_.value(count - 1)[c] - samples_.value(count - 1 - n)[c];
            line.slope[c] = n >= 2 && all > 0.0f ? rise / all : 0.0f;
            line.value[c] = samples_.value(count - 1)[c] + line.slope[c] * gone;
        }
        return line;
    }

    Samples<Place, Window> samples_{};
    Search search_{};
    std::array<Step<3>, Window + 1> steps_{};
    Mark before_{}, newest_column_{};  // the last two columns
    curve::RotationState state_{};     // where the window began
    curve::RotationState start_{};     // where the frame began
    curve::GridQuat start_grid_{}, end_grid_{};
    Quat end_anchor_{};
    Quat old_anchor_{};  // of the committed samples: at the frame's end, of all in a frame given up
    Place target_{};
    Segment segment_{};
    Extent whole_{};  // of a frame that was given up
    Cursor cursor_{};
    Check check_{};
    std::uint32_t failures_{0};
    curve::Scale scale_{256, -8};
    float step_{1}, radius_{}, full_radius_{}, check_radius_{};
    curve::Moment newest_{};
    std::int32_t start_tick_{0}, frame_tick_{0}, column_tick_{0}, end_tick_{0};
    std::size_t columns_{0}, first_samples_{0}, step_count_{0}, frame_steps_{0};
    Cost spent_{0};
    bool active_{false}, starts_{false}, last_{false}, told_{false}, frame_told_{false},
        far_{false};
    bool held_{false}, exact_{false};  // the steps are those of a committed frame; of one given up
};

}  // namespace fairlead::reduce
