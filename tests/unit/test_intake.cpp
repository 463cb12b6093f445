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

TEST(Intake, ADamagedStampDoesNotSilenceTheStream) {
    constexpr std::int64_t far = std::numeric_limits<std::int64_t>::max();
    Intake<Pose> intake;
    EXPECT_EQ(accepted_times(intake, {-10 * ms, 0, far, 20 * ms, far - 1, 30 * ms}),
              (Times{-10 * ms, 0, 20 * ms, 30 * ms}));
    EXPECT_EQ(intake.faults()[Fault::leap], 2u);
    // two records that agree are believed: the board was off for two minutes
    const std::int64_t later = 120'000 * ms;
    EXPECT_FALSE(intake.push(pose_at(later)));
    const auto out = intake.push(pose_at(later + 10 * ms));
    ASSERT_TRUE(out);
    EXPECT_TRUE(out->flags & flag::gap_before);
    EXPECT_TRUE(intake.push(pose_at(later + 20 * ms)));
}

TEST(Intake, AClockThatStartsAgainIsTakenOnlyOnRequest) {
    const Times times{500 * ms, 510 * ms, 10 * ms, 20 * ms, 30 * ms, 40 * ms};
    Intake<Pose> never;
    EXPECT_EQ(accepted_times(never, times), (Times{500 * ms, 510 * ms}));
    IntakeParams params;
    params.restart_records = 2;
    Intake<Pose> after_two{params};
    EXPECT_EQ(accepted_times(after_two, times), (Times{500 * ms, 510 * ms, 30 * ms, 40 * ms}));
    EXPECT_EQ(after_two.faults()[Fault::gap], 1u);
    never.reset();
    EXPECT_EQ(accepted_times(never, {10 * ms}), (Times{10 * ms}));
    EXPECT_EQ(never.faults()[Fault::backward_time], 4u);
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
        std::int64_t t = 0, last_out = -1, last_p = -1, last_q = -1;
        std::uint64_t in_count = 0, out_count = 0, expected_bad = 0, gaps = 0;
        for (int i = 0; i < 5000; ++i) {
            t += chance(200) ? 500 * ms : 8 * ms;
            Pose in = pose_at(t);
            if (i > 0 && chance(30)) in.t_ns -= static_cast<std::int64_t>(random() % 3) * 8 * ms;
            if (i > 0 && chance(200)) in.t_ns = static_cast<std::int64_t>(random());
            const bool bad_p = chance(20), bad_q = chance(20);
            if (bad_p) (&in.p_w_m.x)[random() % 3] = bad();
            if (bad_q) (&in.q_wb.w)[random() % 4] = bad();
            ++in_count;
            const auto out = intake.push(in);
            if (!out) continue;
            ++out_count;
            expected_bad += bad_p + bad_q;
            ASSERT_EQ(out->t_ns, in.t_ns);
            ASSERT_GT(out->t_ns, last_out);
            ASSERT_TRUE(is_finite(out->p_w_m) && is_finite(out->q_wb));
            ASSERT_EQ((out->flags & flag::position_valid) == 0, bad_p);
            ASSERT_EQ((out->flags & flag::orientation_valid) == 0, bad_q);
            ASSERT_LE(approx::absolute(out->p_w_m.x), 1e4f);
            ASSERT_NEAR(dot(out->q_wb, out->q_wb), 1, 1e-6);
            const auto gap = [&out](std::int64_t last) {
                return last >= 0 && out->t_ns - last > 100 * ms;
            };
            ASSERT_EQ((out->flags & flag::gap_before) != 0, gap(last_out));
            ASSERT_EQ((out->flags & flag::position_gap) != 0, !bad_p && gap(last_p));
            ASSERT_EQ((out->flags & flag::orientation_gap) != 0, !bad_q && gap(last_q));
            gaps += (out->flags & ~both) != 0;
            last_out = out->t_ns;
            if (!bad_p) last_p = out->t_ns;
            if (!bad_q) last_q = out->t_ns;
        }
        const FaultCounts& f = intake.faults();
        EXPECT_EQ(in_count,
                  out_count + f[Fault::repeated_time] + f[Fault::backward_time] + f[Fault::leap]);
        EXPECT_EQ(f[Fault::not_finite] + f[Fault::out_of_range] + f[Fault::not_unit], expected_bad);
        EXPECT_EQ(f[Fault::gap], gaps);
        EXPECT_GT(out_count, 4500u);  // no single fault silences the stream
    }
}
