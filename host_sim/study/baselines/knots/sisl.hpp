#pragma once
// libsisl, the public implementation of Lyche and Morken's data reduction, as a yardstick.
//
// Two ways in: s1961 (piecewise linear interpolant reduced, elevated, reduced again; parameter =
// time; the share of the tolerance for the first stage is 0 or 0.1) and s1940 on the cubic
// interpolant of the samples. At most 20 rounds each. Both may leave their tolerance or abort on
// some data, so each call runs in a child process and its error is measured here, at the samples.
#include "host_sim/study/baselines/knots/spline.hpp"

namespace fairlead::sim {

enum class SislMethod { s1961, s1961_shared, s1940 };
constexpr SislMethod sisl_methods[] = {SislMethod::s1961, SislMethod::s1961_shared,
                                       SislMethod::s1940};
const char* to_string(SislMethod method);

/// Control points and true error; no control points where the library failed.
struct SislResult {
    std::size_t control_points{};
    double error{};
};

/// One call with `tolerance` for every component.
SislResult sisl(const Track& track, SislMethod method, double tolerance);

}  // namespace fairlead::sim
