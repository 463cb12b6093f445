// Fairing against an independent double-precision reference, its bounds, and its laws.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "fairlead/smooth/fairing.hpp"
#include "fairlead/smooth/fairing_window.hpp"
#include "tests/ref/motions.hpp"

namespace fairlead::test {
namespace {

using Position = detail::FairPosition<float>;
using Orientation = detail::FairOrientation<float>;

// ---- the reference: [Lee & Shin 1996, (16), (18)] sample by sample, written out case by case
struct Reference {
    std::vector<Vector3d> p;
    std::vector<Quaterniond> q;

    explicit Reference(const std::vector<Pose>& motion) {
        for (const auto& pose : motion) {
            p.push_back(to_double(pose.p_w_m));
            q.push_back(to_double(pose.q_wb));
        }
    }
    Vector3d w(std::size_t i) const { return log_d(q[i].conjugate() * q[i + 1]); }

    void round(int order, bool mirrored, double damping_p, double damping_q) {
        const std::size_t n = p.size();
        auto next_p = p;
        auto next_q = q;
        for (std::size_t i = 0; i < n; ++i) {
            const Vector3d tp = order == 2 ? second(i) : third(i, mirrored);
            const Quaterniond tq = order == 2 ? second_q(i) : third_q(i, mirrored);
            next_p[i] = damping_p * tp + (1 - damping_p) * p[i];
            next_q[i] = (q[i] * exp_d(damping_q * log_d(q[i].conjugate() * tq))).normalized();
        }
        p = next_p;
        q = next_q;
    }

  private:
    Vector3d second(std::size_t i) const {
        const std::size_t n = p.size();
        if (i == 0) return 2 * p[1] - p[2];
        if (i == n - 1) return 2 * p[n - 2] - p[n - 3];
        return (p[i - 1] + p[i + 1]) / 2;
    }
    Quaterniond second_q(std::size_t i) const {
        const std::size_t n = p.size();
        if (i == 0) return q[1] * q[2].conjugate() * q[1];
        if (i == n - 1) return q[n - 2] * q[n - 3].conjugate() * q[n - 2];
        return q[i - 1].slerp(0.5, q[i + 1]);
    }
    Vector3d third(std::size_t i, bool mirrored) const {
        const std::size_t n = p.size();
        if (i == 0) return p[3] - 3 * p[2] + 3 * p[1];
        if (i == n - 1) return p[n - 4] - 3 * p[n - 3] + 3 * p[n - 2];
        if (mirrored) {
            if (i == 1) return p[2] + (p[0] - p[3]) / 3;
            return p[i - 1] + (p[i + 1] - p[i - 2]) / 3;
        }
        if (i == n - 2) return p[n - 3] + (p[n - 1] - p[n - 4]) / 3;
        return p[i + 1] + (p[i - 1] - p[i + 2]) / 3;
    }
    Quaterniond third_q(std::size_t i, bool mirrored) const {
        const std::size_t n = q.size();
        if (i == 0) return q[1] * exp_d(w(2) - 2 * w(1));
        if (i == n - 1) return q[n - 2] * exp_d(2 * w(n - 3) - w(n - 4));
        if (mirrored) {
            if (i == 1) return q[2] * exp_d(-(w(2) + w(0)) / 2);
            return q[i - 1] * exp_d((w(i - 2) + w(i)) / 2);
        }
        if (i == n - 2) return q[n - 3] * exp_d((w(n - 2) + w(n - 4)) / 2);
        return q[i + 1] * exp_d(-(w(i + 1) + w(i - 1)) / 2);
    }
};

template <int Order>
std::vector<Pose> faired_buffer(const std::vector<Pose>& raw, std::size_t rounds,
                                const FairingParams& params, OnBound on_bound = OnBound::stop,
                                FairingReport* report = nullptr) {
    std::vector<Pose> out(raw.size()), scratch(raw.size());
    const auto r =
        fair<Order>(raw.data(), out.data(), scratch.data(), raw.size(), rounds, params, on_bound);
    if (report) *report = r;
    return out;
}

template <class Window>
std::vector<Pose> streamed(const std::vector<Pose>& raw, const FairingParams& params) {
    Window window{params};
    std::vector<Pose> out;
    for (std::size_t i = 0; i < raw.size(); ++i) {
        const auto y = window.push(raw[i]);
        EXPECT_EQ(y.has_value(), i >= Window::latency);
        if (y) out.push_back(*y);
    }
    while (const auto y = window.flush()) out.push_back(*y);
    return out;
}

void expect_same_bits(const std::vector<Pose>& a, const std::vector<Pose>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].t_ns, b[i].t_ns);
        ASSERT_EQ(a[i].flags, b[i].flags);
        ASSERT_TRUE(a[i].p_w_m.x == b[i].p_w_m.x && a[i].p_w_m.y == b[i].p_w_m.y &&
                    a[i].p_w_m.z == b[i].p_w_m.z)
            << "position " << i;
        ASSERT_TRUE(a[i].q_wb.w == b[i].q_wb.w && a[i].q_wb.x == b[i].q_wb.x &&
                    a[i].q_wb.y == b[i].q_wb.y && a[i].q_wb.z == b[i].q_wb.z)
            << "orientation " << i;
    }
}

template <int Order>
void expect_reference(bool alternate) {
    Motions motions{seed()};
    for (const std::size_t n : {4u, 5u, 6u, 60u}) {
        MotionPlan plan;
        plan.n = n;
        const auto raw = motions.make(plan);
        FairingParams params;
        params.alternate = alternate;
        Reference reference{raw};
        for (std::size_t r = 0; r < 20; ++r)
            reference.round(Order, alternate && r % 2 == 1, 0.5, 0.1);
        const auto out = faired_buffer<Order>(raw, 20, params);
        for (std::size_t i = 0; i < n; ++i) {
            ASSERT_LT((to_double(out[i].p_w_m) - reference.p[i]).norm(), 1e-6) << n << ' ' << i;
            ASSERT_LT(angle_d(to_double(out[i].q_wb), reference.q[i]), 4e-6) << n << ' ' << i;
        }
    }
}

TEST(Fairing, agrees_with_the_double_reference) {
    SCOPED_TRACE(seed_text());
    expect_reference<2>(false);
    expect_reference<3>(false);
    expect_reference<3>(true);
}

template <int Order>
std::pair<double, double> energy(const std::vector<Pose>& m) {
    return {fairing_energy<Position, Order>([&](std::size_t i) { return m[i].p_w_m; }, m.size()),
            fairing_energy<Orientation, Order>([&](std::size_t i) { return m[i].q_wb; }, m.size())};
}

template <int Order>
void expect_falling_energy() {
    Motions motions{seed()};
    MotionPlan plan;
    plan.n = 100;
    const auto raw = motions.make(plan);
    auto before = energy<Order>(raw);
    auto motion = raw;
    for (int round = 0; round < 10; ++round) {
        motion = faired_buffer<Order>(motion, 1, {});
        const auto after = energy<Order>(motion);
        ASSERT_LT(after.first, before.first) << round;
        ASSERT_LT(after.second, before.second) << round;
        before = after;
    }
}

TEST(Fairing, each_round_lowers_the_energy) {
    SCOPED_TRACE(seed_text());
    expect_falling_energy<2>();
    expect_falling_energy<3>();
}

TEST(Fairing, energies_are_the_papers_sums) {
    // p = i^2: second differences 2, third 0; a turn that gains 0.1 rad a step: second differences
    // 0.1
    std::vector<Pose> m(6);
    double angle = 0;
    for (std::size_t i = 0; i < m.size(); ++i) {
        m[i].p_w_m = {static_cast<float>(i * i), 0, 0};
        angle += 0.1 * static_cast<double>(i);
        m[i].q_wb = to_float(exp_d(Vector3d(0, 0, angle)));
    }
    EXPECT_NEAR(energy<2>(m).first, 4 * 4, 1e-5);
    EXPECT_NEAR(energy<3>(m).first, 0, 1e-5);
    EXPECT_NEAR(energy<2>(m).second, 4 * 0.01, 1e-6);
    EXPECT_NEAR(energy<3>(m).second, 0, 1e-6);
}

TEST(Fairing, the_returned_motion_keeps_both_bounds) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    std::size_t at_bound = 0;
    for (int trial = 0; trial < 20; ++trial) {
        MotionPlan plan;
        plan.n = 80;
        plan.noise_m = 0.01;
        plan.noise_rad = 0.1;
        const auto raw = motions.make(plan);
        FairingParams params;
        params.bound_m = static_cast<float>(motions.uniform(0.001, 0.03));
        params.bound_rad = static_cast<float>(motions.uniform(0.01, 0.3));
        for (const auto on_bound : {OnBound::stop, OnBound::hold}) {
            FairingReport report;
            const auto out = faired_buffer<3>(raw, 200, params, on_bound, &report);
            if (report.rounds_p < 200 && report.rounds_q < 200) ++at_bound;
            for (std::size_t i = 0; i < raw.size(); ++i) {
                ASSERT_LE((to_double(out[i].p_w_m) - to_double(raw[i].p_w_m)).norm(),
                          static_cast<double>(params.bound_m));
                ASSERT_LE(angle_d(to_double(out[i].q_wb), to_double(raw[i].q_wb)),
                          static_cast<double>(params.bound_rad));
            }
        }
    }
    EXPECT_GT(at_bound, 5u) << "the bounds hardly ever mattered";
}

TEST(Fairing, a_channel_at_its_bound_does_not_stop_the_other) {
    Motions motions{7};
    const auto raw = motions.make({});
    FairingParams params;
    params.bound_m = 0.0005f;
    FairingReport report;
    faired_buffer<3>(raw, 50, params, OnBound::stop, &report);
    EXPECT_LT(report.rounds_p, 5u);
    EXPECT_EQ(report.rounds_q, 50u);
}

TEST(Fairing, constant_rate_and_constant_acceleration_stay) {
    std::vector<Pose> line(40), bend(40);
    for (std::size_t i = 0; i < line.size(); ++i) {
        const double t = static_cast<double>(i);
        line[i].flags = bend[i].flags = flag::position_valid | flag::orientation_valid;
        line[i].p_w_m = to_float(Vector3d(0.01 * t, -0.02 * t, 0.3));
        line[i].q_wb = to_float(exp_d(Vector3d(0.05 * t, 0, 0)));
        bend[i].p_w_m = to_float(Vector3d(1e-4 * t * t, 0, 0));
        bend[i].q_wb = to_float(exp_d(Vector3d(0, 1e-3 * t * t, 0)));
    }
    const auto expect_still = [](const std::vector<Pose>& a, const std::vector<Pose>& b) {
        for (std::size_t i = 0; i < a.size(); ++i) {
            ASSERT_LT((to_double(a[i].p_w_m) - to_double(b[i].p_w_m)).norm(), 1e-6);
            ASSERT_LT(angle_d(to_double(a[i].q_wb), to_double(b[i].q_wb)), 5e-6);
        }
    };
    expect_still(line, faired_buffer<2>(line, 30, {}));
    expect_still(line, faired_buffer<3>(line, 30, {}));
    expect_still(bend, faired_buffer<3>(bend, 30, {}));
}

TEST(Fairing, rotations_and_shifts_of_the_frame_pass_through) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    MotionPlan plan;
    plan.n = 60;
    const auto raw = motions.make(plan);
    const Quaterniond a = motions.rotation(), b = motions.rotation();
    const Vector3d shift = motions.normal(0.3);
    auto moved = raw;
    for (auto& pose : moved) {
        pose.p_w_m = to_float(a * to_double(pose.p_w_m) + shift);
        pose.q_wb = to_float(a * to_double(pose.q_wb) * b);
        if (motions.chance(0.5)) pose.q_wb = -pose.q_wb;
    }
    FairingParams params;
    params.alternate = true;
    const auto x = faired_buffer<3>(raw, 30, params), y = faired_buffer<3>(moved, 30, params);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Vector3d p = a * to_double(x[i].p_w_m) + shift;
        ASSERT_LT((to_double(y[i].p_w_m) - p).norm(), 2e-6) << i;
        ASSERT_LT(angle_d(to_double(y[i].q_wb), a * to_double(x[i].q_wb) * b), 5e-6) << i;
    }
}

TEST(Fairing, rho_2_is_symmetric_in_time) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    const auto raw = motions.make({});
    auto turned = raw;
    std::reverse(turned.begin(), turned.end());
    const auto x = faired_buffer<2>(raw, 10, {});
    auto y = faired_buffer<2>(turned, 10, {});
    std::reverse(y.begin(), y.end());
    for (std::size_t i = 0; i < x.size(); ++i) {
        ASSERT_LT((to_double(y[i].p_w_m) - to_double(x[i].p_w_m)).norm(), 1e-6);
        ASSERT_LT(angle_d(to_double(y[i].q_wb), to_double(x[i].q_wb)), 4e-6);
    }
}

/// A stream with gaps of both kinds, lost channels and short segments.
std::vector<Pose> broken_stream(Motions& motions) {
    MotionPlan plan;
    plan.n = 250;
    plan.noise_rad = 0.05;
    auto raw = motions.make(plan);
    const double p_gap = motions.uniform(0, 0.2), p_lost = motions.uniform(0, 0.1);
    for (auto& pose : raw) {
        if (motions.chance(p_gap)) {
            constexpr std::uint32_t gaps[] = {flag::gap_before, flag::position_gap,
                                              flag::orientation_gap};
            pose.flags |= gaps[static_cast<std::size_t>(motions.uniform(0, 2.999))];
        }
        if (motions.chance(p_lost)) pose.flags &= ~flag::position_valid;
        if (motions.chance(p_lost)) pose.flags &= ~flag::orientation_valid;
    }
    return raw;
}

template <int Order, std::size_t Rounds, bool Alternate>
void expect_stream_equals_buffer(const std::vector<Pose>& raw, FairingParams params) {
    params.alternate = Alternate;
    const auto whole = faired_buffer<Order>(raw, Rounds, params, OnBound::hold);
    const auto stream = streamed<FairingWindow<Order, Rounds, Alternate>>(raw, params);
    expect_same_bits(whole, stream);
}

TEST(FairingWindow, equals_the_whole_buffer_bit_for_bit) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    for (int trial = 0; trial < 12; ++trial) {
        auto raw = trial == 0 ? motions.make({}) : broken_stream(motions);
        FairingParams params;
        if (trial % 2 == 1) params.bound_m = 0.002f, params.bound_rad = 0.05f;
        expect_stream_equals_buffer<2, 1, false>(raw, params);
        expect_stream_equals_buffer<2, 12, false>(raw, params);
        expect_stream_equals_buffer<3, 1, false>(raw, params);
        expect_stream_equals_buffer<3, 10, false>(raw, params);
        expect_stream_equals_buffer<3, 9, true>(raw, params);
        for (std::size_t n = 0; n < 12; ++n) {
            raw.resize(11 - n);
            expect_stream_equals_buffer<3, 4, false>(raw, params);
        }
        if (HasFailure()) return;
    }
}

TEST(FairingWindow, states_its_latency) {
    static_assert(FairingWindow<2, 1>::latency == 2 && FairingWindow<2, 10>::latency == 11);
    static_assert(FairingWindow<3, 1>::latency == 3 && FairingWindow<3, 10>::latency == 21);
    static_assert(FairingWindow<3, 10, true>::latency <= 18);
}

TEST(FairingWindow, flush_leaves_it_as_new) {
    Motions motions{3};
    const auto raw = motions.make({});
    FairingWindow<3, 5> window;
    std::vector<Pose> first, second;
    for (auto* out : {&first, &second}) {
        for (const auto& pose : raw) {
            if (const auto y = window.push(pose)) out->push_back(*y);
        }
        while (const auto y = window.flush()) out->push_back(*y);
    }
    expect_same_bits(first, second);
}

}  // namespace
}  // namespace fairlead::test
