#include "host_sim/bench_attitude/trials.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fairlead/sense/attitude.hpp"

namespace fairlead::sim {
namespace {

constexpr double deg = 0.017453292519943295;
constexpr double break_at_s = 20, recovery_s = 20;

void add(Means& sum, const Score& s) {
    sum.total += s.total_deg;
    sum.heading += s.heading_deg;
    sum.inclination += s.inclination_deg;
    sum.worst_inclination = std::max(sum.worst_inclination, s.worst_inclination_deg);
    sum.not_finite += s.not_finite;
}
Means divided(Means sum, std::size_t n) {
    const auto by = static_cast<double>(n);
    sum.total /= by;
    sum.heading /= by;
    sum.inclination /= by;
    return sum;
}

void clamp_all(Vec3& v, float limit) {
    v = {std::clamp(v.x, -limit, limit), std::clamp(v.y, -limit, limit),
         std::clamp(v.z, -limit, limit)};
}

}  // namespace

Means mean_score(const std::vector<Recording>& recordings, AttitudeMode mode,
                 const AttitudeParams& params, const Conditions& conditions, double after_s) {
    Means sum;
    for (const Recording& r : recordings)
        add(sum, score(r, run_attitude(r, mode, params, conditions), conditions.start_s + after_s));
    return divided(sum, recordings.size());
}

std::vector<Trial> trials() {
    std::vector<Trial> out;
    const auto trial = [&](const std::string& name, double bound) -> Trial& {
        out.emplace_back();
        out.back().name = name;
        out.back().bound_deg = bound;
        return out.back();
    };
    trial("as recorded", 1.80);
    trial("1 % of the samples lost, in runs of 5", 1.85).conditions.drop = {0.01, 5, 1};
    trial("10 % of the samples lost, in runs of 5", 0).conditions.drop = {0.1, 5, 1};
    trial("time stamps 1 % fast", 1.90).conditions.rate_error = 0.01;
    trial("time stamps 1 % slow", 1.90).conditions.rate_error = -0.01;
    trial("half the rate", 1.95).conditions.every = 2;
    trial("a third of the rate", 1.95).conditions.every = 3;
    trial("a sixth of the rate (48 Hz)", 0).conditions.every = 6;
    trial("started at the first movement", 2.80).from_movement = true;
    for (const double s : {5.0, 20.0}) {
        Trial& t =
            trial("started " + std::to_string(static_cast<int>(s)) + " s into the movement", 0);
        t.from_movement = true;
        t.conditions.start_s = s;
    }
    Trial& scaled = trial("gyro scale +1 / -1 / +1.5 %, after the first minute", 2.20);
    scaled.after_s = 60;
    scaled.conditions.spoil = [](Sample& s, double) {
        s.gyro_rad_s = {1.01f * s.gyro_rad_s.x, 0.99f * s.gyro_rad_s.y, 1.015f * s.gyro_rad_s.z};
    };
    return out;
}

Means run_trial(const std::vector<Recording>& recordings, const Trial& trial) {
    Means sum;
    for (const Recording& r : recordings) {
        Conditions c = trial.conditions;
        if (trial.from_movement) c.start_s += movement_start_s(r);
        add(sum,
            score(r, run_attitude(r, AttitudeMode::imu_mag, {}, c), c.start_s + trial.after_s));
    }
    return divided(sum, recordings.size());
}

std::vector<Break> breaks() {
    std::vector<Break> out;
    AttitudeParams narrow_gyro, narrow_accel;
    narrow_gyro.gyro_max_rad_s = static_cast<float>(500 * deg);
    narrow_accel.accel_max_m_s2 = 4 * gravity_m_s2;
    out.push_back(
        {"gyro range 500 deg/s, throughout", 0, narrow_gyro,
         [](Sample& s, const Sample&) { clamp_all(s.gyro_rad_s, static_cast<float>(500 * deg)); }});
    out.push_back({"accelerometer range 4 g, throughout", 0, narrow_accel,
                   [](Sample& s, const Sample&) { clamp_all(s.accel_m_s2, 4 * gravity_m_s2); }});
    out.push_back({"gyro x axis stuck for 2 s", 2, {}, [](Sample& s, const Sample& first) {
                       s.gyro_rad_s.x = first.gyro_rad_s.x;
                   }});
    out.push_back({"accelerometer x axis stuck for 2 s", 2, {}, [](Sample& s, const Sample& first) {
                       s.accel_m_s2.x = first.accel_m_s2.x;
                   }});
    out.push_back({"magnetometer missing for 20 s", 20, {}, [](Sample& s, const Sample&) {
                       s.flags &= ~static_cast<std::uint32_t>(flag::mag_valid);
                   }});
    out.push_back({"magnetometer offset of 30 uT for 20 s", 20, {}, [](Sample& s, const Sample&) {
                       s.mag_uT.x += 30;
                   }});
    out.push_back({"10 s of NaN in all sensors", 10, {}, [](Sample& s, const Sample&) {
                       const float x = std::numeric_limits<float>::quiet_NaN();
                       s.gyro_rad_s = s.accel_m_s2 = s.mag_uT = {x, x, x};
                   }});
    return out;
}

BreakErrors run_break(const std::vector<Recording>& recordings, const Break& broken) {
    BreakErrors sum;
    for (const Recording& r : recordings) {
        const double start = movement_start_s(r);
        const double from = broken.seconds > 0 ? start + break_at_s : 0;
        const double to = broken.seconds > 0 ? from + broken.seconds : 1e9;
        Conditions c;
        Sample first;
        bool begun = false;
        c.spoil = [&](Sample& s, double t_s) {
            if (t_s < from || t_s >= to) return;
            if (!begun) first = s;
            begun = true;
            broken.spoil(s, first);
        };
        const auto estimate = run_attitude(r, AttitudeMode::imu_mag, broken.params, c);
        add(sum.during, score(r, estimate, from, to));
        add(sum.after, score(r, estimate, broken.seconds > 0 ? to + recovery_s : start));
    }
    return {divided(sum.during, recordings.size()), divided(sum.after, recordings.size())};
}

Honesty honesty(const Recording& recording) {
    Attitude filter;
    double inclination = 0, heading = 0;
    std::size_t n = 0;
    for (std::size_t i = 0; i < recording.samples.size(); ++i) {
        const auto pose = filter.push(recording.samples[i]);
        const bool counts =
            recording.moving[i] != 0 && (recording.truth[i].flags & flag::orientation_valid) != 0;
        if (!pose || !counts) continue;
        const OrientationError e = orientation_error(pose->q_wb, recording.truth[i].q_wb);
        const double si = static_cast<double>(filter.inclination_sigma());
        const double sh = static_cast<double>(filter.heading_sigma());
        inclination +=
            e.inclination * e.inclination / (si * si);  // si^2: the sum of both axes' variances
        heading += e.heading * e.heading / (sh * sh);
        ++n;
    }
    const auto by = static_cast<double>(std::max<std::size_t>(n, 1));
    return {inclination / by, heading / by};
}

double float_against_double(const Recording& recording) {
    Attitude narrow;
    BasicAttitude<double, AttitudeMode::imu_mag> wide;
    double sum = 0;
    for (const Sample& sample : recording.samples) {
        narrow.push(sample);
        wide.push(sample);
        const auto q = narrow.orientation();
        const BasicQuat<double> single{static_cast<double>(q.w), static_cast<double>(q.x),
                                       static_cast<double>(q.y), static_cast<double>(q.z)};
        const double angle = rotation_angle(normalised(single), wide.orientation());
        sum += angle * angle;
    }
    return std::sqrt(sum / static_cast<double>(recording.samples.size())) / deg;
}

std::vector<AttitudeParams> settings_grid() {
    std::vector<AttitudeParams> out;
    for (const float field_uT : {0.7f, 1.0f, 2.0f})
        for (const float field_s : {2.0f, 3.0f, 5.0f})
            for (const float scale : {0.004f, 0.008f, 0.016f})
                for (const float velocity : {0.5f, 0.7f, 1.0f}) {
                    AttitudeParams p;
                    p.field_uT = field_uT;
                    p.field_s = field_s;
                    p.scale_error = scale;
                    p.velocity_m_s = velocity;
                    out.push_back(p);
                }
    return out;
}

}  // namespace fairlead::sim
