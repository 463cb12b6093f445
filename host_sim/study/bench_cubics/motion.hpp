#pragma once
// Errors of a decoded track: of its values, and of what a reader gets who differentiates.
//
// Velocity is the difference of neighbouring values, acceleration that of neighbouring velocities.
// They are compared with the same differences of the samples, averaged over 9 of them: that takes
// the noise of the samples out, which a curve within a tolerance need not follow. Where a motion
// was generated, its true velocity and acceleration are compared instead.
#include <vector>

#include "host_sim/study/baselines/track.hpp"

namespace fairlead::sim::cubics {

/// Root mean square and largest, in m (or rad) a second, or a second squared.
struct MotionError {
    double rms{}, most{};
};
struct MotionErrors {
    MotionError velocity, acceleration;
};

/// decoded: dim() numbers a record, as the track's. truth: values without noise, of the same
/// records; empty: averages of 9 samples.
MotionErrors motion_errors(const Track& track, const std::vector<double>& decoded,
                           const std::vector<double>& truth = {});

}  // namespace fairlead::sim::cubics
