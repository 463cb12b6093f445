#pragma once
// What the attitude filter is tried with: conditions, faults, and what is measured of each.
#include <string>
#include <vector>

#include "host_sim/replay/attitude_run.hpp"

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

/// Is the reported covariance honest? Errors squared over the reported variance: 1 is expected.
struct Honesty {
    double inclination{}, heading{};  // mean over the movement phase
    double inclination_at_rest{};     // before and after it
    double seconds{};                 // of the movement
    std::vector<double> heading_z;    // heading error over its sigma, every look_s of the movement
    static constexpr double look_s = 0.1;
};
Honesty honesty(const Recording& recording);

/// How often |z| < limit, over all.
double share_within(const std::vector<Honesty>& all, double limit);

/// Heading errors wander slowly, so that a recording holds only few independent ones.
struct Independence {
    double correlation_s{};      // their autocorrelation falls to 1/e within it
    double draws{};              // independent ones in a recording of mean length
    double lowest{}, highest{};  // 95 % of the recordings' means of an honest filter lie between
    double mean_lowest{}, mean_highest{};  // and of the mean over all of them
};
Independence independence(const std::vector<Honesty>& all);

/// Difference between the float and the double filter, degrees RMS over all samples.
double float_against_double(const Recording& recording);

/// Settings of the few constants that matter, for leave-one-out.
std::vector<AttitudeParams> settings_grid();

}  // namespace fairlead::sim
