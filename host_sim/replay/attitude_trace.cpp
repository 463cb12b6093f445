#include "host_sim/replay/attitude_trace.hpp"

#include <optional>

#include "fairlead/math/quat.hpp"

namespace fairlead::sim {
namespace {

/// Of e = estimate * conj(truth), the part that the mode cannot know.
Quat unknowable(const Quat& e, AttitudeMode mode) {
    if (mode == AttitudeMode::gyro) return e;
    if (mode == AttitudeMode::imu) return normalised(Quat{e.w, 0, 0, e.z});
    return {};
}

}  // namespace

void add_errors(AttitudeTrace& trace, const Recording& recording,
                const std::vector<Pose>& estimate) {
    if (recording.truth.size() != recording.samples.size()) return;
    std::optional<Quat> zero;
    std::size_t at = 0;
    for (std::size_t i = 0; i < trace.points.size() && i < estimate.size(); ++i) {
        AttitudePoint& point = trace.points[i];
        while (at < recording.truth.size() && recording.truth[at].t_ns < point.t_ns) ++at;
        if (at == recording.truth.size()) return;
        const Pose& truth = recording.truth[at];
        if (truth.t_ns != point.t_ns || (truth.flags & flag::orientation_valid) == 0) continue;
        if ((estimate[i].flags & flag::orientation_valid) == 0) continue;
        if (!zero) zero = unknowable(estimate[i].q_wb * conj(truth.q_wb), trace.mode);
        const auto error = orientation_error(conj(*zero) * estimate[i].q_wb, truth.q_wb);
        point.turn_error = error.total;
        point.inclination_error = error.inclination;
        point.heading_error = error.heading;
        trace.has_truth = true;
    }
}

}  // namespace fairlead::sim
