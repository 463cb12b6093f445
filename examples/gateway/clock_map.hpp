#pragma once
// A board's clock on the gateway's clock, from the times at which its frames end.
//
// A frame leaves the board a constant number of records behind its end (the filter's latency, and
// the pushes in which it is coded), to a tick; it arrives later by the time on the line and by
// whatever wakes this program up. Arrival minus the time of leaving is therefore the clocks' offset
// plus a delay that is never negative: the smallest of the last few is the best, and its excess is
// bounded by a tick, the line, a wake-up and what two crystals drift apart meanwhile.
#include <cstdint>

#include "fairlead/base/ring.hpp"

namespace fairlead::gateway {

class ClockMap {
  public:
    static constexpr std::int64_t wakeup_ns = 1'000'000;  // a busy Linux without adapters' timers
    static constexpr std::int64_t drift_ppm = 200;        // two crystals of 100 ppm

    void reset() noexcept { marks_.clear(); }

    /// source_ns: when the frame left the board; on_line_ns: what it takes on the line.
    void mark(std::int64_t source_ns, std::int64_t arrival_ns, std::int64_t on_line_ns,
              std::int64_t tick_ns) noexcept {
        if (marks_.full()) marks_.pop();
        marks_.push({arrival_ns - on_line_ns - source_ns, arrival_ns, tick_ns + on_line_ns});
    }
    bool known() const noexcept { return !marks_.empty(); }

    std::int64_t offset_ns() const noexcept { return best().offset_ns; }
    /// Bound of |offset - truth|, unless the line hides a delay of its own (a USB adapter's timer).
    std::int64_t error_ns(std::int64_t now_ns) const noexcept {
        const Mark& mark = best();
        return mark.slack_ns + wakeup_ns + (now_ns - mark.arrival_ns) / 1'000'000 * drift_ppm;
    }

  private:
    struct Mark {
        std::int64_t offset_ns{};
        std::int64_t arrival_ns{};
        std::int64_t slack_ns{};
    };
    const Mark& best() const noexcept {
        std::size_t least = 0;
        for (std::size_t i = 1; i < marks_.size(); ++i) {
            if (marks_[i].offset_ns <= marks_[least].offset_ns) least = i;
        }
        return marks_[least];
    }

    Ring<Mark, 8> marks_{};
};

}  // namespace fairlead::gateway
