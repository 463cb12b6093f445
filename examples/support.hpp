#pragma once
// What the examples need around the one idea that each shows: sources of poses and of an IMU's raw
// numbers, and a printer.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "fairlead/math/quat.hpp"

/// Noise, even within +-1.
inline float rough() {
    static unsigned state = 1;
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) / 8388608.0f - 1;
}

/// Ten seconds of a waving hand, as a 120 Hz tracker with half a millimetre of noise would see it.
inline bool next(fairlead::Pose& pose) {
    static int i = 0;
    if (i == 1200) return false;
    const float t = static_cast<float>(i) / 120, wave = std::sin(3 * t);
    pose.t_ns = i * std::int64_t{8333333};
    pose.p_w_m = {0.3f * wave + 0.0005f * rough(), 0.1f * t + 0.0005f * rough(), 1};
    pose.q_wb = fairlead::from_rotation_vector<float>({0.002f * rough(), 0.8f * wave, 0.1f * t});
    pose.flags = fairlead::flag::position_valid | fairlead::flag::orientation_valid;
    ++i;
    return true;
}

/// What a driver reads from a six-axis chip, in counts of +-2000 deg/s and +-16 g.
struct Raw {
    std::int64_t t_us;
    std::array<float, 3> gyro, accel;
};

/// Twenty seconds at 100 Hz: at rest for five, then the board nods by 30 degrees about its x axis.
inline bool next(Raw& raw) {
    static int i = 0;
    if (i == 2000) return false;
    const float t = std::max(0.0f, static_cast<float>(i) / 100 - 5), swing = 0.5236f;
    const float angle = swing * std::sin(t), rate = swing * std::cos(t) * (t > 0 ? 1.0f : 0.0f);
    const float count_rad_s = 32768 / (2000 * 0.01745329f), count_g = 32768 / 16;
    raw.t_us = i * std::int64_t{10000};
    const auto counts = [](float value) { return std::round(value + 3 * rough()); };
    raw.gyro = {counts(count_rad_s * rate), counts(0), counts(0)};
    raw.accel = {counts(0), counts(count_g * std::sin(angle)), counts(count_g * std::cos(angle))};
    ++i;
    return true;
}

inline void print(const fairlead::Pose& pose) {
    const auto d = [](float x) { return static_cast<double>(x); };
    const auto &p = pose.p_w_m, &v = fairlead::rotation_vector(pose.q_wb);
    std::printf("%.3f s  position %.4f %.4f %.4f m  rotation %.4f %.4f %.4f rad\n",
                static_cast<double>(pose.t_ns) * 1e-9, d(p.x), d(p.y), d(p.z), d(v.x), d(v.y),
                d(v.z));
}
