#pragma once
// An independent reference for rotations: double precision, libm, rotation matrices where that
// keeps it unlike the code under test. Header only, tests only.
#include <array>
#include <cmath>
#include <random>

#include "fairlead/base/types.hpp"

namespace ref {

struct V : std::array<double, 3> {};
struct Q : std::array<double, 4> {};  // w x y z

inline V operator+(const V& a, const V& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline V operator-(const V& a, const V& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline V operator*(double s, const V& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double norm(const V& a) { return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

inline Q mul(const Q& a, const Q& b) {
    return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] + a[2] * b[0] + a[3] * b[1] - a[1] * b[3],
            a[0] * b[3] + a[3] * b[0] + a[1] * b[2] - a[2] * b[1]};
}
inline Q inverse(const Q& q) {
    const double n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    return {q[0] / n, -q[1] / n, -q[2] / n, -q[3] / n};
}
inline Q unit(const Q& q) {
    const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    return {q[0] / n, q[1] / n, q[2] / n, q[3] / n};
}
/// Quaternion of a rotation vector (full angle).
inline Q from_vector(const V& r) {
    const double a = norm(r);
    const double s = a > 1e-12 ? std::sin(a / 2) / a : 0.5;
    return {std::cos(a / 2), s * r[0], s * r[1], s * r[2]};
}
/// Rotation vector (full angle, at most pi) of a quaternion of any length and sign.
inline V to_vector(const Q& q) {
    const double sign = q[0] < 0 ? -1 : 1;
    const V v{sign * q[1], sign * q[2], sign * q[3]};
    const double n = norm(v);
    const double a = 2 * std::atan2(n, sign * q[0]);
    return n > 0 ? (a / n) * v : V{};
}
/// Full rotation angle between two rotations.
inline double angle(const Q& a, const Q& b) { return norm(to_vector(mul(inverse(a), b))); }

inline Q of(const fairlead::Quat& q) {
    return {double{q.w}, double{q.x}, double{q.y}, double{q.z}};
}
inline V of(const fairlead::Vec3& v) { return {double{v.x}, double{v.y}, double{v.z}}; }
inline fairlead::Quat narrow(const Q& q) {
    return {static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2]),
            static_cast<float>(q[3])};
}
inline fairlead::Vec3 narrow(const V& v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

/// Vector with independent normal components.
template <class Random>
V normal(Random& random, double sigma) {
    std::normal_distribution<double> n;
    return {sigma * n(random), sigma * n(random), sigma * n(random)};
}
/// Uniform on all rotations, either sign.
template <class Random>
Q any_rotation(Random& random) {
    std::normal_distribution<double> n{0, 1};
    return unit({n(random), n(random), n(random), n(random)});
}

}  // namespace ref
