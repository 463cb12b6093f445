#pragma once
// A flat picture of the rotations around an anchor, in which orientation curves are plain splines.
//
// The chart coordinate of q is twice the vector part of conj(anchor) * q: near the anchor it is the
// rotation vector, and going back needs one square root. Rotating the world leaves it as it is and
// rotating the body turns it, so that reduction does not depend on the choice of frames. At a knot
// more than about a radian away the anchor moves to the curve itself: a change of coordinates, not
// of the curve.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/math/quat.hpp"
#include "fairlead/reduce/span.hpp"

namespace fairlead {

/// A unit quaternion on a grid of 2^-15: three components and the index of the fourth, which is the
/// largest and positive. Cost of q(): one square root.
struct Anchor {
    std::array<std::int16_t, 3> small{};
    std::uint8_t largest{};  // 0: w, 1: x, 2: y, 3: z

    static Anchor nearest(const Quat& q) noexcept {
        const std::array<float, 4> v{q.w, q.x, q.y, q.z};
        Anchor a;
        for (std::uint8_t i = 1; i < 4; ++i)
            if (approx::abs(v[i]) > approx::abs(v[a.largest])) a.largest = i;
        const float grid = v[a.largest] < 0 ? -32768.0f : 32768.0f;
        for (std::uint8_t i = 0, k = 0; i < 4; ++i)
            if (i != a.largest) a.small[k++] = static_cast<std::int16_t>(to_integer(grid * v[i]));
        return a;
    }

    Quat q() const noexcept {
        std::array<float, 4> v{};
        float rest = 1;
        for (std::uint8_t i = 0, k = 0; i < 4; ++i) {
            if (i == largest) continue;
            v[i] = static_cast<float>(small[k++]) * (1.0f / 32768.0f);
            rest -= v[i] * v[i];
        }
        v[largest] = approx::sqrt(rest > 0 ? rest : 0);
        return {v[0], v[1], v[2], v[3]};
    }
};

/// Chart coordinates of q: 2 vec(conj(anchor) q), on the anchor's side of S^3.
inline std::array<float, 3> to_chart(const Quat& anchor, const Quat& q) noexcept {
    Quat d = conj(anchor) * q;
    if (d.w < 0) d = -d;
    return {2 * d.x, 2 * d.y, 2 * d.z};
}

/// conj(anchor) * q of the chart coordinates y: unit length by construction for |y| <= 2.
inline Quat chart_point(const std::array<float, 3>& y) noexcept {
    const float x1 = y[0] / 2, x2 = y[1] / 2, x3 = y[2] / 2;
    const float rest = 1 - (x1 * x1 + x2 * x2 + x3 * x3);
    return {approx::sqrt(rest > 0 ? rest : 0), x1, x2, x3};
}

/// An orientation curve leaves its chart at a knot when |coordinate| exceeds this (rotation of 58
/// deg).
inline constexpr float chart_radius = 0.97f;

/// The state of the curve in the chart of another anchor: value and derivatives up to the third of
/// the same motion. `unit` is the length of a unit of the span.
inline Span<3, 4> in_chart(const Span<3, 4>& span, float unit, const Quat& from,
                           const Quat& to) noexcept {
    const Polynomial<3, 4> p{span};
    const auto half = [&](std::size_t m) {
        const float s = unit / 2;
        return Vec3{s * p.c[m][0], s * p.c[m][1], s * p.c[m][2]};
    };
    // Taylor series of the point (w, v) on S^3, v = y / 2, from w^2 + v.v = 1 power by power
    const Vec3 v0 = half(0), v1 = half(1), v2 = half(2), v3 = half(3);
    const float rest = 1 - dot(v0, v0);
    const float w0 = approx::sqrt(rest > 1e-6f ? rest : 1e-6f);
    const float w1 = -dot(v0, v1) / w0;
    const float w2 = -(dot(v1, v1) + 2 * dot(v0, v2) + w1 * w1) / (2 * w0);
    const float w3 = -(dot(v0, v3) + dot(v1, v2) + w1 * w2) / w0;
    const Quat turn = conj(to) * from;
    const std::array<Quat, 4> jet{
        turn * Quat{w0, v0.x, v0.y, v0.z}, turn * Quat{w1, v1.x, v1.y, v1.z},
        turn * Quat{w2, v2.x, v2.y, v2.z}, turn * Quat{w3, v3.x, v3.y, v3.z}};
    const float side = (jet[0].w < 0 ? -2.0f : 2.0f) / unit;
    Span<3, 4> out;
    out.t0_ns = span.t0_ns;
    for (std::size_t m = 0; m < 4; ++m) {
        const float s = side * power_of_two(fraction_bits(m));
        out.c[m] = {to_integer(s * jet[m].x), to_integer(s * jet[m].y), to_integer(s * jet[m].z)};
    }
    return out;
}

}  // namespace fairlead
