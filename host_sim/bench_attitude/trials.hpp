#pragma once
// What the attitude filter is tried with: conditions, faults, and what is measured of each.
#include <string>
#include <vector>

#include "host_sim/attitude_run.hpp"

namespace fairlead::sim {

struct Means {
    double total{}, heading{}, inclination{}, worst_inclination{};
    std::size_t not_finite{};
};

/// Mean over recordings of the score of each, from `after_s` past the filter's start.
Means mean_score(const std::vector<Recording>& recordings, AttitudeMode mode,
                 const AttitudeParams& params, const Conditions& conditions = {},
                 double after_s = 0);

/// A way to deliver recordings that the filter ought to bear, and the bound it is held to.
struct Trial {
    std::string name;
    Conditions conditions;
    bool from_movement{false};  // start at the first sample of the movement phase
    double after_s{0};          // score from so long after the start
    double bound_deg{0};        // 0: none
};
std::vector<Trial> trials();
Means run_trial(const std::vector<Recording>& recordings, const Trial& trial);

/// Something breaks for a while, 20 s into the movement.
struct Break {
    std::string name;
    double seconds{};  // it lasts; 0: all the time
    AttitudeParams params;
    void (*spoil)(Sample& sample, const Sample& first){};  // first: as it was when it began
};
std::vector<Break> breaks();
struct BreakErrors {
    Means during, after;  // after: from 20 s past its end
};
BreakErrors run_break(const std::vector<Recording>& recordings, const Break& broken);

/// Normalised error squared over its expectation: 1 where the reported covariance is honest.
struct Honesty {
    double inclination{}, heading{};
};
Honesty honesty(const Recording& recording);

/// Difference between the float and the double filter, degrees RMS over all samples.
double float_against_double(const Recording& recording);

/// Settings of the few constants that matter, for leave-one-out.
std::vector<AttitudeParams> settings_grid();

}  // namespace fairlead::sim
