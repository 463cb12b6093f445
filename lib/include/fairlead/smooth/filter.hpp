#pragma once
// Filters by mask for orientations, positions and poses.
//
// Orientations [Lee & Shin 2002, eq. (19), (20)]: with the half-angle steps w_i = log(q_i^-1
// q_{i+1}), each the short way round (q and -q are the same rotation),
//   out_i = q_i exp( sum_m b_m w_{i+m} ),   b_m the partial sums of the mask (smooth/mask.hpp).
// Positions are treated alike with w_i = p_{i+1} - p_i: that is the mask itself, and no digits are
// lost far from the origin.
//
// Records. One in, one out, latency records late, each stamped with its own time; flush() gives the
// last ones. The samples of a channel are the records in which it is valid. A segment ends where a
// gap flag starts another, at flush(), and where the data known when a record falls due ends (a
// channel lost for a while holds nothing up). Beyond an end the steps are reflected about the end
// element [eq. (26)]: w_{-1} = w_1, w_n = w_{n-2}. So the first record of a segment differs from
// the whole-buffer result by the outermost tap, whose mirror image comes one sample later.
//
// In:   unit q_wb; even spacing; neighbours closer than pi.
// Out:  unit q_wb; signs continuous within a segment.
// Cost: one log and one exp per record, and Taps - 1 multiply-adds of vectors, whatever happens.
// Laws: left and right rotation invariance, time invariance, symmetry for symmetric masks,
//       sign-flip invariance, the scalar FIR on a fixed axis (tests/laws/test_filter.cpp).
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fairlead/base/ring.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/smooth/mask.hpp"
#include "fairlead/smooth/space.hpp"

namespace fairlead {

namespace detail {

/// One channel: its steps, as far back as the mask and its reflection reach. Latency: the most
/// samples that may have followed the one that is taken.
template <class Space, class AMask, std::size_t Latency>
class MaskTrack {
  public:
    using Value = typename Space::Value;
    using Step = typename Space::Step;

    constexpr explicit MaskTrack(const AMask& mask) noexcept : mask_{mask} {}
    constexpr std::size_t ahead() const noexcept { return mask_.size() - 1 - mask_.centre(); }

    /// Takes the next sample; returns it with its sign made continuous.
    Value push(const Value& value) noexcept {
        const bool first = !running_;
        const Value next = first ? value : Space::continued(newest_, value);
        const std::size_t before = first ? 0 : entries_.newest().before + 1;
        if (entries_.full()) entries_.pop();
        entries_.push(
            {first ? Step{} : Space::step(newest_, next), before < capacity ? before : capacity});
        newest_ = next;
        running_ = true;
        ++waiting_;
        return next;
    }

    /// The filtered value of the oldest sample that was not taken yet; `value` is that sample.
    Value take(const Value& value) noexcept {
        FAIRLEAD_ASSERT(waiting_ > 0);
        const std::size_t newer = --waiting_;
        const std::size_t at = entries_.size() - 1 - newer;
        const std::size_t before = entries_[at].before;
        const std::size_t behind = before < at + 1 ? before : at + 1;
        std::size_t ahead = 0;
        while (ahead < newer && entries_[at + ahead + 1].before > ahead) ++ahead;
        return Space::moved(value, weighted(at, behind, ahead));
    }

    /// The next sample starts a segment.
    constexpr void restart() noexcept { running_ = false; }
    constexpr void reset() noexcept {
        entries_.clear();
        waiting_ = 0;
        running_ = false;
    }

  private:
    struct Entry {
        Step step{};           // from the sample before to this one; unused at a start
        std::size_t before{};  // samples before this one in its segment, at most capacity
    };
    // at an end eq. (26) looks one step further back than the mask does inside
    static constexpr std::size_t behind_max =
        AMask::behind_max > AMask::ahead_max + 1 ? AMask::behind_max : AMask::ahead_max + 1;
    static constexpr std::size_t capacity = behind_max + Latency;

    /// sum_m b_m w_{at+m}, of which w_{at-behind} ... w_{at+ahead-1} are known, the rest reflected.
    Step weighted(std::size_t at, std::size_t behind, std::size_t ahead) const noexcept {
        Step sum{};
        const std::size_t known = behind + ahead;
        if (known == 0) return sum;
        const std::size_t first = at + 1 - behind;
        const auto shift =
            static_cast<std::ptrdiff_t>(behind) - static_cast<std::ptrdiff_t>(mask_.centre());
        for (std::size_t i = 0; i + 1 < mask_.size(); ++i) {
            const std::size_t j = reflected(shift + static_cast<std::ptrdiff_t>(i), known);
            sum += mask_.step(i) * entries_[first + j].step;
        }
        return sum;
    }

    /// j folded into 0 ... n - 1 about the end elements.
    static constexpr std::size_t reflected(std::ptrdiff_t j, std::size_t n) noexcept {
        const auto distance = static_cast<std::size_t>(j < 0 ? -j : j);
        if (j >= 0 && distance < n) return distance;
        if (n == 1) return 0;
        const std::size_t period = 2 * (n - 1), r = distance % period;
        return r < n ? r : period - r;
    }

    AMask mask_;
    Ring<Entry, capacity> entries_{};
    Value newest_{};
    std::size_t waiting_{0};
    bool running_{false};
};

/// Stands for the channel that a filter leaves alone.
struct NoMask {
    static constexpr std::size_t ahead_max = 0;
};
template <class Space, std::size_t Latency>
class MaskTrack<Space, NoMask, Latency> {
  public:
    using Value = typename Space::Value;
    constexpr explicit MaskTrack(NoMask) noexcept {}
    static constexpr std::size_t ahead() noexcept { return 0; }
    static constexpr Value push(const Value& value) noexcept { return value; }
    static constexpr Value take(const Value& value) noexcept { return value; }
    static constexpr void restart() noexcept {}
    static constexpr void reset() noexcept {}
};

/// Pose records in order through a mask per channel.
template <class OrientationMask, class PositionMask>
class MaskFilter {
  public:
    constexpr MaskFilter(const OrientationMask& orientation, const PositionMask& position) noexcept
        : orientation_{orientation}, position_{position} {}

    std::optional<Pose> push(const Pose& pose) noexcept {
        Pose record = pose;
        if (record.flags & (flag::gap_before | flag::orientation_gap)) orientation_.restart();
        if (record.flags & (flag::gap_before | flag::position_gap)) position_.restart();
        if (record.flags & flag::orientation_valid) record.q_wb = orientation_.push(record.q_wb);
        if (record.flags & flag::position_valid) record.p_w_m = position_.push(record.p_w_m);
        records_.push(record);
        if (records_.size() <= delay()) return std::nullopt;
        return take();
    }

    /// The next of the last records; when there is none left the filter is as new.
    std::optional<Pose> flush() noexcept {
        if (!records_.empty()) return take();
        reset();
        return std::nullopt;
    }

    constexpr void reset() noexcept {
        records_.clear();
        orientation_.reset();
        position_.reset();
    }

    /// Records between a record and its filtered one; the same as `latency` where that exists.
    constexpr std::size_t delay() const noexcept {
        const std::size_t a = orientation_.ahead(), b = position_.ahead();
        return a > b ? a : b;
    }

  protected:
    static constexpr std::size_t latency_max = OrientationMask::ahead_max > PositionMask::ahead_max
                                                   ? OrientationMask::ahead_max
                                                   : PositionMask::ahead_max;

  private:
    Pose take() noexcept {
        Pose record = records_.oldest();
        records_.pop();
        if (record.flags & flag::orientation_valid) record.q_wb = orientation_.take(record.q_wb);
        if (record.flags & flag::position_valid) record.p_w_m = position_.take(record.p_w_m);
        return record;
    }

    Ring<Pose, latency_max + 1> records_{};
    MaskTrack<OrientationSpace<float>, OrientationMask, latency_max> orientation_;
    MaskTrack<PositionSpace<float>, PositionMask, latency_max> position_;
};

}  // namespace detail

/// Filters q_wb; positions pass beside it, at the same delay.
template <std::size_t Taps, std::size_t Centre = Taps / 2>
class OrientationFilter : public detail::MaskFilter<Mask<Taps, Centre>, detail::NoMask> {
  public:
    static constexpr std::size_t latency = Taps - 1 - Centre;  // records
    constexpr OrientationFilter() noexcept
        : OrientationFilter{Mask<Taps, Centre>{}} {}  // changes nothing
    constexpr explicit OrientationFilter(const Mask<Taps, Centre>& mask) noexcept
        : detail::MaskFilter<Mask<Taps, Centre>, detail::NoMask>{mask, {}} {}
};

/// Filters p_w_m; orientations pass beside it, at the same delay.
template <std::size_t Taps, std::size_t Centre = Taps / 2>
class PositionFilter : public detail::MaskFilter<detail::NoMask, Mask<Taps, Centre>> {
  public:
    static constexpr std::size_t latency = Taps - 1 - Centre;
    constexpr PositionFilter() noexcept
        : PositionFilter{Mask<Taps, Centre>{}} {}  // changes nothing
    constexpr explicit PositionFilter(const Mask<Taps, Centre>& mask) noexcept
        : detail::MaskFilter<detail::NoMask, Mask<Taps, Centre>>{{}, mask} {}
};

/// Filters both channels, each on the records in which it is valid. The filter of a pipeline.
template <std::size_t Taps, std::size_t Centre = Taps / 2>
class PoseFilter : public detail::MaskFilter<Mask<Taps, Centre>, Mask<Taps, Centre>> {
    using Base = detail::MaskFilter<Mask<Taps, Centre>, Mask<Taps, Centre>>;

  public:
    static constexpr std::size_t latency = Taps - 1 - Centre;
    constexpr PoseFilter() noexcept : PoseFilter{Mask<Taps, Centre>{}} {}  // changes nothing
    constexpr explicit PoseFilter(const Mask<Taps, Centre>& both) noexcept : Base{both, both} {}
    constexpr PoseFilter(const Mask<Taps, Centre>& orientation,
                         const Mask<Taps, Centre>& position) noexcept
        : Base{orientation, position} {}
};

/// PoseFilter with a mask chosen at run time; delay() tells its latency.
template <std::size_t Capacity>
class AnyPoseFilter : public detail::MaskFilter<AnyMask<Capacity>, AnyMask<Capacity>> {
    using Base = detail::MaskFilter<AnyMask<Capacity>, AnyMask<Capacity>>;

  public:
    constexpr AnyPoseFilter() noexcept : Base{{}, {}} {}
    constexpr explicit AnyPoseFilter(const AnyMask<Capacity>& both) noexcept : Base{both, both} {}
};

}  // namespace fairlead
