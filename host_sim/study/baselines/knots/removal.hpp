#pragma once
// Knot removal in the sense of Lyche and Morken (IMA J. Numer. Anal. 8, 1988): rank the interior
// knots, remove as many of the least important ones as the tolerance allows, approximate on what is
// left, and begin again. Any order up to 6, any dimension.
#include <functional>

#include "host_sim/study/baselines/knots/spline.hpp"

namespace fairlead::sim {

/// How far the curve must move, at least, for knot i to become superfluous: the smallest largest
/// change of a coefficient, over all components. Only the last of equal knots has a weight.
double knot_weight(const Spline& spline, std::size_t i);

/// Interior knot indices in the order of removal: by classes of weight that double, and within a
/// class first such that no two neighbours go.
std::vector<std::size_t> removal_order(const Spline& spline, double tolerance);

/// Fits a curve on the given knots; false where it misses its tolerance.
using Approximate = std::function<bool(const std::vector<double>& knots, Spline& out)>;

struct RemovalParams {
    double tolerance{};
    std::size_t rounds_max{40};
    bool one_by_one{};  // at the end also try every knot alone until none can go
};

/// `start` must be a curve that is within its tolerance.
Spline remove_knots(Spline start, const Approximate& approximate, const RemovalParams& params);

/// Reduction of `f` against `f` itself: least squares over its coefficients, checked on them, which
/// bounds the distance of the curves everywhere.
Spline reduce_curve(const Spline& f, double tolerance);

/// The published way from samples: linear interpolant reduced at share * tolerance, elevated to
/// `order`, reduced again with the rest. `tolerance` holds for each component.
Spline lyche_morken(const Track& track, std::size_t order, double tolerance, double share);

/// The same three steps checked where it counts, at the samples; fits are pulled towards the
/// largest error (Lawson weights) before a knot is kept. From a dense least squares spline with a
/// knot at every second sample, and from the published way's result: the better of the two.
Spline global_removal(const Track& track, std::size_t order, double tolerance);

}  // namespace fairlead::sim
