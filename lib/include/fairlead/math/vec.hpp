#pragma once
// Three-vectors: the few operations the library needs, free functions, no surprises.
#include <cstddef>

#include "fairlead/base/types.hpp"
#include "fairlead/math/approx.hpp"

namespace fairlead {

template <class R>
constexpr BasicVec3<R> operator+(const BasicVec3<R>& a, const BasicVec3<R>& b) noexcept {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class R>
constexpr BasicVec3<R> operator-(const BasicVec3<R>& a, const BasicVec3<R>& b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class R>
constexpr BasicVec3<R> operator-(const BasicVec3<R>& a) noexcept {
    return {-a.x, -a.y, -a.z};
}
template <class R>
constexpr BasicVec3<R> operator*(R s, const BasicVec3<R>& a) noexcept {
    return {s * a.x, s * a.y, s * a.z};
}
template <class R>
constexpr BasicVec3<R>& operator+=(BasicVec3<R>& a, const BasicVec3<R>& b) noexcept {
    return a = a + b;
}

/// i: 0, 1, 2 for x, y, z.
template <class R>
constexpr R component(const BasicVec3<R>& a, std::size_t i) noexcept {
    return i == 0 ? a.x : i == 1 ? a.y : a.z;
}

template <class R>
constexpr R dot(const BasicVec3<R>& a, const BasicVec3<R>& b) noexcept {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class R>
constexpr BasicVec3<R> cross(const BasicVec3<R>& a, const BasicVec3<R>& b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class R>
inline R norm(const BasicVec3<R>& a) noexcept {
    return approx::sqrt(dot(a, a));
}
template <class R>
constexpr bool is_finite(const BasicVec3<R>& a) noexcept {
    return approx::is_finite(a.x) && approx::is_finite(a.y) && approx::is_finite(a.z);
}

}  // namespace fairlead
