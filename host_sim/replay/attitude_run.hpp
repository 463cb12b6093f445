#pragma once
// The attitude filter over a recording, as it was or under conditions, and the score of the result.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/attitude_state.hpp"
#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

struct DropPlan {
    double rate{0};  // share of the samples that is lost
    int burst{1};    // in runs of so many
    std::uint64_t seed{1};
};

/// What happens to a recording on its way to the filter.
struct Conditions {
    DropPlan drop;
    double rate_error{0};  // 0.01: the time stamps say 1 % more than is true
    int every{1};          // keep one sample of so many
    double start_s{0};     // from the recording's start
    std::function<void(Sample&, double t_s)> spoil;  // t_s: from the recording's start
};

/// imu_mag where any sample has a magnetometer reading, else imu.
AttitudeMode all_sensors(const Recording& recording);

/// One estimate per sample that reached the filter, at the recording's own time stamps. Samples
/// pass an Intake first. No knowledge of the reference.
std::vector<Pose> run_attitude(const Recording& recording, AttitudeMode mode,
                               const AttitudeParams& params = {},
                               const Conditions& conditions = {});

/// e = estimate * conj(truth) in the world frame, taken apart as in Score; heading is signed. Rad.
struct OrientationError {
    double total{}, heading{}, inclination{};
};
OrientationError orientation_error(const Quat& estimate, const Quat& truth);

struct Score {
    double total_deg{}, heading_deg{}, inclination_deg{};  // root mean squares
    double worst_inclination_deg{};
    std::size_t count{}, not_finite{};
};

/// The data set's own score [Laidig et al. 2021]: over samples of the movement phase with a valid
/// reference, e = estimate * conj(reference) in the world frame; total = 2 acos|e.w|, heading =
/// 2 atan|e.z / e.w|, inclination = 2 acos sqrt(e.w^2 + e.z^2). Only times in [from_s, to_s).
Score score(const Recording& recording, const std::vector<Pose>& estimate, double from_s = -1e9,
            double to_s = 1e9);

/// What a score leaves out: a constant heading offset (a reference that is level but not
/// north-aligned), or a constant rotation between the reference's world and the estimate's.
enum class Align : std::uint8_t { none, heading, rotation };

/// The estimate with its own constant offset to the reference removed, over the samples that
/// score() counts. Heading: a robust circular mean; rotation: the mean quaternion [Markley 2007].
std::vector<Pose> aligned(const Recording& recording, std::vector<Pose> estimate, Align align,
                          double from_s = -1e9, double to_s = 1e9);

/// Start of the movement phase, s from the recording's start.
double movement_start_s(const Recording& recording);

/// Estimates as `t_ns,qw,qx,qy,qz` with 9 significant digits, and back.
std::string to_estimate_csv(const std::vector<Pose>& estimate);
std::vector<Pose> parse_estimate_csv(const std::string& text, const std::string& name);

}  // namespace fairlead::sim
