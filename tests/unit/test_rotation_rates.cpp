// How fast a rotation turns that is told by its rotation vector: against differences of the
// rotation itself, in double.
#include <gtest/gtest.h>

#include <cmath>

#include "fairlead/math/quat.hpp"
#include "fairlead/math/rotation_rates.hpp"

namespace fairlead {
namespace {

using V = BasicVec3<double>;

BasicQuat<double> turned(const V& v) {
    const double n = std::sqrt(dot(v, v)), s = n > 1e-9 ? std::sin(n / 2) / n : 0.5;
    return {std::cos(n / 2), s * v.x, s * v.y, s * v.z};
}
/// Angular velocity of the body between two rotations, dt apart.
V between(const BasicQuat<double>& a, const BasicQuat<double>& b, double dt) {
    const BasicQuat<double> d = conj(a) * b;
    return (2 / dt) * V{d.x, d.y, d.z};
}

TEST(RotationRates, AreThoseOfTheRotation) {
    const V rate{0.7, -1.1, 0.4}, bend{-0.3, 0.9, 1.3};
    for (const double angle : {0.0, 0.3, 1.0, 2.0, 3.1, 3.9}) {
        const V theta = angle * V{0.48, -0.6, 0.64};
        const auto at = [&](double t) { return turned(theta + t * rate + (t * t / 2) * bend); };
        const double h = 1e-4;
        const V before = between(at(-h), at(0), h), after = between(at(0), at(h), h);
        const auto motion = rotation_motion(theta, rate, bend);
        const V off = motion.velocity - 0.5 * (before + after);
        const V off2 = motion.acceleration - (1 / h) * (after - before);
        EXPECT_LT(std::sqrt(dot(off, off)), 1e-6) << angle;
        EXPECT_LT(std::sqrt(dot(off2, off2)), 1e-5) << angle;
    }
}

TEST(RotationRates, OfNonsenseAreFinite) {
    const Vec3 rate{1, 2, 3}, bend{4, 5, 6};
    for (const float far_off : {4.1f, 100.0f, 158944.0f, 1e19f, 1e30f}) {
        const auto motion = rotation_motion(Vec3{-0.1f, 240.0f, far_off}, rate, bend);
        EXPECT_TRUE(is_finite(motion.velocity) && is_finite(motion.acceleration)) << far_off;
    }
}

}  // namespace
}  // namespace fairlead
