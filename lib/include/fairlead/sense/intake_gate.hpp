#pragma once
// The two checks that an intake is made of: the order of times, and the worth of one value.
// What they promise together: sense/intake.hpp.
#include <cstdint>
#include <limits>

#include "fairlead/base/types.hpp"
#include "fairlead/math/quat.hpp"
#include "fairlead/sense/fault.hpp"

namespace fairlead {

struct IntakeParams {
    std::int64_t gap_ns{100'000'000};      // a longer pause is a gap
    std::int64_t leap_ns{60'000'000'000};  // a longer step ahead must be confirmed
    std::uint32_t stuck_records{0};        // as many equal values in a row are refused; 0: never
    std::uint32_t restart_records{0};      // as many rising records in the past are a new clock,
                                           // accepted after a gap; 0: never, time cannot go back
    float position_max_m{1e4f};
    float gyro_max_rad_s{100};
    float accel_max_m_s2{2000};
    float mag_max_uT{5000};
    float unit_tolerance{0.01f};  // largest | |q| - 1 | that is mended
};

namespace detail {

class IntakeClock {
  public:
    enum class Verdict : std::uint8_t { next, gap, repeated, backward, leap };

    constexpr Verdict check(std::int64_t t_ns, const IntakeParams& p) noexcept {
        if (!running_) {
            running_ = true;
            return accept(t_ns, Verdict::next);
        }
        const bool ahead = t_ns > last_ns_;
        if (ahead && within(last_ns_, t_ns, p.leap_ns))
            return accept(t_ns, within(last_ns_, t_ns, p.gap_ns) ? Verdict::next : Verdict::gap);
        if (t_ns == last_ns_) return Verdict::repeated;
        const bool follows =
            suspects_ > 0 && t_ns > suspect_ns_ && within(suspect_ns_, t_ns, p.leap_ns);
        suspects_ = follows ? suspects_ + 1 : 1;
        suspect_ns_ = t_ns;
        if (ahead ? suspects_ > 1 : p.restart_records > 0 && suspects_ > p.restart_records)
            return accept(t_ns, Verdict::gap);
        return ahead ? Verdict::leap : Verdict::backward;
    }
    /// to - from <= limit for from < to, whatever the two are.
    static constexpr bool within(std::int64_t from, std::int64_t to, std::int64_t limit) noexcept {
        return static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from) <=
               static_cast<std::uint64_t>(limit > 0 ? limit : 0);
    }

  private:
    constexpr Verdict accept(std::int64_t t_ns, Verdict v) noexcept {
        last_ns_ = t_ns;
        suspects_ = 0;
        return v;
    }

    std::int64_t last_ns_{0};
    std::int64_t suspect_ns_{0};
    std::uint32_t suspects_{0};  // records in a row that contradict the clock but not each other
    bool running_{false};
};

/// One value within a record: its bits among the flags, and the largest component it may have.
struct ChannelLimits {
    std::uint32_t valid;
    std::uint32_t gap;  // 0: the channel has no gap flag of its own
    float component_max;
};

template <class Value>
class ChannelGate {
  public:
    /// Clears or mends the value and its bits in flags.
    void pass(std::int64_t t_ns, Value& value, std::uint32_t& flags, const ChannelLimits& limits,
              const IntakeParams& p, FaultCounts& counts) noexcept {
        if (flags & limits.gap) gap_ = true;
        flags &= ~limits.gap;
        if ((flags & limits.valid) && !good(value, flags, limits, p, counts))
            flags &= ~limits.valid;
        if (!(flags & limits.valid)) {
            value = {};
            return;
        }
        // a clock that restarted left the last sample in the future: that is a gap as well
        if (seen_ && (t_ns <= last_ns_ || !IntakeClock::within(last_ns_, t_ns, p.gap_ns)))
            gap_ = true;
        if (gap_) flags |= limits.gap;
        gap_ = false;
        seen_ = true;
        last_ns_ = t_ns;
    }

  private:
    bool good(Value& value, std::uint32_t& flags, const ChannelLimits& limits,
              const IntakeParams& p, FaultCounts& counts) noexcept {
        if (!is_finite(value)) return counts.add(Fault::not_finite), false;
        if (!in_range(value, limits.component_max)) return counts.add(Fault::out_of_range), false;
        repeats_ = known_ && equal(value, raw_) ? repeats_ + (repeats_ + 1 < repeats_max) : 0;
        raw_ = value;
        known_ = true;
        if (!mend(value, p)) return counts.add(Fault::not_unit), false;
        if (p.stuck_records > 0 && repeats_ + 1 >= p.stuck_records) {
            flags |= flag::stuck;
            return counts.add(Fault::stuck), false;
        }
        return true;
    }

    static constexpr bool in_range(const Vec3& v, float max) noexcept {
        return approx::absolute(v.x) <= max && approx::absolute(v.y) <= max &&
               approx::absolute(v.z) <= max;
    }
    static constexpr bool in_range(const Quat&, float) noexcept { return true; }  // see mend()
    static constexpr bool equal(const Vec3& a, const Vec3& b) noexcept {
        return approx::same(a.x, b.x) && approx::same(a.y, b.y) && approx::same(a.z, b.z);
    }
    static constexpr bool equal(const Quat& a, const Quat& b) noexcept {
        return approx::same(a.w, b.w) && approx::same(a.x, b.x) && approx::same(a.y, b.y) &&
               approx::same(a.z, b.z);
    }
    constexpr bool mend(Vec3&, const IntakeParams&) noexcept { return true; }
    bool mend(Quat& q, const IntakeParams& p) noexcept {
        const float n2 = dot(q, q);
        const float low = 1 - p.unit_tolerance, high = 1 + p.unit_tolerance;
        if (!(n2 >= low * low && n2 <= high * high)) return false;
        constexpr float rounding = 1e-6f;  // unit already, as far as float goes: keep its bits
        if (approx::absolute(n2 - 1) > rounding) q = normalised(q);
        q = same_side(side_, q);
        side_ = q;
        return true;
    }

    static constexpr std::uint32_t repeats_max = (std::numeric_limits<std::uint32_t>::max)();

    Value raw_{};
    Value side_{};  // the last good value; of use to quaternions
    std::int64_t last_ns_{0};
    std::uint32_t repeats_{0};
    bool known_{false};
    bool seen_{false};
    bool gap_{false};
};

}  // namespace detail
}  // namespace fairlead
