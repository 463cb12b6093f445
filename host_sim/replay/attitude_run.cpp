#include "host_sim/replay/attitude_run.hpp"
#include "host_sim/recording/progress.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "fairlead/math/quat.hpp"
#include "fairlead/sense/attitude.hpp"
#include "fairlead/sense/attitude_gyro.hpp"
#include "fairlead/sense/intake.hpp"
#include "host_sim/generate/random.hpp"

namespace fairlead::sim {
namespace {

/// The samples that reach the filter, with the time stamps it sees; `index` tells which they were.
struct Delivered {
    std::vector<Sample> samples;
    std::vector<std::size_t> index;
};

Delivered deliver(const Recording& recording, const Conditions& conditions) {
    Delivered out;
    Random random{conditions.drop.seed};
    const double start_chance = conditions.drop.rate / std::max(1, conditions.drop.burst);
    int lost = 0;
    const std::int64_t t0 = recording.samples.front().t_ns;
    for (std::size_t i = 0; i < recording.samples.size(); ++i) {
        Sample sample = recording.samples[i];
        const double t_s = static_cast<double>(sample.t_ns - t0) * 1e-9;
        if (t_s < conditions.start_s || i % static_cast<std::size_t>(conditions.every) != 0)
            continue;
        if (lost == 0 && conditions.drop.rate > 0 && random.uniform() < start_chance)
            lost = conditions.drop.burst;
        if (lost > 0) {
            --lost;
            continue;
        }
        if (conditions.spoil) conditions.spoil(sample, t_s);
        sample.t_ns =
            t0 + static_cast<std::int64_t>(std::llround(static_cast<double>(sample.t_ns - t0) *
                                                        (1 + conditions.rate_error)));
        out.samples.push_back(sample);
        out.index.push_back(i);
    }
    return out;
}

template <class Filter>
std::vector<Pose> run(const Recording& recording, const Delivered& in,
                      const AttitudeParams& params) {
    Intake<Sample> intake;
    Filter filter{params};
    std::vector<Pose> out;
    Progress progress{"attitude", in.samples.size()};
    for (std::size_t i = 0; i < in.samples.size(); ++i) {
        progress.show(i);
        const auto sample = intake.push(in.samples[i]);
        if (!sample) continue;
        auto pose = filter.push(*sample);
        if (!pose) continue;
        pose->t_ns = recording.samples[in.index[i]].t_ns;
        out.push_back(*pose);
    }
    return out;
}

}  // namespace

AttitudeMode all_sensors(const Recording& recording) {
    const auto has_field = [](const Sample& s) { return (s.flags & flag::mag_valid) != 0; };
    const bool any = std::any_of(recording.samples.begin(), recording.samples.end(), has_field);
    return any ? AttitudeMode::imu_mag : AttitudeMode::imu;
}

std::vector<Pose> run_attitude(const Recording& recording, AttitudeMode mode,
                               const AttitudeParams& params, const Conditions& conditions) {
    if (recording.samples.empty()) throw BadData(recording.name + ": holds no IMU samples");
    const Delivered in = deliver(recording, conditions);
    switch (mode) {
        case AttitudeMode::gyro: return run<AttitudeGyro>(recording, in, params);
        case AttitudeMode::imu: return run<AttitudeImu>(recording, in, params);
        case AttitudeMode::imu_mag: break;
    }
    return run<Attitude>(recording, in, params);
}

double movement_start_s(const Recording& recording) {
    for (std::size_t i = 0; i < recording.moving.size(); ++i)
        if (recording.moving[i] != 0)
            return static_cast<double>(recording.t_ns(i) - recording.t_ns(0)) * 1e-9;
    return 0;
}

std::string to_estimate_csv(const std::vector<Pose>& estimate) {
    std::string out = "t_ns,qw,qx,qy,qz\n";
    char line[128];
    Progress progress{"write", estimate.size()};
    for (const Pose& pose : estimate) {
        progress.show(static_cast<std::size_t>(&pose - estimate.data()));
        const Quat& q = pose.q_wb;
        std::snprintf(line, sizeof line, "%lld,%.9g,%.9g,%.9g,%.9g\n",
                      static_cast<long long>(pose.t_ns), static_cast<double>(q.w),
                      static_cast<double>(q.x), static_cast<double>(q.y), static_cast<double>(q.z));
        out += line;
    }
    return out;
}

std::vector<Pose> parse_estimate_csv(const std::string& text, const std::string& name) {
    std::vector<Pose> out;
    std::istringstream lines{text};
    std::string line;
    Progress progress{"estimate", text.size(), "bytes"};
    for (std::size_t number = 1, done = 0; std::getline(lines, line); ++number) {
        progress.show(done);
        done += line.size() + 1;
        if (line.empty() || (number == 1 && line.rfind("t_ns", 0) == 0)) continue;
        long long t_ns = 0;
        double q[4]{};
        char rest = 0;
        const int fields = std::sscanf(line.c_str(), "%lld,%lf,%lf,%lf,%lf %c", &t_ns, &q[0], &q[1],
                                       &q[2], &q[3], &rest);
        if (fields != 5)
            throw BadData(name + ": line " + std::to_string(number) +
                          " is not t_ns,qw,qx,qy,qz: " + line);
        const double n2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        if (std::abs(n2 - 1) > 0.01)  // NaN passes: score counts it
            throw BadData(name + ": line " + std::to_string(number) +
                          " is not a unit quaternion: " + line);
        Pose pose;
        pose.t_ns = t_ns;
        pose.q_wb = {static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2]),
                     static_cast<float>(q[3])};
        pose.flags = flag::orientation_valid;
        out.push_back(pose);
    }
    return out;
}

}  // namespace fairlead::sim
