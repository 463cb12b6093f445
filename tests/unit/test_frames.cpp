#include "fairlead/sense/frames.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>

namespace {

using namespace fairlead;

constexpr std::array<Axis, 6> axes{Axis::plus_x,  Axis::minus_x, Axis::plus_y,
                                   Axis::minus_y, Axis::plus_z,  Axis::minus_z};

TEST(AxisMap, TwentyFourOfAllTriplesAreRotations) {
    int rotations = 0;
    for (const Axis x : axes)
        for (const Axis y : axes)
            for (const Axis z : axes) {
                const AxisMap map{x, y, z};
                const Vec3 a = map({1, 0, 0}), b = map({0, 1, 0}), c = map({0, 0, 1});
                const bool proper = dot(cross(a, b), c) == 1.0f;  // determinant
                ASSERT_EQ(map.is_rotation(), proper);
                rotations += proper ? 1 : 0;
            }
    EXPECT_EQ(rotations, 24);
}

TEST(AxisMap, AgreesWithItsQuaternion) {
    const Vec3 v{0.3f, -1.7f, 2.9f};
    for (const Axis x : axes)
        for (const Axis y : axes)
            for (const Axis z : axes) {
                const AxisMap map{x, y, z};
                if (!map.is_rotation()) continue;
                const Quat q = map.rotation();
                EXPECT_NEAR(dot(q, q), 1, 1e-6);
                EXPECT_NEAR(norm(rotate(q, v) - map(v)), 0, 1e-5);
            }
}

TEST(WorldFrame, AxesPointWhereTheirNamesSay) {
    const Vec3 east{1, 0, 0}, north{0, 1, 0}, up{0, 0, 1};
    const Quat ned = from_enu(WorldFrame::ned), nwu = from_enu(WorldFrame::nwu);
    EXPECT_NEAR(norm(rotate(ned, north) - Vec3{1, 0, 0}), 0, 1e-6);
    EXPECT_NEAR(norm(rotate(ned, east) - Vec3{0, 1, 0}), 0, 1e-6);
    EXPECT_NEAR(norm(rotate(ned, up) - Vec3{0, 0, -1}), 0, 1e-6);
    EXPECT_NEAR(norm(rotate(nwu, north) - Vec3{1, 0, 0}), 0, 1e-6);
    EXPECT_NEAR(norm(rotate(nwu, east) - Vec3{0, -1, 0}), 0, 1e-6);
    EXPECT_NEAR(norm(rotate(nwu, up) - Vec3{0, 0, 1}), 0, 1e-6);
    EXPECT_EQ(rotate(from_enu(WorldFrame::enu), north).y, 1.0f);
}

TEST(Mounted, TurnsAllThreeSensors) {
    Sample s;
    s.gyro_rad_s = {1, 2, 3};
    s.accel_m_s2 = {4, 5, 6};
    s.mag_uT = {7, 8, 9};
    constexpr AxisMap map{Axis::plus_y, Axis::minus_x, Axis::plus_z};
    static_assert(map.is_rotation());
    const Sample a = mounted(s, map), b = mounted(s, map.rotation());
    EXPECT_EQ(a.gyro_rad_s.x, 2);
    EXPECT_EQ(a.gyro_rad_s.y, -1);
    EXPECT_NEAR(norm(a.accel_m_s2 - b.accel_m_s2), 0, 1e-5);
    EXPECT_NEAR(norm(a.mag_uT - b.mag_uT), 0, 1e-5);
}

}  // namespace
