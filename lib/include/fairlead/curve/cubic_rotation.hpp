#pragma once
// Orientations as C2 cubics: three components that share their vertices, in a chart about an
// anchor.
//
// Q(t) = A exp(theta(t)), as in rotation.hpp; theta is a cubic of cubic_state.hpp with N = 3. Where
// the anchor moves, the state goes over into the other chart. What stays is the rotation, the body
// rate w and the angular acceleration w'. With theta, d = theta', b = theta'' and the right
// Jacobian of SO(3) [Chirikjian 2012, eq. 10.86; Sola et al. 2018, eq. 143]:
//     w = J(theta) d,   w' = J(theta) b + turn(theta, d),   turn = dJ/dt d.
// At the anchor theta = 0, J is the identity and turn is 0: there d is w and b is w'.
//
// The anchor moves at two places:
//   rebase()      to where the curve is: at each end of a frame, and at code::rebase;
//   begin_run()   from there to a rotation of the grid: where a run of three pieces begins, so that
//                 a reader that joins knows the chart of the run. It lies near the first control
//                 point, which therefore is 0.
// The state is in integers; these two compute in float, in a fixed order that is part of the
// format. A reader that joined knows no state before the end of the run, and never computes
// begin_run()'s floats: behind the run, the anchor is the grid's and the state is that of the three
// control points.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/curve/cubic_state.hpp"
#include "fairlead/curve/rotation.hpp"

namespace fairlead::curve {

struct CubicRotation {
    Quat anchor{};
    CubicState<3> chart{};

    /// A curve begins at rest on a rotation, which is the anchor.
    static CubicRotation begin(const Quat& anchor) noexcept {
        return {anchor, CubicState<3>::begin({})};
    }
    /// A reader joins where a run begins; begin_run() tells it the anchor.
    static CubicRotation join() noexcept { return {{}, CubicState<3>::join()}; }
};

/// The part of the angular acceleration that comes from the motion of the Jacobian, where the chart
/// moves through theta (rad) with `speed`: a product of two speeds, in their unit squared.
inline Vec3 rate_turn(const Vec3& theta, const Vec3& speed) noexcept {
    // J = 1 - f [theta] + g [theta]^2, f = (1 - cos n) / n^2, g = (n - sin n) / n^3; slopes in n^2
    constexpr float f_series[]{-1 / 24.0f, 1 / 360.0f, -1 / 13440.0f, 1 / 907200.0f};
    constexpr float g_series[]{1 / 6.0f, -1 / 120.0f, 1 / 5040.0f, -1 / 362880.0f, 1 / 39916800.0f};
    constexpr float h_series[]{-1 / 120.0f, 1 / 2520.0f, -1 / 120960.0f, 1 / 9979200.0f};
    const float n2 = dot(theta, theta);
    float f_slope, g, g_slope;
    if (n2 < 1.0f) {
        f_slope = detail::horner(f_series, 4, n2);
        g = detail::horner(g_series, 5, n2);
        g_slope = detail::horner(h_series, 4, n2);
    } else {
        const detail::HalfAngle h{theta};
        const float sine = h.cos * h.sinc;  // sin n / n
        const float cosine = 2.0f * h.cos * h.cos - 1.0f;
        g = (1.0f - sine) / n2;
        f_slope = (0.5f * sine - 0.5f * h.sinc * h.sinc) / n2;
        g_slope = ((0.5f * (sine - cosine)) / n2 - g) / n2;
    }
    const Vec3 across = cross(theta, speed);
    const float twice = 2.0f * dot(theta, speed);
    return (g * cross(speed, across) - (twice * f_slope) * across) +
           (twice * g_slope) * cross(theta, across);
}

/// Speed of the chart at theta where the body turns with `rate`: the inverse of body_rate().
/// |theta| at most pi.
inline Vec3 chart_speed(const Vec3& theta, const Vec3& rate) noexcept {
    const float n2 = dot(theta, theta);
    if (n2 < 1e-12f) return rate;
    const detail::HalfAngle h{theta};
    const Vec3 across = rate - (dot(theta, rate) / n2) * theta;
    return (rate + 0.5f * cross(theta, rate)) - (1.0f - h.cos / h.sinc) * across;
}

namespace detail {

/// Units of p, v and a in a lattice step, as floats; all are exact.
inline constexpr float cubic_p_units = static_cast<float>(6 * cubic_unit);
inline constexpr float cubic_v_units = static_cast<float>(2 * cubic_unit);
inline constexpr float cubic_a_units = static_cast<float>(cubic_unit);

/// x in units, toward zero. @return false: too large.
inline bool to_units(float x, float units, std::int64_t& n) noexcept {
    constexpr float most = 4611686018427387904.0f;  // 2^62
    const float y = x * units;
    if (!(y > -most && y < most)) return false;
    n = static_cast<std::int64_t>(y);
    return true;
}

/// One of p, v, a of all components, in steps: 1 / units each.
inline Vec3 in_steps(const std::array<CubicVertex, 3>& at, std::int64_t CubicVertex::*what,
                     float units) noexcept {
    const float unit = 1.0f / units;
    return {static_cast<float>(at[0].*what) * unit, static_cast<float>(at[1].*what) * unit,
            static_cast<float>(at[2].*what) * unit};
}

/// Sets the state. @return false, with the state unchanged, where it leaves the bounds.
inline bool set_vertices(std::array<CubicVertex, 3>& at, const Vec3& p, const Vec3& v,
                         const Vec3& a) noexcept {
    std::array<CubicVertex, 3> to{};
    for (std::size_t c = 0; c < 3; ++c)
        if (!to_units(component(p, c), cubic_p_units, to[c].p) ||
            !to_units(component(v, c), cubic_v_units, to[c].v) ||
            !to_units(component(a, c), cubic_a_units, to[c].a) || !inside(to[c]))
            return false;
    at = to;
    return true;
}

}  // namespace detail

/// Rotation vector of a vertex in its chart, in rad.
inline Vec3 chart_angle(const std::array<CubicVertex, 3>& at, float step) noexcept {
    return step * detail::in_steps(at, &CubicVertex::p, detail::cubic_p_units);
}

/// The rotation of the vertex.
inline Quat rotation_at(const CubicRotation& state, float step) noexcept {
    return normalised(state.anchor * chart_exp(chart_angle(state.chart.at, step)));
}

/// Moves the anchor to where the curve is. Rotation, body rate and angular acceleration go on, but
/// for the rounding of floats (measured: docs/cubics.md). step: of the lattice, 1e-4 to 1 rad.
/// @return false, with the state unchanged: a run has begun and has not ended, or the state leaves
/// the bounds of cubic.hpp.
[[nodiscard]] inline bool rebase(CubicRotation& state, float step) noexcept {
    CubicState<3>& chart = state.chart;
    if (chart.run != 0 || !chart.known) return false;
    const Vec3 theta = chart_angle(chart.at, step);
    const Vec3 v = detail::in_steps(chart.at, &CubicVertex::v, detail::cubic_v_units);
    const Vec3 a = detail::in_steps(chart.at, &CubicVertex::a, detail::cubic_a_units);
    const Quat anchor = normalised(state.anchor * chart_exp(theta));
    if (!detail::set_vertices(chart.at, {}, body_rate(theta, v),
                              body_rate(theta, a) + step * rate_turn(theta, v)))
        return false;
    state.anchor = anchor;
    return true;
}

/// Begins a run about `anchor`, a rotation of the grid, from a state behind rebase(); and of a
/// reader that joins. The state of a curve that is known goes over into that chart.
/// @return false, with the state unchanged, where it leaves the bounds of cubic.hpp.
[[nodiscard]] inline bool begin_run(CubicRotation& state, const Quat& anchor, float step) noexcept {
    CubicState<3>& chart = state.chart;
    if (chart.known) {
        const Vec3 w = detail::in_steps(chart.at, &CubicVertex::v, detail::cubic_v_units);
        const Vec3 turn = detail::in_steps(chart.at, &CubicVertex::a, detail::cubic_a_units);
        const Vec3 theta = chart_log(conj(anchor) * state.anchor);
        const Vec3 v = chart_speed(theta, w);
        const Vec3 a = chart_speed(theta, turn - step * rate_turn(theta, v));
        if (!detail::set_vertices(chart.at, (1.0f / step) * theta, v, a)) return false;
    }
    state.anchor = anchor;
    chart.restart();
    return true;
}

}  // namespace fairlead::curve
