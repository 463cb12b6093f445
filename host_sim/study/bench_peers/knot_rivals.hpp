#pragma once
// Control points of the rivals that reduce knots with the whole recording in hand.
#include <string>
#include <vector>

#include "host_sim/study/bench_peers/cache.hpp"
#include "host_sim/study/bench_peers/subjects.hpp"

namespace fairlead::sim {

struct KnotResult {
    std::string method;
    std::size_t control_points{};  // 0: the method failed
    double error{};                // largest true error over the tolerance
};

constexpr const char* sisl_name = "libsisl";

/// libsisl as the yardstick is defined in docs/peers.md: positions as given, orientations tuned.
KnotResult sisl_yardstick(const Cell& cell, Cache& cache);

/// The yardstick first, then every other method.
std::vector<KnotResult> knot_rivals(const Cell& cell, Cache& cache);

}  // namespace fairlead::sim
