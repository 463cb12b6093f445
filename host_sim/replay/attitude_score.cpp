#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "fairlead/math/quat.hpp"
#include "host_sim/replay/attitude_run.hpp"

namespace fairlead::sim {

namespace {

constexpr double rad_to_deg = 57.295779513082320877;

/// Calls use(pose, truth) for every estimate that a score counts.
template <class Use>
void each_scored(const Recording& recording, const std::vector<Pose>& estimate, double from_s,
                 double to_s, Use use) {
    if (recording.truth.size() != recording.samples.size() || recording.truth.empty())
        throw BadData(recording.name + ": holds no reference orientation");
    std::size_t i = 0;
    const std::int64_t t0 = recording.samples.front().t_ns;
    for (const Pose& pose : estimate) {
        while (i < recording.samples.size() && recording.samples[i].t_ns < pose.t_ns) ++i;
        if (i == recording.samples.size()) break;
        if (recording.samples[i].t_ns != pose.t_ns) continue;
        const double t_s = static_cast<double>(pose.t_ns - t0) * 1e-9;
        const bool moving = i < recording.moving.size() && recording.moving[i] != 0;
        if (!moving || (recording.truth[i].flags & flag::orientation_valid) == 0) continue;
        if (t_s >= from_s && t_s < to_s) use(pose, recording.truth[i]);
    }
}

BasicQuat<double> wide(const Quat& q) {
    return {static_cast<double>(q.w), static_cast<double>(q.x), static_cast<double>(q.y),
            static_cast<double>(q.z)};
}

double wrapped(double angle) { return std::remainder(angle, 2 * pi_v<double>); }

/// Mean of angles: the circular mean, then the mean of what is left about it.
double mean_angle(const std::vector<double>& angles) {
    double s = 0, c = 0;
    for (const double a : angles) {
        s += std::sin(a);
        c += std::cos(a);
    }
    double mean = std::atan2(s, c);
    for (int pass = 0; pass < 5; ++pass) {
        double left = 0;
        for (const double a : angles) left += wrapped(a - mean);
        mean = wrapped(mean + left / static_cast<double>(angles.size()));
    }
    return mean;
}

/// Largest eigenvector of the sum of q q', by squaring the matrix.
BasicQuat<double> mean_rotation(const std::vector<BasicQuat<double>>& turns) {
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    for (const auto& q : turns) {
        const Eigen::Vector4d v{q.w, q.x, q.y, q.z};
        sum += v * v.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver{sum};
    const Eigen::Vector4d v = solver.eigenvectors().col(3);
    return {v[0], v[1], v[2], v[3]};
}

}  // namespace

OrientationError orientation_error(const Quat& estimate, const Quat& truth) {
    const BasicQuat<double> e = wide(estimate) * conj(wide(truth));
    return {2 * std::acos(std::min(1.0, std::abs(e.w))),
            2 * std::atan2(std::copysign(1.0, e.w) * e.z, std::abs(e.w)),
            2 * std::acos(std::min(1.0, std::hypot(e.w, e.z)))};
}

std::vector<Pose> aligned(const Recording& recording, std::vector<Pose> estimate, Align align,
                          double from_s, double to_s) {
    if (align == Align::none) return estimate;
    std::vector<double> headings;
    std::vector<BasicQuat<double>> turns;
    each_scored(recording, estimate, from_s, to_s, [&](const Pose& pose, const Pose& truth) {
        const BasicQuat<double> e = wide(pose.q_wb) * conj(wide(truth.q_wb));
        if (!is_finite(e)) return;
        headings.push_back(2 * std::atan2(std::copysign(1.0, e.w) * e.z, std::abs(e.w)));
        turns.push_back(e);
    });
    if (headings.empty()) return estimate;
    const BasicQuat<double> offset =
        align == Align::rotation
            ? mean_rotation(turns)
            : from_rotation_vector(BasicVec3<double>{0, 0, mean_angle(headings)});
    for (Pose& pose : estimate) {
        const BasicQuat<double> q = normalised(conj(offset) * wide(pose.q_wb));
        if (!is_finite(pose.q_wb)) continue;
        pose.q_wb = {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
                     static_cast<float>(q.z)};
    }
    return estimate;
}

Score score(const Recording& recording, const std::vector<Pose>& estimate, double from_s,
            double to_s) {
    Score out;
    each_scored(recording, estimate, from_s, to_s, [&](const Pose& pose, const Pose& truth) {
        const OrientationError e = orientation_error(pose.q_wb, truth.q_wb);
        if (!std::isfinite(e.total + e.heading + e.inclination)) {
            ++out.not_finite;
            return;
        }
        out.total_deg += e.total * e.total;
        out.heading_deg += e.heading * e.heading;
        out.inclination_deg += e.inclination * e.inclination;
        out.worst_inclination_deg = std::max(out.worst_inclination_deg, rad_to_deg * e.inclination);
        ++out.count;
    });
    const auto n = static_cast<double>(std::max<std::size_t>(out.count, 1));
    out.total_deg = rad_to_deg * std::sqrt(out.total_deg / n);
    out.heading_deg = rad_to_deg * std::sqrt(out.heading_deg / n);
    out.inclination_deg = rad_to_deg * std::sqrt(out.inclination_deg / n);
    return out;
}

}  // namespace fairlead::sim
