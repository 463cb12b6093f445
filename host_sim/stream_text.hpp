#pragma once
// The text layouts, one record a line: EuRoC IMU CSV, pose CSV, TUM.
#include <string_view>

#include "host_sim/stream.hpp"

namespace fairlead::sim {

/// Fills the recording line by line; throws BadData with the line number at the first damage,
/// leaving all records before it in place.
void parse_text(std::string_view text, Recording& recording);

}  // namespace fairlead::sim
