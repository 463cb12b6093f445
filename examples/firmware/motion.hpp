#pragma once
// The motion that the emulated tracker sees: two seconds of rest, then a hand that draws slow
// loops. Known in closed form, so that a reader of the frames can check what it decodes.
#include "fairlead/base/convert.hpp"
#include "fairlead/math/quat.hpp"

namespace motion {

constexpr std::int64_t step_ns = 8'333'333;  // 120 records a second
constexpr std::int64_t records = 1200;

inline fairlead::Pose at(std::int64_t t_ns) {
    const float t = fairlead::to_float(t_ns - 2'000'000'000) * 1e-9f;
    const float s = t > 0 ? t : 0;
    const auto swing = [s](float rate) { return 1 - fairlead::approx::cos(rate * s); };
    fairlead::Pose pose;
    pose.t_ns = t_ns;
    pose.p_w_m = {0.2f * swing(2), 0.1f * swing(3), 1 + 0.05f * swing(1)};
    pose.q_wb = fairlead::from_rotation_vector(fairlead::Vec3{0.3f * swing(2), 0, 0.5f * swing(1)});
    pose.flags = fairlead::flag::position_valid | fairlead::flag::orientation_valid;
    return pose;
}

}  // namespace motion
