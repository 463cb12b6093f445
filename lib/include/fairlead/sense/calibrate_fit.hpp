#pragma once
// What the fits share: running moments.
#include <cstdint>

#include "fairlead/math/vec.hpp"

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

}  // namespace fairlead
