#pragma once
// The sensors of one device in files of their own, as loggers of phones write them, as one
// recording.
#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

/// Merges the parts by time: the records are those of the gyroscope; each reading of another sensor
/// goes to the record that is nearest in time, unchanged. What is shifted most and what finds no
/// record is told in the notes. Throws BadData where no part, or more than one, has a gyroscope,
/// where two parts have the same sensor, and where the times do not overlap.
Recording merged(const std::vector<Recording>& parts);

}  // namespace fairlead::sim
