#pragma once
// Rotations as unit quaternions.
//
// One convention, stated here and used nowhere else: exp(v) = (cos|v|, v/|v| sin|v|) with
// HALF-angle vectors v, log its inverse [Lee & Shin 2002, sec. III]. Outside this header rotations
// are given as rotation vectors (full angle): see rotation_vector() and from_rotation_vector().
#include "fairlead/base/types.hpp"
#include "fairlead/math/approx.hpp"
#include "fairlead/math/vec.hpp"

namespace fairlead {

template <class R>
constexpr BasicQuat<R> operator*(const BasicQuat<R>& a, const BasicQuat<R>& b) noexcept {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
            a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
template <class R>
constexpr BasicQuat<R> conj(const BasicQuat<R>& q) noexcept {
    return {q.w, -q.x, -q.y, -q.z};
}
template <class R>
constexpr BasicQuat<R> operator-(const BasicQuat<R>& q) noexcept {
    return {-q.w, -q.x, -q.y, -q.z};
}
template <class R>
constexpr R dot(const BasicQuat<R>& a, const BasicQuat<R>& b) noexcept {
    return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class R>
constexpr BasicVec3<R> vec(const BasicQuat<R>& q) noexcept {
    return {q.x, q.y, q.z};
}
template <class R>
constexpr bool is_finite(const BasicQuat<R>& q) noexcept {
    return approx::is_finite(q.w) && approx::is_finite(q.x) && approx::is_finite(q.y) &&
           approx::is_finite(q.z);
}

/// q / |q|; the identity where |q| is 0 or not finite.
template <class R>
inline BasicQuat<R> normalised(const BasicQuat<R>& q) noexcept {
    const R n2 = dot(q, q);
    if (!(n2 > 0) || !approx::is_finite(n2)) return {};
    const R s = 1 / approx::sqrt(n2);
    return {q.w * s, q.x * s, q.y * s, q.z * s};
}

/// v_a = q_ab * v_b * conj(q_ab), for unit q_ab. Cost: 15 multiplications.
template <class R>
constexpr BasicVec3<R> rotate(const BasicQuat<R>& q, const BasicVec3<R>& v) noexcept {
    const BasicVec3<R> u = vec(q), t = R{2} * cross(u, v);
    return v + q.w * t + cross(u, t);
}

/// Unit quaternion of the half-angle vector v. Exact to rounding near 0.
template <class R>
inline BasicQuat<R> exp(const BasicVec3<R>& v) noexcept {
    const R n2 = dot(v, v);
    R s, c;
    if (n2 < static_cast<R>(1e-4)) {  // series: the first term left out is below 2e-12 of the sine
        s = 1 + n2 * (static_cast<R>(-1.0 / 6) + n2 * static_cast<R>(1.0 / 120));
        c = 1 + n2 * (static_cast<R>(-0.5) +
                      n2 * (static_cast<R>(1.0 / 24) - n2 * static_cast<R>(1.0 / 720)));
    } else {
        const R n = approx::sqrt(n2);
        const auto sc = approx::sin_cos(n);
        s = sc.sin / n;
        c = sc.cos;
    }
    return {c, s * v.x, s * v.y, s * v.z};
}

/// Half-angle vector of the rotation q, |v| <= pi/2: log(q) = log(-q). Exact to rounding near 0 and
/// near pi.
template <class R>
inline BasicVec3<R> log(const BasicQuat<R>& q) noexcept {
    const R sign = q.w < 0 ? R{-1} : R{1};
    const BasicVec3<R> v = sign * vec(q);
    const R w = sign * q.w;
    const R n2 = dot(v, v);
    if (n2 < static_cast<R>(1e-30))
        return v;  // |v|^2 would underflow; there log is the vector itself
    const R n = approx::sqrt(n2);
    return (approx::atan2(n, w) / n) * v;
}

/// Rotation vector (axis times full angle, at most pi) of q.
template <class R>
inline BasicVec3<R> rotation_vector(const BasicQuat<R>& q) noexcept {
    return R{2} * log(q);
}
template <class R>
inline BasicQuat<R> from_rotation_vector(const BasicVec3<R>& r) noexcept {
    return exp(R{1} / R{2} * r);
}

/// Full rotation angle between a and b, in [0, pi]. Well conditioned near 0 and near pi.
template <class R>
inline R rotation_angle(const BasicQuat<R>& a, const BasicQuat<R>& b) noexcept {
    const BasicQuat<R> d = conj(a) * b;
    return 2 * approx::atan2(norm(vec(d)), approx::absolute(d.w));
}

/// b or -b, whichever lies on a's side: the same rotation, the shorter way on S^3.
template <class R>
constexpr BasicQuat<R> same_side(const BasicQuat<R>& a, const BasicQuat<R>& b) noexcept {
    return dot(a, b) < 0 ? -b : b;
}

/// Geodesic from a (s = 0) to b (s = 1), the short way. Unit in, unit out.
template <class R>
inline BasicQuat<R> slerp(const BasicQuat<R>& a, const BasicQuat<R>& b, R s) noexcept {
    return a * exp(s * log(conj(a) * b));
}

}  // namespace fairlead
