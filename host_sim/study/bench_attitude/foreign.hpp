#pragma once
// Other people's devices and motions: recordings of a folder, and simulations whose plans and seeds
// stand in foreign.cpp. Ours beside the filters that everybody knows, constant heading offset of
// each removed.
#include <string>
#include <vector>

#include "fairlead/sense/attitude_params.hpp"
#include "host_sim/study/bench_attitude/simulated.hpp"

namespace fairlead::sim {

std::vector<SimPlan> foreign_plans();

/// The .imu files of a folder, by name; a magnetometer of exactly zero, or not finite, is none.
std::vector<Recording> read_imu_folder(const std::string& folder);

/// One line a recording and estimator set, as a table.
std::string foreign_recordings(const std::string& folder, const AttitudeParams& params);
std::string foreign_simulations(const AttitudeParams& params);

/// The simulations that know their speed: with and without the speed input, total/inclination.
std::string foreign_speed(const AttitudeParams& params);

}  // namespace fairlead::sim
