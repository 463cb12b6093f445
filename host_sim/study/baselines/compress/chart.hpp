#pragma once
// Positions and orientations as the byte rivals code them: both move by 3 numbers. A position moves
// by a vector, an orientation by a rotation vector in its own frame, so steps are small near any
// attitude, there is no wrap-around, and a quantised step errs alike in all directions.
#include <array>

#include "host_sim/study/baselines/compress/rice.hpp"
#include "host_sim/study/baselines/track.hpp"

namespace fairlead::sim {

using State = std::array<double, 4>;    // x y z 0, or w x y z
using Step = std::array<double, 3>;     // m, or rad
using GridSteps = std::array<long, 3>;  // the same in units of a grid

struct Chart {
    Channel channel{};

    Step difference(const State& from, const State& to) const;
    State moved(const State& from, const Step& by) const;
    State sample(const Track& track, std::size_t i) const;
};

Step scaled(const GridSteps& n, double grid);
GridSteps rounded(const Step& step, double grid);

/// What a restart sends: the record's number (16 bits) and a value that stands alone, positions on
/// a grid, orientations as their smallest three components, so fine that it errs by less than
/// `error_max`.
class Absolute {
  public:
    Absolute(const Track& track, double error_max);
    void put(std::vector<Symbol>& out, std::size_t record, const State& value) const;
    State get(const Symbol*& next) const;  // moves past the symbols of one restart

  private:
    Channel channel_{};
    double grid_{};
    unsigned bits_{};  // of one component; the reach of positions is known from the header
};

}  // namespace fairlead::sim
