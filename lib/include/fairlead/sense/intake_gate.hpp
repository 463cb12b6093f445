#pragma once
// What an intake checks of one value of a record: finite, in range, a rotation, alive.
// What the checks promise together: sense/intake.hpp.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "fairlead/base/types.hpp"
#include "fairlead/math/quat.hpp"
#include "fairlead/sense/fault.hpp"
#include "fairlead/sense/intake_clock.hpp"
#include "fairlead/sense/intake_params.hpp"

namespace fairlead {

namespace detail {

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
        if ((flags & flag::new_run) && seen_) {  // last_ns_ is of another clock
            gap_ = true;
            seen_ = false;
        }
        if ((flags & limits.valid) && !good(value, flags, limits, p, counts))
            flags &= ~limits.valid;
        if (!(flags & limits.valid)) {
            value = {};
            return;
        }
        if (seen_ && !IntakeClock::within(last_ns_, t_ns, p.gap_ns)) gap_ = true;
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
    template <std::size_t D>
    static constexpr bool in_range(const std::array<float, D>& v, float max) noexcept {
        for (const float x : v)
            if (!(approx::absolute(x) <= max)) return false;
        return true;
    }
    template <std::size_t D>
    static constexpr bool is_finite(const std::array<float, D>& v) noexcept {
        for (const float x : v)
            if (!approx::is_finite(x)) return false;
        return true;
    }
    template <class V>
    static constexpr bool is_finite(const V& v) noexcept {
        return fairlead::is_finite(v);
    }
    static constexpr bool equal(const Vec3& a, const Vec3& b) noexcept {
        return approx::same(a.x, b.x) && approx::same(a.y, b.y) && approx::same(a.z, b.z);
    }
    static constexpr bool equal(const Quat& a, const Quat& b) noexcept {
        return approx::same(a.w, b.w) && approx::same(a.x, b.x) && approx::same(a.y, b.y) &&
               approx::same(a.z, b.z);
    }
    template <std::size_t D>
    static constexpr bool equal(const std::array<float, D>& a,
                                const std::array<float, D>& b) noexcept {
        for (std::size_t i = 0; i < D; ++i)
            if (!approx::same(a[i], b[i])) return false;
        return true;
    }
    template <class V>
    constexpr bool mend(V&, const IntakeParams&) noexcept {
        return true;
    }
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
