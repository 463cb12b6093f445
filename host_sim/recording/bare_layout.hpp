#pragma once
// Text without names: the one known layout that fits the numbers.
#include "host_sim/recording/layout.hpp"
#include "host_sim/recording/table.hpp"

namespace fairlead::sim {

/// The one known layout that the numbers fit, by the size of gravity, the length of quaternions and
/// the steps of time; `notes` says which. Throws BadData with the choices where none or several
/// fit.
Layout bare_layout(const Table& table, const Evidence& evidence, const ReadOptions& options);

}  // namespace fairlead::sim
