#pragma once
// How many records of a recording the intake does not take whole.
#include <cstddef>

#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

/// Records that the intake refuses, or of which it refuses a channel.
std::size_t refused_records(const Recording& recording);

}  // namespace fairlead::sim
