#pragma once
// The data of a page that a person explores: charts, marks, bands and the body's motion.
#include <string>
#include <vector>

#include "host_sim/replay/replay.hpp"
#include "host_sim/report/plot.hpp"

namespace fairlead::sim {

/// The data as a script element; page/report.js draws it. `figures` share the axis of time.
std::string explorer_data(const Replay& replay, const std::vector<Figure>& figures);

/// Style, libraries and scripts; the last part of a page.
std::string explorer_scripts();

}  // namespace fairlead::sim
