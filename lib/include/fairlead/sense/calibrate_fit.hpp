#pragma once
// What the fits share: running moments, and the inverse of a 3 x 3 matrix.
#include <cstdint>

#include "fairlead/sense/matrix3.hpp"

namespace fairlead {

/// Mean and variance of a stream of vectors in one pass [Welford 1962]. Cost: constant.
class Moments {
  public:
    void push(const Vec3& v) noexcept {
        ++count_;
        const Vec3 step = v - mean_;
        mean_ += (1 / static_cast<float>(count_)) * step;
        const Vec3 rest = v - mean_;
        sum2_ += Vec3{step.x * rest.x, step.y * rest.y, step.z * rest.z};
    }
    void reset() noexcept { *this = {}; }

    std::uint32_t count() const noexcept { return count_; }
    Vec3 mean() const noexcept { return mean_; }
    /// Standard deviation of one sample: the largest of the three axes.
    float deviation() const noexcept {
        if (count_ < 2) return 0;
        const float most = sum2_.x > sum2_.y ? (sum2_.x > sum2_.z ? sum2_.x : sum2_.z)
                                             : (sum2_.y > sum2_.z ? sum2_.y : sum2_.z);
        return approx::sqrt(most / static_cast<float>(count_ - 1));
    }

  private:
    Vec3 mean_{}, sum2_{};
    std::uint32_t count_{0};
};

template <class Real>
constexpr Real determinant(const Matrix3<Real>& m) noexcept {
    return dot(m.x, cross(m.y, m.z));
}

/// By cofactors; m must be regular.
template <class Real>
constexpr Matrix3<Real> inverse(const Matrix3<Real>& m) noexcept {
    const Real by = 1 / determinant(m);
    const BasicVec3<Real> a = cross(m.y, m.z), b = cross(m.z, m.x), c = cross(m.x, m.y);
    return {{by * a.x, by * b.x, by * c.x},
            {by * a.y, by * b.y, by * c.y},
            {by * a.z, by * b.z, by * c.z}};
}

}  // namespace fairlead
