#pragma once
// A track of positions as frames of C2 cubics, read again from their bytes: what the search is
// worth.
//
// Frames as in docs/stream.md, cut to what their size depends on: 3 bytes a frame, a restart within
// 240 records with 8 bits of time and the values of c1; each axis in turn.
#include <string>

#include "host_sim/study/baselines/track.hpp"
#include "host_sim/study/bench_cubics/search.hpp"

namespace fairlead::sim::cubics {

struct StreamParams {
    std::int32_t delay{120};     // records that a sample may wait
    std::int32_t look_ahead{4};  // of these, records behind a frame's end that its search knows
    std::int32_t restart{240};   // records
    double step{1.35};           // lattice step over tolerance
    SearchParams search{};
};

struct Result {
    std::size_t bytes{}, pieces{}, breaks{};
    double error{};     // largest, over the tolerance, of the curve as decoded
    double velocity{};  // error against means of 9 samples, root mean square, m/s
    double seam{};      // largest move of p where a state is set at a restart, over the tolerance
    std::string fault;  // empty: a reader in step and one that joins decode the same
};

/// Encodes and decodes. counts: symbols are added, for training.
Result run(const Track& track, double tolerance, const StreamParams& params, const Costs& costs,
           Counts& counts);

}  // namespace fairlead::sim::cubics
