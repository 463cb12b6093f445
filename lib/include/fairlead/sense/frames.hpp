#pragma once
// World conventions and mounting: how others name the axes that fairlead calls east, north, up.
#include <cstdint>

#include "fairlead/math/quat.hpp"

namespace fairlead {

/// Axes x, y, z of the world frame. Inside fairlead: enu.
enum class WorldFrame : std::uint8_t {
    enu,  // east, north, up
    ned,  // north, east, down
    nwu,  // north, west, up
};

/// q_vw: from fairlead's ENU world w to the world v of the convention; q_vb = q_vw * q_wb.
template <class Real = float>
constexpr BasicQuat<Real> from_enu(WorldFrame to) noexcept {
    constexpr Real half = static_cast<Real>(0.70710678118654752);  // sqrt(1/2)
    switch (to) {
        case WorldFrame::ned: return {0, half, half, 0};
        case WorldFrame::nwu: return {half, 0, 0, -half};
        case WorldFrame::enu: break;
    }
    return {};
}

/// The signed axis of the sensor that lies along an axis of the body.
enum class Axis : std::uint8_t { plus_x, minus_x, plus_y, minus_y, plus_z, minus_z };

namespace detail {

constexpr int axis_index(Axis a) noexcept { return static_cast<int>(a) / 2; }
constexpr int axis_sign(Axis a) noexcept { return static_cast<int>(a) % 2 == 0 ? 1 : -1; }

}  // namespace detail

/// How a sensor sits in its body: body x is the sensor's axis `x`, and so on. Of the 216 triples,
/// 24 are rotations: is_rotation() tells, and static_assert can ask it.
struct AxisMap {
    Axis x{Axis::plus_x}, y{Axis::plus_y}, z{Axis::plus_z};

    constexpr bool is_rotation() const noexcept {
        const int i = detail::axis_index(x), j = detail::axis_index(y), k = detail::axis_index(z);
        if (i == j || j == k || i == k) return false;
        const int order = (j - i + 3) % 3 == 1 ? 1 : -1;  // even or odd permutation
        return order * detail::axis_sign(x) * detail::axis_sign(y) * detail::axis_sign(z) == 1;
    }

    /// Sensor to body, exact.
    constexpr Vec3 operator()(const Vec3& v) const noexcept {
        return {pick(x, v), pick(y, v), pick(z, v)};
    }

    /// The same as a rotation: v_b = q_bs * v_s * conj(q_bs).
    Quat rotation() const noexcept {
        const Vec3 rx = row(x), ry = row(y), rz = row(z);
        // of the four expressions for a quaternion of this matrix, the one with the largest root
        const float w = 1 + rx.x + ry.y + rz.z, i = 1 + rx.x - ry.y - rz.z,
                    j = 1 - rx.x + ry.y - rz.z, k = 1 - rx.x - ry.y + rz.z;
        Quat q;
        if (w >= i && w >= j && w >= k)
            q = {w, rz.y - ry.z, rx.z - rz.x, ry.x - rx.y};
        else if (i >= j && i >= k)
            q = {rz.y - ry.z, i, rx.y + ry.x, rx.z + rz.x};
        else if (j >= k)
            q = {rx.z - rz.x, rx.y + ry.x, j, ry.z + rz.y};
        else
            q = {ry.x - rx.y, rx.z + rz.x, ry.z + rz.y, k};
        return normalised(q);
    }

  private:
    static constexpr float pick(Axis a, const Vec3& v) noexcept {
        const float value = component(v, static_cast<std::size_t>(detail::axis_index(a)));
        return detail::axis_sign(a) > 0 ? value : -value;
    }
    static constexpr Vec3 row(Axis a) noexcept {
        const int i = detail::axis_index(a);
        const auto s = static_cast<float>(detail::axis_sign(a));
        return {i == 0 ? s : 0, i == 1 ? s : 0, i == 2 ? s : 0};
    }
};

/// All three sensors of one chip turned from the sensor's frame into the body's.
inline Sample mounted(const Sample& sample, const AxisMap& map) noexcept {
    Sample out = sample;
    out.gyro_rad_s = map(sample.gyro_rad_s);
    out.accel_m_s2 = map(sample.accel_m_s2);
    out.mag_uT = map(sample.mag_uT);
    return out;
}
inline Sample mounted(const Sample& sample, const Quat& q_bs) noexcept {
    Sample out = sample;
    out.gyro_rad_s = rotate(q_bs, sample.gyro_rad_s);
    out.accel_m_s2 = rotate(q_bs, sample.accel_m_s2);
    out.mag_uT = rotate(q_bs, sample.mag_uT);
    return out;
}

}  // namespace fairlead
