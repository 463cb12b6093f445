#pragma once
// The two kinds of 3 x 3 matrix that sensors need: any, by rows, and symmetric.
#include "fairlead/math/vec.hpp"

namespace fairlead {

template <class Real>
struct Matrix3 {
    BasicVec3<Real> x{}, y{}, z{};  // rows
};

template <class Real>
constexpr BasicVec3<Real> operator*(const Matrix3<Real>& m, const BasicVec3<Real>& v) noexcept {
    return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}

/// Symmetric: what scales the axes, and what shears them.
template <class Real>
struct Symmetric3 {
    BasicVec3<Real> scale{};  // xx, yy, zz
    BasicVec3<Real> shear{};  // yz, zx, xy
};

template <class Real>
constexpr BasicVec3<Real> operator*(const Symmetric3<Real>& m, const BasicVec3<Real>& v) noexcept {
    return {m.scale.x * v.x + m.shear.z * v.y + m.shear.y * v.z,
            m.shear.z * v.x + m.scale.y * v.y + m.shear.x * v.z,
            m.shear.y * v.x + m.shear.x * v.y + m.scale.z * v.z};
}

template <class Real>
constexpr Real component(const BasicVec3<Real>& v, std::size_t i) noexcept {
    return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

}  // namespace fairlead
