#include "host_sim/study/bench_attitude/locks.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "fairlead/sense/attitude.hpp"
#include "fairlead/sense/intake.hpp"
#include "host_sim/replay/attitude_run.hpp"

namespace fairlead::sim {
namespace {

constexpr double deg = 0.017453292519943295;

template <class Filter>
void run(const Recording& r, const AttitudeParams& params, std::uint64_t seed, LockCounts& counts) {
    constexpr double end_s = 5, locked_deg = 30, tilted_deg = 20;
    Intake<Sample> intake;
    Filter filter{params};
    double sum = 0;
    std::size_t n = 0, clear = 0;
    const std::int64_t last_ns = r.samples.back().t_ns;
    for (std::size_t i = 0; i < r.samples.size(); ++i) {
        const auto sample = intake.push(r.samples[i]);
        if (!sample) continue;
        const auto pose = filter.push(*sample);
        if (!pose) continue;
        const OrientationError e = orientation_error(pose->q_wb, r.truth[i].q_wb);
        if (static_cast<double>(last_ns - pose->t_ns) * 1e-9 < end_s) {
            sum += e.inclination;
            ++n;
        }
        if ((pose->flags & flag::settling) != 0) continue;
        ++clear;
        counts.worst_deg = std::max(counts.worst_deg, e.inclination / deg);
        if (e.inclination > tilted_deg * deg) ++counts.tilted;
        if constexpr (std::is_same_v<Filter, Attitude>)
            if (std::abs(e.heading) > 3 * static_cast<double>(filter.heading_sigma()))
                ++counts.turned;
    }
    counts.samples += clear;
    counts.clear_share += static_cast<double>(clear) / static_cast<double>(r.samples.size());
    ++counts.runs;
    if (!(sum / static_cast<double>(std::max<std::size_t>(n, 1)) < locked_deg * deg)) {
        if (counts.locked++ == 0) counts.first_locked = seed;
    }
}

/// What both kinds of runs share: a sensor.
SimPlan sensor(std::uint64_t seed, Random& random) {
    constexpr std::array chips{"bmi160", "icm42688", "lsm6dso", "mpu6050"};
    constexpr std::array rates{50.0, 100.0, 200.0};
    SimPlan plan;
    plan.seed = seed;
    plan.chip = chips[random.below(chips.size())];
    plan.rate_hz = rates[random.below(rates.size())];
    return plan;
}

}  // namespace

SimPlan start_in_motion(std::uint64_t seed) {
    constexpr std::array kinds{"fast", "fast", "hand", "walk", "run", "drone", "hinge", "car"};
    Random random{seed ^ 0x5741524Du};
    SimPlan plan = sensor(seed, random);
    plan.motion.kind = kinds[random.below(kinds.size())];
    plan.cut_s = random.uniform(14, 24);
    plan.motion.seconds = 65;
    return plan;
}

SimPlan upside_down_loss(std::uint64_t seed) {
    using Failure = TurnOver::Failure;
    constexpr std::array failures{Failure::gap, Failure::saturation, Failure::frozen_gyro,
                                  Failure::frozen_all};
    Random random{seed ^ 0x464C4950u};
    SimPlan plan = sensor(seed, random);
    plan.motion.kind = random.below(2) == 0 ? "hand" : "walk";
    plan.motion.seconds = 60;
    TurnOver over;
    over.at_s = random.uniform(18, 24);
    over.seconds = random.uniform(0.3, 1.5);
    over.angle_deg = random.uniform(140, 180);
    over.failure = failures[random.below(failures.size())];
    plan.turn_over = over;
    return plan;
}

LockCounts count_locks(SimPlan (*plan)(std::uint64_t), AttitudeMode mode, std::uint64_t first,
                       std::size_t count, const AttitudeParams& params) {
    LockCounts counts;
    for (std::uint64_t seed = first; seed < first + count; ++seed) {
        const Recording r = simulate(plan(seed)).recording;
        if (mode == AttitudeMode::imu_mag)
            run<Attitude>(r, params, seed, counts);
        else
            run<AttitudeImu>(r, params, seed, counts);
    }
    counts.clear_share /= static_cast<double>(std::max<std::size_t>(counts.runs, 1));
    return counts;
}

}  // namespace fairlead::sim
