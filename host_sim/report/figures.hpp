#pragma once
// The figures of a replay's report.
#include <vector>

#include "host_sim/replay/replay.hpp"
#include "host_sim/report/plot.hpp"

namespace fairlead::sim {

std::vector<Figure> figures_of(const Replay& replay);

}  // namespace fairlead::sim
