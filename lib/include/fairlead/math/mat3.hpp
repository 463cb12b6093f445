#pragma once
// 3 x 3 matrices, any and symmetric: the few operations that block elimination, calibration and
// attitude need, as free functions.
#include "fairlead/base/types.hpp"
#include "fairlead/math/vec.hpp"

namespace fairlead {

/// Three rows.
template <class R>
struct BasicMat3 {
    BasicVec3<R> x{}, y{}, z{};
};

/// Symmetric: the upper triangle.
template <class R>
struct BasicSym3 {
    R xx{}, xy{}, xz{}, yy{}, yz{}, zz{};

    static constexpr BasicSym3 diagonal(R d) noexcept { return {d, 0, 0, d, 0, d}; }
};

using Mat3 = BasicMat3<float>;
using Sym3 = BasicSym3<float>;

template <class R>
constexpr BasicVec3<R> operator*(const BasicMat3<R>& m, const BasicVec3<R>& v) noexcept {
    return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}
template <class R>
constexpr BasicVec3<R> operator*(const BasicSym3<R>& m, const BasicVec3<R>& v) noexcept {
    return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
            m.xz * v.x + m.yz * v.y + m.zz * v.z};
}
/// transpose(m) * v
template <class R>
constexpr BasicVec3<R> transposed_times(const BasicMat3<R>& m, const BasicVec3<R>& v) noexcept {
    return v.x * m.x + v.y * m.y + v.z * m.z;
}

template <class R>
constexpr BasicMat3<R> operator*(const BasicMat3<R>& a, const BasicMat3<R>& b) noexcept {
    return {transposed_times(b, a.x), transposed_times(b, a.y), transposed_times(b, a.z)};
}
template <class R>
constexpr BasicMat3<R> operator*(const BasicMat3<R>& a, const BasicSym3<R>& b) noexcept {
    return {b * a.x, b * a.y, b * a.z};
}
template <class R>
constexpr BasicMat3<R> operator*(const BasicSym3<R>& a, const BasicMat3<R>& b) noexcept {
    return {a.xx * b.x + a.xy * b.y + a.xz * b.z, a.xy * b.x + a.yy * b.y + a.yz * b.z,
            a.xz * b.x + a.yz * b.y + a.zz * b.z};
}
template <class R>
constexpr BasicMat3<R> operator+(const BasicMat3<R>& a, const BasicMat3<R>& b) noexcept {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class R>
constexpr BasicMat3<R> operator-(const BasicMat3<R>& a, const BasicMat3<R>& b) noexcept {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class R>
constexpr BasicMat3<R> operator*(R s, const BasicMat3<R>& a) noexcept {
    return {s * a.x, s * a.y, s * a.z};
}

template <class R>
constexpr BasicSym3<R> operator+(const BasicSym3<R>& a, const BasicSym3<R>& b) noexcept {
    return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}
template <class R>
constexpr BasicSym3<R> operator-(const BasicSym3<R>& a, const BasicSym3<R>& b) noexcept {
    return {a.xx - b.xx, a.xy - b.xy, a.xz - b.xz, a.yy - b.yy, a.yz - b.yz, a.zz - b.zz};
}
template <class R>
constexpr BasicSym3<R> operator*(R s, const BasicSym3<R>& a) noexcept {
    return {s * a.xx, s * a.xy, s * a.xz, s * a.yy, s * a.yz, s * a.zz};
}

/// a * b where the caller knows the product to be symmetric: its upper triangle.
template <class R>
constexpr BasicSym3<R> symmetric_product(const BasicSym3<R>& a, const BasicSym3<R>& b) noexcept {
    return {a.xx * b.xx + a.xy * b.xy + a.xz * b.xz, a.xx * b.xy + a.xy * b.yy + a.xz * b.yz,
            a.xx * b.xz + a.xy * b.yz + a.xz * b.zz, a.xy * b.xy + a.yy * b.yy + a.yz * b.yz,
            a.xy * b.xz + a.yy * b.yz + a.yz * b.zz, a.xz * b.xz + a.yz * b.yz + a.zz * b.zz};
}
/// a * transpose(b), symmetric: its upper triangle.
template <class R>
constexpr BasicSym3<R> symmetric_product(const BasicMat3<R>& a, const BasicMat3<R>& b) noexcept {
    return {dot(a.x, b.x), dot(a.x, b.y), dot(a.x, b.z),
            dot(a.y, b.y), dot(a.y, b.z), dot(a.z, b.z)};
}
template <class R>
constexpr BasicMat3<R> transposed(const BasicMat3<R>& m) noexcept {
    return {{m.x.x, m.y.x, m.z.x}, {m.x.y, m.y.y, m.z.y}, {m.x.z, m.y.z, m.z.z}};
}

template <class R>
constexpr R determinant(const BasicMat3<R>& m) noexcept {
    return dot(m.x, cross(m.y, m.z));
}
/// By cofactors; m must be regular.
template <class R>
constexpr BasicMat3<R> inverse(const BasicMat3<R>& m) noexcept {
    return (1 / determinant(m)) *
           transposed(BasicMat3<R>{cross(m.y, m.z), cross(m.z, m.x), cross(m.x, m.y)});
}
/// By cofactors; a positive definite matrix, else the result is of no use.
template <class R>
constexpr BasicSym3<R> inverse(const BasicSym3<R>& m) noexcept {
    const R xx = m.yy * m.zz - m.yz * m.yz;
    const R xy = m.xz * m.yz - m.xy * m.zz;
    const R xz = m.xy * m.yz - m.xz * m.yy;
    const R s = 1 / (m.xx * xx + m.xy * xy + m.xz * xz);
    return s * BasicSym3<R>{xx,
                            xy,
                            xz,
                            m.xx * m.zz - m.xz * m.xz,
                            m.xy * m.xz - m.xx * m.yz,
                            m.xx * m.yy - m.xy * m.xy};
}

}  // namespace fairlead
