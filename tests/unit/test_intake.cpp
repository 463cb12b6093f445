// The gate: each kind of fault by hand, then all of them at random, with a book kept beside it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <vector>

#include "fairlead/sense/intake.hpp"
#include "tests/ref/rotation.hpp"

using namespace fairlead;

namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::uint32_t both = flag::position_valid | flag::orientation_valid;
constexpr std::uint32_t six_axes = flag::gyro_valid | flag::accel_valid;
constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();
constexpr float inf_f = std::numeric_limits<float>::infinity();

/// A living stream: no value repeats.
Pose pose_at(std::int64_t t_ns) {
    const double t = static_cast<double>(t_ns) * 1e-9;
    return {t_ns, ref::narrow(ref::V{std::sin(t), t, 1 - t}),
            ref::narrow(ref::from_vector({t, std::cos(t), 0.5})), both};
}

std::vector<std::int64_t> accepted_times(Intake<Pose>& intake,
                                         const std::vector<std::int64_t>& times) {
    std::vector<std::int64_t> out;
    for (const std::int64_t t : times)
        if (const auto y = intake.push(pose_at(t))) out.push_back(y->t_ns);
    return out;
}

using Times = std::vector<std::int64_t>;

}  // namespace

TEST(Intake, GoodRecordsPassUnchanged) {
    Intake<Pose> intake;
    for (int i = 0; i < 100; ++i) {
        const Pose in = pose_at(i * 8 * ms);
        const auto out = intake.push(in);
        ASSERT_TRUE(out);
        EXPECT_EQ(out->t_ns, in.t_ns);
        EXPECT_EQ(out->flags, in.flags);
        EXPECT_EQ(out->p_w_m.x, in.p_w_m.x);
        EXPECT_EQ(out->q_wb.w, in.q_wb.w);
        EXPECT_EQ(out->q_wb.y, in.q_wb.y);
    }
    EXPECT_EQ(intake.faults().total(), 0u);
    EXPECT_FALSE(intake.flush());
}

TEST(Intake, TimeRises) {
    Intake<Pose> intake;
    EXPECT_EQ(
        accepted_times(intake, {10 * ms, 20 * ms, 20 * ms, 5 * ms, 30 * ms, 30 * ms, 40 * ms}),
        (Times{10 * ms, 20 * ms, 30 * ms, 40 * ms}));
    EXPECT_EQ(intake.faults()[Fault::repeated_time], 2u);
    EXPECT_EQ(intake.faults()[Fault::backward_time], 1u);
    EXPECT_EQ(intake.faults().total(), 3u);
}

TEST(Intake, ALoneWrongStampCostsItself) {
    constexpr std::int64_t far = std::numeric_limits<std::int64_t>::max();
    Intake<Pose> intake;
    EXPECT_EQ(
        accepted_times(intake, {-10 * ms, 0, far, 20 * ms, -far - 1, 30 * ms, 25 * ms, 40 * ms}),
        (Times{-10 * ms, 0, 20 * ms, 30 * ms, 40 * ms}));
    EXPECT_EQ(intake.faults()[Fault::leap], 1u);
    EXPECT_EQ(intake.faults()[Fault::backward_time], 2u);
    EXPECT_EQ(intake.faults().total(), 3u);
}

// Up to leap_ns ahead it passes as a record after a pause; it must not silence what follows it.
TEST(Intake, AStampAMinuteAheadSilencesNothing) {
    for (const std::int64_t ahead : {50 * ms, 200 * ms, 59'900 * ms}) {
        Intake<Pose> intake;
        Times in{0, 10 * ms, 20 * ms + ahead};
        for (int i = 3; i < 100; ++i) in.push_back(i * 10 * ms);
        Times out = accepted_times(intake, in);
        if (const auto last = intake.flush()) out.push_back(last->t_ns);
        EXPECT_EQ(out, in) << ahead;
        EXPECT_EQ(intake.faults()[Fault::new_run], 1u);
        EXPECT_EQ(intake.faults()[Fault::gap], ahead == 50 * ms ? 1u : 2u);
    }
}

// Back to any time, ahead by any time: the first record waits for the second, and nothing is lost.
TEST(Intake, ANewClockLosesNothing) {
    constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
    constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
    const Times starts{
        0,           495 * ms, -1,       least,         least + 1, 1'700'000'000'000 * ms,
        61'000 * ms, 10 * ms,  480 * ms, most - 50 * ms};
    for (const std::int64_t start : starts) {
        SCOPED_TRACE(start);
        Intake<Pose> intake;
        Times in{500 * ms, 510 * ms};
        for (int i = 0; i < 5; ++i) in.push_back(start + i * 10 * ms);
        std::vector<Pose> out;
        for (const std::int64_t t : in)
            if (const auto y = intake.push(pose_at(t))) out.push_back(*y);
        ASSERT_NE(intake.waiting(), nullptr);
        EXPECT_EQ(out.size(), in.size() - 1);
        if (const auto y = intake.idle()) out.push_back(*y);
        EXPECT_FALSE(intake.idle() || intake.flush());
        ASSERT_EQ(out.size(), in.size());
        for (std::size_t i = 0; i < in.size(); ++i) {
            EXPECT_EQ(out[i].t_ns, in[i]);
            EXPECT_EQ((out[i].flags & flag::new_run) != 0, i == 2);
            EXPECT_EQ((out[i].flags & flag::gap_before) != 0, i == 2);
            EXPECT_EQ((out[i].flags & flag::orientation_gap) != 0, i == 2);
        }
        EXPECT_EQ(intake.faults()[Fault::new_run], 1u);
    }
}

TEST(Intake, TheEndOfAStreamBelievesADoubtfulRecord) {
    Intake<Pose> intake;
    ASSERT_TRUE(intake.push(pose_at(500 * ms)));
    ASSERT_FALSE(intake.push(pose_at(10 * ms)));
    EXPECT_FALSE(intake.refused());
    EXPECT_FALSE(intake.idle());  // it stays
    ASSERT_NE(intake.waiting(), nullptr);
    const auto last = intake.flush();
    ASSERT_TRUE(last);
    EXPECT_EQ(last->t_ns, 10 * ms);
    EXPECT_EQ(last->flags & ~both,
              flag::new_run | flag::gap_before | flag::position_gap | flag::orientation_gap);
    EXPECT_FALSE(intake.flush());
    intake.reset();
    EXPECT_TRUE(intake.push(pose_at(-500 * ms)));
    EXPECT_EQ(intake.faults()[Fault::new_run], 1u);
}

// The record that waits leaves in the push of one that is refused, or of one that is doubtful.
TEST(Intake, ARecordWaitsForOnePushAtMost) {
    Intake<Pose> intake;
    const auto time_of = [](const std::optional<Pose>& pose) { return pose ? pose->t_ns : -1; };
    EXPECT_EQ(time_of(intake.push(pose_at(500 * ms))), 500 * ms);
    EXPECT_EQ(time_of(intake.push(pose_at(10 * ms))), -1);
    EXPECT_EQ(time_of(intake.push(pose_at(10 * ms))), -1);  // a repeated stamp says nothing
    EXPECT_TRUE(intake.refused());
    EXPECT_EQ(time_of(intake.push(pose_at(500 * ms))), -1);  // nor does this one
    EXPECT_TRUE(intake.refused());
    EXPECT_EQ(intake.faults()[Fault::repeated_time], 2u);
    EXPECT_EQ(time_of(intake.push(pose_at(20 * ms))), 10 * ms);
    EXPECT_FALSE(intake.refused());
    EXPECT_EQ(time_of(intake.push(pose_at(30 * ms))), 20 * ms);
    EXPECT_EQ(time_of(intake.push(pose_at(5 * ms))), 30 * ms);
    EXPECT_EQ(time_of(intake.push(pose_at(40 * ms))), 40 * ms);  // 5 ms was wrong: at once again
    EXPECT_EQ(time_of(intake.push(pose_at(5 * ms))), -1);
    EXPECT_EQ(time_of(intake.push(pose_at(6 * ms))), 5 * ms);
    EXPECT_EQ(time_of(intake.push(pose_at(6 * ms))), 6 * ms);
    EXPECT_TRUE(intake.refused());
    EXPECT_EQ(time_of(intake.push(pose_at(16 * ms))), 16 * ms);
    EXPECT_EQ(intake.faults()[Fault::backward_time], 1u);
    EXPECT_EQ(intake.faults()[Fault::new_run], 2u);
}

TEST(Intake, GapFlagsOfADoubtfulRecordMoveOn) {
    Intake<Pose> intake;
    ASSERT_TRUE(intake.push(pose_at(500 * ms)));
    Pose wrong = pose_at(10 * ms);
    wrong.flags |= flag::position_gap;
    ASSERT_FALSE(intake.push(wrong));
    const auto next = intake.push(pose_at(510 * ms));
    ASSERT_TRUE(next);
    EXPECT_EQ(next->flags, both | flag::position_gap);
    Pose forged = pose_at(520 * ms);  // the bit is the intake's own
    forged.flags |= flag::new_run;
    EXPECT_EQ(intake.push(forged)->flags, both);
}

// What the stages behind cannot carry is refused here, and only that.
TEST(Intake, LimitsAreTheirs) {
    IntakeLimits limits;
    limits.spacing_min_ns = ms;
    limits.position_max_m = 2;
    limits.run_ns_max = 100 * ms;
    Intake<Pose> intake{{}, limits};
    EXPECT_EQ(accepted_times(intake, {0, ms - 1, ms, 2 * ms - 1, 2 * ms}), (Times{0, ms, 2 * ms}));
    EXPECT_EQ(intake.faults()[Fault::too_close], 2u);
    EXPECT_EQ(intake.push(pose_at(100 * ms))->flags & flag::new_run, 0u);
    EXPECT_EQ(intake.push(pose_at(101 * ms))->flags & flag::new_run, flag::new_run);
    EXPECT_EQ(intake.push(pose_at(201 * ms))->flags & flag::new_run, 0u);
    Pose far = pose_at(202 * ms);
    far.p_w_m.z = -2;
    EXPECT_EQ(intake.push(far)->flags & (flag::position_valid | flag::new_run),
              flag::position_valid | flag::new_run);
    EXPECT_EQ(intake.faults()[Fault::new_run], 2u);
    far.t_ns += 10 * ms;
    far.p_w_m.z = 2.0000002f;
    EXPECT_EQ(intake.push(far)->flags & flag::position_valid, 0u);
    far.t_ns += 10 * ms;
    far.p_w_m = {2, -2, 2};
    EXPECT_NE(intake.push(far)->flags & flag::position_valid, 0u);
    // doubtful records keep the spacing, too
    Intake<Pose> close{{}, limits};
    EXPECT_EQ(accepted_times(close, {500 * ms, 10 * ms, 10 * ms + 1, 11 * ms, 12 * ms}),
              (Times{500 * ms, 10 * ms, 11 * ms}));
    EXPECT_EQ(close.faults()[Fault::too_close], 1u);
}

TEST(Intake, WhatNobodyTakesIsClearedWithItsFlags) {
    Intake<Pose, flag::position_valid> position;
    Intake<Pose, flag::orientation_valid> orientation;
    Intake<Sample, six_axes> inertial;
    Pose pose = pose_at(0);
    pose.flags |= flag::position_gap | flag::orientation_gap | flag::clipped;
    const auto p = position.push(pose), q = orientation.push(pose);
    EXPECT_EQ(p->flags, flag::position_valid | flag::position_gap | flag::clipped);
    EXPECT_EQ(p->p_w_m.y, pose.p_w_m.y);
    EXPECT_EQ(p->q_wb.z, 0);
    EXPECT_EQ(q->flags, flag::orientation_valid | flag::orientation_gap | flag::clipped);
    EXPECT_EQ(q->p_w_m.z, 0);
    EXPECT_EQ(q->q_wb.z, pose.q_wb.z);
    Sample sample;
    sample.mag_uT = {nan_f, 0, 0};
    sample.flags = six_axes | flag::mag_valid;
    const auto s = inertial.push(sample);
    EXPECT_EQ(s->flags, six_axes);
    EXPECT_EQ(s->mag_uT.x, 0);
    EXPECT_EQ(inertial.faults().total(), 0u);
}

TEST(Intake, VectorsOfAnyLength) {
    IntakeLimits limits;
    limits.value_max = 8;
    Intake<VectorSample<5>> intake{{}, limits};
    VectorSample<5> in{0, {1, 2, -8, 8, 5}, flag::vector_valid};
    EXPECT_EQ(intake.push(in)->flags, +flag::vector_valid);
    for (const float bad : {8.000001f, -9.0f, nan_f, inf_f}) {
        in.t_ns += 10 * ms;
        in.value[4] = bad;
        const auto out = intake.push(in);
        ASSERT_TRUE(out);
        EXPECT_EQ(out->flags, 0u);
        EXPECT_EQ(out->value[0], 0);
    }
    in.t_ns += 110 * ms;
    in.value[4] = 0;
    EXPECT_EQ(intake.push(in)->flags, flag::vector_valid | flag::vector_gap | flag::gap_before);
    EXPECT_EQ(intake.faults()[Fault::out_of_range], 2u);
    EXPECT_EQ(intake.faults()[Fault::not_finite], 2u);
}

TEST(Intake, AVectorIsStuckWhereAllItsComponentsAre) {
    IntakeParams params;
    params.stuck_records = 4;
    for (int moving = -1; moving < 3; ++moving) {
        Intake<VectorSample<3>> intake{params};
        for (int i = 0; i < 10; ++i) {
            VectorSample<3> in{i * 10 * ms, {1, 2, 3}, flag::vector_valid};
            if (moving >= 0) in.value[static_cast<std::size_t>(moving)] += static_cast<float>(i);
            const auto out = intake.push(in);
            ASSERT_TRUE(out);
            const bool stuck = moving < 0 && i >= 3;
            EXPECT_EQ((out->flags & flag::vector_valid) == 0, stuck) << moving << ' ' << i;
            EXPECT_EQ((out->flags & flag::stuck) != 0, stuck) << moving << ' ' << i;
        }
    }
}

TEST(Intake, RefusesParametersByName) {
    const auto field = [](auto change, const IntakeLimits& limits = {}) {
        IntakeParams params;
        change(params);
        const Check found = check(params, limits);
        EXPECT_EQ(static_cast<bool>(found), found.field[0] == 0);
        Intake<Pose> intake{params, limits};  // refused parameters accept nothing
        EXPECT_EQ(static_cast<bool>(intake.push(pose_at(0))), static_cast<bool>(found));
        EXPECT_EQ(intake.refused(), !found);
        return std::string{found.field};
    };
    static_assert(check(IntakeParams{}));
    IntakeLimits limits;
    limits.gap_ns_max = 200 * ms;
    limits.spacing_min_ns = 20 * ms;
    limits.value_max = 7;
    EXPECT_EQ(field([](auto&) {}, limits), "");
    EXPECT_EQ(field([](auto& p) { p.gap_ns = -1; }), "gap_ns");
    EXPECT_EQ(field([](auto& p) { p.gap_ns = 200 * ms; }, limits), "");
    EXPECT_EQ(field([](auto& p) { p.gap_ns = 200 * ms + 1; }, limits), "gap_ns");
    EXPECT_EQ(field([](auto& p) { p.gap_ns = 20 * ms - 1; }, limits), "gap_ns");
    EXPECT_EQ(field([](auto& p) { p.leap_ns = 0; }), "leap_ns");
    EXPECT_EQ(field([](auto& p) { p.leap_ns = 100 * ms; }), "");
    EXPECT_EQ(field([](auto& p) { p.leap_ns = 100 * ms - 1; }), "leap_ns");
    EXPECT_EQ(field([](auto& p) { p.position_max_m = 1e4f; }), "");
    EXPECT_EQ(field([](auto& p) { p.position_max_m = 1.0001e4f; }), "position_max_m");
    EXPECT_EQ(field([](auto& p) { p.position_max_m = nan_f; }), "position_max_m");
    EXPECT_EQ(field([](auto& p) { p.value_max = 7.1f; }, limits), "value_max");
    EXPECT_EQ(field([](auto& p) { p.gyro_max_rad_s = 0; }), "gyro_max_rad_s");
    EXPECT_EQ(field([](auto& p) { p.accel_max_m_s2 = -1; }), "accel_max_m_s2");
    EXPECT_EQ(field([](auto& p) { p.mag_max_uT = inf_f; }), "mag_max_uT");
    EXPECT_EQ(field([](auto& p) { p.unit_tolerance = 1; }), "unit_tolerance");
}

TEST(Intake, TheDefaultPauseSuitsTheRate) {
    const auto hz = [](std::int64_t rate) { return 1'000'000'000 / rate; };
    EXPECT_EQ(default_gap_ns(hz(100)), 120 * ms);
    EXPECT_EQ(default_gap_ns(hz(120)), 100 * ms);
    EXPECT_EQ(default_gap_ns(hz(400)), 100 * ms);
    EXPECT_EQ(default_gap_ns(hz(1000)), 64 * ms);
    EXPECT_EQ(default_gap_ns(hz(8)), 1500 * ms);  // each record of a slow sensor is no gap
    EXPECT_EQ(default_gap_ns(hz(1)), 12'000 * ms);
}

TEST(Intake, APauseIsAGap) {
    IntakeParams params;
    params.gap_ns = 50 * ms;
    Intake<Pose> intake{params};
    const Times times{0, 50 * ms, 101 * ms, 110 * ms};
    for (const std::int64_t t : times) {
        const auto out = intake.push(pose_at(t));
        ASSERT_TRUE(out);
        const bool gap = t == 101 * ms;
        EXPECT_EQ((out->flags & flag::gap_before) != 0, gap);
        EXPECT_EQ((out->flags & flag::position_gap) != 0, gap);
        EXPECT_EQ((out->flags & flag::orientation_gap) != 0, gap);
    }
    EXPECT_EQ(intake.faults()[Fault::gap], 1u);
    EXPECT_EQ(intake.faults().total(), 1u);
}

TEST(Intake, AChannelThatWasAwayComesBackWithAGap) {
    Intake<Pose> intake;
    for (int i = 0; i < 60; ++i) {
        Pose in = pose_at(i * 10 * ms);
        if (i >= 20 && i < 40) in.flags = flag::position_valid;
        if (i == 50) in.flags = flag::orientation_valid;  // one record is no gap
        const auto out = intake.push(in);
        ASSERT_TRUE(out);
        EXPECT_EQ(out->flags & both, in.flags & both);
        EXPECT_EQ(out->flags & ~both, i == 40 ? +flag::orientation_gap : 0u) << i;
    }
    EXPECT_EQ(intake.faults()[Fault::gap], 1u);
}

TEST(Intake, GapFlagsOfTheSourceAreKeptUntilTheyCanBeTold) {
    Intake<Pose> intake;
    ASSERT_TRUE(intake.push(pose_at(10 * ms)));
    Pose refused = pose_at(10 * ms);
    refused.flags |= flag::gap_before;
    EXPECT_FALSE(intake.push(refused));
    auto out = intake.push(pose_at(20 * ms));
    ASSERT_TRUE(out);
    EXPECT_EQ(out->flags, both | flag::gap_before);

    Pose broken = pose_at(30 * ms);
    broken.flags |= flag::position_gap;
    broken.p_w_m.x = nan_f;
    out = intake.push(broken);
    ASSERT_TRUE(out);
    EXPECT_EQ(out->flags, +flag::orientation_valid);
    out = intake.push(pose_at(40 * ms));
    ASSERT_TRUE(out);
    EXPECT_EQ(out->flags, both | flag::position_gap);
    EXPECT_EQ(intake.faults()[Fault::gap], 2u);
}

TEST(Intake, BadValuesTakeTheirChannelOnly) {
    const auto check = [](const Vec3& p, const Quat& q, std::uint32_t valid, Fault fault) {
        Intake<Pose> intake;
        ASSERT_TRUE(intake.push(pose_at(0)));
        const auto out = intake.push({ms, p, q, both});
        ASSERT_TRUE(out);
        EXPECT_EQ(out->flags, valid);
        EXPECT_TRUE(is_finite(out->p_w_m) && is_finite(out->q_wb));
        EXPECT_EQ(intake.faults()[fault], 1u);
        EXPECT_EQ(intake.faults().total(), 1u);
    };
    const Quat one{};
    check({nan_f, 0, 0}, one, flag::orientation_valid, Fault::not_finite);
    check({0, 0, -inf_f}, one, flag::orientation_valid, Fault::not_finite);
    check({0, 2e4f, 0}, one, flag::orientation_valid, Fault::out_of_range);
    check({}, {1, 0, nan_f, 0}, flag::position_valid, Fault::not_finite);
    check({}, {inf_f, 0, 0, 0}, flag::position_valid, Fault::not_finite);
    check({}, {0, 0, 0, 0}, flag::position_valid, Fault::not_unit);
    check({}, {1, 0.2f, 0, 0}, flag::position_valid, Fault::not_unit);
    check({}, {3e38f, 3e38f, 0, 0}, flag::position_valid, Fault::not_unit);
    check({}, {0.98f, 0, 0, 0}, flag::position_valid, Fault::not_unit);
}

TEST(Intake, QuaternionsAreMendedAndKeepTheirSide) {
    Intake<Pose> intake;
    std::mt19937_64 random{1};
    Quat before;
    for (int i = 0; i < 1000; ++i) {
        Pose in = pose_at(i * 10 * ms);
        const float scale =
            (random() & 1 ? 1.0f : -1.0f) * (1 + 0.009f * std::sin(static_cast<float>(i)));
        const Quat q = in.q_wb;
        in.q_wb = {q.w * scale, q.x * scale, q.y * scale, q.z * scale};
        const auto out = intake.push(in);
        ASSERT_TRUE(out);
        ASSERT_EQ(out->flags, both);
        EXPECT_NEAR(dot(out->q_wb, out->q_wb), 1, 1e-6);
        EXPECT_LT(ref::angle(ref::of(out->q_wb), ref::of(q)), 1e-6);
        if (i > 0) {
            EXPECT_GT(dot(before, out->q_wb), 0);
        }
        before = out->q_wb;
    }
    EXPECT_EQ(intake.faults().total(), 0u);
}

TEST(Intake, FrozenValues) {
    IntakeParams params;
    params.stuck_records = 5;
    Intake<Sample> intake{params};
    for (int i = 0; i < 30; ++i) {
        Sample in{i * ms, {1, 2, static_cast<float>(i)}, {0, 0, 9.8f}, {}, six_axes};
        if (i >= 20) in.accel_m_s2.x = static_cast<float>(i);  // it lives again
        const auto out = intake.push(in);
        ASSERT_TRUE(out);
        const bool frozen = i >= 4 && i < 20;
        EXPECT_EQ(out->flags, frozen ? flag::gyro_valid | flag::stuck : six_axes) << i;
        EXPECT_EQ(out->gyro_rad_s.z, static_cast<float>(i));
        if (frozen) {
            EXPECT_EQ(out->accel_m_s2.z, 0);
        }
    }
    EXPECT_EQ(intake.faults()[Fault::stuck], 16u);
}

TEST(Intake, SamplesHaveTheirOwnRanges) {
    Intake<Sample> intake;
    constexpr std::uint32_t nine = six_axes | flag::mag_valid;
    auto out = intake.push({0, {101, 0, 0}, {2001, 0, 0}, {0, 0, -5001}, nine});
    ASSERT_TRUE(out);
    EXPECT_EQ(out->flags, 0u);
    EXPECT_EQ(intake.faults()[Fault::out_of_range], 3u);
    out = intake.push({ms, {99, 0, 0}, {-1999, 0, 0}, {0, nan_f, 0}, nine});
    ASSERT_TRUE(out);
    EXPECT_EQ(out->flags, six_axes);
    EXPECT_EQ(out->mag_uT.y, 0);
    EXPECT_EQ(out->accel_m_s2.x, -1999);
}

// Faults at random, several kinds in one record; what comes out is held against the rules.
TEST(Intake, RandomFaultsNeverGetThrough) {
    for (unsigned seed = 1; seed <= 30; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random{seed};
        const auto chance = [&random](int one_in) { return random() % unsigned(one_in) == 0; };
        const auto bad = [&random]() -> float {
            constexpr float values[] = {nan_f, inf_f, -inf_f, 3e38f, -1e30f, 1e5f};
            return values[random() % 6];
        };
        Intake<Pose> intake;
        std::int64_t t = 0, last_out = 0, last_p = 0, last_q = 0;
        bool any_out = false, any_p = false, any_q = false;
        std::uint64_t in_count = 0, out_count = 0, expected_bad = 0, gaps = 0, runs = 0;
        std::map<std::int64_t, std::pair<bool, bool>> sent;  // by time: is the position bad, ...
        const auto take = [&](const std::optional<Pose>& out) {
            if (!out) return;
            ++out_count;
            ASSERT_EQ(sent.count(out->t_ns), 1u);
            const auto [bad_p, bad_q] = sent[out->t_ns];
            expected_bad += bad_p + bad_q;
            const bool run = (out->flags & flag::new_run) != 0;
            runs += run;
            ASSERT_TRUE(run || !any_out || out->t_ns > last_out);
            ASSERT_TRUE(is_finite(out->p_w_m) && is_finite(out->q_wb));
            ASSERT_EQ((out->flags & flag::position_valid) == 0, bad_p);
            ASSERT_EQ((out->flags & flag::orientation_valid) == 0, bad_q);
            ASSERT_LE(approx::absolute(out->p_w_m.x), 1e4f);
            ASSERT_NEAR(dot(out->q_wb, out->q_wb), 1, 1e-6);
            if (run) any_p = any_q = any_out = false;
            const auto gap = [&](bool any, std::int64_t last) {
                return any && out->t_ns - last > 100 * ms;
            };
            ASSERT_EQ((out->flags & flag::gap_before) != 0, run || gap(any_out, last_out));
            const bool p_gap = (out->flags & flag::position_gap) != 0;
            const bool q_gap = (out->flags & flag::orientation_gap) != 0;
            // a run that begins while a channel is away is told when the channel comes back
            if (any_p) {
                ASSERT_EQ(p_gap, !bad_p && gap(any_p, last_p));
            } else {
                ASSERT_EQ(p_gap, !bad_p && runs > 0);
            }
            if (any_q) {
                ASSERT_EQ(q_gap, !bad_q && gap(any_q, last_q));
            } else {
                ASSERT_EQ(q_gap, !bad_q && runs > 0);
            }
            gaps +=
                (out->flags & (flag::gap_before | flag::position_gap | flag::orientation_gap)) != 0;
            last_out = out->t_ns;
            any_out = true;
            if (!bad_p) last_p = out->t_ns, any_p = true;
            if (!bad_q) last_q = out->t_ns, any_q = true;
        };
        for (int i = 0; i < 5000; ++i) {
            t += chance(200) ? 500 * ms : 8 * ms;
            Pose in = pose_at(t);
            if (i > 0 && chance(30)) in.t_ns -= static_cast<std::int64_t>(random() % 3) * 8 * ms;
            if (i > 0 && chance(200)) in.t_ns = static_cast<std::int64_t>(random());
            const bool bad_p = i > 0 && chance(20), bad_q = i > 0 && chance(20);
            if (bad_p) (&in.p_w_m.x)[random() % 3] = bad();
            if (bad_q) (&in.q_wb.w)[random() % 4] = bad();
            ++in_count;
            const auto before = sent.find(in.t_ns);
            if (before == sent.end())
                sent[in.t_ns] = {bad_p, bad_q};
            else if (before->second != std::pair{bad_p, bad_q}) {
                --in_count;
                continue;
            }
            take(intake.push(in));
            if (HasFatalFailure()) return;
        }
        take(intake.flush());
        const FaultCounts& f = intake.faults();
        EXPECT_EQ(in_count, out_count + f[Fault::repeated_time] + f[Fault::backward_time] +
                                f[Fault::leap] + f[Fault::too_close]);
        EXPECT_EQ(f[Fault::not_finite] + f[Fault::out_of_range] + f[Fault::not_unit], expected_bad);
        EXPECT_EQ(f[Fault::gap], gaps);
        EXPECT_EQ(f[Fault::new_run], runs);
        EXPECT_GT(out_count, 4500u);  // no single fault silences the stream
    }
}

// Any times at all, drawn so that they often meet: whatever comes, the order holds, each record is
// given once or counted, and it waits for one push at most.
TEST(Intake, AnyTimesAtAll) {
    const Times corners{
        std::numeric_limits<std::int64_t>::min(), -60'000 * ms, -1, 0, 1, ms, 100 * ms, 60'000 * ms,
        std::numeric_limits<std::int64_t>::max()};
    for (unsigned seed = 1; seed <= 2000; ++seed) {
        std::mt19937_64 random{seed};
        IntakeLimits limits;
        limits.spacing_min_ns = 1 + static_cast<std::int64_t>(random() % 3) * ms;
        limits.run_ns_max = random() % 2 ? IntakeLimits::run_ns : 500 * ms;
        limits.first_waits = random() % 2;
        Intake<Pose> intake{{}, limits};
        std::vector<std::int64_t> given;  // not yet seen again, oldest first
        std::uint64_t in_count = 0, out_count = 0;
        std::int64_t last = 0, base = 0, t = 0;
        const auto refused = [&] {
            const FaultCounts& f = intake.faults();
            return f[Fault::repeated_time] + f[Fault::backward_time] + f[Fault::leap] +
                   f[Fault::too_close];
        };
        const auto take = [&](const std::optional<Pose>& out) {
            if (!out) return;
            while (!given.empty() && given.front() != out->t_ns) given.erase(given.begin());
            ASSERT_FALSE(given.empty()) << "seed " << seed;
            given.erase(given.begin());
            if (out_count == 0 || (out->flags & flag::new_run)) {
                base = out->t_ns;
            } else {
                ASSERT_GE(out->t_ns, last) << "seed " << seed;
                ASSERT_GE(out->t_ns - last, limits.spacing_min_ns) << "seed " << seed;
                ASSERT_LE(out->t_ns - base, limits.run_ns_max) << "seed " << seed;
                ASSERT_LE(out->t_ns - last, 60'000 * ms) << "seed " << seed;
            }
            last = out->t_ns;
            ++out_count;
        };
        for (int i = 0; i < 60; ++i) {
            const auto step = static_cast<std::int64_t>(random() % 40) * ms / 2;
            const std::uint64_t wrapped = static_cast<std::uint64_t>(t);
            switch (random() % 8) {
                case 0: t = corners[random() % corners.size()]; break;
                case 1:
                    t = static_cast<std::int64_t>(wrapped - static_cast<std::uint64_t>(step));
                    break;
                case 2:
                    t = static_cast<std::int64_t>(wrapped + static_cast<std::uint64_t>(50 * step));
                    break;
                default: t = static_cast<std::int64_t>(wrapped + static_cast<std::uint64_t>(step));
            }
            given.push_back(t);
            ++in_count;
            take(intake.push(pose_at(t)));
            if (random() % 16 == 0) take(intake.idle());
            const std::uint64_t inside = intake.waiting() ? 1 : 0;
            ASSERT_EQ(in_count, out_count + refused() + inside) << "seed " << seed;
        }
        take(intake.flush());
        ASSERT_EQ(in_count, out_count + refused()) << "seed " << seed;
        if (HasFatalFailure()) return;
    }
}
