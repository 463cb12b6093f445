#pragma once
// report.html: one self-contained page about a replay, to be explored in a browser without network.
#include <string>

#include "host_sim/replay/replay.hpp"

namespace fairlead::sim {

/// The whole page: figures in words, charts that move together, the body in 3D, a table.
std::string report_page(const Replay& replay);

}  // namespace fairlead::sim
