#pragma once
// Search of one axis for C2 cubics: a beam over the records of a frame.
//
// Each vertex that is kept goes on by all lengths whose interval of third derivatives, running over
// the samples, is not empty. A C2 piece decides more than the samples under it: its control point
// lies h behind its end. So the beam is ordered by bits and by how far the last two control points
// are from those of the samples around them, as far as they are known.
#include <limits>
#include <vector>

#include "host_sim/study/bench_cubics/tables.hpp"

namespace fairlead::sim::cubics {

struct SearchParams {
    std::size_t width{5};        // vertices kept at a record
    std::size_t values{4};       // control points tried for a length
    double control_weight{1.1};  // bits for a control point one step off
    double vertex_weight{0.6};   // the same, of the one at the vertex
    double break_bits{40};       // price of a break, beside what it costs
    double margin_bits{40};      // dearer vertices are dropped
    std::int32_t look{1000};     // ticks that a vertex sees ahead
};

/// Samples of one axis in lattice steps, one a tick, with their sums for parabolas in O(1).
class Samples {
  public:
    explicit Samples(std::vector<double> x);
    std::size_t size() const { return x_.size(); }
    double operator[](std::size_t i) const { return x_[i]; }
    /// The control point at tick t of a uniform spline with knots h apart, by a parabola over
    /// t - h to t + h; behind `known`, from the last samples there.
    double control(std::int32_t t, std::int32_t h, std::int32_t known) const;

  private:
    struct Parabola {
        double value, rate, bend;
    };
    Parabola fit(std::int32_t first, std::int32_t last, double t) const;
    std::vector<double> x_, sum_, sum1_, sum2_;
};

/// Pieces from `start`, at tick `from`, to tick `to`. known: the last tick whose sample may be
/// looked at. radius: tolerance in steps. @return in order; there always are some.
std::vector<Piece> search(const Samples& samples, const State& start, std::int32_t from,
                          std::int32_t to, std::int32_t known, double radius, const Costs& costs,
                          const SearchParams& params);

}  // namespace fairlead::sim::cubics
