#pragma once
// What is odd about a recording that was read without an error: units that cannot be meant,
// sensors that read nothing, quaternions in another order. Each with the option that may mend it.
#include <string>
#include <vector>

#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

/// One sentence each; empty: nothing is odd.
std::vector<std::string> doubts(const Recording& recording, const Steps& progress = {});

}  // namespace fairlead::sim
