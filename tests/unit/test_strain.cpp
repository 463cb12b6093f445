// Strain smoothing against independent double-precision references, and its laws.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "fairlead/smooth/strain.hpp"
#include "fairlead/smooth/strain_buffer.hpp"
#include "tests/ref/strain.hpp"

namespace fairlead::test {
namespace {

constexpr float step_s = 1 / 120.0f;
constexpr std::size_t buffer_size = 1200;

StrainParams params_at(double cutoff_hz, std::size_t steps = 40, float step = step_s) {
    const auto params = StrainParams::from_cutoff(static_cast<float>(cutoff_hz), step, steps);
    EXPECT_TRUE(params);
    return *params;
}

std::vector<Pose> smoothed(const std::vector<Pose>& raw, const StrainParams& params) {
    const auto buffer = std::make_unique<StrainBuffer<buffer_size>>();
    std::vector<Pose> out(raw.size());
    buffer->smooth(raw.data(), out.data(), raw.size(), params);
    return out;
}

template <std::size_t Lag>
std::vector<Pose> streamed(const std::vector<Pose>& raw, const StrainParams& params) {
    const auto smoother = std::make_unique<StrainSmoother<Lag>>(params);
    std::vector<Pose> out;
    for (std::size_t i = 0; i < raw.size(); ++i) {
        const auto y = smoother->push(raw[i]);
        EXPECT_EQ(y.has_value(), i >= Lag);
        if (y) out.push_back(*y);
    }
    while (const auto y = smoother->flush()) out.push_back(*y);
    EXPECT_EQ(out.size(), raw.size());
    return out;
}

struct Error {
    double position{}, orientation{};
};

/// The largest differences over the records valid in each channel.
Error worst(const std::vector<Pose>& a, const std::vector<Pose>& b) {
    Error e;
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].t_ns, b[i].t_ns);
        if (a[i].flags & flag::position_valid)
            e.position =
                std::max(e.position, (to_double(a[i].p_w_m) - to_double(b[i].p_w_m)).norm());
        if (a[i].flags & flag::orientation_valid)
            e.orientation =
                std::max(e.orientation, angle_d(to_double(a[i].q_wb), to_double(b[i].q_wb)));
    }
    return e;
}
Error error_of(const std::vector<Pose>& out, double cutoff_hz, double step = step_s,
               const std::vector<Pose>* raw = nullptr) {
    const auto& in = raw ? *raw : out;
    const auto p = strain_positions(in, cutoff_hz, step);
    const auto q = StrainOrientations(in, cutoff_hz, step).solve();
    Error e;
    std::size_t kp = 0, kq = 0;
    for (const auto& pose : out) {
        if (pose.flags & flag::position_valid)
            e.position = std::max(e.position, (to_double(pose.p_w_m) - p[kp++]).norm());
        if (pose.flags & flag::orientation_valid)
            e.orientation = std::max(e.orientation, angle_d(to_double(pose.q_wb), q[kq++]));
    }
    return e;
}

TEST(StrainWeight, the_gain_at_the_cut_off_is_one_half) {
    // a long sine at the cut-off, read in its middle
    constexpr double step = 1 / 100.0, cutoff = 4;
    std::vector<Pose> wave(1000);
    for (std::size_t i = 0; i < wave.size(); ++i) {
        const double x =
            0.3 * std::sin(2 * 3.14159265358979 * cutoff * step * static_cast<double>(i));
        wave[i].t_ns = static_cast<std::int64_t>(i) * 10'000'000;
        wave[i].flags = flag::position_valid | flag::orientation_valid;
        wave[i].p_w_m = {static_cast<float>(x), 0, 0};
        wave[i].q_wb = to_float(exp_d(Vector3d(0, x, 0)));
    }
    const auto out = smoothed(wave, params_at(cutoff, 40, 0.01f));
    for (std::size_t i = 300; i < 700; ++i) {
        EXPECT_NEAR(out[i].p_w_m.x, wave[i].p_w_m.x / 2, 3e-6);
        const auto turn = log_d(to_double(out[i].q_wb));
        EXPECT_NEAR(turn.y(), static_cast<double>(wave[i].p_w_m.x) / 2, 1e-5);
    }
}

TEST(StrainWeight, says_what_is_wrong) {
    const float inf = std::numeric_limits<float>::infinity();
    const auto error = [](float cutoff, float step) {
        const char* const what = strain_weight_error(cutoff, step);
        return std::string{what == nullptr ? "" : what};
    };
    EXPECT_EQ(error(10, 0.01f), "");
    for (const float bad : {0.0f, -1.0f, inf, -inf, std::nanf("")}) {
        EXPECT_EQ(error(10, bad), "the step must be positive") << bad;
        EXPECT_EQ(error(bad, 0.01f), "the cut-off must be positive") << bad;
    }
    EXPECT_NE(error(0.7f, 0.01f).find("thin the samples out"), std::string::npos);
    EXPECT_NE(error(50, 0.01f).find("below 0.5 cycles"), std::string::npos);
}

TEST(StrainWeight, refuses_what_float_cannot_bear) {
    EXPECT_EQ(strain_weight(0.9f, step_s).status(), Status::bad_argument);  // 0.0075
    EXPECT_TRUE(strain_weight(1.0f, step_s));                               // 0.0083
    EXPECT_TRUE(strain_weight(0.008f, 1.0f));
    EXPECT_FALSE(strain_weight(60.0f, step_s));
    EXPECT_FALSE(strain_weight(-1, step_s));
    EXPECT_FALSE(strain_weight(std::nanf(""), step_s));
    EXPECT_FALSE(strain_weight(5, 0));
    EXPECT_FALSE(StrainParams::from_cutoff(0.9f, step_s));
    EXPECT_NE(strain_weight_error(0.9f, step_s), nullptr);
    EXPECT_EQ(strain_weight_error(2, step_s), nullptr);
}

TEST(Strain, whole_buffer_agrees_with_the_double_reference) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    for (const double cutoff : {1.0, 2.0, 5.0, 10.0, 20.0}) {
        for (const double jitter : {0.0, 0.4}) {
            MotionPlan plan;
            plan.n = 800;
            plan.size_m = 1;
            plan.jitter = jitter;
            const auto raw = motions.make(plan);
            const auto e = error_of(smoothed(raw, params_at(cutoff)), cutoff, step_s, &raw);
            EXPECT_LT(e.position, 2e-6) << cutoff << " Hz, jitter " << jitter;
            EXPECT_LT(e.orientation, 1e-5) << cutoff << " Hz, jitter " << jitter;
        }
    }
}

void short_segments_and_lost_channels(std::uint32_t from) {
    Motions motions{from};
    for (int trial = 0; trial < 10; ++trial) {
        SCOPED_TRACE(testing::Message() << "FAIRLEAD_SEED=" << from << ", trial " << trial);
        MotionPlan plan;
        plan.n = 300;
        auto raw = motions.make(plan);
        const double p_gap = motions.uniform(0, 0.3), p_lost = motions.uniform(0, 0.5);
        for (auto& pose : raw) {
            if (motions.chance(p_gap)) pose.flags |= flag::gap_before;
            if (motions.chance(p_lost)) pose.flags &= ~flag::position_valid;
            if (motions.chance(p_lost)) pose.flags &= ~flag::orientation_valid;
        }
        const auto e = error_of(smoothed(raw, params_at(5)), 5, step_s, &raw);
        EXPECT_LT(e.position, 2e-6);
        EXPECT_LT(e.orientation, 1e-5);
        // every second sample lost is half the rate: the lag doubles
        const auto stream = error_of(streamed<146>(raw, params_at(5, 1)), 5, step_s, &raw);
        EXPECT_LT(stream.position, 2e-6);
        EXPECT_LT(stream.orientation, 1e-5);
    }
}

TEST(Strain, short_segments_and_lost_channels_agree_too) {
    short_segments_and_lost_channels(seed());
}

/// Seeds at which the last, tiny steps were once refused, because the cost before them had been
/// rounded down.
TEST(Strain, steps_below_the_rounding_of_the_cost_are_taken) {
    for (const std::uint32_t from : {269u, 1023u}) short_segments_and_lost_channels(from);
}

TEST(Strain, no_step_raises_the_cost) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    for (const double rate : {2.0, 10.0, 40.0}) {  // the last turns 0.3 rad a sample, and wildly
        MotionPlan plan;
        plan.n = 200;
        plan.rate_rad_s = rate;
        plan.noise_rad = 0.1;
        const auto raw = motions.make(plan);
        const StrainOrientations reference(raw, 2, step_s);
        double before = reference.cost(reference.raw());
        for (std::size_t steps = 1; steps < 12; ++steps) {
            std::vector<Quaterniond> q;
            for (const auto& pose : smoothed(raw, params_at(2, steps)))
                q.push_back(to_double(pose.q_wb));
            const double cost = reference.cost(q);
            ASSERT_LE(cost, before * (1 + 1e-5)) << rate << " rad/s, step " << steps;
            before = cost;
        }
    }
}

/// Any rotation at all follows any other: now and then a full step would raise the cost.
TEST(Strain, a_step_that_is_too_long_is_halved) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937 random{seed};
        std::normal_distribution<double> normal{0, 2.2};
        std::vector<Pose> raw(60);
        for (std::size_t i = 0; i < raw.size(); ++i) {
            const double x = normal(random), y = normal(random), z = normal(random);
            raw[i].t_ns = static_cast<std::int64_t>(i) * 8'333'333;
            raw[i].flags = flag::orientation_valid;
            raw[i].q_wb = to_float(exp_d(Vector3d(x, y, z)));
        }
        const StrainOrientations reference(raw, 2, step_s);
        double before = reference.cost(reference.raw());
        const double first = before;
        for (const std::size_t steps : {1u, 2u, 4u, 8u, 16u, 40u}) {
            std::vector<Quaterniond> q;
            for (const auto& pose : smoothed(raw, params_at(2, steps)))
                q.push_back(to_double(pose.q_wb));
            const double cost = reference.cost(q);
            ASSERT_LE(cost, before * (1 + 1e-5)) << steps << " steps";
            before = cost;
        }
        EXPECT_LT(before, 2e-4 * first) << "the steps stopped half-way";
    }
}

TEST(Strain, scaling_the_positions_scales_the_result) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    const auto raw = motions.make({});
    auto large = raw, odd = raw;
    for (auto& pose : large) pose.p_w_m = 1024.0f * pose.p_w_m;
    for (auto& pose : odd) pose.p_w_m = 3.7f * pose.p_w_m;
    const auto x = smoothed(raw, params_at(3)), y = smoothed(large, params_at(3)),
               z = smoothed(odd, params_at(3));
    for (std::size_t i = 0; i < raw.size(); ++i) {
        ASSERT_EQ(y[i].p_w_m.x, 1024 * x[i].p_w_m.x);  // a power of two: the same bits
        ASSERT_EQ(y[i].p_w_m.z, 1024 * x[i].p_w_m.z);
        ASSERT_LT((to_double(z[i].p_w_m) - 3.7 * to_double(x[i].p_w_m)).norm(), 3e-6);
    }
}

TEST(Strain, rotations_and_shifts_of_the_frame_pass_through) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    const auto raw = motions.make({});
    const Quaterniond a = motions.rotation(), b = motions.rotation();
    const Vector3d shift = motions.normal(0.3);
    auto moved = raw;
    for (auto& pose : moved) {
        pose.p_w_m = to_float(a * to_double(pose.p_w_m) + shift);
        pose.q_wb = to_float(a * to_double(pose.q_wb) * b);
        if (motions.chance(0.5)) pose.q_wb = -pose.q_wb;
    }
    auto expected = smoothed(raw, params_at(3));
    for (auto& pose : expected) {
        pose.p_w_m = to_float(a * to_double(pose.p_w_m) + shift);
        pose.q_wb = to_float(a * to_double(pose.q_wb) * b);
    }
    const auto e = worst(smoothed(moved, params_at(3)), expected);
    EXPECT_LT(e.position, 2e-6);
    EXPECT_LT(e.orientation, 5e-6);
}

TEST(Strain, turning_time_round_turns_the_result) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    const auto raw = motions.make({});
    auto turned = raw;
    std::reverse(turned.begin(), turned.end());
    for (std::size_t i = 0; i < raw.size(); ++i) turned[i].t_ns = raw[i].t_ns;
    auto back = smoothed(turned, params_at(3));
    std::reverse(back.begin(), back.end());
    for (std::size_t i = 0; i < raw.size(); ++i) back[i].t_ns = raw[i].t_ns;
    const auto e = worst(smoothed(raw, params_at(3)), back);
    EXPECT_LT(e.position, 2e-6);
    EXPECT_LT(e.orientation, 5e-6);
}

TEST(StrainSmoother, gives_what_the_whole_buffer_gives_for_the_records_known) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    MotionPlan plan;
    plan.n = 160;
    plan.jitter = 0.3;
    const auto raw = motions.make(plan);
    constexpr std::size_t lag = 25;  // far below strain_lag(): the past must be exact all the same
    const auto stream = streamed<lag>(raw, params_at(3, 3));
    for (std::size_t i = 0; i < raw.size(); i += 13) {
        const std::vector<Pose> known(
            raw.begin(),
            raw.begin() + static_cast<std::ptrdiff_t>(std::min(raw.size(), i + lag + 1)));
        const auto p = strain_positions(known, 3, step_s);
        const auto q = StrainOrientations(known, 3, step_s).solve();
        EXPECT_LT((to_double(stream[i].p_w_m) - p[i]).norm(), 2e-6) << i;
        // the past is linearised where it left the window, 25 records of a 40-record filter back
        EXPECT_LT(angle_d(to_double(stream[i].q_wb), q[i]), 2e-4) << i;
    }
}

TEST(StrainSmoother, without_lag_is_the_best_causal_estimate) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    MotionPlan plan;
    plan.n = 150;
    auto raw = motions.make(plan);
    for (std::size_t i = 60; i < 90; ++i) raw[i].flags &= ~flag::position_valid;  // bridged
    const auto stream = streamed<0>(raw, params_at(3, 2));
    for (std::size_t i = 2; i < raw.size(); i += 7) {
        const std::vector<Pose> known(raw.begin(),
                                      raw.begin() + static_cast<std::ptrdiff_t>(i + 1));
        const auto p = strain_positions(known, 3, step_s);
        const auto q = StrainOrientations(known, 3, step_s).solve();
        if (raw[i].flags & flag::position_valid) {
            EXPECT_LT((to_double(stream[i].p_w_m) - p.back()).norm(), 2e-6) << i;
        }
        // every older sample is linearised once and for all where it left
        EXPECT_LT(angle_d(to_double(stream[i].q_wb), q.back()), 3e-3) << i;
    }
}

TEST(StrainSmoother, at_the_stated_lag_equals_the_whole_buffer) {
    SCOPED_TRACE(seed_text());
    static_assert(StrainSmoother<73>::latency == 73);
    Motions motions{seed()};
    MotionPlan plan;
    plan.n = 600;
    const auto raw = motions.make(plan);
    ASSERT_EQ(strain_lag(5, step_s), 73u);
    ASSERT_EQ(strain_lag(2, step_s), 180u);
    auto e = error_of(streamed<73>(raw, params_at(5, 1)), 5, step_s, &raw);
    EXPECT_LT(e.position, 2e-6);
    EXPECT_LT(e.orientation, 1e-5);
    e = error_of(streamed<180>(raw, params_at(2, 1)), 2, step_s, &raw);
    EXPECT_LT(e.position, 2e-6);
    EXPECT_LT(e.orientation, 1e-5);
}

/// Of the stream too, at any lag: the frame, the signs, the scale and the clock do not matter.
TEST(StrainSmoother, frames_scales_and_clocks_pass_through) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    MotionPlan plan;
    plan.n = 240;
    plan.jitter = 0.3;
    const auto raw = motions.make(plan);
    const Quaterniond a = motions.rotation(), b = motions.rotation();
    const Vector3d shift = motions.normal(0.3);
    auto moved = raw, scaled = raw, later = raw;
    for (auto& pose : moved) {
        pose.p_w_m = to_float(a * to_double(pose.p_w_m) + shift);
        pose.q_wb = to_float(a * to_double(pose.q_wb) * b);
        if (motions.chance(0.5)) pose.q_wb = -pose.q_wb;
    }
    for (auto& pose : scaled) pose.p_w_m = 64.0f * pose.p_w_m;
    for (auto& pose : later) pose.t_ns += 1'700'000'000'123'456'789;
    const auto check = [&](std::size_t lag, auto stream) {
        SCOPED_TRACE(testing::Message() << "lag " << lag);
        auto expected = stream(raw);
        const auto times_64 = stream(scaled), same = stream(later), turned = stream(moved);
        for (std::size_t i = 0; i < raw.size(); ++i) {
            ASSERT_EQ(times_64[i].p_w_m.y, 64 * expected[i].p_w_m.y);
            ASSERT_EQ(same[i].p_w_m.y, expected[i].p_w_m.y);
            ASSERT_EQ(same[i].q_wb.w, expected[i].q_wb.w);
            ASSERT_EQ(same[i].t_ns - later[i].t_ns, 0);
        }
        for (auto& pose : expected) {
            pose.p_w_m = to_float(a * to_double(pose.p_w_m) + shift);
            pose.q_wb = to_float(a * to_double(pose.q_wb) * b);
        }
        const auto e = worst(turned, expected);
        EXPECT_LT(e.position, 2e-6);
        // a last step may be taken in one frame and not in the other, where its gain drowns in the
        // rounding of the cost: 522 times the square of a difference of rates
        EXPECT_LT(e.orientation, 1e-4);
    };
    check(0, [](const auto& in) { return streamed<0>(in, params_at(4, 1)); });
    check(3, [](const auto& in) { return streamed<3>(in, params_at(4, 1)); });
    check(25, [](const auto& in) { return streamed<25>(in, params_at(4, 2)); });
}

TEST(StrainSmoother, flush_leaves_it_as_new) {
    Motions motions{3};
    MotionPlan plan;
    plan.n = 100;
    const auto raw = motions.make(plan);
    const auto smoother = std::make_unique<StrainSmoother<20>>(params_at(10, 1));
    std::vector<Pose> first, second;
    for (auto* out : {&first, &second}) {
        for (const auto& pose : raw)
            if (const auto y = smoother->push(pose)) out->push_back(*y);
        while (const auto y = smoother->flush()) out->push_back(*y);
    }
    const auto e = worst(first, second);
    EXPECT_EQ(e.position, 0);
    EXPECT_EQ(e.orientation, 0);
}

}  // namespace
}  // namespace fairlead::test
