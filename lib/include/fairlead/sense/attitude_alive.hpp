#pragma once
// Are the sensors alive? A sensor that has frozen repeats its reading exactly. So does a healthy
// one that is quiet and coarse (a hinge leaves two gyro axes quiet; 16-bit parts at 2000 deg/s have
// steps larger than their noise), so a repetition counts only against what it contradicts:
//   - a gyro axis, while the board moves, at a rate that is not its bias;
//   - an accelerometer, while the gyro shows a motion that must change its reading;
//   - a magnetometer, while the board turns under it. Zero is not a field, and not a force.
// A reading that repeats proves no rest either: see attitude_still.hpp. Cost: 9 comparisons a
// sample.
#include <algorithm>
#include <cstdint>

#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/attitude_state.hpp"

namespace fairlead {

template <class Real>
constexpr bool same_vector(const BasicVec3<Real>& a, const BasicVec3<Real>& b) noexcept {
    return approx::same(a.x, b.x) && approx::same(a.y, b.y) && approx::same(a.z, b.z);
}

template <class Real>
constexpr bool is_zero(const BasicVec3<Real>& v) noexcept {
    return same_vector(v, BasicVec3<Real>{});
}

/// Is it a longer run of repetitions than usual? A stream that holds each reading for some samples
/// does so always: its habit is learned from the gyro.
template <class Real>
constexpr bool is_long(const AliveState<Real>& s, int runs) noexcept {
    constexpr int beyond16 = 40;  // two and a half more than usual
    return 16 * runs > s.usual_held16 + beyond16;
}

/// Does an accelerometer that has been frozen speak again, and of something else?
template <class Real>
inline bool thaws(const AliveState<Real>& s, const BasicVec3<Real>& accel) noexcept {
    constexpr Real other2 = 4;  // (m/s^2)^2
    if (s.accel_runs == 0 || !is_long(s, s.accel_runs)) return false;
    const BasicVec3<Real> step = accel - s.accel;
    return dot(step, step) > other2;
}

/// Has the whole gyro repeated its reading more often than it uses to?
template <class Real>
inline bool is_held(AliveState<Real>& s, bool repeats) noexcept {
    if (repeats) {
        if (s.held < 0xFF) ++s.held;
        return is_long(s, s.held);
    }
    constexpr int most = 15;
    if ((s.held | s.usual_held16) != 0) {
        const int usual = s.usual_held16, run = (std::min)(+s.held, most);
        s.usual_held16 = static_cast<std::uint8_t>(usual + run - (usual + 15) / 16);
        s.held = 0;
    }
    return false;
}

/// Every sample: how often each gyro axis and the accelerometer have repeated themselves. True
/// where the gyro may have frozen: a board in motion is then not where it seems to be.
template <class Real>
inline bool count_repeats(AliveState<Real>& s, const BasicVec3<Real>& gyro,
                          const BasicVec3<Real>& accel) noexcept {
    const auto run = [](bool same, std::uint16_t n) {
        return static_cast<std::uint16_t>(!same ? 0 : n < 0xFFFF ? n + 1 : n);
    };
    const bool x = approx::same(gyro.x, s.gyro.x), y = approx::same(gyro.y, s.gyro.y),
               z = approx::same(gyro.z, s.gyro.z);
    if (x || y || z)
        s.gyro_runs = {run(x, s.gyro_runs[0]), run(y, s.gyro_runs[1]), run(z, s.gyro_runs[2])};
    else
        s.gyro_runs = {};  // nearly always
    s.accel_runs = run(same_vector(accel, s.accel), s.accel_runs);
    s.gyro = gyro;
    s.accel = accel;
    return is_held(s, x && y && z);
}

/// Once a Kalman step: which of them contradict the others.
template <class Real>
inline void judge_alive(AliveState<Real>& s, const AttitudeParams& p, const BasicVec3<Real>& bias,
                        Real period, bool quiet) noexcept {
    // eight repetitions at least: a slow sensor needs longer than a fast one
    const auto times = [period](float seconds) {
        return (std::max)(
            8, static_cast<int>((std::min)(static_cast<Real>(seconds) / period, Real{60000})));
    };
    const int axis = times(p.dead_axis_s), all = times(p.dead_sensor_s);
    const auto turning = [&](Real rate, Real b) {
        return approx::absolute(rate - b) > static_cast<Real>(p.dead_rate_rad_s);
    };
    const bool x = turning(s.gyro.x, bias.x), y = turning(s.gyro.y, bias.y),
               z = turning(s.gyro.z, bias.z);
    const auto& r = s.gyro_runs;
    const int least = (std::min)(r[0], (std::min)(r[1], r[2]));
    const bool one = (r[0] > axis && x) || (r[1] > axis && y) || (r[2] > axis && z);
    s.accel_dead = s.accel_runs > all && !quiet;
    s.gyro_dead = (one && !quiet) || (least > 2 * all && !quiet) ||
                  (least > all && s.accel_runs > all && (x || y || z));
}

}  // namespace fairlead
