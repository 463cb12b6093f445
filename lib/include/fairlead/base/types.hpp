#pragma once
// What flows through fairlead: Sample, Pose or VectorSample, and Event beside them. All plain
// data.
//
// Conventions, stated once:
//   - SI units: m, s, rad, rad/s, m/s^2; magnetic field in uT. Degrees and g exist at the edges
//   only.
//   - Time is int64 nanoseconds of a monotonic clock of the caller's choice; it arrives in the
//   data.
//   - Frames are two letters, target first: q_wb takes body to world, v_w = q_wb * v_b *
//   conj(q_wb),
//     and q_wb * q_ba = q_wa.
//   - Every angle in the API is the full rotation angle in radians. The half-angle exp/log
//   convention
//     of quaternions is known to math/quat.hpp alone.
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

template <class Real>
struct BasicVec3 {
    Real x{}, y{}, z{};
};

/// Unit quaternion of a rotation, Hamilton product, scalar first. Default: the identity.
template <class Real>
struct BasicQuat {
    Real w{1}, x{}, y{}, z{};
};

using Vec3 = BasicVec3<float>;
using Quat = BasicQuat<float>;

/// Quality travels with the data, as bits of Sample::flags and Pose::flags.
namespace flag {
using Bits = std::uint32_t;
inline constexpr Bits position_valid = 1u << 0;     // Pose: p_w_m holds a measurement
inline constexpr Bits orientation_valid = 1u << 1;  // Pose: q_wb holds a measurement
inline constexpr Bits gap_before = 1u << 2;         // time or data is missing: curves start anew
inline constexpr Bits position_gap = 1u << 3;       // the same, of the position channel alone
inline constexpr Bits orientation_gap = 1u << 4;    // the same, of the orientation channel alone
inline constexpr Bits clipped = 1u << 5;            // a sensor axis stood at the end of its range
inline constexpr Bits stuck = 1u << 6;              // one value for longer than a sensor repeats it
inline constexpr Bits settling = 1u << 7;           // an estimator has not converged yet
inline constexpr Bits mag_rejected = 1u << 8;       // the magnetic field is disturbed
inline constexpr Bits rest = 1u << 9;               // the board is at rest
inline constexpr Bits gyro_valid = 1u << 10;        // Sample: gyro_rad_s holds a measurement
inline constexpr Bits accel_valid = 1u << 11;       // Sample: accel_m_s2 holds a measurement
inline constexpr Bits mag_valid = 1u << 12;         // Sample: mag_uT holds a measurement
inline constexpr Bits gyro_clipped = 1u << 13;      // Sample: of what sensor, beside clipped
inline constexpr Bits accel_clipped = 1u << 14;     // likewise
inline constexpr Bits mag_clipped = 1u << 15;       // likewise
inline constexpr Bits temperature_valid = 1u << 16;  // Sample: temperature_c holds a measurement
inline constexpr Bits new_run = 1u << 17;   // set by an intake: times before this record are of
                                            // another clock and must not be compared with it
inline constexpr Bits new_grid = 1u << 18;  // inside a pipeline: curves change their grid
inline constexpr Bits vector_valid = position_valid;  // VectorSample: value holds a measurement
inline constexpr Bits vector_gap = position_gap;      // VectorSample: its curve starts anew
}  // namespace flag

/// One reading of an IMU, as the chip said it, in SI units and the body frame.
struct alignas(8) Sample {  // 8: one layout, also where 64-bit integers need only 4
    std::int64_t t_ns{};
    Vec3 gyro_rad_s{};
    Vec3 accel_m_s2{};
    Vec3 mag_uT{};
    std::uint32_t flags{};
    float temperature_c{};  // of the gyro's die: drivers and file readers set it, the temperature
                            // table of a GyroCalibration (sense/calibrate.hpp) uses it
};

/// Position and orientation of a body. t_ns is the time at which the pose is TRUE: a centred filter
/// emits its centre tap's time.
struct alignas(8) Pose {
    std::int64_t t_ns{};
    Vec3 p_w_m{};
    Quat q_wb{};
    std::uint32_t flags{};
};

/// The most components of a vector: a frame holds one step of so many, whatever comes.
inline constexpr std::size_t vector_components_max = 5;

/// D numbers that were measured together, such as joint angles. Units are the caller's.
template <std::size_t D>
struct VectorSample {
    std::int64_t t_ns{};
    std::array<float, D> value{};
    std::uint32_t flags{};
};

/// A change on a discrete channel, such as a button or a trigger: from t_ns on it has this value.
struct alignas(8) Event {
    std::int64_t t_ns{};
    std::uint16_t channel{};
    std::uint16_t value{};
    std::uint32_t flags{};  // gap_before: events before this one are missing
};

static_assert(std::is_trivially_copyable_v<Sample> && sizeof(Sample) == 56);
static_assert(std::is_trivially_copyable_v<Pose> && sizeof(Pose) == 40);
static_assert(std::is_trivially_copyable_v<Event> && sizeof(Event) == 16);

}  // namespace fairlead
