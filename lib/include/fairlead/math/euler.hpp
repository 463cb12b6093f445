#pragma once
// Euler angles of a rotation, z then y then x (yaw, pitch, roll about the axes as they have been
// turned), for people and displays: q = q_z(yaw) q_y(pitch) q_x(roll).
//
// The half sum and half difference of yaw and roll are angles of two complex numbers, and pitch is
// twice the angle between their lengths: no arc sine, exact at every pitch [Bernardes & Viollet,
// PLoS ONE 2022]. At a pitch of +-90 degrees only one of the two is defined, and it is all that is
// left of yaw and roll: then roll is 0 and yaw carries it. Cost: 3 arcus tangents, 2 square roots.
#include "fairlead/math/approx.hpp"
#include "fairlead/math/quat.hpp"

namespace fairlead {

/// rad; yaw and roll in (-pi, pi], pitch in [-pi/2, pi/2].
template <class R>
struct EulerAngles {
    R yaw{}, pitch{}, roll{};
};

/// q: unit; -q gives the same angles.
template <class R>
inline EulerAngles<R> euler_angles(const BasicQuat<R>& q) noexcept {
    constexpr R pi = pi_v<R>;
    // below this length (a pitch within 0.04 degrees of +-90) an angle would be rounding
    constexpr R least = static_cast<R>(5e-4);
    const R a = q.w + q.y, b = q.z - q.x, c = q.w - q.y, d = q.z + q.x;
    const R up = approx::sqrt(a * a + b * b), down = approx::sqrt(c * c + d * d);
    const R difference = up > least ? approx::atan2(b, a) : R{0};  // (yaw - roll) / 2
    const R sum = down > least ? approx::atan2(d, c) : R{0};       // (yaw + roll) / 2
    const auto wrapped = [](R angle) {
        return angle > pi ? angle - 2 * pi : angle <= -pi ? angle + 2 * pi : angle;
    };
    EulerAngles<R> out;
    out.pitch = 2 * approx::atan2(up, down) - pi / 2;
    if (!(up > least) || !(down > least)) {
        out.yaw = wrapped(2 * (sum + difference));
        return out;
    }
    out.yaw = wrapped(sum + difference);
    out.roll = wrapped(sum - difference);
    return out;
}

/// The rotation of these angles.
template <class R>
inline BasicQuat<R> from_euler_angles(const EulerAngles<R>& e) noexcept {
    return from_rotation_vector(BasicVec3<R>{0, 0, e.yaw}) *
           from_rotation_vector(BasicVec3<R>{0, e.pitch, 0}) *
           from_rotation_vector(BasicVec3<R>{e.roll, 0, 0});
}

}  // namespace fairlead
