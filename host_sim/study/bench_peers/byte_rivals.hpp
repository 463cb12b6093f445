#pragma once
// Bytes of the rivals that code every sample or piece, over all settings, kept in the cache.
#include <vector>

#include "host_sim/study/baselines/compress/sweep.hpp"
#include "host_sim/study/bench_peers/cache.hpp"
#include "host_sim/study/bench_peers/subjects.hpp"

namespace fairlead::sim {

std::vector<Tried> byte_rivals(const Cell& cell, std::size_t delay, Cache& cache);

/// The best setting of every rival, in the order of the sweep.
std::vector<Tried> best_of_each(const std::vector<Tried>& all);

}  // namespace fairlead::sim
