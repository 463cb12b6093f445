#pragma once
// What a search sees of a track: components in lattice steps, one sample a tick.
//
// A vector's components are its own. A rotation's are rotation vectors in a chart about an anchor,
// and another anchor gives other samples.
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "fairlead/base/types.hpp"
#include "host_sim/study/baselines/track.hpp"

namespace fairlead::sim::cubics {

/// Samples of one component from a tick on, with their sums for parabolas in O(1).
class Samples {
  public:
    Samples() = default;
    explicit Samples(std::vector<double> x, std::int32_t first = 0);
    double operator[](std::int32_t tick) const {
        return x_[static_cast<std::size_t>(tick - first_)];
    }
    /// The control point at tick t of a uniform spline with knots h apart, by a parabola over
    /// t - h to t + h; behind `known`, from the last samples there.
    double control(std::int32_t t, std::int32_t h, std::int32_t known) const;

  private:
    struct Parabola {
        double value, rate, bend;
    };
    Parabola fit(std::int32_t first, std::int32_t last, double t) const;
    std::int32_t first_{};
    std::vector<double> x_, sum_, sum1_, sum2_;
};

/// The samples of N components about an anchor.
template <std::size_t N>
struct Chart {
    Quat anchor{};
    std::array<Samples, N> x;
};

/// A track, or one axis of it, as a source of charts.
template <std::size_t N>
class Subject {
  public:
    /// Components `first` to first + N - 1 of positions, or the orientations. step: m or rad.
    Subject(const Track& track, std::size_t first, double step);
    bool rotates() const { return track_->channel == Channel::orientation; }
    double step() const { return step_; }
    /// Samples of ticks from `from` and some before, to `to`. A vector ignores the anchor.
    std::shared_ptr<const Chart<N>> chart(const Quat& anchor, std::int32_t from,
                                          std::int32_t to) const;

  private:
    const Track* track_;
    double step_;
    std::shared_ptr<const Chart<N>> all_;  // of a vector
};

/// Rotations in double: of rotation vectors, and back the shorter way.
BasicQuat<double> wide(const Quat& q);
BasicQuat<double> exp_of(const std::array<double, 3>& vector);
std::array<double, 3> log_of(const BasicQuat<double>& q);

}  // namespace fairlead::sim::cubics
