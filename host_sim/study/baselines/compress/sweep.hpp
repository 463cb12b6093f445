#pragma once
// Every byte rival over its settings: the best that keeps the tolerance, and all that were tried.
#include <string>
#include <vector>

#include "host_sim/study/baselines/compress/coder.hpp"

namespace fairlead::sim {

struct Tried {
    std::string rival, setting;
    std::size_t bytes{};  // of the whole track
    bool within{};        // error checked on the decoded values
};

/// In a fixed order, rivals one after another, at least 20 settings each.
std::vector<Tried> sweep(const Track& track, double tolerance, std::size_t delay);

}  // namespace fairlead::sim
