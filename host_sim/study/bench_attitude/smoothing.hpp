#pragma once
// What the future is worth: the filter of the board, the same with fixed lags, and the whole
// recording forward and backward.
#include <string>

namespace fairlead::sim {

/// Tables over the recordings of a folder and of its subfolder foreign; empty without recordings.
std::string smoothing_table(const std::string& folder);

}  // namespace fairlead::sim
