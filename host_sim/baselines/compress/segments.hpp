#pragma once
// Rivals that code pieces: swing filter, swinging door (SDT), Ramer-Douglas-Peucker, dead band;
// each with adaptive Rice codes for lengths and values.
//
// All work in a closed loop on decoded values, so quantisation costs no tolerance but in
// Ramer-Douglas-Peucker, which fixes its vertices before they are rounded. Where the delay bound
// strikes inside a piece, the piece is cut there; complete pieces leave together with it.
#include "host_sim/baselines/compress/coder.hpp"

namespace fairlead::sim {

enum class Pieces {
    swing,     // a line from the last vertex, its end free within the tolerance of all samples
    door,      // a line from the last vertex to a sample
    peucker,   // lines between samples chosen by splitting at the worst sample
    dead_band  // a constant
};

enum class Choice {   // of one number where several are within the tolerance
    near_prediction,  // fewest bits now
    least_squares     // dead band: the middle; door, peucker: always the sample
};

struct SegmentParams {
    Pieces pieces{};
    double grid_share{1};  // of the grid of the rivals that code every sample
    Choice choice{};
    double slope_share{};  // the next slope is predicted as this much of the last
    bool by_length{};      // entropy states of values by the piece's length
};

std::vector<Frame> encode(const Track& track, double tolerance, const SegmentParams& params,
                          std::size_t delay);
std::vector<State> decode(const std::vector<Frame>& frames, const Track& track, double tolerance,
                          const SegmentParams& params);

}  // namespace fairlead::sim
