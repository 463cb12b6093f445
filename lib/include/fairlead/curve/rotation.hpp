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

/// Steps of a lattice of rotations, in rad: the grid counts in 16 bits, and squares stay finite.
constexpr bool rotation_step_valid(float step) noexcept { return step >= 1e-4f && step <= 1.0f; }

struct RotationState {
    Quat anchor{};
    State<3> chart{};
};

constexpr bool same(const Quat& a, const Quat& b) noexcept {
    return approx::same(a.w, b.w) && approx::same(a.x, b.x) && approx::same(a.y, b.y) &&
           approx::same(a.z, b.z);
}
constexpr bool same(const RotationState& a, const RotationState& b) noexcept {
    return same(a.anchor, b.anchor) && same(a.chart, b.chart);
}

/// A rotation in few bits: the three smaller components of the quaternion in steps of a grid, the
/// largest is positive and follows. |n| <= grid_size(step).
struct GridQuat {
    std::uint8_t largest{};  // index of the largest component: w x y z
    std::array<std::int16_t, 3> n{};
};

/// Step of the grid for components of quaternions, for a lattice of `step` rad: an error of at most
/// step / 8 for each of the three that are told. The fourth follows, and errs by their sum where
/// all four are 1/2: such a place turns by at most 2 sqrt(3 + 9) step / 8 = 0.87 step.
constexpr float grid_step(float step) noexcept { return step * 0.25f; }
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
    return static_cast<std::int32_t>(!(r < most) ? most : r < -most ? -most : r);
}

/// c[0] + c[1] x + c[2] x^2 + ... by Horner's scheme.
inline float horner(const float* c, std::size_t n, float x) noexcept {
    float r = c[--n];
    while (n > 0) r = r * x + c[--n];
    return r;
}
// Chebyshev interpolants in float (tests/ref/approx_coefficients.py): of cos(a) and sin(a) / a in
// a^2 up to 1.25, and of atan(t) / t in t^2 up to 1
inline constexpr float cos_of[]{1.0f, -0.49999994f, 0.0416662544f, -0.00138796587f,
                                2.39535511e-05f};
inline constexpr float sinc_of[]{1.0f, -0.166666657f, 0.00833329558f, -0.000198328533f,
                                 2.6784553e-06f};
inline constexpr float atan_of[]{0.999999881f,  -0.333318114f,  0.199669614f,  -0.140032902f,
                                 0.0986886546f, -0.0588297546f, 0.0237805191f, -0.00455979211f};

/// cos(a) and sin(a) / a of half the angle of a rotation vector, a = |theta| / 2.
struct HalfAngle {
    float cos, sinc;

    explicit HalfAngle(const Vec3& theta) noexcept {
        float x = 0.25f * dot(theta, theta);
        int halved = 0;
        for (; halved < 32 && x > 1.25f; ++halved) x *= 0.25f;
        cos = horner(cos_of, 5, x);
        sinc = horner(sinc_of, 5, x);
        for (; halved > 0; --halved) {
            sinc = cos * sinc;
            cos = 2.0f * cos * cos - 1.0f;
        }
    }
};
}  // namespace detail

/// exp(theta), nearly normalised: within 1e-6 for |theta| <= 8 rad.
inline Quat chart_exp(const Vec3& theta) noexcept {
    const detail::HalfAngle h{theta};
    const float f = 0.5f * h.sinc;
    return {h.cos, f * theta.x, f * theta.y, f * theta.z};
}
/// log(q) of a unit quaternion, the shorter way: 4 atan(|t|) / |t| t, t = xyz / (1 + |w|).
inline Vec3 chart_log(const Quat& q) noexcept {
    const float d = (q.w < 0 ? -1.0f : 1.0f) / (1.0f + approx::absolute(q.w));
    const Vec3 t{d * q.x, d * q.y, d * q.z};
    return 4.0f * detail::horner(detail::atan_of, 8, dot(t, t)) * t;
}

/// Body rate at the chart's place theta where the chart moves with `speed`; the same units. The
/// Jacobian keeps what is along theta, and turns and shortens what is across it.
inline Vec3 body_rate(const Vec3& theta, const Vec3& speed) noexcept {
    const float n2 = dot(theta, theta);
    if (n2 < 1e-12f) return speed;
    const detail::HalfAngle h{theta};
    const Vec3 across = speed - (dot(theta, speed) / n2) * theta;
    return (speed - (0.5f * h.sinc * h.sinc) * cross(theta, speed)) -
           (1.0f - h.cos * h.sinc) * across;
}

/// Rotation vector of a place in the chart, in rad.
inline Vec3 chart_angle(const std::array<std::int32_t, 3>& v, float step) noexcept {
    return {static_cast<float>(v[0]) * step, static_cast<float>(v[1]) * step,
            static_cast<float>(v[2]) * step};
}

namespace detail {
/// The chart about a new anchor, which stands at `theta` in the one before.
inline void anchor_at(RotationState& state, const Quat& anchor, const Vec3& theta) noexcept {
    const auto& s = state.chart.s;
    const Vec3 rate = body_rate(
        theta, {static_cast<float>(s[0]), static_cast<float>(s[1]), static_cast<float>(s[2])});
    state.anchor = anchor;
    state.chart.v = {};
    state.chart.s = {nearest_slope(rate.x), nearest_slope(rate.y), nearest_slope(rate.z)};
}
}  // namespace detail

/// Moves the anchor to where the curve is: at every end of a frame that is no restart, and at
/// code::rebase.
inline void rebase(RotationState& state, float step) noexcept {
    const Vec3 theta = chart_angle(state.chart.v, step);
    detail::anchor_at(state, normalised(state.anchor * chart_exp(theta)), theta);
}

/// Where in the chart the rotation q is, in lattice steps.
inline std::array<float, 3> place(const Quat& anchor, const Quat& q, float step) noexcept {
    const Vec3 r = chart_log(conj(anchor) * q);
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
    detail::anchor_at(state, target, {end[0] * step, end[1] * step, end[2] * step});
}

/// Ends a segment exactly on `target` instead of a lattice point: the last piece of a frame that
/// tells its end. A jump has been stepped already.
inline void step_onto(RotationState& state, std::uint8_t c, std::int32_t subs, const Quat& target,
                      const std::array<float, 3>& end, float step) noexcept {
    State<3>& chart = state.chart;
    if (c != code::jump) {
        const std::int32_t h = subs / subs_per_tick, zero[3]{};
        const bool chord = ends_on_chord(c, chart.fresh);
        for (std::size_t i = 0; i < 3; ++i)
            chart.s[i] = slope_onto(chart.s[i], chord, end[i] - static_cast<float>(chart.v[i]), h);
        remember(chart.view(), c, subs, zero);
    }
    land(state, target, end, step);
}

}  // namespace fairlead::curve
