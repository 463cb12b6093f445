#pragma once
// Orientations as curves of three components: a chart about an anchor.
//
// Q(t) = A exp(theta(t)), A the anchor of a segment, theta a curve of rotation vectors on a lattice
// of `step` rad (state.hpp with N = 3). exp never lengthens distances, so that a difference in the
// chart bounds the angle between rotations from above. At the end of a segment the anchor moves
// there: A' = A exp(theta), v = 0, and the slope goes over into the chart of A' by the right
// Jacobian of SO(3) [Chirikjian 2012, eq. 10.86; Sola et al. 2018, eq. 143]:
//     s' = s - (1 - cos a) / a^2 theta x s + (a - sin a) / a^3 theta x (theta x s),   a = |theta|
// The order of these float operations is part of the format.
#include <array>
#include <cstdint>

#include "fairlead/curve/state.hpp"
#include "fairlead/math/quat.hpp"

namespace fairlead::curve {

/// Beyond this angle from the anchor (rad) a segment ends: in the chart distances grow too long.
inline constexpr float chart_angle_max = 2.2f;

struct RotationState {
    Quat anchor{};
    State<3> chart{};
};

/// A rotation in few bits: the three smaller components of the quaternion in steps of a grid, the
/// largest is positive and follows. |n| <= grid_size(step).
struct GridQuat {
    std::uint8_t largest{};  // index of the largest component: w x y z
    std::array<std::int16_t, 3> n{};
};

/// Step of the grid for components of quaternions, for a lattice of `step` rad: an error of at most
/// step / 6 for each of the three told, which turns by at most 0.93 step (all components alike).
constexpr float grid_step(float step) noexcept { return step * (1.0f / 3.0f); }
/// Largest n on this grid: sqrt(1/2) / grid_step, rounded up.
constexpr std::int32_t grid_size(float step) noexcept {
    return static_cast<std::int32_t>(0.70710678f / grid_step(step)) + 1;
}

/// Nearest rotation on the grid; q must be a unit quaternion, step >= 1e-4 rad.
inline GridQuat to_grid(const Quat& q, float step) noexcept {
    const std::array<float, 4> c{q.w, q.x, q.y, q.z};
    std::size_t m = 0;
    for (std::size_t i = 1; i < 4; ++i)
        if (approx::absolute(c[i]) > approx::absolute(c[m])) m = i;
    const float per_step = (c[m] < 0 ? -1.0f : 1.0f) / grid_step(step);
    const float most = static_cast<float>(grid_size(step));
    GridQuat g;
    g.largest = static_cast<std::uint8_t>(m);
    for (std::size_t i = 0, at = 0; i < 4; ++i) {
        if (i == m) continue;
        const float x = c[i] * per_step;
        const float r = x < 0 ? x - 0.5f : x + 0.5f;
        g.n[at++] = static_cast<std::int16_t>(r > most ? most : r < -most ? -most : r);
    }
    return g;
}

/// The unit quaternion of a grid point. Any n give a rotation.
inline Quat from_grid(const GridQuat& g, float step) noexcept {
    const float size = grid_step(step);
    std::array<float, 4> c{};
    float rest = 1.0f;
    for (std::size_t i = 0, at = 0; i < 4; ++i) {
        if (i == (g.largest & 3u)) continue;
        c[i] = static_cast<float>(g.n[at++]) * size;
        rest -= c[i] * c[i];
    }
    c[g.largest & 3u] = rest > 0.0f ? approx::sqrt(rest) : 0.0f;
    return normalised(Quat{c[0], c[1], c[2], c[3]});
}

namespace detail {
inline std::int32_t nearest_slope(float x) noexcept {
    const float most = static_cast<float>(slope_max);
    const float r = x < 0 ? x - 0.5f : x + 0.5f;
    return static_cast<std::int32_t>(r > most ? most : r < -most ? -most : r);
}
}  // namespace detail

/// Body rate at the chart's place theta where the chart moves with `speed`; the same units.
inline Vec3 body_rate(const Vec3& theta, const Vec3& speed) noexcept {
    const float n2 = dot(theta, theta);
    float a, b;
    if (n2 < 1e-4f) {
        a = 0.5f - n2 * (1.0f / 24.0f);
        b = 1.0f / 6.0f - n2 * (1.0f / 120.0f);
    } else {
        const float n = approx::sqrt(n2);
        const auto sc = approx::sin_cos(n);
        a = (1.0f - sc.cos) / n2;
        b = (n - sc.sin) / (n2 * n);
    }
    const Vec3 once = cross(theta, speed), twice = cross(theta, once);
    return (speed - a * once) + b * twice;
}

/// Rotation vector of a place in the chart, in rad.
inline Vec3 chart_angle(const std::array<std::int32_t, 3>& v, float step) noexcept {
    return {static_cast<float>(v[0]) * step, static_cast<float>(v[1]) * step,
            static_cast<float>(v[2]) * step};
}

/// Moves the anchor to where the curve is: at every end of a frame that is no restart, and at
/// code::rebase.
inline void rebase(RotationState& state, float step) noexcept {
    const Vec3 theta = chart_angle(state.chart.v, step);
    const auto& s = state.chart.s;
    const Vec3 speed{static_cast<float>(s[0]), static_cast<float>(s[1]), static_cast<float>(s[2])};
    const Vec3 rate = body_rate(theta, speed);
    state.anchor = normalised(state.anchor * from_rotation_vector(theta));
    state.chart.v = {};
    state.chart.s = {detail::nearest_slope(rate.x), detail::nearest_slope(rate.y),
                     detail::nearest_slope(rate.z)};
}

/// Where in the chart the rotation q is, in lattice steps.
inline std::array<float, 3> place(const Quat& anchor, const Quat& q, float step) noexcept {
    const Vec3 r = rotation_vector(conj(anchor) * q);
    const float inverse = 1.0f / step;
    return {r.x * inverse, r.y * inverse, r.z * inverse};
}

/// Slope at the end of a piece that rises by a number of steps that is no integer.
inline std::int32_t slope_onto(std::int32_t s, bool chord, float rise, std::int32_t h) noexcept {
    const float per_tick = static_cast<float>(slope_unit) * rise / static_cast<float>(h);
    return detail::nearest_slope(chord ? per_tick : 2.0f * per_tick - static_cast<float>(s));
}

/// Moves the anchor to `target`, where the curve is: a place of the grid, not of the lattice. `end`
/// is its place in the chart, in steps: place(anchor, target, step).
inline void land(RotationState& state, const Quat& target, const std::array<float, 3>& end,
                 float step) noexcept {
    const auto& s = state.chart.s;
    const Vec3 rate =
        body_rate({end[0] * step, end[1] * step, end[2] * step},
                  {static_cast<float>(s[0]), static_cast<float>(s[1]), static_cast<float>(s[2])});
    state.anchor = target;
    state.chart.v = {};
    state.chart.s = {detail::nearest_slope(rate.x), detail::nearest_slope(rate.y),
                     detail::nearest_slope(rate.z)};
}

/// Ends a segment exactly on `target` instead of a lattice point: the last piece of a frame that
/// tells its end. A jump has been stepped already.
inline void step_onto(RotationState& state, const Piece<3>& piece, const Quat& target,
                      const std::array<float, 3>& end, float step) noexcept {
    State<3>& chart = state.chart;
    if (piece.code != code::jump) {
        const std::int32_t h = piece.subs / subs_per_tick;
        const bool chord = ends_on_chord(piece.code, chart.fresh);
        for (std::size_t c = 0; c < 3; ++c)
            chart.s[c] = slope_onto(chart.s[c], chord, end[c] - static_cast<float>(chart.v[c]), h);
        remember(chart, piece);
        chart.phase = 0;
    }
    land(state, target, end, step);
}

}  // namespace fairlead::curve
