// Attitude on simulated devices and motions that it was not tuned for: no wrong state lasts, rests
// are rests, sensors that fail are noticed and quiet ones are not accused, vehicles with a speed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fairlead/math/euler.hpp"
#include "fairlead/sense/attitude_lag.hpp"
#include "fairlead/sense/calibrate_temperature.hpp"
#include "fairlead/sense/clip.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/replay/attitude_run.hpp"
#include "host_sim/replay/attitude_settings.hpp"
#include "host_sim/replay/attitude_smooth.hpp"
#include "host_sim/study/bench_attitude/locks.hpp"

namespace fairlead::sim {
namespace {

constexpr double deg = 0.017453292519943295;

SimPlan plan(const std::string& kind, double seconds, std::uint64_t seed = 7) {
    SimPlan p;
    p.motion.kind = kind;
    p.motion.seconds = seconds;
    p.seed = seed;
    p.name = kind;
    return p;
}

Score scored(const Recording& r, const std::vector<Pose>& estimate, double from_s = 15) {
    return score(r, aligned(r, estimate, Align::heading, from_s), from_s);
}
Score nine(const Recording& r, double from_s = 15) {
    return scored(r, run_attitude(r, AttitudeMode::imu_mag), from_s);
}

/// What the filter knows after a recording, each sample changed first.
template <class Change>
Attitude after(const Recording& r, Change change) {
    Attitude filter;
    for (Sample s : r.samples) {
        change(s, static_cast<double>(s.t_ns) * 1e-9);
        filter.push(s);
    }
    return filter;
}

TEST(AttitudeDevices, NoWrongStateLasts) {
    for (const AttitudeMode mode : {AttitudeMode::imu_mag, AttitudeMode::imu}) {
        for (const auto trial : {start_in_motion, upside_down_loss}) {
            const LockCounts c = count_locks(trial, mode, 5001, 24);
            EXPECT_EQ(c.locked, 0u);
            EXPECT_EQ(c.tilted, 0u) << "settled while more than 20 degrees off";
        }
    }
}

/// When a pose is first settled, s from the first sample.
double settled_after(const Recording& r) {
    AttitudeImu filter;
    for (const Sample& s : r.samples) {
        const auto pose = filter.push(s);
        if (pose && (pose->flags & flag::settling) == 0)
            return static_cast<double>(s.t_ns - r.samples.front().t_ns) * 1e-9;
    }
    return 1e9;
}

TEST(AttitudeDevices, AStartInMotionMustProveItself) {
    // what looks like gravity may be a bend or a thrust: prove_s without a contradiction, or a rest
    SimPlan p = plan("walk", 60);
    EXPECT_LT(settled_after(simulate(p).recording), 3) << "from rest";
    p.cut_s = 20;
    const double moving = settled_after(simulate(p).recording);
    EXPECT_GT(moving, static_cast<double>(AttitudeParams{}.prove_s));
    EXPECT_LT(moving, 15);
}

TEST(AttitudeDevices, AHeldReadingIsDoubtedOnlyWhereItIsNoHabit) {
    // each reading four times: a slow sensor behind a fast reader
    SimPlan p = plan("hand", 60);
    p.rate_hz = 50;
    const Recording r = simulate(p).recording;
    const auto settled = [&](int freeze_at) {
        Attitude filter;
        std::size_t clear = 0, seen = 0;
        Sample last;
        for (std::size_t i = 0; i < r.samples.size(); ++i)
            for (int k = 0; k < 4; ++k) {
                const bool frozen = freeze_at > 0 && static_cast<int>(i) >= freeze_at;
                Sample s = frozen ? last : r.samples[i];
                last = s;
                s.t_ns = r.samples[i].t_ns + 5000000 * k;
                const auto pose = filter.push(s);
                if (freeze_at > 0 ? static_cast<int>(i) < freeze_at + 3 ||
                                        static_cast<int>(i) > freeze_at + 15
                                  : i < 500)
                    continue;
                ++seen;
                clear += pose && (pose->flags & flag::settling) == 0 ? 1u : 0u;
            }
        return static_cast<double>(clear) / static_cast<double>(seen);
    };
    EXPECT_GT(settled(0), 0.9);
    EXPECT_LT(settled(1000), 1e-9);
}

/// Violent shaking upward and downward with a range that holds the one half of it only: what is
/// left points down, and says nothing.
TEST(AttitudeDevices, AClippedAccelerometerIsNoEvidence) {
    for (const double hz : {0.7, 1.0, 3.0})
        for (const double amplitude_g : {2.0, 4.0, 6.0}) {
            SCOPED_TRACE(testing::Message() << hz << " Hz, " << amplitude_g << " g");
            AttitudeParams params;
            params.accel_full_scale_m_s2 = 4 * gravity_m_s2;
            AttitudeImu filter{params};
            double worst = 0;
            std::size_t settled = 0, seen = 0;
            for (int i = 0; i < 6000; ++i) {
                const double t = i * 0.005,
                             shake = t < 5 ? 0 : std::sin(2 * 3.14159265358979 * hz * (t - 5));
                const double up = std::clamp(1 + amplitude_g * shake, -4.0, 4.0);
                const auto f = [](double x) { return static_cast<float>(x); };
                Sample s;
                s.t_ns = 1 + std::int64_t{5000000} * i;
                s.gyro_rad_s = {f(7e-4 * std::sin(1.7 * i)), f(7e-4 * std::cos(2.3 * i)), 0};
                s.accel_m_s2 = {f(0.02 * std::sin(0.9 * i)), f(0.02 * std::cos(1.1 * i)),
                                f(up) * gravity_m_s2};
                s.flags = flag::gyro_valid | flag::accel_valid;
                const auto pose = filter.push(s);
                if (!pose || t < 5) continue;
                ++seen;
                settled += (pose->flags & flag::settling) == 0 ? 1u : 0u;
                worst = std::max(worst, orientation_error(pose->q_wb, {}).inclination / deg);
            }
            EXPECT_LT(worst, 2);
            EXPECT_GT(settled, seen * 9 / 10);
        }
}

TEST(AttitudeDevices, SettledIsSettledAfterAStartInMotion) {
    // Over 2000 runs 0.58 % of the settled samples are beyond three sigma of heading, in few runs;
    // between blocks of 100 runs that differs by 0.44 % (standard deviation). This block is chosen
    // for its first 16 runs, which alone hold 4.9 %; make attitude-locks holds 1000 runs to 1 %.
    constexpr std::uint64_t first = 6001;
    constexpr std::size_t runs = 100;
    constexpr double mean = 0.0058, deviation = 0.0044;
    const LockCounts c = count_locks(start_in_motion, AttitudeMode::imu_mag, first, runs);
    EXPECT_EQ(c.tilted, 0u);
    EXPECT_LT(static_cast<double>(c.turned),
              (mean + 3 * deviation) * static_cast<double>(c.samples));
    EXPECT_GT(c.clear_share, 0.3) << "a filter that never settles is no use";
}

TEST(AttitudeDevices, ASlowTurnIsNoBiasWhereTheFieldSeesIt) {
    for (const double rate : {0.5, 1.0, 1.9}) {
        SCOPED_TRACE(rate);
        SimPlan p = plan("turntable", 100);
        p.motion.turn_deg_s = rate;
        p.chip = "icm42688";  // its accelerometer's zero leaves room to see anything else
        EXPECT_LT(nine(simulate(p).recording).total_deg, 4);
        p.cut_s = 25;  // it turns from the first sample on
        EXPECT_LT(nine(simulate(p).recording, 10).total_deg, 8);
    }
}

TEST(AttitudeDevices, AKnownBiasIsNotGivenUpForASlowTurnWithoutAField) {
    SimPlan p = plan("turntable", 100);
    p.motion.turn_deg_s = 1.5;
    const Recording r = simulate(p).recording;
    EXPECT_LT(scored(r, run_attitude(r, AttitudeMode::imu)).total_deg, 6);
}

TEST(AttitudeDevices, TheFirstRestShowsAnyBias) {
    for (const double bias : {4.0, -12.0, 24.0}) {
        SCOPED_TRACE(bias);
        SimPlan p = plan("hand", 60);
        p.bias_deg_s = bias;
        const Recording r = simulate(p).recording;
        for (const AttitudeMode mode : {AttitudeMode::imu_mag, AttitudeMode::imu})
            EXPECT_LT(scored(r, run_attitude(r, mode)).total_deg, 8);
    }
}

TEST(AttitudeDevices, DriftsAndJumpsOfTheBiasAreFollowed) {
    SimPlan drift = plan("hand", 200);
    drift.drift = Drift{20, 180, -3, 3};
    EXPECT_LT(nine(simulate(drift).recording).total_deg, 8.5);
    SimPlan jump = plan("hand", 150);
    jump.jump = Jump{66, 1};
    EXPECT_LT(nine(simulate(jump).recording).total_deg, 4.5);
}

TEST(AttitudeDevices, SustainedMotionIsNotTilt) {
    EXPECT_LT(nine(simulate(plan("drone", 120)).recording).inclination_deg, 2.3);
    EXPECT_LT(nine(simulate(plan("run", 120)).recording).inclination_deg, 2.3);
    EXPECT_LT(nine(simulate(plan("walk", 120)).recording).inclination_deg, 2.3);
}

TEST(AttitudeDevices, ASpeedMakesAVehicleLevel) {
    const Simulated car = simulate(plan("car", 240, 18));
    Attitude with, without;
    std::vector<Pose> a, b;
    for (std::size_t i = 0; i < car.recording.samples.size(); ++i) {
        with.drive(car.speed_m_s[i] * car.forward, 0.1f + 0.02f * car.speed_m_s[i]);
        if (const auto pose = with.push(car.recording.samples[i])) a.push_back(*pose);
        if (const auto pose = without.push(car.recording.samples[i])) b.push_back(*pose);
    }
    EXPECT_LT(scored(car.recording, a).inclination_deg, 2);
    EXPECT_GT(scored(car.recording, b).inclination_deg, 3) << "or the test shows nothing";
}

TEST(AttitudeDevices, AVelocityThatTurnsWithTheBodyIsNotTilt) {
    AttitudeParams never;
    never.cruise_m_s = 1e4f;
    for (const std::uint64_t seed : {19u, 20u}) {
        SCOPED_TRACE(seed);
        const Recording r = simulate(plan("car", 240, seed)).recording;
        const double with = scored(r, run_attitude(r, AttitudeMode::imu)).inclination_deg;
        const double without = scored(r, run_attitude(r, AttitudeMode::imu, never)).inclination_deg;
        EXPECT_LT(with, 5.5);
        EXPECT_LT(with, 0.9 * without);
    }
}

TEST(AttitudeDevices, AVehicleThatSetsOutDoesNotTeachABias) {
    // it begins to roll, and to pitch slowly, while the board is still quiet
    for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
        SCOPED_TRACE(seed);
        const Recording r = simulate(plan("car", 60, seed)).recording;
        Vec3 rest{};
        Attitude filter;
        double worst = 0;
        for (const Sample& s : r.samples) {
            const double t = static_cast<double>(s.t_ns) * 1e-9;
            if (t > 20) break;
            filter.push(s);
            if (t < 9.5) rest = filter.bias_rad_s();
            worst = std::max(worst, static_cast<double>(norm(filter.bias_rad_s() - rest)));
            if (t < 9.5) worst = 0;
        }
        EXPECT_LT(worst, 0.25 * deg);
    }
}

TEST(AttitudeDevices, AnEndOfTheRangeThatNobodyToldIsNoticed) {
    // a runner's phone whose accelerometer ends at 2 g: it shows less than the force, and the
    // filter says that the velocity is known less well
    Recording r = simulate(plan("run", 60)).recording;
    int clipped = 0;
    for (Sample& s : r.samples)
        for (float* x : {&s.accel_m_s2.x, &s.accel_m_s2.y, &s.accel_m_s2.z}) {
            clipped += std::abs(*x) > 19.6f ? 1 : 0;
            *x = std::clamp(*x, -19.6f, 19.6f);
        }
    ASSERT_GT(clipped, 100) << "or the test shows nothing";
    EXPECT_LT(scored(r, run_attitude(r, AttitudeMode::imu)).inclination_deg, 2);
    AttitudeParams told_wide;
    told_wide.accel_full_scale_m_s2 = 157;
    Attitude unaware{told_wide}, aware;
    double doubt = 0, trust = 0;
    for (const Sample& s : r.samples) {
        unaware.push(s);
        aware.push(s);
        doubt += static_cast<double>(aware.state().sums.doubt_velocity2);
        trust += static_cast<double>(unaware.state().sums.doubt_velocity2);
    }
    EXPECT_GT(doubt, 0);
    EXPECT_EQ(trust, 0) << "it fits into the range that was told";
}

TEST(AttitudeDevices, ALargeBiasIsFoundInMotion) {
    // no rest: the phone is in use from the first sample on
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        SCOPED_TRACE(seed);
        SimPlan p = plan("slow", 120, seed);
        p.bias_deg_s = 2.5;
        p.cut_s = 15;
        const Recording r = simulate(p).recording;
        EXPECT_LT(scored(r, run_attitude(r, AttitudeMode::imu), 10).inclination_deg, 4);
    }
}

TEST(UsualRange, IsTheLeastThatHoldsAllReadings) {
    constexpr float g = 9.80665f;
    const auto told = [end2 = usual_end2](float reading) mutable {
        return at_usual_end(end2, reading * reading);
    };
    auto small = told;
    EXPECT_FALSE(small(1.5f * g));
    EXPECT_TRUE(small(2 * g));
    EXPECT_TRUE(small(1.93f * g));
    auto larger = told;
    EXPECT_TRUE(larger(2 * g));
    EXPECT_FALSE(larger(3 * g));
    EXPECT_FALSE(larger(2 * g)) << "it has shown more";
    EXPECT_TRUE(larger(4 * g));
    EXPECT_TRUE(larger(16 * g));
    EXPECT_FALSE(larger(8 * g));
    EXPECT_FALSE(larger(18 * g));
    EXPECT_FALSE(larger(16 * g));
    auto absurd = told;
    EXPECT_FALSE(absurd(1e18f));
    EXPECT_FALSE(absurd(16 * g));
}

TEST(AttitudeDevices, ASpeedThatEndsOrIsNonsenseDoesNoHarm) {
    const Recording r = simulate(plan("hand", 60)).recording;
    Attitude filter;
    std::vector<Pose> out;
    for (std::size_t i = 0; i < r.samples.size(); ++i) {
        if (i == 1000) filter.drive({0, 0, 0}, 0.1f);
        if (i > 2000) filter.drive({std::nanf(""), 0, 0}, 0.1f);
        if (const auto pose = filter.push(r.samples[i])) out.push_back(*pose);
    }
    EXPECT_LT(scored(r, out).total_deg, 4);
}

TEST(AttitudeDevices, AnyVelocityServes) {
    const Recording r = simulate(plan("hand", 60)).recording;
    for (const float v : {0.1f, 0.7f, 3.5f, 10.0f, 30.0f}) {
        SCOPED_TRACE(v);
        AttitudeParams params;
        params.velocity_m_s = v;
        EXPECT_LT(scored(r, run_attitude(r, AttitudeMode::imu_mag, params)).inclination_deg, 5);
    }
}

TEST(AttitudeDevices, QuietCoarseAxesAreAlive) {
    for (const char* chip : {"lsm6dso", "icm42688"}) {
        SCOPED_TRACE(chip);
        SimPlan p = plan("hinge", 60);
        p.chip = chip;
        const Recording r = simulate(p).recording;
        std::size_t accused = 0, settling = 0, n = 0;
        Attitude filter;
        for (const Sample& s : r.samples) {
            const auto pose = filter.push(s);
            if (!pose || static_cast<double>(s.t_ns) < 10e9) continue;
            accused += (pose->flags & flag::clipped) != 0 ? 1u : 0u;
            settling += (pose->flags & flag::settling) != 0 ? 1u : 0u;
            ++n;
        }
        EXPECT_EQ(accused, 0u);
        EXPECT_LT(settling, n / 50);
    }
}

TEST(AttitudeDevices, OneFrozenAxisIsNoticed) {
    const Recording r = simulate(plan("fast", 40)).recording;
    Attitude filter;
    std::size_t noticed = 0, n = 0;
    float frozen = 0;
    for (Sample s : r.samples) {
        const double t = static_cast<double>(s.t_ns) * 1e-9;
        if (t < 15) frozen = s.gyro_rad_s.x;
        if (t >= 15 && t < 18) s.gyro_rad_s.x = frozen;
        const auto pose = filter.push(s);
        if (!pose || t < 15.5 || t >= 18) continue;
        noticed += (pose->flags & flag::settling) != 0 ? 1u : 0u;
        ++n;
    }
    EXPECT_GT(noticed, n * 9 / 10);
}

TEST(AttitudeDevices, AGyroOfWhichOneAxisLivesIsAlive) {
    // a turntable about an axis of the sensor: coarse readings of the other two are always zero
    for (std::size_t axis = 0; axis < 3; ++axis) {
        AttitudeImu filter;
        bool dead = false;
        for (int i = 0; i < 8000; ++i) {
            Sample s;
            s.t_ns = i * std::int64_t{5'000'000};
            s.flags = flag::gyro_valid | flag::accel_valid;
            const auto rate = static_cast<float>(std::sin(0.01 * i));
            s.gyro_rad_s = {axis == 0 ? rate : 0, axis == 1 ? rate : 0, axis == 2 ? rate : 0};
            s.accel_m_s2 = {axis == 0 ? 9.81f : 0, axis == 1 ? 9.81f : 0, axis == 2 ? 9.81f : 0};
            s.accel_m_s2.x += static_cast<float>(0.05 * std::sin(1.3 * i));
            filter.push(s);
            dead = dead || filter.state().alive.gyro_dead;
        }
        EXPECT_FALSE(dead) << axis;
    }
}

TEST(AttitudeDevices, AFrozenAccelerometerTeachesNoBias) {
    const Recording r = simulate(plan("hand", 50)).recording;
    Vec3 frozen{};
    const Attitude clean = after(r, [](Sample&, double) {});
    const Attitude held = after(r, [&](Sample& s, double t) {
        if (t < 20) frozen = s.accel_m_s2;
        if (t >= 20 && t < 24) s.accel_m_s2 = frozen;
    });
    const Attitude zero = after(r, [](Sample& s, double t) {
        if (t >= 20 && t < 24) s.accel_m_s2 = {};
    });
    for (const Attitude* filter : {&held, &zero}) {
        const Vec3 off = filter->bias_rad_s() - clean.bias_rad_s();
        EXPECT_LT(norm(off), 0.3 * deg);
    }
}

TEST(AttitudeDevices, AFrozenSensorTeachesNoBias) {
    // everything repeats, at a rate that is no bias: a board that turned when its bus hung
    const Recording r = simulate(plan("hand", 40)).recording;
    Sample last;
    const Attitude filter = after(r, [&](Sample& s, double t) {
        if (t < 13) last = s;
        if (t < 13 || t > 25) return;
        const std::int64_t t_ns = s.t_ns;
        s = last;
        s.t_ns = t_ns;
        s.gyro_rad_s = {0.02f, 0.02f, 0.02f};
    });
    const Attitude clean = after(r, [](Sample&, double) {});
    EXPECT_LT(norm(filter.bias_rad_s() - clean.bias_rad_s()), 0.5 * deg);
}

TEST(AttitudeDevices, ZeroIsNoField) {
    const Recording r = simulate(plan("hand", 30)).recording;
    const Attitude filter = after(r, [](Sample& s, double) { s.mag_uT = {}; });
    EXPECT_GT(filter.heading_sigma(), 0.5f);
    EXPECT_NE(filter.state().flags & flag::settling, 0);
}

TEST(AttitudeDevices, ANewRunStartsAnew) {
    const Recording r = simulate(plan("hand", 20)).recording;
    Attitude filter;
    for (const Sample& s : r.samples) filter.push(s);
    const Vec3 bias = filter.bias_rad_s();
    Sample first = r.samples.front();
    first.t_ns = INT64_MIN;
    EXPECT_FALSE(filter.push(first).has_value());
    first.flags |= flag::new_run;
    ASSERT_TRUE(filter.push(first).has_value());
    EXPECT_NE(filter.state().flags & flag::settling, 0);
    EXPECT_EQ(filter.bias_rad_s().x, bias.x);
    first.flags &= ~static_cast<std::uint32_t>(flag::new_run);
    first.t_ns = INT64_MAX;  // their difference fits no 64 bits
    EXPECT_TRUE(filter.push(first).has_value());
}

TEST(AttitudeDevices, VariancesStayPositiveWhereTheFieldStandsOnEnd) {
    Attitude filter;
    for (int i = 0; i < 2000; ++i) {
        Sample s;
        s.t_ns = i * 16'000'000ll;
        s.accel_m_s2 = {0, 0, 9.81f};
        s.mag_uT = {-0.6f, -0.6f, 55.8f};
        s.flags = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
        filter.push(s);
        for (std::size_t k = 0; k < Attitude::State::size; ++k)
            ASSERT_GE(filter.state().covariance(k, k), 0) << i << ' ' << k;
    }
}

/// Seconds pass in one Kalman step here: a tilt that is not known has made a velocity of tens of
/// m/s of it when the first rest tells that velocity to a few mm/s.
template <class Filter>
void variances_stay_positive(std::int64_t first_ns, std::int64_t period_ns) {
    Filter filter;
    Sample s;
    s.accel_m_s2 = {25.2f, 25.2f, 25.2f};
    s.mag_uT = {0, 20, -45};
    s.flags = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    for (int i = 0; i < 120; ++i) {
        s.t_ns += i < 3 ? first_ns : period_ns;
        filter.push(s);
        for (std::size_t k = 0; k < Filter::State::size; ++k)
            ASSERT_GE(filter.state().covariance(k, k), 0)
                << i << ' ' << k << ' ' << first_ns << ' ' << period_ns;
    }
}
TEST(AttitudeDevices, VariancesStayPositiveWhereSamplesAreRare) {
    for (const std::int64_t first_ms : {20, 128, 200})
        for (std::int64_t period_ms = 300; period_ms < 400; period_ms += 7) {
            variances_stay_positive<Attitude>(first_ms * 1'000'000, period_ms * 1'000'000);
            variances_stay_positive<AttitudeImu>(first_ms * 1'000'000, period_ms * 1'000'000);
        }
}

TEST(AttitudeDevices, ParametersAreChecked) {
    AttitudeParams params;
    EXPECT_TRUE(check(params));
    params.velocity_m_s = 0;
    EXPECT_STREQ(check(params).field, "velocity_m_s");
    params.velocity_m_s = std::nanf("");
    EXPECT_STREQ(check(params).field, "velocity_m_s");
    EXPECT_THROW(apply_settings(params, {"velocity_ms=1"}), BadSpec);
    EXPECT_THROW(apply_settings(params, {"velocity_m_s=1000"}), BadSpec);
    apply_settings(params, {"velocity_m_s=3", "field_s=4"});
    EXPECT_EQ(params.velocity_m_s, 3);
}

// ---- smoothing

TEST(AttitudeSmoothing, TheWholeRecordingKnowsMore) {
    SimPlan p = plan("fast", 60);
    p.cut_s = 15;
    const Recording r = simulate(p).recording;
    for (const AttitudeMode mode : {AttitudeMode::imu_mag, AttitudeMode::imu}) {
        const Score causal = scored(r, run_attitude(r, mode), 5);
        const auto smooth = smooth_attitude(r, mode);
        EXPECT_GE(smooth.size() + 2, r.samples.size());
        EXPECT_LT(scored(r, smooth, 5).inclination_deg, 0.7 * causal.inclination_deg);
    }
    EXPECT_THROW(smooth_attitude(r, AttitudeMode::gyro), BadSpec);
}

TEST(AttitudeSmoothing, ALagIsALag) {
    const Recording r = simulate(plan("hand", 30)).recording;
    LaggedAttitude<50> lagged;
    Attitude plain;
    std::vector<Pose> causal, out;
    for (const Sample& s : r.samples) {
        if (const auto pose = plain.push(s)) causal.push_back(*pose);
        if (const auto pose = lagged.push(s)) out.push_back(*pose);
    }
    ASSERT_EQ(out.size() + 50, causal.size());
    EXPECT_EQ(out.back().t_ns, causal[causal.size() - 51].t_ns);
    while (const auto pose = lagged.flush()) out.push_back(*pose);
    ASSERT_EQ(out.size(), causal.size());
    double moved = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
        ASSERT_EQ(out[i].t_ns, causal[i].t_ns);
        moved = std::max(moved, static_cast<double>(rotation_angle(out[i].q_wb, causal[i].q_wb)));
    }
    EXPECT_GT(moved, 0.1 * deg) << "it must have learned something";
    EXPECT_LT(static_cast<double>(rotation_angle(out.back().q_wb, causal.back().q_wb)), 0.01 * deg);
}

TEST(AttitudeSmoothing, ALagHelpsAfterADisturbedStart) {
    SimPlan p = plan("fast", 50);
    p.cut_s = 15;
    const Recording r = simulate(p).recording;
    LaggedAttitude<200> lagged;
    std::vector<Pose> out;
    for (const Sample& s : r.samples)
        if (const auto pose = lagged.push(s)) out.push_back(*pose);
    EXPECT_LT(scored(r, out, 3).inclination_deg, nine(r, 3).inclination_deg);
}

// ---- score, Euler angles, temperature

TEST(Align, RemovesAConstantOffsetAndNothingElse) {
    const Recording r = simulate(plan("hand", 20)).recording;
    const Quat turn = from_rotation_vector(Vec3{0, 0, 1.1f});
    const Quat any = from_rotation_vector(Vec3{0.3f, -0.2f, 0.9f});
    std::vector<Pose> turned = r.truth, tilted = r.truth;
    for (Pose& pose : turned) pose.q_wb = turn * pose.q_wb;
    for (Pose& pose : tilted) pose.q_wb = any * pose.q_wb;
    EXPECT_GT(score(r, turned).total_deg, 60);
    EXPECT_LT(score(r, aligned(r, turned, Align::heading)).total_deg, 0.05);  // float
    EXPECT_GT(score(r, aligned(r, tilted, Align::heading)).total_deg, 15);
    EXPECT_LT(score(r, aligned(r, tilted, Align::rotation)).total_deg, 0.05);
}

TEST(Euler, KeepsTheAngleThatRemains) {
    const auto angles = [](double yaw, double pitch, double roll) {
        const EulerAngles<double> e{yaw * deg, pitch * deg, roll * deg};
        const EulerAngles<double> back = euler_angles(from_euler_angles(e));
        return EulerAngles<double>{back.yaw / deg, back.pitch / deg, back.roll / deg};
    };
    const auto up = angles(25, 90, 40), down = angles(25, -90, 40);
    EXPECT_NEAR(up.pitch, 90, 1e-6);
    EXPECT_NEAR(up.yaw, -15, 1e-6);  // yaw - roll is what is left
    EXPECT_EQ(up.roll, 0);
    EXPECT_NEAR(down.pitch, -90, 1e-6);
    EXPECT_NEAR(down.yaw, 65, 1e-6);  // yaw + roll
    const auto plain = angles(-170, 30, 100);
    EXPECT_NEAR(plain.yaw, -170, 1e-9);
    EXPECT_NEAR(plain.pitch, 30, 1e-9);
    EXPECT_NEAR(plain.roll, 100, 1e-9);
}

TEST(Euler, GivesTheRotationBack) {
    Random random{3};
    for (int i = 0; i < 20000; ++i) {
        const auto axis = random.direction();
        const BasicQuat<double> q = from_rotation_vector(random.uniform(0, 6.2) * axis);
        ASSERT_LT(rotation_angle(q, from_euler_angles(euler_angles(q))), 1e-9);
        // close to the pole, in float
        const EulerAngles<float> e{static_cast<float>(random.uniform(-3, 3)),
                                   static_cast<float>(pi_v<double> / 2 - random.uniform(0, 2e-3)),
                                   static_cast<float>(random.uniform(-3, 3))};
        const Quat p = from_euler_angles(e);
        ASSERT_LT(rotation_angle(p, from_euler_angles(euler_angles(p))), 2e-3f);
    }
}

TEST(TemperatureTable, FollowsABiasThatIsNoStraightLine) {
    const auto truth = [](float c) {
        const float u = (c - 25) / 20;
        return Vec3{0.02f * u * u, -0.01f * u, 0.005f};
    };
    GyroTableFit<16> fit{0, 4};
    EXPECT_EQ(fit.result().status(), Status::not_enough_data);
    for (float c = 2; c < 62; c += 0.1f) fit.push(truth(c), c);
    fit.push(Vec3{std::nanf(""), 0, 0}, 20);
    fit.push(Vec3{}, 200);
    EXPECT_EQ(fit.outside(), 1u);
    fit.push(Vec3{0, GyroTableFit<16>::bias_max_rad_s, 0}, 30);  // so large: no bias
    const auto table = fit.result();
    ASSERT_TRUE(table);
    for (float c = 4; c < 60; c += 0.7f) EXPECT_LT(norm(table->at(c) - truth(c)), 6e-4f) << c;
    EXPECT_LT(norm(table->at(-50) - truth(2.95f)), 1e-3f) << "the ends hold";

    Sample s;
    s.gyro_rad_s = truth(40) + Vec3{0.5f, 0, 0};
    s.temperature_c = 40;
    EXPECT_EQ((*table)(s).gyro_rad_s.x, s.gyro_rad_s.x) << "no valid temperature";
    s.flags = flag::temperature_valid;
    EXPECT_NEAR((*table)(s).gyro_rad_s.x, 0.5f, 1e-3f);
}

}  // namespace
}  // namespace fairlead::sim
