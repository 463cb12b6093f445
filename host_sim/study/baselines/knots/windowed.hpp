#pragma once
// The published incremental schemes: Balaguer and Gobbetti, "Sketching 3D Animations" (Eurographics
// 1995, sec. 2.2), and Banks's before it. The first curve takes the samples as CONTROL POINTS and
// is then reduced window by window, so nothing bounds the error at the samples: it is measured.
#include "host_sim/study/baselines/knots/spline.hpp"

namespace fairlead::sim {

struct WindowParams {
    std::size_t window{50};    // interior knots in view
    double tolerance{};        // per component
    bool head_anchored{true};  // the first `order` control points of a window stay
    double tail_share{0.25};   // of the tolerance, for its last `order` control points; 1: all
    bool against_first{};      // Banks: compare with the first curve, one removal a window
    std::size_t order{4};
};

/// Control polygon = samples; knots t1 four times, t3 .. t(n-2), tn four times.
Spline samples_as_control_points(const Track& track, std::size_t order = 4);

Spline reduce_windowed(const Spline& first, const WindowParams& params);

}  // namespace fairlead::sim
