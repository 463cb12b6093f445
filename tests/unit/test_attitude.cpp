// The attitude filter on motions with known truth: what it converges to, what it survives, and the
// laws that it keeps. Recordings and their figures: docs/attitude.md.
#include "fairlead/sense/attitude.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fairlead/sense/attitude_gyro.hpp"
#include "fairlead/sense/intake.hpp"
#include "host_sim/generate/random.hpp"
#include "tests/ref/imu_motion.hpp"

namespace {

using namespace fairlead;

using ref::AttitudeErrors;
using Motion = ref::ImuMotion;
using World = ref::World;
using ref::attitude_errors;

constexpr std::int64_t period_ns = 3'500'000;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Worst errors between two times, after `spoil` has had its way with every sample.
template <class Filter, class Spoil>
AttitudeErrors worst(Filter& filter, Motion& motion, double from_s, double to_s, Spoil spoil) {
    AttitudeErrors most;
    while (motion.time() < to_s) {
        Sample s = motion.next();
        spoil(s, motion.time());
        const auto pose = filter.push(s);
        if (!pose) continue;
        EXPECT_TRUE(is_finite(pose->q_wb));
        if (motion.time() < from_s) continue;
        const AttitudeErrors e = attitude_errors(pose->q_wb, motion.truth());
        most.total_deg = std::max(most.total_deg, e.total_deg);
        most.inclination_deg = std::max(most.inclination_deg, e.inclination_deg);
    }
    return most;
}
const auto leave = [](Sample&, double) {};

TEST(Attitude, FindsOrientationAndBiasFromRest) {
    Motion motion{World{}};
    Attitude filter;
    const AttitudeErrors e = worst(filter, motion, 5, 60, leave);
    EXPECT_LT(e.inclination_deg, 1.0);
    EXPECT_LT(e.total_deg, 2.0);
    EXPECT_NEAR(filter.bias_rad_s().x, 0.004, 0.0005);
    EXPECT_NEAR(filter.bias_rad_s().y, -0.006, 0.0005);
    EXPECT_NEAR(filter.bias_rad_s().z, 0.003, 0.0005);
}

TEST(Attitude, LearnsAScaleErrorInMotion) {
    World world;
    world.scale_x = 0.015;
    Motion motion{world};
    Attitude filter;
    worst(filter, motion, 100, 100, leave);
    EXPECT_NEAR(filter.state().gyro_matrix.xx, 0.015, 0.004);
    EXPECT_NEAR(filter.state().gyro_matrix.yy, 0, 0.004);
}

TEST(Attitude, StartsInMotion) {
    World world;
    world.still_s = 0;
    Motion motion{world};
    Attitude filter;
    const AttitudeErrors e = worst(filter, motion, 20, 60, leave);
    EXPECT_LT(e.inclination_deg, 1.5);
    EXPECT_LT(e.total_deg, 4.0);
}

TEST(Attitude, TheMagnetometerCannotTouchTheInclination) {
    Motion a{World{}}, b{World{}};
    Attitude nine;
    AttitudeImu six;
    for (int i = 0; i < 10000; ++i) {
        const auto p = nine.push(a.next());
        const auto q = six.push(b.next());
        ASSERT_TRUE(p && q);
        const Vec3 up9 = rotate(conj(p->q_wb), Vec3{0, 0, 1});
        const Vec3 up6 = rotate(conj(q->q_wb), Vec3{0, 0, 1});
        ASSERT_NEAR(norm(up9 - up6), 0, 1e-4) << i;  // 0.006 deg: rounding in two frames
    }
}

TEST(Attitude, ForgetsNothingOverNaNDropOutsAndBadTime) {
    for (const double outage_s : {0.02, 0.3, 0.9, 10.0}) {
        Motion motion{World{}};
        Attitude filter;
        const auto spoil = [&](Sample& s, double t) {
            if (t < 20 || t >= 20 + outage_s) return;
            s.gyro_rad_s.x = s.accel_m_s2.y = s.mag_uT.z = static_cast<float>(not_a_number);
        };
        const AttitudeErrors e = worst(filter, motion, 45, 60, spoil);
        EXPECT_LT(e.inclination_deg, 1.5) << outage_s;
        EXPECT_LT(e.total_deg, 4.0) << outage_s;
    }
}

TEST(Attitude, EachSensorMayFailAlone) {
    for (int sensor = 0; sensor < 3; ++sensor) {
        Motion motion{World{}};
        Attitude filter;
        const auto spoil = [&](Sample& s, double t) {
            if (t < 20 || t > 24) return;
            s.flags &= ~(sensor == 0   ? flag::gyro_valid
                         : sensor == 1 ? flag::accel_valid
                                       : flag::mag_valid);
        };
        const AttitudeErrors e = worst(filter, motion, 45, 60, spoil);
        EXPECT_LT(e.inclination_deg, 1.5) << sensor;
        EXPECT_LT(e.total_deg, 4.0) << sensor;
    }
}

TEST(Attitude, InvalidReadingsAreNotCalledValid) {
    Motion motion{World{}};
    Attitude filter;
    Sample s = motion.next();
    s.flags = 0;
    EXPECT_FALSE(filter.push(s)) << "nothing is known yet";
    EXPECT_TRUE(filter.push(motion.next()));
    s = motion.next();
    s.flags = flag::accel_valid;
    const auto pose = filter.push(s);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->flags & flag::orientation_valid, 0u);
    s = motion.next();
    EXPECT_TRUE(filter.push(s));
    EXPECT_FALSE(filter.push(s)) << "no time has passed";
    s.t_ns -= period_ns;
    EXPECT_FALSE(filter.push(s)) << "time goes back";
}

TEST(Attitude, BridgesLostSamples) {
    World world;
    world.still_s = 5;
    Motion motion{world};
    Attitude filter;
    sim::Random random{3};
    int burst = 0;
    double sum = 0;
    int n = 0;
    while (motion.time() < 40) {
        const Sample s = motion.next();
        if (burst == 0 && random.uniform() < 0.01) burst = 20;
        if (burst > 0) {
            --burst;
            continue;
        }
        const auto pose = filter.push(s);
        if (motion.time() < 6) continue;
        const double e = attitude_errors(pose->q_wb, motion.truth()).inclination_deg;
        sum += e * e;
        ++n;
    }
    EXPECT_LT(std::sqrt(sum / n), 0.7);  // 0.59; with the newest rate held over the gaps 0.81
}

TEST(Attitude, RecoversFromAClippedGyro) {
    Motion motion{World{}};
    Attitude filter;
    bool flagged = false;
    const auto clip = [&](Sample& s, double t) {
        if (t > 30) return;
        for (float* x : {&s.gyro_rad_s.x, &s.gyro_rad_s.y, &s.gyro_rad_s.z}) {
            if (std::abs(*x) < 1.4f) continue;
            *x = std::clamp(*x, -1.4f, 1.4f);
            s.flags |= flag::clipped | flag::gyro_clipped;
        }
        flagged = flagged || (filter.state().flags & flag::clipped) != 0;
    };
    const AttitudeErrors e = worst(filter, motion, 50, 90, clip);
    EXPECT_TRUE(flagged);
    EXPECT_LT(e.inclination_deg, 1.5);
    EXPECT_LT(e.total_deg, 4.0);
}

TEST(Attitude, AnAxisThatDiesIsNoticedAndOneThatRestsIsNot) {
    for (const bool moving : {true, false}) {
        Motion motion{World{}};
        Attitude filter;
        float last = 0;
        const double from = moving ? 20 : 5;
        const auto hold = [&](Sample& s, double t) {
            if (t < from) last = s.gyro_rad_s.y;
            if (t >= from && t < from + 2) s.gyro_rad_s.y = last;
        };
        worst(filter, motion, from, from + 0.2, hold);
        EXPECT_EQ(filter.state().flags & flag::clipped, 0u) << "too early to tell";
        const float before = filter.inclination_sigma();
        worst(filter, motion, from, from + 0.6, hold);
        EXPECT_EQ((filter.state().flags & flag::clipped) != 0, moving);
        worst(filter, motion, from, from + 1.9, hold);
        EXPECT_EQ(filter.inclination_sigma() > 3 * before, moving);
        const AttitudeErrors e = worst(filter, motion, from + 25, from + 45, hold);
        EXPECT_LT(e.inclination_deg, 1.5);
        EXPECT_EQ(filter.state().flags & flag::clipped, 0u);
    }
}

TEST(Attitude, AClippedSensorSpeaksForItselfAlone) {
    const auto worst_with = [](flag::Bits flags) {
        Motion motion{World{}};
        Attitude filter;
        const auto mark = [flags](Sample& s, double t) {
            s.flags |= t > 20 && t < 30 ? flags : 0u;
        };
        worst(filter, motion, 29, 29, mark);
        return std::pair{filter.inclination_sigma(), filter.state().flags & flag::clipped};
    };
    const auto plain = worst_with(0);
    const auto mag = worst_with(flag::clipped | flag::mag_clipped);
    EXPECT_NEAR(mag.first, plain.first, 0.01f * plain.first) << "the others are trusted";
    EXPECT_EQ(mag.second, 0u);
    const auto gyro = worst_with(flag::clipped | flag::gyro_clipped);
    const auto accel = worst_with(flag::clipped | flag::accel_clipped);
    EXPECT_GT(gyro.first, 1.5f * plain.first);
    EXPECT_GT(accel.first, 1.5f * plain.first);
    EXPECT_NE(gyro.second, 0u);
    EXPECT_NE(accel.second, 0u);
    const auto any = worst_with(flag::clipped);  // from nobody knows which
    EXPECT_GT(any.first, gyro.first);
}

TEST(Attitude, AMagnetometerThatRepeatsItselfBlindsNobody) {
    Motion a{World{}}, b{World{}};
    IntakeParams params;
    params.stuck_records = 20;
    Intake<Sample> intake{params};
    Attitude plain, held;
    Vec3 last{};
    for (int i = 0; i < 10000; ++i) {
        Sample s = a.next(), t = b.next();
        if (i % 100 == 0) last = s.mag_uT;
        s.mag_uT = last;  // a driver that delivers the last reading again
        if (i % 100 >= 19) t.flags &= ~flag::mag_valid;
        t.mag_uT = last;
        const auto p = held.push(*intake.push(s)), q = plain.push(t);
        ASSERT_EQ(p->q_wb.x, q->q_wb.x) << i;
        ASSERT_EQ(p->q_wb.z, q->q_wb.z) << i;
    }
    EXPECT_EQ(held.state().blind_s, 0);
}

TEST(Attitude, BelievesANewFieldOnceItIsSteady) {
    Motion motion{World{}};
    AttitudeParams params;
    Attitude filter{params};
    // indoors now: the field is weaker and steeper, and stays so
    const auto indoors = [&](Sample& s, double t) {
        if (t < 40) return;
        s.mag_uT += ref::narrow(motion.to_body({0, -5, -15}));
    };
    worst(filter, motion, 50, 50, indoors);
    EXPECT_NE(filter.state().flags & flag::mag_rejected, 0u);
    // the reference that takes over is the new field as a whole, not one on its way there
    const auto& field = filter.state().field;
    for (auto weight = field.weight_s; field.weight_s >= weight && motion.time() < 100;) {
        weight = field.weight_s;
        const double until = motion.time() + 0.01;
        worst(filter, motion, 100, until, indoors);
    }
    EXPECT_NEAR(field.up, -57, 3);
    EXPECT_NEAR(field.horizontal, 13, 1.5);
    EXPECT_NEAR(field.residual2, 0, 15);
    const AttitudeErrors e = worst(filter, motion, 100, 120, indoors);
    EXPECT_EQ(filter.state().flags & flag::mag_rejected, 0u);
    EXPECT_NEAR(filter.state().field.up, -57, 3);
    EXPECT_LT(e.total_deg, 3.0);
}

TEST(Attitude, TheForceIsOffBeyondAnAngleAndNotAtIt) {
    using Filter = KalmanStep<double, AttitudeMode::imu>;
    AttitudeState<double, AttitudeMode::imu> state;
    constexpr float angle = 0.25f;
    constexpr double slope = angle * (1 + angle * angle / 3);  // its tangent, to the third order
    const auto off = [&](double x, double y, double z) {
        state.force_m_s2 = {x, y, z};
        return Filter::force_is_off(state, angle);
    };
    EXPECT_FALSE(off(0, 0, 9.81));
    EXPECT_FALSE(off(8 * slope, 0, 8));
    EXPECT_FALSE(off(0, -0.999 * 8 * slope, 8));
    EXPECT_TRUE(off(1.001 * 8 * slope, 0, 8));
    EXPECT_TRUE(off(0.8 * 8 * slope, -0.8 * 8 * slope, 8));
    EXPECT_TRUE(off(0, 0, -9.81)) << "upside down";
    EXPECT_TRUE(off(0, 0, 0)) << "no force says nothing of the vertical";
}

TEST(Attitude, CorrectionsThatKeepTheirSideUnsettle) {
    struct Case {
        float most_rad, over_s;
        bool unsettles;
    };
    for (const Case& c : {Case{2e-3f, 5, true}, Case{2e-3f, 0.1f, false}, Case{3, 5, false}}) {
        AttitudeParams params;
        params.force_tilt = params.settled_tilt = 1;  // the corrections speak alone
        params.corrected_max = c.most_rad;
        params.corrected_s = c.over_s;
        AttitudeImu filter{params};
        Sample s;
        s.flags = flag::gyro_valid | flag::accel_valid;
        bool settling = false;
        for (int i = 0; i < 6600; ++i) {  // ten seconds of rest, then an acceleration that lasts
            const bool rests = i < 3000;
            const auto wobble = static_cast<float>(0.02 * std::sin(0.4 * i));
            s.t_ns += period_ns;
            s.accel_m_s2 = {rests ? 0 : 2.0f, wobble, 9.81f};
            s.gyro_rad_s = {(rests ? 0.01f : 3.0f) * wobble, 0, 0};
            const auto pose = filter.push(s);
            ASSERT_TRUE(pose);
            settling = (settling && i != 2990) || (pose->flags & flag::settling) != 0;
            if (i == 2999) {
                ASSERT_FALSE(settling);
            }
        }
        EXPECT_EQ(settling, c.unsettles) << c.most_rad << " over " << c.over_s;
    }
}

TEST(Attitude, RestAdaptsToANoisySensor) {
    World world;
    world.gyro_noise = 0.015;  // 0.9 deg/s: a fixed limit of 2 deg/s would see motion for ever
    world.accel_noise = 0.1;
    Motion motion{world};
    Attitude filter;
    worst(filter, motion, 9, 9, leave);
    EXPECT_TRUE(filter.resting());
    worst(filter, motion, 12, 12, leave);
    EXPECT_FALSE(filter.resting());
}

TEST(Attitude, ASteadyTurnIsNoRest) {
    Attitude filter;
    AttitudeGyro gyro;
    Sample s;
    s.flags = flag::gyro_valid | flag::accel_valid;
    s.accel_m_s2 = {0, 0, 9.81f};
    s.gyro_rad_s = {0, 0, 0.5f};  // a turntable, as steady as a bias but too fast for one
    for (int i = 0; i < 10000; ++i) {
        s.t_ns += period_ns;
        const auto pose = gyro.push(s);
        filter.push(s);
        ASSERT_FALSE(filter.resting());
        ASSERT_EQ(pose->flags & flag::rest, 0u);
    }
    EXPECT_NEAR(filter.bias_rad_s().z, 0, 1e-3f);
    EXPECT_EQ(gyro.bias_rad_s().z, 0);
}

TEST(Attitude, FloatFollowsDouble) {
    Motion a{World{}}, b{World{}};
    Attitude single;
    BasicAttitude<double, AttitudeMode::imu_mag> wide;
    double sum = 0;
    int n = 0;
    for (; n < 20000; ++n) {
        const auto p = single.push(a.next());
        wide.push(b.next());
        const auto q = wide.orientation();
        const ref::Q reference{q.w, q.x, q.y, q.z};
        const double e = attitude_errors(p->q_wb, reference).total_deg;
        sum += e * e;
    }
    EXPECT_LT(std::sqrt(sum / n), 0.02);
}

TEST(Attitude, ASavedStateGoesOnBitForBit) {
    Motion motion{World{}};
    Attitude filter;
    for (int i = 0; i < 5000; ++i) filter.push(motion.next());
    auto saved = save(filter.state());
    Attitude other;
    const auto state = restore(saved);
    ASSERT_TRUE(state);
    other.restore_all(*state);
    for (int i = 0; i < 2000; ++i) {
        const Sample s = motion.next();
        const auto p = filter.push(s), q = other.push(s);
        ASSERT_EQ(p->q_wb.w, q->q_wb.w);
        ASSERT_EQ(p->q_wb.x, q->q_wb.x);
        ASSERT_EQ(p->q_wb.z, q->q_wb.z);
    }
    for (std::size_t i = 0; i < sizeof saved; i += 7) {  // every damage is noticed
        auto damaged = saved;
        reinterpret_cast<unsigned char*>(&damaged)[i] ^= 0x10u;
        const bool padding = i >= offsetof(decltype(saved), crc) + sizeof saved.crc ||
                             (i >= 8 && i < offsetof(decltype(saved), value));
        EXPECT_EQ(static_cast<bool>(restore(damaged)), padding) << i;
    }
    saved.version += 1;
    EXPECT_FALSE(restore(saved));
}

TEST(Attitude, KnownBiasSettlesAtOnce) {
    Motion motion{World{}};
    Attitude filter;
    for (int i = 0; i < 20000; ++i) filter.push(motion.next());
    Attitude again;
    again.restore_knowledge(filter.state());
    World moving;
    moving.still_s = 0;
    moving.seed = 9;
    Motion next{moving};
    const AttitudeErrors e = worst(again, next, 15, 40, leave);
    EXPECT_LT(e.total_deg, 3.0);
    EXPECT_NEAR(again.bias_rad_s().x, 0.004, 0.0005);
}

TEST(Attitude, PredictsAtTheRateSeen) {
    Motion motion{World{}};
    Attitude filter;
    for (int i = 0; i < 12000; ++i) filter.push(motion.next());
    const auto now = filter.orientation(), later = filter.predict(0.02f);
    const auto turned = rotation_vector(conj(now) * later);
    EXPECT_NEAR(norm(turned - 0.02f * filter.rate_rad_s()), 0, 1e-4);
}

TEST(Attitude, AccelerationIsFreeOfGravity) {
    World world;
    world.accel_noise = 0;
    Motion motion{world};
    Attitude filter;
    while (motion.time() < 9) filter.push(motion.next());
    Sample s = motion.next();
    filter.push(s);
    EXPECT_NEAR(norm(filter.earth_acceleration(s)), 0, 0.05);
    const ref::V push_w{1, -2, 0.5};  // m/s^2, east north up
    s.accel_m_s2 += ref::narrow(motion.to_body(push_w));
    const Vec3 earth = filter.earth_acceleration(s), body = filter.linear_acceleration(s);
    EXPECT_NEAR(norm(earth - ref::narrow(push_w)), 0, 0.1);
    EXPECT_NEAR(norm(body - ref::narrow(motion.to_body(push_w))), 0, 0.1);
}

TEST(Attitude, SettlesOnlyWhenBothAnglesAreKnown) {
    Motion a{World{}}, b{World{}};
    Attitude both, blind;
    int settled = 0;
    while (a.time() < 9) {
        Sample s = b.next();
        s.flags &= ~flag::mag_valid;
        both.push(a.next());
        const auto pose = blind.push(s);
        settled += (pose->flags & flag::settling) == 0 ? 1 : 0;
    }
    EXPECT_EQ(both.state().flags & flag::settling, 0u);
    EXPECT_EQ(settled, 0) << "without a magnetometer there is no heading";
    EXPECT_GT(blind.heading_sigma(), 0.5f);
    EXPECT_LT(blind.inclination_sigma(), 0.01f);
    Attitude fresh;
    fresh.push(a.next());
    EXPECT_GT(fresh.inclination_sigma(), 0.5f) << "one reading is no levelling";
    EXPECT_GT(fresh.heading_sigma(), 0.5f);
}

TEST(Attitude, ReportsWhatNoRestCanTell) {
    World world;
    world.still_s = 1e9;
    Motion motion{world};
    AttitudeParams params;
    Attitude filter{params};
    while (motion.time() < 300) filter.push(motion.next());
    // the zero of the accelerometer on both axes, and magnetic north: all that is left
    const float tilt = params.sigma_scale * std::sqrt(2.0f) * params.accel_offset_m_s2 / 9.81f;
    EXPECT_GE(filter.inclination_sigma(), tilt);
    EXPECT_LT(filter.inclination_sigma(), 1.3f * tilt);
    EXPECT_GE(filter.heading_sigma(), params.sigma_scale * params.field_offset);
    // and by the dip, what the zero of an uncalibrated accelerometer does to the heading
    const float dip = static_cast<float>(world.up_uT / world.horizontal_uT);
    const float zero = dip * params.accel_zero_m_s2 / 9.81f;
    const float left = std::hypot(params.field_offset, zero);
    EXPECT_LT(filter.heading_sigma(), 1.5f * params.sigma_scale * left);
}

TEST(Attitude, LevelsUpsideDown) {
    Attitude filter;
    Sample s;
    s.flags = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    s.accel_m_s2 = {0, 0, -9.81f};
    s.mag_uT = {0, 18, 42};
    for (int i = 0; i < 1000; ++i) {
        s.t_ns += period_ns;
        const auto pose = filter.push(s);
        const Vec3 up_b = rotate(conj(pose->q_wb), Vec3{0, 0, 1});
        const Vec3 north_b = rotate(conj(pose->q_wb), Vec3{0, 1, 0});
        ASSERT_NEAR(up_b.z, -1, 1e-5f) << i;
        ASSERT_NEAR(north_b.y, 1, 1e-4f) << i;
    }
}

TEST(Attitude, AGapIsPassedOn) {
    Motion motion{World{}};
    Attitude filter;
    filter.push(motion.next());
    Sample s = motion.next();
    s.flags |= flag::gap_before;
    EXPECT_NE(filter.push(s)->flags & flag::gap_before, 0u);
    EXPECT_EQ(filter.push(motion.next())->flags & flag::gap_before, 0u);
}

TEST(Attitude, CovarianceStaysPositive) {
    Motion motion{World{}};
    Attitude filter;
    const std::size_t n = Attitude::State::size;
    for (int i = 0; i < 40000; ++i) {
        filter.push(motion.next());
        if (i % 97 != 0 || i < 200) continue;
        const auto& p = filter.state().covariance;
        std::array<std::array<double, 14>, 14> l{};  // Cholesky in double, of the scaled matrix
        for (std::size_t r = 0; r < n; ++r)
            for (std::size_t c = 0; c <= r; ++c) {
                double sum = static_cast<double>(p(r, c)) /
                             std::sqrt(static_cast<double>(p(r, r)) * static_cast<double>(p(c, c)));
                for (std::size_t k = 0; k < c; ++k) sum -= l[r][k] * l[c][k];
                if (r == c) {
                    ASSERT_GT(sum, 0) << "sample " << i << " state " << r;
                }
                l[r][c] = r == c ? std::sqrt(sum) : sum / l[c][c];
            }
    }
}

TEST(AttitudeGyro, FollowsTruthAndLearnsItsBiasAtRest) {
    Motion motion{World{}};
    AttitudeGyro filter;
    Quat start;
    ref::Q truth_at_start{};
    double worst_deg = 0;
    for (int i = 0; i < 10000; ++i) {
        const auto pose = filter.push(motion.next());
        ASSERT_TRUE(pose);
        if (motion.time() < 9.9) {
            start = pose->q_wb;
            truth_at_start = motion.truth();
            continue;
        }
        const Quat moved = conj(start) * pose->q_wb;
        const ref::Q truly = ref::mul(ref::inverse(truth_at_start), motion.truth());
        worst_deg = std::max(worst_deg, attitude_errors(moved, truly).total_deg);
    }
    EXPECT_NEAR(filter.bias_rad_s().y, -0.006, 0.0005);
    EXPECT_LT(worst_deg, 1.0);
}

TEST(AttitudeGyro, AGapTeachesNoBias) {
    AttitudeGyro filter;
    Sample s;
    s.flags = flag::gyro_valid;
    for (int i = 0; i < 2000; ++i) {  // it rests, and its bias is known
        s.t_ns += period_ns;
        filter.push(s);
    }
    s.gyro_rad_s = {0, 0, 0.02f};  // a slow turn after an hour's silence
    s.t_ns += 3'600'000'000'000;
    const auto pose = filter.push(s);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->flags & flag::rest, 0u);
    EXPECT_EQ(filter.bias_rad_s().z, 0);
}

TEST(AttitudeGyro, SaysThatItIsClipped) {
    AttitudeParams params;
    params.gyro_full_scale_rad_s = 4;
    AttitudeGyro filter{params};
    Sample s;
    s.flags = flag::gyro_valid;
    for (const float rate : {3.0f, 3.99f, 3.0f}) {
        s.t_ns += period_ns;
        s.gyro_rad_s.y = -rate;
        const auto pose = filter.push(s);
        if (s.t_ns > period_ns) {
            EXPECT_EQ((pose->flags & flag::clipped) != 0, rate > 3.9f);
        }
    }
}

}  // namespace
