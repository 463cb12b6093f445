// The attitude filter on sensors that nobody tuned it for: any rate, uneven time, slow or missing
// magnetometers, gaps, noise, coarse counts, bias beyond belief, any mounting, garbage. Truth is
// known; bounds hold for every seed.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "fairlead/sense/attitude.hpp"
#include "fairlead/sense/frames.hpp"
#include "fairlead/sense/intake.hpp"
#include "tests/ref/imu_motion.hpp"

namespace {

using namespace fairlead;
using ref::World;

struct Found {
    double inclination{}, heading{};              // worst, degrees
    double inclination_e2_s2{}, heading_e2_s2{};  // means of squared errors over reported variances
    double settled_s{1e9};                        // first pose that is not settling
    double settling{};                            // share of the poses from from_s that are
};

using Keep = std::function<bool(Sample&, double t_s)>;
const Keep all = [](Sample&, double) { return true; };

/// Errors from from_s to to_s of the motion, of the samples that `keep` lets pass.
Found run(const World& world, double from_s, double to_s, const Keep& keep = all,
          const AttitudeParams& params = {}) {
    constexpr double deg = 57.29577951308232;
    ref::ImuMotion motion{world};
    Attitude filter{params};
    Found out;
    double n = 0;
    while (motion.time() < to_s) {
        Sample s = motion.next();
        if (!keep(s, motion.time())) continue;
        const auto pose = filter.push(s);
        if (!pose) continue;
        EXPECT_TRUE(is_finite(pose->q_wb));
        const bool settling = (pose->flags & flag::settling) != 0;
        if (!settling) out.settled_s = std::min(out.settled_s, motion.time());
        if (motion.time() < from_s) continue;
        const auto e = ref::attitude_errors(pose->q_wb, motion.truth());
        out.inclination = std::max(out.inclination, e.inclination_deg);
        out.heading = std::max(out.heading, e.heading_deg);
        const double si = deg * static_cast<double>(filter.inclination_sigma());
        const double sh = deg * static_cast<double>(filter.heading_sigma());
        out.inclination_e2_s2 += e.inclination_deg * e.inclination_deg / (si * si);
        out.heading_e2_s2 += e.heading_deg * e.heading_deg / (sh * sh);
        out.settling += settling ? 1 : 0;
        n += 1;
    }
    out.inclination_e2_s2 /= n;
    out.heading_e2_s2 /= n;
    out.settling /= n;
    return out;
}

constexpr std::array<std::uint64_t, 2> seeds{1, 2};

class Seeded : public testing::TestWithParam<std::uint64_t> {
  protected:
    World world() const {
        World w;
        w.seed = GetParam();
        return w;
    }
};
using AttitudeDelivery = Seeded;

TEST_P(AttitudeDelivery, AnySampleRateServes) {
    for (const double rate_hz : {20.0, 50.0, 100.0, 400.0, 1000.0}) {
        for (const double speed : {1.0, 3.0}) {
            SCOPED_TRACE(testing::Message() << rate_hz << " Hz, speed " << speed);
            World w = world();
            w.rate_hz = rate_hz;
            w.speed = speed;
            const Found f = run(w, 16, 40);
            EXPECT_LT(f.inclination, 1.0);
            EXPECT_LT(f.heading, 1.0);
            EXPECT_LT(f.settled_s, 4);
        }
    }
}

TEST_P(AttitudeDelivery, AStartInMotionSettlesAtAnyRate) {
    for (const double rate_hz : {50.0, 200.0, 1000.0}) {
        SCOPED_TRACE(rate_hz);
        World w = world();
        w.rate_hz = rate_hz;
        w.still_s = 0;
        const Found f = run(w, 15, 40);
        EXPECT_LT(f.inclination, 1.0);
        EXPECT_LT(f.heading, 1.5);
        EXPECT_LT(f.settled_s, 8);
    }
}

TEST_P(AttitudeDelivery, UnevenTimeStampsAreTakenAsTheyAre) {
    World w = world();
    w.jitter = 0.6;
    const Found f = run(w, 16, 40);
    EXPECT_LT(f.inclination, 0.8);
    EXPECT_LT(f.heading, 1.2);
}

TEST_P(AttitudeDelivery, ASlowMagnetometerTellsAsMuch) {
    for (const int every : {4, 29, 286}) {  // 70, 10 and 1 Hz
        SCOPED_TRACE(every);
        World w = world();
        w.mag_every = every;
        const Found f = run(w, 16, 50);
        EXPECT_LT(f.inclination, 0.9);
        EXPECT_LT(f.heading, 1.2);
        EXPECT_LT(f.settled_s, every > 100 ? 9 : 4);  // at 1 Hz it waits for a handful of readings
    }
}

TEST_P(AttitudeDelivery, GapsAreBridgedAndOutagesSurvived) {
    for (const double gap_s : {0.05, 0.15, 0.35, 0.6, 3.0}) {
        SCOPED_TRACE(gap_s);
        const Keep gaps = [&](Sample&, double t_s) {
            return t_s < 12 || std::fmod(t_s, 10) > gap_s;
        };
        const Found f = run(world(), 12, 62, gaps);
        EXPECT_LT(f.inclination_e2_s2, 3);  // what is not known is not claimed
        EXPECT_LT(f.heading_e2_s2, 3);
        if (gap_s < 0.2) {
            EXPECT_LT(f.inclination, 2.0);
            EXPECT_LT(f.heading, 3.0);
        }
    }
}

TEST_P(AttitudeDelivery, NoisyAndCoarseSensorsServeWorseButServe) {
    World gyro = world(), accel = world(), mag = world(), coarse = world(), quiet = world();
    gyro.gyro_noise = 0.05;  // 3 deg/s
    accel.accel_noise = 1;
    mag.mag_noise = 3;
    coarse.gyro_step = 0.0175;  // 1 deg/s, and 15 mg
    coarse.accel_step = 0.15;
    coarse.mag_step = 0.6;
    coarse.gyro_noise = coarse.accel_noise = coarse.mag_noise = 0;
    quiet.gyro_noise = quiet.accel_noise = quiet.mag_noise = 0;
    for (const World& w : {gyro, accel, mag, coarse}) {
        const Found f = run(w, 15, 60);
        EXPECT_LT(f.inclination, 4.0);
        EXPECT_LT(f.heading, 4.0);
        EXPECT_LT(f.settled_s, 8);  // where noise hides the rest, prove_s must pass
        EXPECT_LT(f.inclination_e2_s2, 2);
    }
    const Found f = run(quiet, 16, 40);  // numbers that repeat at rest are no dead axes
    EXPECT_LT(f.inclination, 0.9);
    EXPECT_LT(f.heading, 0.5);
}

TEST_P(AttitudeDelivery, FieldsOfEveryPlaceServeAsFarAsTheyCan) {
    for (const auto& [horizontal, up] : {std::pair{35.0, 10.0}, {18.0, -42.0}, {8.0, 57.0}}) {
        World w = world();
        w.horizontal_uT = horizontal;
        w.up_uT = up;
        SCOPED_TRACE(horizontal);
        EXPECT_LT(run(w, 16, 40).heading, 2.0);
    }
    World pole = world();
    pole.horizontal_uT = 0.3;
    pole.up_uT = 60;
    const Found f = run(pole, 16, 40);
    EXPECT_LT(f.inclination, 0.9);
    EXPECT_EQ(f.settling, 1) << "there is no heading to be had, and the filter says so";
}

TEST_P(AttitudeDelivery, ABiasBeyondBeliefIsDoubtedNotHidden) {
    constexpr double deg = 0.017453292519943295;
    AttitudeParams raised, narrow;
    raised.bias_rad_s = static_cast<float>(7 * deg);
    narrow.bias_max_rad_s = static_cast<float>(2 * deg);
    for (const double bias : {3.0, 7.0}) {
        SCOPED_TRACE(bias);
        World w = world();
        w.bias = {bias * deg, -bias * deg, bias * deg};
        const Found f = run(w, 20, 90, all, narrow);
        EXPECT_GT(f.settling, 0.5);
        EXPECT_LT(f.inclination_e2_s2, bias < 5 ? 2 : 20);
        const Found g = run(w, 16, 40, all, raised);
        EXPECT_LT(g.inclination, 0.9);
        EXPECT_LT(g.heading, 0.5);
        w.still_s = 0;
        const Found h = run(w, 30, 60, all, raised);
        EXPECT_LT(h.inclination, 0.6);
        EXPECT_LT(h.heading, 0.8);
    }
}

// A board may sit in any of 24 ways: the body turns, the answer does not.
TEST_P(AttitudeDelivery, IsTheSameInEveryMounting) {
    World w = world();
    w.scale_x = 0.01;
    constexpr std::array<Axis, 6> axes{Axis::plus_x,  Axis::minus_x, Axis::plus_y,
                                       Axis::minus_y, Axis::plus_z,  Axis::minus_z};
    std::vector<AxisMap> maps;
    for (const Axis x : axes)
        for (const Axis y : axes)
            for (const Axis z : axes)
                if (AxisMap{x, y, z}.is_rotation()) maps.push_back({x, y, z});
    ASSERT_EQ(maps.size(), 24u);
    ref::ImuMotion motion{w};
    Attitude plain;
    std::vector<Attitude> turned(maps.size());
    while (motion.time() < 20) {
        const Sample s = motion.next();
        const auto q_ws = plain.push(s)->q_wb;
        for (std::size_t i = 0; i < maps.size(); ++i) {
            const auto q_wb = turned[i].push(mounted(s, maps[i]))->q_wb;
            ASSERT_LT(rotation_angle(q_wb * maps[i].rotation(), q_ws), 2e-4f)
                << "mounting " << i << " at " << motion.time() << " s";
        }
    }
}

TEST_P(AttitudeDelivery, TimeHasNoOrigin) {
    ref::ImuMotion motion{world()};
    Attitude now, later;
    for (int i = 0; i < 4000; ++i) {
        Sample s = motion.next();
        const auto a = now.push(s);
        s.t_ns += 8'000'000'000'000'000'000;  // 253 years
        const auto b = later.push(s);
        ASSERT_EQ(a->q_wb.x, b->q_wb.x);
        ASSERT_EQ(a->q_wb.z, b->q_wb.z);
        ASSERT_EQ(a->flags, b->flags);
    }
}

// Whatever an intake lets pass: the state stays finite, the covariance positive, and afterwards
// the filter finds its way back.
TEST_P(AttitudeDelivery, GarbageLeavesNoTrace) {
    sim::Random random{GetParam() + 100};
    ref::ImuMotion motion{world()};
    Intake<Sample> intake;
    Attitude filter;
    const auto wild = [&](Vec3& v) {
        const float huge = static_cast<float>(std::pow(10, 8 * random.uniform() - 2));
        const std::array<float, 5> values{huge, -huge, 0, std::numeric_limits<float>::quiet_NaN(),
                                          std::numeric_limits<float>::infinity()};
        float* const parts[] = {&v.x, &v.y, &v.z};
        *parts[random.below(3)] = values[random.below(values.size())];
    };
    while (motion.time() < 180) {
        Sample s = motion.next();
        const bool garbage = motion.time() > 5 && motion.time() < 80;
        if (garbage && random.uniform() < 0.3) {
            if (random.uniform() < 0.3) wild(s.gyro_rad_s);
            if (random.uniform() < 0.3) wild(s.accel_m_s2);
            if (random.uniform() < 0.3) wild(s.mag_uT);
            if (random.uniform() < 0.2)
                s.flags &= static_cast<std::uint32_t>(random.below(1u << 13));
            if (random.uniform() < 0.2) s.flags |= flag::clipped;
            if (random.uniform() < 0.1) s.t_ns -= static_cast<std::int64_t>(random.below(1u << 30));
        }
        if (garbage && random.uniform() < 0.01) motion.next();
        const auto sample = intake.push(s);
        if (!sample) continue;
        const auto pose = filter.push(*sample);
        if (!pose) continue;
        ASSERT_TRUE(is_finite(pose->q_wb)) << motion.time();
        ASSERT_NEAR(dot(pose->q_wb, pose->q_wb), 1, 2e-3f);
        for (std::size_t i = 0; i < Attitude::State::size; ++i)
            ASSERT_GE(filter.state().covariance(i, i), 0)
                << "state " << i << " at " << motion.time();
        ASSERT_TRUE(is_finite(filter.bias_rad_s()));
        if (motion.time() < 170) continue;  // what it had learned of the gyro was spoilt, too
        const auto e = ref::attitude_errors(pose->q_wb, motion.truth());
        ASSERT_LT(e.inclination_deg, 1.5) << motion.time();
        ASSERT_LT(e.heading_deg, 3.0) << motion.time();
    }
}

INSTANTIATE_TEST_SUITE_P(Seed, AttitudeDelivery, testing::ValuesIn(seeds));

}  // namespace
