#pragma once
// Readings at the end of a sensor's range: what they say is wrong, and by how much is not known.
//
// A driver that knows its counts sets flag::clipped and the sensor's own bit. Where only the ranges
// are known, mark_clipped() does, on readings as the chip gave them: calibration and mounting move
// the end of a range. Where only flag::clipped is set, it speaks for every sensor.
#include <cstdint>
#include <limits>

#include "fairlead/base/types.hpp"
#include "fairlead/math/approx.hpp"

namespace fairlead {

/// Is an axis at the end of the range? max 0: not known, then none is.
constexpr bool at_range_end(const Vec3& v, float max) noexcept {
    constexpr float full = 0.99f;  // of the range: the last code may be a little below it
    const float limit = full * max;
    return max > 0 && (approx::absolute(v.x) >= limit || approx::absolute(v.y) >= limit ||
                       approx::absolute(v.z) >= limit);
}

/// The sample with its flags for clipping, by the ranges that are known (not 0).
constexpr Sample mark_clipped(const Sample& sample, float gyro_full_scale_rad_s,
                              float accel_full_scale_m_s2) noexcept {
    Sample out = sample;
    if (at_range_end(sample.gyro_rad_s, gyro_full_scale_rad_s))
        out.flags |= flag::clipped | flag::gyro_clipped;
    if (at_range_end(sample.accel_m_s2, accel_full_scale_m_s2))
        out.flags |= flag::clipped | flag::accel_clipped;
    return out;
}

/// Accelerometers end at 2, 4, 8 or 16 g; calibration moves that by up to 5 % (zero 40 mg, scale
/// 3 %). Where nobody tells the range it is the least of these that holds all readings so far.
inline constexpr float usual_range_m_s2 = 19.6133f, usual_range_error = 0.05f;
/// The least reading, squared, that is at the end of the least range.
inline constexpr float usual_end2 =
    (1 - usual_range_error) * (1 - usual_range_error) * usual_range_m_s2 * usual_range_m_s2;

/// Is the largest component of a reading, squared, at the end of that range? end2: usual_end2 at
/// first; follows the readings.
template <class Real>
constexpr bool at_usual_end(Real& end2, Real largest2) noexcept {
    constexpr float wide = (1 + usual_range_error) / (1 - usual_range_error);
    constexpr int ranges = 4;
    constexpr auto last2 = static_cast<Real>(usual_end2 * (1 << 2 * (ranges - 1)));
    for (int i = 0; i < ranges && largest2 > static_cast<Real>(wide * wide) * end2; ++i) end2 *= 4;
    if (!(end2 > last2)) return largest2 >= end2;
    end2 = (std::numeric_limits<Real>::max)();  // larger than any of them
    return false;
}

/// own: flag::gyro_clipped, accel_clipped or mag_clipped.
constexpr bool is_clipped(const Sample& sample, flag::Bits own) noexcept {
    constexpr flag::Bits which = flag::gyro_clipped | flag::accel_clipped | flag::mag_clipped;
    const flag::Bits said = sample.flags & (which | flag::clipped);
    if (said == 0) return false;  // nearly always
    return (said & which) == 0 || (said & own) != 0;
}

}  // namespace fairlead
