#include "host_sim/study/bench_attitude/foreign.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "fairlead/sense/attitude.hpp"
#include "host_sim/replay/attitude_run.hpp"
#include "host_sim/study/baselines/ahrs/ahrs.hpp"

namespace fairlead::sim {
namespace {

template <class... Args>
std::string text(const char* format, Args... args) {
    std::array<char, 400> line{};
    std::snprintf(line.data(), line.size(), format, args...);
    return line.data();
}

std::string pair_of(const Score& s) { return text("%.2f/%.2f", s.total_deg, s.inclination_deg); }

Score aligned_score(const Recording& r, const std::vector<Pose>& estimate, double from_s) {
    return score(r, aligned(r, estimate, Align::heading, from_s), from_s);
}

/// A magnetometer of exactly zero, or not finite, is none.
void drop_absent_field(Recording& r) {
    for (Sample& s : r.samples) {
        const Vec3& m = s.mag_uT;
        if (!is_finite(m) || dot(m, m) == 0)
            s.flags &= ~static_cast<std::uint32_t>(flag::mag_valid);
    }
}

/// The gains are those that were best on other recordings (`bench-attitude table`).
std::string rivals(const Recording& r, bool field, double from_s) {
    std::string out;
    const std::array<AhrsGain, 3> nine{{{0.08, 0}, {1, 0.001}, {8, 0}}},
        six{{{0.03, 0}, {0.25, 0.0003}, {4, 0}}};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto filter = ahrs_kinds()[k].make(field ? nine[k] : six[k]);
        std::vector<Pose> estimate;
        std::int64_t before = r.samples.front().t_ns;
        Vec3 seen{};
        for (Sample s : r.samples) {
            // they need a magnetometer reading with every sample: the last one is held
            if ((s.flags & flag::mag_valid) != 0) seen = s.mag_uT;
            s.mag_uT = seen;
            const auto& q = filter->update(s, static_cast<double>(s.t_ns - before) * 1e-9, field);
            before = s.t_ns;
            Pose pose;
            pose.t_ns = s.t_ns;
            pose.q_wb = {static_cast<float>(q.w()), static_cast<float>(q.x()),
                         static_cast<float>(q.y()), static_cast<float>(q.z())};
            estimate.push_back(pose);
        }
        out += pair_of(aligned_score(r, estimate, from_s)) + " | ";
    }
    return out;
}

constexpr const char* heading_row =
    "| %s | Hz | s | 9D | Madgwick 9D | Mahony 9D | complementary 9D | 6D | Madgwick 6D | Mahony "
    "6D | "
    "complementary 6D |\n|---|---|---|---|---|---|---|---|---|---|---|\n";

std::string line(const Recording& r, const AttitudeParams& params, double from_s) {
    const double seconds =
        static_cast<double>(r.samples.back().t_ns - r.samples.front().t_ns) * 1e-9;
    const double hz = static_cast<double>(r.samples.size()) / seconds;
    std::string out = text("| %s | %.0f | %.0f | ", r.name.c_str(), hz, seconds);
    for (const bool field : {true, false}) {
        if (field && all_sensors(r) != AttitudeMode::imu_mag) {
            out += "- | - | - | - | ";
            continue;
        }
        const auto mode = field ? AttitudeMode::imu_mag : AttitudeMode::imu;
        out += pair_of(aligned_score(r, run_attitude(r, mode, params), from_s)) + " | ";
        out += rivals(r, field, from_s);
    }
    out.back() = '\n';
    return out;
}

}  // namespace

std::vector<SimPlan> foreign_plans() {
    std::vector<SimPlan> out;
    const auto plan = [&](const std::string& name, const std::string& kind,
                          double seconds) -> SimPlan& {
        SimPlan p;
        p.name = name;
        p.motion.kind = kind;
        p.motion.seconds = seconds;
        p.seed = out.size() + 1;
        out.push_back(p);
        return out.back();
    };
    for (const char* chip : {"bmi160", "icm42688", "lsm6dso", "mpu6050"})
        plan(std::string("hand, ") + chip, "hand", 120).chip = chip;
    for (const double hz : {25.0, 50.0, 200.0, 1000.0})
        plan(text("hand, %.0f Hz", hz), "hand", 90).rate_hz = hz;
    plan("hand, magnetometer at 10 Hz", "hand", 120).mag_rate_hz = 10;
    plan("hand, hard iron 20 uT", "hand", 120).hard_iron_uT = 20;
    plan("hand, bias 8 deg/s", "hand", 120).bias_deg_s = 8;
    plan("hand, bias 20 deg/s", "hand", 120).bias_deg_s = 20;
    plan("slow", "slow", 120);
    plan("walker", "walk", 180);
    plan("runner", "run", 180);
    plan("drone", "drone", 180);
    plan("drone, slower", "drone", 180).motion.rate_hz_max = 0.12;
    plan("car", "car", 240);
    plan("car", "car", 240);
    SimPlan& walk = plan("walk on a circle of 3 m, 1.2 m/s", "circle", 110);
    walk.motion.turn_deg_s = 23;
    SimPlan& carousel = plan("carousel, 3 m, 46 deg/s", "circle", 110);
    carousel.motion.turn_deg_s = 46;
    for (const double w : {0.2, 0.5, 1.0, 1.5, 1.9})
        plan(text("turntable, %.1f deg/s", w), "turntable", 120).motion.turn_deg_s = w;
    plan("hand, drift -5 to 5 deg/s in 4 min", "hand", 300).drift = Drift{20, 260, -5, 5};
    plan("hand, bias jumps by 1 deg/s", "hand", 180).jump = Jump{80, 1};
    plan("rest, drift 3 deg/s in 3 min", "rest", 240).drift = Drift{20, 200, 0, 3};
    plan("hinge", "hinge", 120);
    plan("hinge, lsm6dso", "hinge", 120).chip = "lsm6dso";
    for (int k = 0; k < 4; ++k) {
        SimPlan& p = plan(text("start in fast motion %d", k + 1), "fast", 90);
        p.cut_s = 20 + 3 * k;
        p.score_from_s = 10;
    }
    return out;
}

std::vector<Recording> read_imu_folder(const std::string& folder) {
    std::vector<std::string> paths;
    if (std::filesystem::is_directory(folder))
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            if (entry.path().extension() == ".imu") paths.push_back(entry.path().string());
    std::sort(paths.begin(), paths.end());
    std::vector<Recording> out;
    for (const auto& path : paths) {
        out.push_back(read_recording(path));
        out.back().name = stem_of(path);
        drop_absent_field(out.back());
    }
    return out;
}

std::string foreign_recordings(const std::string& folder, const AttitudeParams& params) {
    constexpr double from_s = 5;
    std::string out = text(heading_row, "recording");
    for (const Recording& r : read_imu_folder(folder)) out += line(r, params, from_s);
    return out;
}

std::string foreign_simulations(const AttitudeParams& params) {
    std::string out = text(heading_row, "simulation");
    for (const SimPlan& plan : foreign_plans())
        out += line(simulate(plan).recording, params, plan.score_from_s);
    return out;
}

std::string foreign_speed(const AttitudeParams& params) {
    std::string out =
        "| simulation | 9D | 9D with speed | 6D | 6D with speed |\n|---|---|---|---|---|\n";
    for (const SimPlan& plan : foreign_plans()) {
        const Simulated sim = simulate(plan);
        if (sim.speed_m_s.empty() || norm(sim.forward) < 0.5f || plan.motion.radius_m < 0.1)
            continue;
        const auto with_speed = [&](auto filter) {
            std::vector<Pose> estimate;
            for (std::size_t i = 0; i < sim.recording.samples.size(); ++i) {
                const float speed = sim.speed_m_s[i];
                filter.drive(speed * sim.forward, 0.1f + 0.02f * speed);
                if (const auto pose = filter.push(sim.recording.samples[i]))
                    estimate.push_back(*pose);
            }
            return pair_of(aligned_score(sim.recording, estimate, plan.score_from_s));
        };
        const auto without = [&](AttitudeMode mode) {
            return pair_of(aligned_score(sim.recording, run_attitude(sim.recording, mode, params),
                                         plan.score_from_s));
        };
        out += "| " + plan.name + " | " + without(AttitudeMode::imu_mag) + " | " +
               with_speed(Attitude{params}) + " | " + without(AttitudeMode::imu) + " | " +
               with_speed(AttitudeImu{params}) + " |\n";
    }
    return out;
}

}  // namespace fairlead::sim
