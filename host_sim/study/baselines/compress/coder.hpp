#pragma once
// What the byte rivals share: when frames must leave, where streams restart, what is checked.
//
// A record i must be decodable from the bytes that left by the arrival of record i + delay. Every
// 2 s a frame begins with an absolute value and fresh entropy states, and no later frame needs an
// earlier restart's. Times cost nothing: the rivals code record numbers of a known, even rate.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "host_sim/study/baselines/compress/chart.hpp"

namespace fairlead::sim {

constexpr std::size_t no_delay_bound = std::numeric_limits<std::size_t>::max();

/// Records from one restart to the next; without a delay bound there is one restart, the start.
inline std::size_t group_size(const Track& track, std::size_t delay) {
    if (delay == no_delay_bound) return track.size();
    return static_cast<std::size_t>(std::lround(2.0 / track.period_s));
}

/// Where the frames of a rival that codes every sample end: equal parts of a group.
struct Schedule {
    std::size_t group{}, frame{};
    Schedule(const Track& track, std::size_t delay)
        : group{group_size(track, delay)}, frame{group} {
        if (delay >= group) return;
        const std::size_t parts = (group + delay) / (delay + 1);
        frame = (group + parts - 1) / parts;
    }
    std::size_t end(std::size_t i, std::size_t n) const {
        const std::size_t in_group = i % group;
        return std::min({n, i - in_group + group, i + frame - in_group % frame});
    }
};

/// Grid of the rivals that code every sample: the coarsest that keeps the tolerance.
inline double finest_error_grid(Channel channel, double tolerance) {
    return (channel == Channel::position ? 2 : 2 / std::sqrt(3.0)) * tolerance * (1 - 1e-9);
}

/// Largest error of decoded values, one per record, in the unit of the track.
inline double largest_error(const Track& track, const std::vector<State>& decoded) {
    double largest = 0;
    for (std::size_t i = 0; i < track.size(); ++i)
        largest = std::max(largest, track.error(i, decoded[i].data()));
    return largest;
}

}  // namespace fairlead::sim
