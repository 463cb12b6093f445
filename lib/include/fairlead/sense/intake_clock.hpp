#pragma once
// Which time stamps an intake believes. Its rules in words: sense/intake.hpp.
//
// Differences of times are formed as unsigned numbers, so that any two int64 may meet.
#include <cstdint>

#include "fairlead/sense/intake_limits.hpp"
#include "fairlead/sense/intake_params.hpp"

namespace fairlead::detail {

class IntakeClock {
  public:
    enum class Verdict : std::uint8_t {
        next,      // accepted: it continues the curve
        gap,       // accepted, after a pause
        run,       // accepted: it begins a run
        repeated,  // refused: the time of the record before
        close,     // refused: nearer to the record before than the stages behind can carry
        behind,    // doubtful: the clock would have gone back
        ahead,     // doubtful: a leap
    };
    static constexpr bool accepted(Verdict v) noexcept { return v <= Verdict::run; }
    static constexpr bool doubtful(Verdict v) noexcept { return v >= Verdict::behind; }

    /// What the stamp after a doubtful one says of it.
    enum class Doubt : std::uint8_t { wrong, confirmed, open };

    /// A stamp, judged by those that were accepted. params: completed.
    constexpr Verdict judge(std::int64_t t_ns, const IntakeParams& params,
                            const IntakeLimits& limits) const noexcept {
        if (!running_) return limits.first_waits ? Verdict::ahead : Verdict::run;
        if (t_ns == last_ns_) return Verdict::repeated;
        if (t_ns < last_ns_) {
            // the stamp before, which came after a pause, was a lone wrong one ahead
            const bool returns =
                paused_ && t_ns > before_ns_ && within(before_ns_, t_ns, params.leap_ns);
            return returns ? Verdict::run : Verdict::behind;
        }
        if (!within(last_ns_, t_ns, params.leap_ns)) return Verdict::ahead;
        if (within(last_ns_, t_ns, limits.spacing_min_ns - 1)) return Verdict::close;
        if (!within(base_ns_, t_ns, limits.run_ns_max)) return Verdict::run;
        return within(last_ns_, t_ns, params.gap_ns) ? Verdict::next : Verdict::gap;
    }

    /// The next stamp, t_ns, judges a doubtful one. open: it says nothing, and is refused itself.
    constexpr Doubt weigh(std::int64_t doubtful_ns, std::int64_t t_ns,
                          const IntakeLimits& limits) const noexcept {
        const bool back = running_ && doubtful_ns < last_ns_;
        if (t_ns < doubtful_ns || (back && t_ns > last_ns_)) return Doubt::wrong;
        const bool apart = !within(doubtful_ns, t_ns, limits.spacing_min_ns - 1);
        return apart && !(back && t_ns == last_ns_) ? Doubt::confirmed : Doubt::open;
    }

    constexpr void accept(std::int64_t t_ns, Verdict verdict) noexcept {
        paused_ = verdict == Verdict::gap;
        before_ns_ = last_ns_;
        last_ns_ = t_ns;
        if (verdict == Verdict::run) base_ns_ = t_ns;
        running_ = true;
    }

    constexpr bool running() const noexcept { return running_; }

    /// to - from <= limit, for from <= to; limit not negative.
    static constexpr bool within(std::int64_t from, std::int64_t to, std::int64_t limit) noexcept {
        return static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from) <=
               static_cast<std::uint64_t>(limit);
    }

  private:
    std::int64_t last_ns_{0};    // newest accepted
    std::int64_t before_ns_{0};  // the accepted one before
    std::int64_t base_ns_{0};    // the first one of the run
    bool running_{false};
    bool paused_{false};  // there was a gap between before_ns_ and last_ns_
};

}  // namespace fairlead::detail
