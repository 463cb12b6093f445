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

/// Every Kalman step: what is quiet for this sensor, and whether its mean rate can be a bias.
template <class Real>
inline void judge_rest(RestState<Real>& s, const AttitudeParams& p, Real time) noexcept {
    constexpr Real noise_factor2 = 25;                          // five times the noise
    const Real rise = 1 + time * static_cast<Real>(1.0 / 600);  // a warmer sensor, in ten minutes
    const auto most = static_cast<Real>(p.rest_noise_max * p.rest_noise_max);
    const auto limit2 = [&](Real& floor2, Real noise2, float limit) {
        floor2 = (std::min)(floor2 * rise, noise2);
        const auto least = static_cast<Real>(limit * limit);
        return (std::clamp)(noise_factor2 * floor2, least, least * most);
    };
    s.gyro_max2 = limit2(s.gyro_floor2, s.gyro_noise2, p.rest_gyro_rad_s);
    s.accel_max2 = limit2(s.accel_floor2, s.accel_noise2, p.rest_accel_m_s2);
}

template <class Real>
inline void start_rest(RestState<Real>& s, const AttitudeParams& p, const BasicVec3<Real>& gyro,
                       const BasicVec3<Real>& accel) noexcept {
    s = {};
    s.gyro = gyro;
    s.accel = accel;
    // noise unknown: assume the most
    s.gyro_floor2 = s.gyro_noise2 = static_cast<Real>(1);
    s.accel_floor2 = s.accel_noise2 = static_cast<Real>(100);
    judge_rest(s, p, Real{0});
}

/// Takes one sample; true when the board has been quiet for params.rest_s.
template <class Real>
inline bool update_rest(RestState<Real>& s, const AttitudeParams& p, const BasicVec3<Real>& gyro,
                        const BasicVec3<Real>& accel, Real dt) noexcept {
    const Real gain = dt / (static_cast<Real>(p.rest_window_s) + dt);
    s.gyro += gain * (gyro - s.gyro);
    s.accel += gain * (accel - s.accel);
    const BasicVec3<Real> g = gyro - s.gyro, a = accel - s.accel;
    const Real g2 = dot(g, g), a2 = dot(a, a);
    s.gyro_noise2 += gain * (g2 - s.gyro_noise2);
    s.accel_noise2 += gain * (a2 - s.accel_noise2);
    const auto enough = static_cast<Real>(p.rest_s);
    if (!(g2 < s.gyro_max2 && a2 < s.accel_max2))
        s.quiet_s = 0;
    else if (s.quiet_s < enough)
        s.quiet_s += dt;
    return s.quiet_s >= enough;
}

}  // namespace fairlead
