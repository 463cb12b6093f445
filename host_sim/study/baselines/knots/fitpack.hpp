#pragma once
// A smoothing spline in the manner of FITPACK's parcur (Dierckx, Computer Graphics and Image
// Processing 20, 1982), written anew: knots are added where the squared residuals are largest until
// their sum falls below s; then the jumps of the highest derivative are damped until the sum equals
// s. s itself is not what a user knows, so it is found by bisection on the largest error.
#include "host_sim/study/baselines/knots/spline.hpp"

namespace fairlead::sim {

/// The smoothing spline of order 4 for the sum of squares s.
Spline smoothing_spline(const Track& track, double s);

/// The one with the fewest control points within `tolerance` that a bisection on s meets.
Spline smoothing_within(const Track& track, double tolerance);

}  // namespace fairlead::sim
