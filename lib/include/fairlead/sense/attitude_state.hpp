#pragma once
// Everything the attitude filter remembers: one plain struct, saved and restored as it is.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/types.hpp"
#include "fairlead/math/mat3.hpp"
#include "fairlead/sense/attitude_covariance.hpp"
#include "fairlead/sense/clip.hpp"

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

/// The closed window, while the Kalman step works on it part by part.
template <class Real>
struct WindowMeans {
    BasicQuat<Real> middle{};  // orientation in the middle of the window
    BasicVec3<Real> rate{};    // mean calibrated rate
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
};

/// Is a quiet board at rest, or does it turn slowly and steadily? (attitude_still.hpp)
template <class Real>
struct StillState {
    BasicVec3<Real> accel{}, field{};  // at the anchor, in the body
    BasicVec3<Real> field_now{};       // low-passed
    BasicVec3<Real> turned{};          // since the anchor, if the known bias is right
    BasicVec3<Real> turned_now{};      // the same, low-passed like the field
    BasicVec3<Real> bias{};            // as it was known at the anchor
    Real variance{};                   // of its least known axis
    BasicVec3<Real> unproven{};        // part of the mean rate that is not taken for a bias
    Real held_s{};                     // since the anchor; 0: none
    bool has_field{}, moved{}, suspected{}, still{};
    bool guessed{};  // this rest's vertical bias is taken without evidence: nothing is known yet
    bool rested{};   // the vertical bias is known
};

/// Does the bias drift? Its corrections of late.
template <class Real>
struct BiasTrend {
    BasicVec3<Real> mean{};  // low-passed correction, a Kalman step
    Real white2{};           // variance of corrections that would be white
    Real variance{};         // of the three biases, before the step's measurements
    Real drift2{};           // what a drift adds to the variance of each, (rad/s)^2/s
};

/// What an odometer or a log said last (BasicAttitude::drive).
template <class Real>
struct DriveState {
    BasicVec3<Real> velocity_m_s{};  // in the body
    Real variance{};
    Real age_s{};  // since then
    bool known{};  // it is in use
    bool fresh{};  // its next reading is the velocity
};

/// The last readings, and for how long they have repeated themselves.
template <class Real>
struct AliveState {
    BasicVec3<Real> gyro{}, accel{};
    std::array<std::uint16_t, 3> gyro_runs{};  // repetitions of each axis
    std::uint16_t accel_runs{};
    bool gyro_dead{}, accel_dead{};
    std::uint8_t held{};          // repetitions of the whole gyro
    std::uint8_t usual_held16{};  // 16 times the usual number of them
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
    static constexpr std::uint32_t saved_version = 5;

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
    // where the running window began; until the step corrects it, the closed one's end
    std::array<Real, 2> velocity_from_m_s{};
    Covariance<Real, size> covariance{};
    std::array<Real, size> correction{};  // found by the parts so far
    WindowSums<Real> sums{};
    WindowMeans<Real> means{};
    RestState<Real> rest{};
    StillState<Real> still{};
    FieldState<Real, mode> field{};
    std::array<Real, 2> cruise_m_s{};         // expected velocity: driven, or turning with the body
    std::array<Real, 2> slow_velocity_m_s{};  // low-passed innovation of the velocity
    Real restless2{};                         // its mean square
    BiasTrend<Real> trend{};
    BasicVec3<Real> force_m_s2{};     // mean specific force, in the world
    Real force_s{};                   // over so much time
    Real tilted_s{};                  // it has been far from the vertical for so long
    std::array<Real, 2> corrected{};  // sum of the tilt's corrections of late, rad
    std::uint16_t unproven_ms{};      // a start in motion: for so long the inclination may be wrong
    bool doubted{};   // readings were lost or wrong: the inclination is to be verified
    Real period_s{};  // typical time step
    Real blind_s{};   // for so long the gyro has been clipped or stuck
    AliveState<Real> alive{};
    DriveState<Real> drive{};
    AttitudePhase phase{};
    std::uint8_t part{};                             // 0: the Kalman step is idle
    std::uint16_t flags{};                           // of the last pose
    Real accel_end2{static_cast<Real>(usual_end2)};  // end of the accelerometer's range (clip.hpp)
};

}  // namespace fairlead
