#pragma once
// report.html: one self-contained page about a replay.
#include <string>

#include "host_sim/replay.hpp"

namespace fairlead::sim {

/// The whole page. Without gnuplot the tables stand alone, and the page says so.
std::string report_page(const Replay& replay);

}  // namespace fairlead::sim
