#pragma once
// What the examples need around the one idea that each shows: a source of poses, and a printer.
#include <cmath>
#include <cstdio>

#include "fairlead/math/quat.hpp"

/// Ten seconds of a waving hand, as a 120 Hz tracker with half a millimetre of noise would see it.
inline bool next(fairlead::Pose& pose) {
    static int i = 0;
    static unsigned noise = 1;
    const auto rough = [] {  // even within +-1
        noise = noise * 1664525u + 1013904223u;
        return static_cast<float>(noise >> 8) / 8388608.0f - 1;
    };
    if (i == 1200) return false;
    const float t = static_cast<float>(i) / 120, wave = std::sin(3 * t);
    pose.t_ns = i * std::int64_t{8333333};
    pose.p_w_m = {0.3f * wave + 0.0005f * rough(), 0.1f * t + 0.0005f * rough(), 1};
    pose.q_wb = fairlead::from_rotation_vector<float>({0.002f * rough(), 0.8f * wave, 0.1f * t});
    pose.flags = fairlead::flag::position_valid | fairlead::flag::orientation_valid;
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
