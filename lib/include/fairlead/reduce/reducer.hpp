#pragma once
// Records in, committed frames out: the windows of all channels on one grid.
//
// The reducer decides when columns are due and where frames end; the channels search. A frame ends
//   - when its oldest record has waited as long as the delay allows,
//   - when its cost comes near to what a frame holds,
//   - before a sample that its window cannot reach (range, 250 ticks), and where it must jump
//   there,
//   - at a pause of a channel, at a change of channels, at the end.
// All channels end at the same tick; a sample behind it is searched again in the next window. Every
// push commits at most one frame, and does the work of one column.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>

#include "fairlead/curve/grid.hpp"
#include "fairlead/reduce/vector_channel.hpp"

namespace fairlead::reduce {

struct Window {
    std::int32_t records{114};   // a frame is committed before its oldest record waits longer
    std::int32_t gap_ticks{32};  // a longer pause of a channel ends its curve; <= 64
    Cost cost_max{16 * 1400};    // 1/16 bit; the cost of a frame does not pass this
};

/// A frame ends at the next column where its cost comes this near to the most: there its end is
/// searched as such, and not forced (1/16 bit).
inline constexpr Cost full_soon = 16 * 80;

/// A committed frame: [start, start + 64 ticks) sub-ticks of the run.
struct Frame {
    std::int64_t start_subs{};
    std::int32_t ticks{};
    Seam seam{};
};

/// What became of a record.
enum class Taken : std::uint8_t {
    kept,       // in the window
    committed,  // and a frame was committed
    blocked,    // not taken: a frame must end before it, and the one before has not left
};

/// Why frames ended early or curves broke; counts since the start.
struct Counts {
    std::uint32_t frames{}, jumps{}, range{}, cost{}, gaps{}, failures{};
};

template <class... Channels>
class Reducer {
  public:
    using Values = std::tuple<typename Channels::Value...>;
    static constexpr std::size_t channel_count = sizeof...(Channels);
    static constexpr std::int32_t frame_ticks_max = 250;

    static constexpr std::int32_t records_max =
        (std::min)({static_cast<std::int32_t>(Channels::window)...});
    static constexpr std::int32_t records_min = 4;
    static constexpr std::int64_t for_ever = INT64_MAX / 2;
    /// So many records lie behind one and not behind the next column's tick, at most.
    static constexpr std::int32_t records_a_tick = curve::subs_per_tick / curve::spacing_subs_min;

    /// Records and pause are limited to what the channels hold.
    void configure(const Window& window) noexcept {
        window_ = window;
        if (window_.records > records_max) window_.records = records_max;
        if (window_.records < records_min) window_.records = records_min;
        if (window_.gap_ticks > curve::gap_ticks_max) window_.gap_ticks = curve::gap_ticks_max;
        if (window_.gap_ticks < 1) window_.gap_ticks = 1;
    }
    template <std::size_t Index>
    auto& channel() noexcept {
        return std::get<Index>(channels_);
    }
    template <std::size_t Index>
    const auto& channel() const noexcept {
        return std::get<Index>(channels_);
    }

    /// A new run with a grid of its own; nothing is open.
    void begin(const curve::Grid& grid) noexcept {
        grid_ = grid;
        std::apply([](auto&... c) { (c.reset(), ...); }, channels_);
        waiting_ = behind_ = 0;
        column_ = 0;
        due_ = {};
        started_ = pending_ = false;
        frame_ = {};
    }
    /// Do all curves end at a tick that is not before this time? Curves end at whole ticks: after
    /// flush() a record may come before the tick, or at it. It needs a new run, so that no two
    /// curves of a run have a time in common.
    bool ended_behind(std::int64_t t_ns) const noexcept {
        return !started_ && frame_.ticks > 0 &&
               t_ns - grid_.time_ns(frame_.start_subs) <= frame_.ticks * grid_.tick_ns();
    }

    /// A record at t_ns: values of the channels whose bit in `valid` is set. Behind every earlier
    /// one of the run by at least curve::spacing_subs_min. A record without a value counts for the
    /// delay of what waits.
    /// @param gaps channels, by bit, whose curve must end before this record; where its end, a
    /// whole
    ///     tick, would not be before the record, it goes on
    /// @param seam how a frame that ends now should hand over; frame().seam tells what was granted
    /// @param drain called before a frame is committed while an earlier one has not been released:
    ///     it must finish with that one, or return false; then no frame is committed at this push
    template <class Drain>
    Taken push(std::int64_t t_ns, const Values& values, std::uint32_t valid, std::uint32_t gaps,
               Seam seam, Drain&& drain) noexcept {
        const bool empty = (valid & ((1u << channel_count) - 1u)) == 0;
        Taken taken = started_ ? pause(t_ns, gaps, seam, drain) : Taken::kept;
        if (taken == Taken::blocked) return taken;
        if (empty) {
            if (!started_) return taken;
            count(false);
            return taken == Taken::kept ? grow_older(t_ns, seam, drain) : taken;
        }
        if (!started_) restart_grid(t_ns);
        curve::Moment at = grid_.moment(t_ns, start_);
        std::int32_t column = grid_.column(t_ns, start_);
        const Cost ahead = needs(1);
        const bool crowded = ahead > window_.cost_max;
        if (taken == Taken::kept && column_ > 0 &&
            (column > frame_ticks_max || crowded || !reach(values, valid))) {
            taken = commit(column_, seam, drain);
            if (taken == Taken::blocked) return taken;
            if (column <= frame_ticks_max) ++(crowded ? counts_.cost : counts_.range);
            at = grid_.moment(t_ns, start_);
            column = grid_.column(t_ns, start_);
        }
        count(true);
        // a record that came when no column could be offered may lie behind this one as well
        const bool reached =
            std::any_of(due_.begin(), due_.end(), [column](std::int32_t d) { return d >= column; });
        const std::uint32_t due = take_due(column, valid);
        const bool offers = due != 0 && taken == Taken::kept;
        const bool nearly = ahead + full_soon > window_.cost_max;
        const bool long_enough = waiting_ >= window_.records || column >= usual_ticks();
        const bool end = offers && (long_enough || stalled() || nearly);
        bool starts = false;
        each([&](auto& channel, auto index) {
            constexpr std::size_t i = decltype(index)::value;
            if ((valid >> i & 1u) == 0) return;
            const auto& value = std::get<i>(values);
            if (!channel.active())
                starts = true, channel.start(at, value, guess(at.tick));
            else
                channel.push(at, value, offers && (due >> i & 1u) != 0 ? column : -1, end, seam);
        });
        if (offers && column > column_) {
            column_ = column;
            const bool later = at.tick > column || (at.tick == column && at.part > 0.0f);
            if (!reached) behind_ = later || starts ? 1 : 0;
        }
        if (taken == Taken::committed) return taken;
        const bool full = offers && needs(0) > window_.cost_max;
        if (offers && (end || full || stalled())) {
            if (full || nearly) ++counts_.cost;
            return commit_or_keep(seam, drain);
        }
        if (waiting_ >= window_.records && column_ > 0) return commit_or_keep(seam, drain);
        return Taken::kept;
    }

    /// Ends all curves at their newest samples.
    template <class Drain>
    Taken flush(Drain&& drain) noexcept {
        return started_ ? end_curves(for_ever, 0, Seam::carry, drain) : Taken::kept;
    }

    // ---- a committed frame that is not right leaves in stretches

    /// Gives up its pieces.
    void give_up() noexcept {
        std::apply([](auto&... c) { (c.give_up(), ...); }, channels_);
    }
    /// The stretch behind tick `from` in which the first channel comes to so many samples.
    Stretch stretch(std::int32_t from, std::size_t samples) const noexcept {
        std::int32_t to = frame_.ticks;
        std::apply(
            [&](const auto&... c) { ((to = (std::min)(to, c.tick_of(from, samples))), ...); },
            channels_);
        return {from, to, to >= frame_.ticks};
    }
    /// The stretch up to this tick has left.
    void drop_to(std::int32_t tick) noexcept {
        std::apply([tick](auto&... c) { (c.drop_to(tick), ...); }, channels_);
    }
    /// The window of a channel begins anew, from these states.
    template <std::size_t Index, class States>
    void resume(const States* states) noexcept {
        channel<Index>().resume(states, guess(behind_));
    }

    const Frame& frame() const noexcept { return frame_; }
    const Counts& counts() const noexcept { return counts_; }
    const curve::Grid& grid() const noexcept { return grid_; }
    /// Records that wait in the window.
    std::int32_t waiting() const noexcept { return waiting_; }
    /// The committed frame has been coded.
    void release() noexcept {
        pending_ = false;
        std::apply([](auto&... c) { (c.release(), ...); }, channels_);
    }

  private:
    template <class Visit>
    void each(Visit&& f) noexcept {
        each(f, std::index_sequence_for<Channels...>{});
    }
    template <class Visit, std::size_t... Index>
    void each(Visit& f, std::index_sequence<Index...>) noexcept {
        (f(std::get<Index>(channels_), std::integral_constant<std::size_t, Index>{}), ...);
    }

    /// Channels, by bit, for which this column is due: it has passed since their last record, so
    /// that all of their samples lie at or before it.
    std::uint32_t take_due(std::int32_t column, std::uint32_t valid) noexcept {
        std::uint32_t due = 0;
        for (std::size_t i = 0; i < channel_count; ++i) {
            if ((valid >> i & 1u) == 0 || column <= due_[i]) continue;
            due_[i] = column;
            due |= 1u << i;
        }
        return due;
    }
    /// Ticks of a frame whose records are a tick apart, on the ticks or between them.
    std::int32_t usual_ticks() const noexcept { return window_.records - 1; }
    /// Ticks from `tick` to where the frame is likely to end.
    std::int32_t guess(std::int32_t tick) const noexcept {
        const std::int32_t left = usual_ticks() - tick;
        return left < 1 ? 1 : left < frame_ticks_max ? left : frame_ticks_max;
    }
    Cost cost() const noexcept {
        return std::apply([](auto&... c) { return (Cost{0} + ... + (c.active() ? c.cost() : 0)); },
                          channels_);
    }
    /// What the window costs with its next column, at most: a frame may have to end with it.
    Cost needs(std::size_t more) const noexcept {
        return cost() +
               16 * std::apply(
                        [more](auto&... c) {
                            return (Cost{0} + ... + (c.active() ? c.next_column_bits(more) : 0));
                        },
                        channels_);
    }
    bool stalled() const noexcept {
        return std::apply([](auto&... c) { return (false || ... || (c.active() && c.stalled())); },
                          channels_);
    }
    bool reach(const Values& values, std::uint32_t valid) noexcept {
        bool all = true;
        each([&](auto& channel, auto index) {
            constexpr std::size_t i = decltype(index)::value;
            if ((valid >> i & 1u) != 0 && channel.active() && !channel.stalled())
                all = all && channel.reaches(std::get<i>(values));
        });
        return all;
    }
    /// Ends the curves of channels without a sample for longer than a curve may be, and of those in
    /// `gaps`.
    template <class Drain>
    Taken pause(std::int64_t t_ns, std::uint32_t gaps, Seam seam, Drain& drain) noexcept {
        const std::int64_t after_ns = t_ns - grid_.time_ns(start_);
        bool any = false;
        each([&](auto& c, auto index) {
            any = any || (c.active() && gone(c, after_ns, gaps >> decltype(index)::value));
        });
        return any ? end_curves(after_ns, gaps, seam, drain) : Taken::kept;
    }
    /// after_ns: of the record, from the start of the frame.
    template <class Channel>
    bool gone(const Channel& channel, std::int64_t after_ns, std::uint32_t gap) const noexcept {
        const std::int64_t pause_ns = after_ns - channel.last_tick() * grid_.tick_ns();
        if ((gap & 1u) != 0 && pause_ns > 0) return true;
        return pause_ns > window_.gap_ticks * grid_.tick_ns();
    }
    template <class Drain>
    Taken end_curves(std::int64_t after_ns, std::uint32_t gaps, Seam seam, Drain& drain) noexcept {
        if (pending_ && !drain()) return Taken::blocked;
        bool all = true,
             part = false;  // do all curves end; has one that ends samples in the window?
        std::int32_t tick = 0;
        each([&](auto& c, auto index) {
            if (!c.active()) return;
            if (!gone(c, after_ns, gaps >> decltype(index)::value)) {
                all = false;
            } else if (c.last_tick() > c.start_tick() || c.starts()) {
                part = true;
                c.end_at(c.last_tick());
                if (c.last_tick() > tick) tick = c.last_tick();
            } else {
                c.end_at(-1);
            }
        });
        ++counts_.gaps;
        if (!all && column_ > tick) tick = column_;
        if (part) return commit(tick, seam, drain);
        each([&](auto& c, auto index) {
            if (c.active() && gone(c, after_ns, gaps >> decltype(index)::value)) c.stop();
        });
        if (all) started_ = false;
        return Taken::kept;
    }
    /// Counts a record, with a value or without one: each sample that waits has waited for one
    /// more. Every record is counted here, once, after a frame that must end before it.
    void count(bool sample) noexcept {
        if (sample || waiting_ > 0) ++waiting_;
        if (sample || behind_ > 0) ++behind_;
    }
    /// After a record without a value: where the samples have waited long enough and the newest
    /// lies behind the last column, a frame ends at the tick behind that sample as soon as no later
    /// record can be before this tick.
    template <class Drain>
    Taken grow_older(std::int64_t t_ns, Seam seam, Drain& drain) noexcept {
        // so early that a sample behind a frame that ends for another reason can still follow
        if (waiting_ == 0 || waiting_ + records_a_tick < window_.records) return Taken::kept;
        std::int32_t last = 1;
        each([&](const auto& c, auto) {
            if (!c.active()) return;
            const bool alone = c.starts() && c.last_tick() == c.start_tick();
            last = (std::max)(last, c.last_tick() + (alone ? 1 : 0));
        });
        if (last <= grid_.column(t_ns, start_)) {
            if (pending_ && !drain()) return Taken::kept;
            behind_ = 0;
            return commit(last, seam, drain);
        }
        const bool old = waiting_ >= window_.records && column_ > 0;
        return old ? commit_or_keep(seam, drain) : Taken::kept;
    }
    void restart_grid(std::int64_t t_ns) noexcept {
        start_ = grid_.subs(t_ns);
        column_ = 0;
        due_ = {};
        waiting_ = behind_ = 0;
        started_ = true;
    }

    /// Ends the frame at the newest column, behind a record that has been taken.
    template <class Drain>
    Taken commit_or_keep(Seam seam, Drain& drain) noexcept {
        const Taken taken = commit(column_, seam, drain);
        return taken == Taken::blocked ? Taken::kept : taken;
    }
    /// Ends the frame at `tick`, behind which no channel has offered a column.
    template <class Drain>
    Taken commit(std::int32_t tick, Seam seam, Drain& drain) noexcept {
        if (pending_ && !drain()) return Taken::blocked;
        release();
        each([&](auto& channel, auto) {
            if (channel.active()) seam = channel.close(tick, seam);
        });
        bool any = false;
        const std::int32_t next = guess(behind_);
        each([&](auto& channel, auto) {
            channel.commit(tick, seam, next);
            any = any || channel.active();
        });
        frame_ = {start_, tick, seam};
        pending_ = true;
        ++counts_.frames;
        start_ += std::int64_t{tick} * curve::subs_per_tick;
        column_ = 0;
        due_ = {};
        waiting_ = behind_;
        started_ = any;
        return Taken::committed;
    }

    std::tuple<Channels...> channels_{};
    curve::Grid grid_{};
    Window window_{};
    Frame frame_{};
    Counts counts_{};
    std::int64_t start_{0};
    std::int32_t column_{0};  // of the newest column in the frame
    // of each channel, of the newest one that was due: its samples may lie behind it
    std::array<std::int32_t, channel_count> due_{};
    std::int32_t waiting_{0};  // records since the oldest that is not committed
    std::int32_t behind_{0};   // the part of them that is behind the newest column
    bool started_{false}, pending_{false};
};

}  // namespace fairlead::reduce
