#include "host_sim/study/bench_attitude/trials.hpp"

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
    narrow_gyro.gyro_full_scale_rad_s = static_cast<float>(500 * deg);
    narrow_accel.accel_full_scale_m_s2 = 4 * gravity_m_s2;
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
    Honesty out;
    std::size_t moving = 0, resting = 0;
    const auto step = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::lround(Honesty::look_s / recording.period_s)));
    for (std::size_t i = 0; i < recording.samples.size(); ++i) {
        const auto pose = filter.push(recording.samples[i]);
        if (!pose || (recording.truth[i].flags & flag::orientation_valid) == 0) continue;
        const OrientationError e = orientation_error(pose->q_wb, recording.truth[i].q_wb);
        const double tilt = e.inclination / static_cast<double>(filter.inclination_sigma());
        const double turn = e.heading / static_cast<double>(filter.heading_sigma());
        if (recording.moving[i] == 0) {
            if ((pose->flags & flag::rest) == 0) continue;
            out.inclination_at_rest += tilt * tilt;
            ++resting;
            continue;
        }
        out.inclination += tilt * tilt;  // sigma^2 is the sum of both axes' variances
        out.heading += turn * turn;
        if (moving++ % step == 0) out.heading_z.push_back(turn);
    }
    out.inclination /= static_cast<double>(std::max<std::size_t>(moving, 1));
    out.heading /= static_cast<double>(std::max<std::size_t>(moving, 1));
    out.inclination_at_rest /= static_cast<double>(std::max<std::size_t>(resting, 1));
    out.seconds = Honesty::look_s * static_cast<double>(out.heading_z.size());
    return out;
}

double share_within(const std::vector<Honesty>& all, double limit) {
    double within = 0, n = 0;
    for (const Honesty& h : all)
        for (const double z : h.heading_z) {
            within += std::abs(z) < limit ? 1 : 0;
            n += 1;
        }
    return within / n;
}

namespace {

/// Over all recordings, at so many looks apart; the mean is known to be 0.
double autocorrelation(const std::vector<Honesty>& all, std::size_t lag) {
    double both = 0, own = 0;
    for (const Honesty& h : all)
        for (std::size_t i = lag; i < h.heading_z.size(); ++i) {
            const double a = h.heading_z[i - lag], b = h.heading_z[i];
            both += a * b;
            own += (a * a + b * b) / 2;
        }
    return own > 0 ? both / own : 0;
}

/// Quantile of chi-squared over its degrees of freedom [Wilson & Hilferty 1931], normal deviate z.
double chi2_quantile(double degrees, double z) {
    const double v = 2 / (9 * degrees);
    return std::pow(std::max(0.0, 1 - v + z * std::sqrt(v)), 3);
}

}  // namespace

Independence independence(const std::vector<Honesty>& all) {
    constexpr double z95 = 1.96;
    Independence out;
    double seconds = 0;
    for (const Honesty& h : all) seconds += h.seconds / static_cast<double>(all.size());
    std::size_t lag = 1;
    while (autocorrelation(all, lag) > std::exp(-1.0) &&
           static_cast<double>(lag) * Honesty::look_s < seconds)
        lag += 10;
    out.correlation_s = static_cast<double>(lag) * Honesty::look_s;
    // the square of an exponentially correlated error: correlation exp(-2 t / tau), averaged over T
    const double t = out.correlation_s / 2 / seconds;
    out.draws = 1 / (2 * t * (1 - t * (1 - std::exp(-1 / t))));
    out.lowest = chi2_quantile(out.draws, -z95);
    out.highest = chi2_quantile(out.draws, z95);
    const double together = out.draws * static_cast<double>(all.size());
    out.mean_lowest = chi2_quantile(together, -z95);
    out.mean_highest = chi2_quantile(together, z95);
    return out;
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
