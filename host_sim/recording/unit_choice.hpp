#pragma once
// The units of a text file's columns: what the header or --units says; where neither does, the one
// unit that fits the numbers, or a refusal with the choices.
#include "host_sim/recording/layout.hpp"

namespace fairlead::sim {

/// Settles the unit of every column that is used. Throws BadData where nothing settles it and
/// BadSpec where --units is wrong.
void settle_units(Layout& layout, const Evidence& evidence, const ReadOptions& options);

}  // namespace fairlead::sim
