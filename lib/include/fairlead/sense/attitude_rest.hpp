#pragma once
// Rest: gyro and accelerometer stay close to their own short means. At rest the gyro shows its bias
// and the velocity is zero.
//
// How close is close follows the sensor: the least mean deviation seen so far is its noise, and a
// noisy sensor raises the limits to five times that, at most rest_noise_max times the defaults (VQF
// [Laidig & Seel 2023, sec. 3.7] has fixed limits). Cost: constant.
#include <algorithm>

#include "fairlead/math/vec.hpp"
#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/attitude_state.hpp"

namespace fairlead {

namespace detail {

inline constexpr float rest_noise_factor2 = 25;  // five times the noise

/// The largest squared deviation that is quiet, after one more squared deviation d2.
template <class Real>
inline Real quiet_limit2(Real& noise2, Real& floor2, Real d2, Real gain, Real rise, float limit,
                         float noise_max) noexcept {
    noise2 += gain * (d2 - noise2);
    floor2 = std::min(floor2 * rise, noise2);
    const Real least = static_cast<Real>(limit * limit);
    return std::clamp(static_cast<Real>(rest_noise_factor2) * floor2, least,
                      least * static_cast<Real>(noise_max * noise_max));
}

}  // namespace detail

template <class Real>
inline void start_rest(RestState<Real>& s, const AttitudeParams& p, const BasicVec3<Real>& gyro,
                       const BasicVec3<Real>& accel) noexcept {
    // noise unknown: assume the most
    const auto most2 = [&](float limit) {
        return static_cast<Real>(limit * limit * p.rest_noise_max * p.rest_noise_max /
                                 detail::rest_noise_factor2);
    };
    s = {};
    s.gyro = gyro;
    s.accel = accel;
    s.gyro_noise2 = s.gyro_floor2 = most2(p.rest_gyro_rad_s);
    s.accel_noise2 = s.accel_floor2 = most2(p.rest_accel_m_s2);
}

/// Takes one sample; true when the board has been quiet for params.rest_s.
template <class Real>
inline bool update_rest(RestState<Real>& s, const AttitudeParams& p, const BasicVec3<Real>& gyro,
                        const BasicVec3<Real>& accel, Real dt) noexcept {
    const Real gain = dt / (static_cast<Real>(p.rest_window_s) + dt);
    const Real rise = 1 + dt * static_cast<Real>(1.0 / 600);  // a warmer sensor, in ten minutes
    s.gyro += gain * (gyro - s.gyro);
    s.accel += gain * (accel - s.accel);
    const BasicVec3<Real> g = gyro - s.gyro, a = accel - s.accel;
    const Real g2 = dot(g, g), a2 = dot(a, a);
    const Real g_max2 = detail::quiet_limit2(s.gyro_noise2, s.gyro_floor2, g2, gain, rise,
                                             p.rest_gyro_rad_s, p.rest_noise_max);
    const Real a_max2 = detail::quiet_limit2(s.accel_noise2, s.accel_floor2, a2, gain, rise,
                                             p.rest_accel_m_s2, p.rest_noise_max);
    const auto bias = static_cast<Real>(p.bias_max_rad_s);
    const bool quiet = g2 < g_max2 && a2 < a_max2 && approx::abs(s.gyro.x) <= bias &&
                       approx::abs(s.gyro.y) <= bias && approx::abs(s.gyro.z) <= bias;
    s.quiet_s = quiet ? std::min(s.quiet_s + dt, static_cast<Real>(p.rest_s)) : Real{0};
    return s.quiet_s >= static_cast<Real>(p.rest_s);
}

}  // namespace fairlead
