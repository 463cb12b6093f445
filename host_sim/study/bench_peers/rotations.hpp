#pragma once
// The same turning motion in other frames: by how much do its figures change, and by how much where
// only the last digit of its samples does?
#include <string>
#include <vector>

#include "host_sim/study/bench_peers/ours.hpp"

namespace fairlead::sim {

/// Changes of a figure over a number of runs, in parts of what the recording as it is takes.
struct Spread {
    double mean{}, rms{}, worst{};
};

struct RotationResult {
    std::string name;
    bool coarse{};
    std::size_t control_points{}, bytes{};  // of the recording as it is
    Spread turned_points, turned_bytes;     // random world and body frames
    Spread digit_points, digit_bytes;       // as it is, but for noise of 1e-7
};

constexpr int rotations = 20;

/// An orientation cell in `rotations` other frames, at a delay of 120 and the medium beam.
std::optional<RotationResult> in_other_frames(const Cell& cell, const Program& program);

std::string to_markdown(const std::vector<RotationResult>& results);

}  // namespace fairlead::sim
