#pragma once
// The binary layouts: .trk and .imu version 1 here, .imu version 2 in imu2.hpp. Little endian, a
// header, fixed records.
#include <string_view>

#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

bool looks_binary(std::string_view bytes);

/// Fills the recording record by record; throws BadData with the byte offset at the first damage,
/// leaving all complete records before it in place.
void parse_binary(std::string_view bytes, const ReadOptions& options, Recording& recording);

/// A backward step of a 32-bit clock of microseconds is one up to this; a larger one is a pause in
/// which the clock has wrapped.
inline constexpr std::uint32_t backward_most_us = 268435456;  // 2^28: 4.5 minutes

}  // namespace fairlead::sim
