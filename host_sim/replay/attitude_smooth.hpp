#pragma once
// Orientation of a whole recording, with what comes before and after every sample: for analysis on
// the host. The filter of the board runs forward and backward in double, each from what the other
// has found of the gyro, and the two are weighted by their variances.
#include <vector>

#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/attitude_state.hpp"
#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

/// One estimate for every sample that the intake lets pass and that both directions can tell.
/// mode: imu or imu_mag (heading is relative to the forward filter's start without a magnetometer);
/// throws BadSpec for gyro alone.
std::vector<Pose> smooth_attitude(const Recording& recording, AttitudeMode mode,
                                  const AttitudeParams& params = {});

}  // namespace fairlead::sim
