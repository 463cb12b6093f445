#pragma once
// Every causal filter that `compare` sweeps: ours and the rivals, each family at 20 settings or
// more.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/study/baselines/filters/filters.hpp"

namespace fairlead::sim {

struct Candidate {
    std::string family, setting;
    bool ours{};
    std::function<std::unique_ptr<CausalFilter>()> make;
};

/// For a stream of the given nominal step.
std::vector<Candidate> candidates(double step_s);

}  // namespace fairlead::sim
