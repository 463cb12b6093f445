// The adaptive filter: its laws, its line against a direct fit in double, its stated errors.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "fairlead/smooth/adaptive.hpp"
#include "tests/ref/mask.hpp"

using namespace fairlead;

namespace {

constexpr std::uint32_t both = flag::position_valid | flag::orientation_valid;
constexpr double t_times_cutoff = 0.39509;

struct Motion {
    std::vector<double> t;  // s
    std::vector<ref::Q> q;
    std::vector<ref::V> p;
};

std::vector<Pose> poses_of(const Motion& m, std::int64_t start_ns = 0) {
    std::vector<Pose> out;
    for (std::size_t i = 0; i < m.t.size(); ++i)
        out.push_back({start_ns + std::llround(m.t[i] * 1e9), ref::narrow(m.p[i]),
                       ref::narrow(m.q[i]), both});
    return out;
}

/// A random motion at uneven times, 2 to 14 ms apart.
Motion random_motion(unsigned seed, std::size_t n, double noise = 0.01) {
    std::mt19937_64 random{seed};
    std::uniform_real_distribution<double> step{0.002, 0.014};
    Motion m;
    ref::Q q = ref::any_rotation(random);
    ref::V rate{}, p{};
    double t = 0;
    for (std::size_t i = 0; i < n; ++i) {
        m.t.push_back(std::round(t * 1e6) * 1e-6);
        m.q.push_back(ref::mul(q, ref::from_vector(ref::normal(random, noise))));
        m.p.push_back(p + ref::normal(random, noise));
        const double dt = step(random);
        rate = 0.98 * rate + ref::normal(random, 1);
        q = ref::mul(q, ref::from_vector(dt * rate));
        p = p + dt * rate;
        t += dt;
    }
    return m;
}

std::vector<Pose> run(AdaptivePoseFilter filter, const std::vector<Pose>& in) {
    std::vector<Pose> out;
    for (const Pose& pose : in) out.push_back(*filter.push(pose));
    return out;
}

/// The filter's definition, fitted anew to the whole past at every sample.
std::vector<ref::V> refitted(const std::vector<Pose>& in, const AdaptiveParams& params) {
    std::vector<ref::V> out;
    std::vector<double> weight;
    ref::V rate{};
    for (std::size_t n = 0; n < in.size(); ++n) {
        const auto age = [&](std::size_t j) {
            return static_cast<double>(in[n].t_ns - in[j].t_ns) * 1e-9;
        };
        if (n > 0) {
            const double cutoff = double{params.cutoff_hz} + double{params.slope} * norm(rate);
            for (double& w : weight) w *= std::exp(-age(n - 1) * cutoff / t_times_cutoff);
        }
        weight.push_back(1);
        double s0 = 0, s1 = 0, s2 = 0;
        ref::V x0{}, x1{};
        for (std::size_t j = 0; j <= n; ++j) {
            s0 += weight[j], s1 += weight[j] * age(j), s2 += weight[j] * age(j) * age(j);
            x0 = x0 + weight[j] * ref::of(in[j].p_w_m);
            x1 = x1 + weight[j] * age(j) * ref::of(in[j].p_w_m);
        }
        const double d = s0 * s2 - s1 * s1;
        out.push_back(n == 0 ? x0 : (1 / d) * (s2 * x0 - s1 * x1));
        rate = n == 0 ? ref::V{} : (1 / d) * (s1 * x0 - s0 * x1);
    }
    return out;
}

/// Turns about one axis by angle(t), positions angle(t) along x, 5 ms apart.
Motion turning(double seconds, const std::function<double(double)>& angle) {
    Motion m;
    for (double t = 0; t < seconds; t += 0.005) {
        const double a = angle(t);
        m.t.push_back(t);
        m.q.push_back(ref::from_vector({0, a * 0.6, a * 0.8}));
        m.p.push_back({a, 0, 0});
    }
    return m;
}

double error_at(const Pose& out, const Motion& m, std::size_t i) {
    return ref::angle(ref::of(out.q_wb), m.q[i]);
}

}  // namespace

TEST(Adaptive, IsTheFadingLineOfItsDefinition) {
    for (unsigned seed = 1; seed <= 10; ++seed)
        for (const AdaptiveParams params : {AdaptiveParams{2, 0}, {1, 2}, {15, 10}, {0.2f, 0}}) {
            const auto in = poses_of(random_motion(seed, 300));
            const auto out = run(AdaptivePoseFilter{{}, params}, in);
            const auto expected = refitted(in, params);
            for (std::size_t i = 0; i < in.size(); ++i)
                ASSERT_LT(ref::norm(ref::of(out[i].p_w_m) - expected[i]),
                          1e-6 * (2 + ref::norm(expected[i])))
                    << "seed " << seed << " sample " << i;
        }
}

TEST(Adaptive, LeftAndRightRotationInvariance) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        std::mt19937_64 random{seed};
        const ref::Q a = ref::any_rotation(random), b = ref::any_rotation(random);
        const auto in = poses_of(random_motion(seed, 300));
        auto turned = in;
        for (Pose& pose : turned)
            pose.q_wb = ref::narrow(ref::mul(ref::mul(a, ref::of(pose.q_wb)), b));
        const auto plain = run(AdaptivePoseFilter{}, in), out = run(AdaptivePoseFilter{}, turned);
        for (std::size_t i = 0; i < in.size(); ++i)
            ASSERT_LT(
                ref::angle(ref::of(out[i].q_wb), ref::mul(ref::mul(a, ref::of(plain[i].q_wb)), b)),
                4e-6)
                << "seed " << seed << " sample " << i;
    }
}

TEST(Adaptive, TimeInvarianceAndSigns) {
    const Motion m = random_motion(3, 300);
    auto late = poses_of(m, 1'000'000'000'000'000'000);
    std::mt19937_64 random{3};
    for (std::size_t i = 1; i < late.size(); ++i)
        if (random() & 1) late[i].q_wb = -late[i].q_wb;
    const auto a = run(AdaptivePoseFilter{}, poses_of(m)), b = run(AdaptivePoseFilter{}, late);
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].q_wb.w, b[i].q_wb.w);
        ASSERT_EQ(a[i].q_wb.z, b[i].q_wb.z);
        ASSERT_EQ(a[i].p_w_m.x, b[i].p_w_m.x);
    }
}

TEST(Adaptive, FixedAxisIsTheFilterOfPositions) {
    std::mt19937_64 random{4};
    std::normal_distribution<double> noise{0, 0.02};
    const Motion m = turning(3, [&](double t) { return std::sin(5 * t) + noise(random); });
    const AdaptiveParams params{1.5f, 0.7f};
    Motion same = m;
    for (std::size_t i = 0; i < m.t.size(); ++i)
        same.p[i] = {ref::to_vector(m.q[i])[2] / 0.8, 0, 0};
    const auto out = run(AdaptivePoseFilter{params, params}, poses_of(same));
    for (const Pose& pose : out)
        ASSERT_LT(std::fabs(ref::to_vector(ref::of(pose.q_wb))[2] / 0.8 - double{pose.p_w_m.x}),
                  3e-6);
}

TEST(Adaptive, ConstantRateDoesNotLag) {
    std::mt19937_64 random{5};
    for (const double rate : {0.0, 0.5, 20.0, 400.0}) {  // 400 rad/s: up to 5.6 rad per sample
        Motion m = random_motion(5, 300, 0);
        for (std::size_t i = 0; i < m.t.size(); ++i) {
            // the first steps are short, so that the rate is learnt before turns pass pi
            if (i < 10) m.t[i] = 1e-4 * static_cast<double>(i);
            const double turn = rate * m.t[i];
            m.q[i] = ref::from_vector({turn * 0.6, 0, -turn * 0.8});
            m.p[i] = {0, 0.01 * rate * m.t[i], 1};
        }
        const auto out = run(AdaptivePoseFilter{}, poses_of(m));
        for (std::size_t i = 0; i < out.size(); ++i) {
            ASSERT_LT(error_at(out[i], m, i), 5e-6 + 1e-6 * rate) << rate << " rad/s, " << i;
            ASSERT_LT(ref::norm(ref::of(out[i].p_w_m) - m.p[i]), 1e-5) << rate << " rad/s, " << i;
        }
    }
}

TEST(Adaptive, ConstantAccelerationLeavesAtMostAT2) {
    for (const float cutoff : {1.0f, 2.0f, 10.0f, 40.0f}) {
        const double time_constant = t_times_cutoff / double{cutoff}, a = 3;
        const Motion m = turning(5, [](double t) { return 1.5 * t * t; });
        const auto out = run(AdaptivePoseFilter{{cutoff, 0}, {cutoff, 0}}, poses_of(m));
        const double bound = a * time_constant * time_constant;
        for (std::size_t i = 0; i < out.size(); ++i)
            ASSERT_LT(error_at(out[i], m, i), bound + 2e-5) << cutoff << " Hz, sample " << i;
        if (cutoff < 3) {
            EXPECT_GT(error_at(out.back(), m, out.size() - 1), 0.95 * bound);
        }
    }
}

TEST(Adaptive, FastTurnsLagLessNotMore) {
    // 40 rad/s^2 up to 120 rad/s: the angle it stays behind shrinks while the rate grows
    const Motion m = turning(3, [](double t) { return 20 * t * t; });
    const auto out = run(AdaptivePoseFilter{{2, 0.5f}, {}}, poses_of(m));
    double before = 1e9;
    for (std::size_t i = 100; i < out.size(); i += 50) {
        const double error = error_at(out[i], m, i);
        EXPECT_LT(error, before) << "at " << m.t[i] << " s";
        before = error;
    }
    EXPECT_LT(before, 0.005);
    // a fixed cut-off keeps its error, 40 T^2
    const auto fixed = run(AdaptivePoseFilter{{2, 0}, {}}, poses_of(m));
    EXPECT_GT(error_at(fixed.back(), m, fixed.size() - 1), 1.5);
}

TEST(Adaptive, CutoffIsTheHalfPowerFrequency) {
    for (const float cutoff : {1.0f, 2.0f, 8.0f}) {
        const double w = 2 * M_PI * double{cutoff};
        Motion m;
        for (int i = 0; i < 40000; ++i) {
            const double t = i * 0.0002;
            m.t.push_back(t);
            m.p.push_back({std::sin(w * t), 0, 0});
            m.q.push_back(ref::Q{{1, 0, 0, 0}});
        }
        const auto out = run(AdaptivePoseFilter{{}, {cutoff, 0}}, poses_of(m));
        double power = 0;
        const auto last = static_cast<std::size_t>(2 / double{cutoff} / 0.0002);  // two periods
        for (std::size_t i = out.size() - last; i < out.size(); ++i)
            power += double{out[i].p_w_m.x} * double{out[i].p_w_m.x};
        EXPECT_NEAR(2 * power / static_cast<double>(last), 0.5, 0.01) << cutoff << " Hz";
    }
}

TEST(Adaptive, NoiseIsThatOfAFadingMemory) {
    std::mt19937_64 random{6};
    Motion m;
    for (int i = 0; i < 100000; ++i) {
        m.t.push_back(i * 0.005);
        m.p.push_back(ref::normal(random, 0.01));
        m.q.push_back(ref::from_vector(ref::normal(random, 0.01)));
    }
    const auto out = run(AdaptivePoseFilter{{5, 0}, {5, 0}}, poses_of(m));
    double p = 0, q = 0;
    for (std::size_t i = 200; i < out.size(); ++i) {
        p += std::pow(ref::norm(ref::of(out[i].p_w_m)), 2);
        q += std::pow(ref::angle(ref::of(out[i].q_wb), ref::Q{{1, 0, 0, 0}}), 2);
    }
    const double f = std::exp(-0.005 * 5 / t_times_cutoff);
    const double variance = (1 - f) * (1 + 4 * f + 5 * f * f) / std::pow(1 + f, 3);
    const auto n = static_cast<double>(out.size() - 200) * 3 * 1e-4;
    EXPECT_NEAR(p / n, variance, 0.02 * variance);
    EXPECT_NEAR(q / n, variance, 0.02 * variance);
}

TEST(Adaptive, PredictionKeepsItsStatedError) {
    for (const float cutoff : {1.0f, 3.0f, 12.0f})
        for (const double ahead : {0.0, 0.01, 0.05, 0.2}) {
            const double a = 4, time_constant = t_times_cutoff / double{cutoff};
            const auto angle = [a](double t) { return 0.5 * a * t * t; };
            const Motion m = turning(4, angle);
            AdaptivePoseFilter filter{{cutoff, 0}, {cutoff, 0}};
            for (const Pose& pose : poses_of(m)) static_cast<void>(filter.push(pose));
            const double t = m.t.back() + ahead, s = angle(t);
            const Pose out = filter.predict(std::llround(t * 1e9));
            EXPECT_EQ(out.flags, both);
            const double bound = a * std::pow(time_constant + ahead, 2) + 2e-5;
            EXPECT_LT(ref::angle(ref::of(out.q_wb), ref::from_vector({0, s * 0.6, s * 0.8})),
                      bound);
            EXPECT_LT(std::fabs(double{out.p_w_m.x} - s), bound);
        }
}

TEST(Adaptive, GapsAndLostChannels) {
    const Motion m = random_motion(7, 100);
    auto in = poses_of(m);
    for (std::size_t i = 40; i < 60; ++i) in[i].flags = flag::position_valid;
    in[60].flags |= flag::orientation_gap;
    in[80].flags |= flag::gap_before;
    AdaptivePoseFilter filter;
    EXPECT_EQ(filter.predict(0).flags, 0u);
    const auto out = run(filter, in);
    const auto plain = run(filter, poses_of(m));
    for (std::size_t i = 0; i < in.size(); ++i) {
        EXPECT_EQ(out[i].flags, in[i].flags);
        EXPECT_EQ(out[i].t_ns, in[i].t_ns);
        if (i < 80) {
            EXPECT_EQ(out[i].p_w_m.x, plain[i].p_w_m.x);
        }
        if (i >= 40 && i < 60) {
            EXPECT_EQ(out[i].q_wb.x, in[i].q_wb.x);
        }
    }
    EXPECT_EQ(out[60].q_wb.x, in[60].q_wb.x);  // a start is its own line
    EXPECT_EQ(out[80].q_wb.x, in[80].q_wb.x);
    EXPECT_EQ(out[80].p_w_m.x, in[80].p_w_m.x);
    EXPECT_NE(out[61].q_wb.x, plain[61].q_wb.x);
    AdaptiveOrientationFilter orientation;
    AdaptivePositionFilter position;
    for (std::size_t i = 0; i < in.size(); ++i) {
        const Pose o = *orientation.push(in[i]), p = *position.push(in[i]);
        EXPECT_EQ(o.q_wb.y, out[i].q_wb.y);
        EXPECT_EQ(o.p_w_m.y, in[i].p_w_m.y);
        EXPECT_EQ(p.p_w_m.y, out[i].p_w_m.y);
        EXPECT_EQ(p.q_wb.y, in[i].q_wb.y);
    }
}

TEST(Adaptive, StaysUnitAndFiniteForEver) {
    std::mt19937_64 random{8};
    AdaptivePoseFilter filter{{0.01f, 5}, {1000, 0}};
    std::int64_t t = 0;
    for (int i = 0; i < 300000; ++i) {
        // steps from 1 ns to an hour, jumps of any size
        t += 1 + static_cast<std::int64_t>(std::exp2(static_cast<double>(random() % 42)));
        const auto out = filter.push(
            {t, ref::narrow(ref::normal(random, 1)), ref::narrow(ref::any_rotation(random)), both});
        ASSERT_NEAR(dot(out->q_wb, out->q_wb), 1, 2e-6);
        ASSERT_TRUE(is_finite(out->p_w_m));
    }
    EXPECT_DEATH((AdaptivePoseFilter{{0, 1}, {}}), "");
    EXPECT_DEATH((AdaptivePoseFilter{{1, NAN}, {}}), "");
}

TEST(Adaptive, WhatIsNotValidPassesAndTeachesNothing) {
    std::mt19937_64 random{5};
    std::vector<Pose> mixed = poses_of(random_motion(5, 400)), position, orientation;
    for (Pose& pose : mixed) {
        const auto lost = random() % 4;
        if (lost == 1) pose.flags = flag::orientation_valid, pose.p_w_m = {1e6f, -1e6f, 3};
        if (lost == 2) pose.flags = flag::position_valid, pose.q_wb = {0, 0, 0, 1};
        if (lost != 1) position.push_back(pose);
        if (lost != 2) orientation.push_back(pose);
    }
    const AdaptivePoseFilter fresh;
    const auto all = run(fresh, mixed), moved = run(fresh, position),
               turned = run(fresh, orientation);
    std::size_t p = 0, q = 0;
    for (std::size_t i = 0; i < mixed.size(); ++i) {
        const bool has_p = (mixed[i].flags & flag::position_valid) != 0;
        const bool has_q = (mixed[i].flags & flag::orientation_valid) != 0;
        const Pose& expected_p = has_p ? moved[p++] : mixed[i];
        const Pose& expected_q = has_q ? turned[q++] : mixed[i];
        ASSERT_EQ(norm(all[i].p_w_m - expected_p.p_w_m), 0) << i;
        const Quat &q_is = all[i].q_wb, &q_due = expected_q.q_wb;
        ASSERT_EQ(norm(vec(q_is) - vec(q_due)), 0) << i;
        ASSERT_EQ(q_is.w, q_due.w) << i;
    }
}
