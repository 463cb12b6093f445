#pragma once
// The two binary layouts, .imu and .trk: little endian, a header of 64 bytes, fixed records.
#include <string_view>

#include "host_sim/stream.hpp"

namespace fairlead::sim {

bool looks_binary(std::string_view bytes);

/// Fills the recording record by record; throws BadData with the byte offset at the first damage,
/// leaving all complete records before it in place.
void parse_binary(std::string_view bytes, Recording& recording);

}  // namespace fairlead::sim
