#pragma once
// The figures of a report that tell how the attitude filter fared.
#include <vector>

#include "host_sim/replay/attitude_trace.hpp"
#include "host_sim/report/chart.hpp"

namespace fairlead::sim {

void append_attitude_figures(std::vector<Figure>& figures, const AttitudeTrace& trace,
                             const TimeAxis& axis);

}  // namespace fairlead::sim
