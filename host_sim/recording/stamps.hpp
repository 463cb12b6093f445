#pragma once
// Times for records that have none: from a rate, or from a file with one time a line (as KITTI
// has).
#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

/// Throws BadData where the file of times does not have one for each record.
void give_times(const ReadOptions& options, Recording& recording);

}  // namespace fairlead::sim
