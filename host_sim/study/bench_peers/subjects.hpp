#pragma once
// What the rivals are compared on: the 13 optical recordings, cut to their longest clean run of at
// most 60 s per channel, and generated motions with jumps, rests and teleports.
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/study/baselines/track.hpp"

namespace fairlead::sim {

/// One channel of one recording at one tolerance.
struct Cell {
    Track track;
    double tolerance{};  // m or rad
    bool coarse{};       // 5 mm / 1 deg, else 1 mm / 0.25 deg
    bool generated{};
    std::string label() const;      // "11 position 1 mm"
    std::string file_name() const;  // of the cut recording
};

constexpr std::array<std::size_t, 3> delays{60, 120, 240};

std::string tolerance_name(Channel channel, bool coarse);
double tolerance_of(Channel channel, bool coarse);

/// Calls `visit` for every cell, recordings first, in the order of their names. `folder` holds the
/// .trk files; where it is absent one line says so and the generated motions alone are visited.
/// Only subjects whose name contains `only` are visited. The cut recordings are written to
/// `cut_folder`, one .trk a channel.
void for_each_cell(const std::string& folder, const std::string& cut_folder,
                   const std::string& only, const std::function<void(const Cell&)>& visit);

}  // namespace fairlead::sim
