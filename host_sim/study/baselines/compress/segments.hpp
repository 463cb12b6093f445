#pragma once
// Rivals that code pieces: swing filter, swinging door (SDT), Ramer-Douglas-Peucker, dead band;
// each with adaptive Rice codes for lengths and values.
//
// All work in a closed loop on decoded values, so quantisation costs no tolerance but in
// Ramer-Douglas-Peucker, which fixes its vertices before they are rounded. Where the delay bound
// strikes inside a piece, the piece is cut there; complete pieces leave together with it.
#include "host_sim/study/baselines/compress/coder.hpp"

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

struct Segment {
    std::size_t end{};  // its last record
    GridSteps n{};      // grid steps from the value it starts with to its end, or to its constant
};

/// What leaves together, before it is coded.
struct PlannedFrame {
    std::size_t sent_at{};
    bool restart{};
    std::size_t
        first{};  // record of the restart, or of the vertex that the first piece starts from
    std::vector<Segment> segments;
};

/// Where the pieces end. Depends on slope_share only where a swing filter chooses near the
/// prediction, and never on by_length.
std::vector<PlannedFrame> plan(const Track& track, double tolerance, const SegmentParams& params,
                               std::size_t delay);
std::vector<Frame> code(const std::vector<PlannedFrame>& planned, const Track& track,
                        double tolerance, const SegmentParams& params);

std::vector<Frame> encode(const Track& track, double tolerance, const SegmentParams& params,
                          std::size_t delay);
std::vector<State> decode(const std::vector<Frame>& frames, const Track& track, double tolerance,
                          const SegmentParams& params);

}  // namespace fairlead::sim
