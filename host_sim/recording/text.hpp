#pragma once
// Text recordings, one record a line: CSV of any separator with a header, TUM, EuRoC, KITTI.
#include <string_view>

#include "host_sim/recording/columns.hpp"
#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

/// Fills the recording line by line; throws BadData with line and column at the first damage,
/// leaving all records before it in place. `sensor_hint`: what columns named x, y, z measure.
void parse_text(std::string_view bytes, const ReadOptions& options, Role sensor_hint,
                Recording& recording);

}  // namespace fairlead::sim
