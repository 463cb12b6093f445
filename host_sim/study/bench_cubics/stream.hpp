#pragma once
// A track as frames of C2 cubics, read again from their bytes: what the search is worth.
//
// Frames as in docs/stream.md, cut to what their size depends on: 3 bytes a frame, a restart within
// 240 records with 8 bits of time and the values of c1, or the anchor of a rotation's run. The axes
// of a position have vertices of their own, or share them; a rotation's components share them.
#include <string>
#include <vector>

#include "host_sim/study/baselines/track.hpp"
#include "host_sim/study/bench_cubics/search.hpp"

namespace fairlead::sim::cubics {

struct StreamParams {
    std::int32_t delay{120};     // records that a sample may wait
    std::int32_t look_ahead{4};  // of these, records behind a frame's end that its search knows
    std::int32_t restart{240};   // records; 0: none but at the start
    double step{1.35};           // lattice step over tolerance
    bool joint{};                // axes of a position share their vertices
    bool rolling{};              // frames end at vertices
    double commit{0.5};          // of a delay, from which on pieces are not committed yet
    SearchParams search{};
};
/// What serves positions and orientations best.
StreamParams usual_params(Channel channel);
/// Few control points: joint vertices, a fine lattice, a price for each piece.
StreamParams knot_params(Channel channel, double piece_bits);

struct Result {
    std::size_t bytes{}, pieces{}, breaks{};
    std::size_t control_points{};  // of the curve as splines of order 4: one, where nothing breaks
    double error{};                // largest, over the tolerance, of the curve as decoded
    double seam{};  // largest move of the curve where its state is set, over the tolerance
    std::vector<double> decoded;  // at each record, as the track's values
    std::string fault;            // empty: a reader in step and one that joins decode the same
};

/// Encodes and decodes. counts: symbols are added, for training.
Result run(const Track& track, double tolerance, const StreamParams& params, const Costs& costs,
           Counts& counts);

}  // namespace fairlead::sim::cubics
