#pragma once
// The sample period of a stream, measured from its own time stamps: the median of the first steps.
//
// A median of 17 steps is right where up to 8 of them are wrong: missing records, a first step that
// a start-up made long, records that came in a burst. Cost: at most 17 comparisons a step.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/sense/intake_limits.hpp"

namespace fairlead {

class PeriodMeter {
  public:
    static constexpr std::size_t steps = 17;

    /// The next accepted time of the same run; steps across a gap or a new run do not count: call
    /// pause() there. @return true in the call in which the period becomes known.
    constexpr bool push(std::int64_t t_ns) noexcept {
        const bool follows = running_;
        const std::int64_t before_ns = last_ns_;
        last_ns_ = t_ns;
        running_ = true;
        if (!follows || known()) return false;
        insert(clamped(t_ns - before_ns));
        return known();
    }
    constexpr void pause() noexcept { running_ = false; }
    constexpr void reset() noexcept { *this = {}; }

    /// Is there a time to form a step with?
    constexpr bool running() const noexcept { return running_; }
    constexpr bool known() const noexcept { return count_ == steps; }
    /// ns, within sample_period_min_ns and _max_ns; the best guess so far, the longest before any.
    constexpr std::int64_t period_ns() const noexcept {
        return count_ == 0 ? sample_period_max_ns : sorted_[count_ / 2];
    }

    static constexpr std::int64_t clamped(std::int64_t step_ns) noexcept {
        return step_ns < sample_period_min_ns   ? sample_period_min_ns
               : step_ns > sample_period_max_ns ? sample_period_max_ns
                                                : step_ns;
    }

  private:
    constexpr void insert(std::int64_t step_ns) noexcept {
        std::size_t i = count_++;
        for (; i > 0 && sorted_[i - 1] > step_ns; --i) sorted_[i] = sorted_[i - 1];
        sorted_[i] = static_cast<std::int32_t>(step_ns);
    }

    std::array<std::int32_t, steps> sorted_{};  // ns, rising
    std::int64_t last_ns_{0};
    std::size_t count_{0};
    bool running_{false};
};

}  // namespace fairlead
