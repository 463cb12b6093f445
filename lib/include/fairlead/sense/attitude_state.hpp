#pragma once
// Everything the attitude filter remembers: one plain struct, saved and restored as it is.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/types.hpp"
#include "fairlead/math/mat3.hpp"
#include "fairlead/sense/attitude_covariance.hpp"

namespace fairlead {

enum class AttitudeMode : std::uint8_t {
    gyro,     // gyro alone: orientation relative to the start
    imu,      // gyro and accelerometer: inclination; heading relative to the start
    imu_mag,  // and magnetometer: heading relative to magnetic north
};

enum class AttitudePhase : std::uint8_t { empty, aligning, running };

/// Sums over the running window, at full rate.
template <class Real>
struct WindowSums {
    BasicVec3<Real> turn{};  // of the body's rotation vectors
    Real turn2{};            // of their squared lengths
    Real lift{};             // of the vertical specific force, times dt
    Real time{};
    Real doubt_angle2{};  // variance that missing or clipped readings add
    Real doubt_velocity2{};
    std::uint16_t count{};
};

/// The closed window, while the Kalman step works on it slice by slice.
template <class Real>
struct WindowMeans {
    BasicQuat<Real> middle{};  // orientation in the middle of the window
    BasicVec3<Real> rate{};    // mean calibrated rate
    std::array<Real, 2> velocity{};
    Real time{};
};

/// What the rest detector has seen.
template <class Real>
struct RestState {
    BasicVec3<Real> gyro{}, accel{};     // low-passed
    Real gyro_noise2{}, accel_noise2{};  // mean squared deviation from that
    Real gyro_floor2{}, accel_floor2{};  // the least of it so far
    Real gyro_max2{}, accel_max2{};      // deviations below are quiet
    Real quiet_s{};
    bool plausible{};  // the mean rate may be a bias
};

template <class Real, AttitudeMode mode>
struct FieldState {};

template <class Real>
struct FieldState<Real, AttitudeMode::imu_mag> {
    BasicVec3<Real> sum{};    // of the field in the world frame, over the running window
    BasicVec3<Real> mean{};   // of the closed window
    Real horizontal{}, up{};  // the reference
    Real residual2{};         // low-passed squared distance from it
    Real weight_s{};          // how much data the reference rests on
    Real since_s{};           // the last window that held a reading
    Real next_horizontal{}, next_up{}, next_residual2{};  // a field that may become the reference
    Real steady_s{};                                      // for so long it has been the better one
    std::uint16_t count{}, mean_count{};
};

template <class Real, AttitudeMode mode>
struct AttitudeState {
    static constexpr std::uint32_t saved_version = 2;

    /// Error states: tilt about east and north, velocity, gyro bias, gyro matrix (scale xx, yy, zz,
    /// shear yz, zx, xy); heading comes last, so that it is one more row below the filter that does
    /// without.
    enum : std::size_t { tilt = 0, velocity = 2, bias = 4, scale = 7, shear = 10, heading = 13 };
    static constexpr std::size_t size = mode == AttitudeMode::imu_mag ? 14 : 13;

    std::int64_t t_ns{};
    BasicQuat<Real> q_wb{};
    BasicVec3<Real> bias_rad_s{};
    BasicSym3<Real> gyro_matrix{};  // rate = (1 - matrix) (gyro - bias): scale and shear
    BasicVec3<Real> rate_rad_s{};
    std::array<Real, 2> velocity_m_s{};  // east, north: a bounded stand-in, not navigation
    Covariance<Real, size> covariance{};
    std::array<Real, size> correction{};  // found by the slices so far
    WindowSums<Real> sums{};
    WindowMeans<Real> means{};
    RestState<Real> rest{};
    FieldState<Real, mode> field{};
    Real period_s{};             // typical time step
    Real blind_s{};              // for so long the gyro has been clipped or stuck
    BasicVec3<Real> raw_gyro{};  // the last reading, to notice an axis that has died
    std::array<std::uint8_t, 3> repeats{};
    bool gyro_dead{};
    AttitudePhase phase{};
    std::uint8_t slice{};   // 0: the Kalman step is idle
    std::uint16_t flags{};  // of the last pose
};

}  // namespace fairlead
