#pragma once
// The attitude filter's parameters by name, for command lines: `--set velocity_m_s=3`.
#include <string>
#include <vector>

#include "fairlead/sense/attitude_params.hpp"

namespace fairlead::sim {

/// Names of all parameters, in the order of AttitudeParams.
std::vector<std::string> attitude_setting_names();

/// Applies `name=value` items. Throws BadSpec for an unknown name, or a value that
/// is no number or out of its range.
void apply_settings(AttitudeParams& params, const std::vector<std::string>& items);

}  // namespace fairlead::sim
