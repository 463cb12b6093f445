#pragma once
// Which filters are worth their lag: the settings that no other of their side beats in lag and
// noise at once, and how our side stands against the other.
#include <string>
#include <vector>

#include "host_sim/study/experiments/measure.hpp"

namespace fairlead::sim {

struct Entry {
    std::string family, setting;
    bool ours{};
    Figures figures;
};

struct Point {
    double lag{}, noise{}, error{};
    const Entry* entry{};
};

/// The settings of one side that no other of it beats, by rising lag.
std::vector<Point> frontier(const std::vector<Entry>& entries, bool ours,
                            ChannelFigures Figures::*channel);

/// One point of the rivals' frontier, and what our side offers for it, at no more total error:
/// quietness bought by bending the motion does not count.
struct Match {
    Point rival;
    Point same_lag;    // least noise at no more lag; entry is null where there is none
    Point same_noise;  // least lag at no more noise; likewise
};
std::vector<Match> matches(const std::vector<Entry>& entries, ChannelFigures Figures::*channel);

}  // namespace fairlead::sim
