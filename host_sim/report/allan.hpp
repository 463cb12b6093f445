#pragma once
// Allan deviation of a sensor at rest, and the noise figures that are read off it.
#include <cstddef>
#include <vector>

namespace fairlead::sim {

struct AllanPoint {
    double tau_s{}, deviation{};
};

/// Overlapping Allan deviation [IEEE Std 952] at about ten taus a decade, up to a third of the
/// data.
std::vector<AllanPoint> allan_deviation(const std::vector<double>& values, double period_s);

struct AllanFigures {
    // white noise, N of the standard, unit/sqrt(Hz): sqrt(tau) times the deviation, short taus. A
    // data sheet's one-sided density is sqrt(2) of it.
    double density{};
    double instability{};  // the least deviation over sqrt(2 ln 2 / pi)
    double instability_tau_s{};
    double walk{};  // rate random walk, unit/sqrt(s): from the longest taus; 0: not seen
};
AllanFigures allan_figures(const std::vector<AllanPoint>& points);

/// [first, last) of the longest stretch in which every value stays within `limit` of the mean of
/// its second.
struct Stretch {
    std::size_t first{}, last{};
};
Stretch longest_rest(const std::vector<double>& values, double period_s, double limit);

}  // namespace fairlead::sim
