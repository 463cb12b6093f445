// Any time of the live window: values that never change, and derivatives against differences of an
// evaluation in double that shares nothing with the library's.
#include "fairlead/wire/live.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <random>

#include "fairlead/pipeline.hpp"

using namespace fairlead;

namespace {

constexpr std::int64_t period_ns = 8333333;
constexpr std::int64_t second_ns = 1000000000;

struct Config : PipelineConfig {
    static constexpr std::size_t window = 60;
};

Pose pose_at(std::int64_t t_ns) {
    const double t = static_cast<double>(t_ns) * 1e-9;
    const auto f = [](double x) { return static_cast<float>(x); };
    Pose pose;
    pose.t_ns = t_ns;
    pose.flags = flag::position_valid | flag::orientation_valid;
    pose.p_w_m = {f(0.3 * std::sin(2.1 * t)), f(0.2 * std::cos(3.3 * t)), f(0.1 * t)};
    pose.q_wb = from_rotation_vector(Vec3{f(std::sin(1.7 * t)), f(0.8 * std::cos(t)), 0.3f}) *
                from_rotation_vector(Vec3{0, 0, f(0.9 * t)});
    return pose;
}

std::unique_ptr<Pipeline<Config>> pipeline() {
    Pipeline<Config>::Params params;
    params.encoder.tol_position_m = {0.002f, 0.002f, 0.002f};
    params.encoder.tol_orientation_rad = 0.01f;
    params.encoder.delay_max = 60;
    return std::make_unique<Pipeline<Config>>(params);
}

/// A piece in double, `s` seconds from t_ns.
template <class Piece>
std::array<double, 4> exact(const Piece& piece, std::int64_t t_ns, double s) {
    const auto& span = piece.curve.span;
    const double tick = piece.tick_ns;
    const double u = (static_cast<double>(t_ns - span.t0_ns) + 1e9 * s) / tick;
    std::array<double, 4> out{};
    for (std::size_t d = 0; d < span.c[0].size(); ++d)
        for (std::size_t m = 0; m < 4; ++m)
            out[d] += std::ldexp(span.c[m][d], -8 - 6 * static_cast<int>(m)) *
                      std::pow(u, static_cast<double>(m));
    return out;
}

std::array<double, 4> unit(std::array<double, 4> q) {
    double square = 0;
    for (const double x : q) square += x * x;
    for (double& x : q) x /= std::sqrt(square);
    return q;
}

/// Body rate that leads from a to b in h seconds, small turns.
std::array<double, 3> rate(const std::array<double, 4>& a, const std::array<double, 4>& b,
                           double h) {
    const double w = a[0], x = -a[1], y = -a[2], z = -a[3];
    return {2 / h * (w * b[1] + x * b[0] + y * b[3] - z * b[2]),
            2 / h * (w * b[2] - x * b[3] + y * b[0] + z * b[1]),
            2 / h * (w * b[3] + x * b[2] - y * b[1] + z * b[0])};
}

}  // namespace

TEST(Live, KnowsPoseAndMotionAtAnyTimeOfTheWindow) {
    const auto encoder = pipeline();
    LiveDecoder<64> live;
    std::mt19937 random{11};
    std::map<std::int64_t, std::pair<Vec3, Quat>> answers;
    std::size_t asked = 0;
    for (std::int64_t i = 0; i < 1200; ++i) {
        const Bytes bytes = encoder->push(pose_at(i * period_ns));
        for (std::size_t k = 0; k < bytes.size; ++k) live.push(bytes.data[k]);
        if (i < 60) continue;
        // within the delay bound everything is known, back to a second at least
        const std::int64_t now = (i - 60) * period_ns;
        std::uniform_int_distribution<std::int64_t> ago{0, std::min(now, second_ns)};
        const std::int64_t t = now - ago(random);
        const auto p = live.position(t);
        const auto q = live.orientation(t);
        ASSERT_TRUE(p && q) << "record " << i << " time " << t;
        const Pose truth = pose_at(t);
        EXPECT_LT(norm(p->p_w_m - truth.p_w_m), 0.006f);
        EXPECT_LT(rotation_angle(q->q_wb, truth.q_wb), 0.02f);
        answers[t] = {p->p_w_m, q->q_wb};
        ++asked;

        constexpr double h = 1e-4;
        const auto* piece = live.positions().at(t);
        const auto a = exact(*piece, t, -h), b = exact(*piece, t, 0), c = exact(*piece, t, h);
        const float v[] = {p->velocity_m_s.x, p->velocity_m_s.y, p->velocity_m_s.z};
        const float w[] = {p->acceleration_m_s2.x, p->acceleration_m_s2.y, p->acceleration_m_s2.z};
        for (std::size_t d = 0; d < 3; ++d) {
            const double scale = piece->scale.unit(d);
            EXPECT_NEAR(v[d], scale * (c[d] - a[d]) / (2 * h), 1e-4);
            EXPECT_NEAR(w[d], scale * (c[d] - 2 * b[d] + a[d]) / (h * h), 2e-3);
        }
        const auto* turn = live.orientations().at(t);
        const auto qa = unit(exact(*turn, t, -h)), qb = unit(exact(*turn, t, 0)),
                   qc = unit(exact(*turn, t, h));
        const auto full = rate(qa, qc, 2 * h), before = rate(qa, qb, h), after = rate(qb, qc, h);
        const float rates[] = {q->rates.velocity_rad_s.x, q->rates.velocity_rad_s.y,
                               q->rates.velocity_rad_s.z};
        const float changes[] = {q->rates.acceleration_rad_s2.x, q->rates.acceleration_rad_s2.y,
                                 q->rates.acceleration_rad_s2.z};
        for (std::size_t d = 0; d < 3; ++d) {
            EXPECT_NEAR(rates[d], full[d], 1e-4);
            EXPECT_NEAR(changes[d], (after[d] - before[d]) / h, 1e-2);
        }
    }
    EXPECT_EQ(asked, 1140u);
    const auto until = live.positions().until_ns();
    ASSERT_TRUE(until);
    EXPECT_FALSE(live.position(*until));
    EXPECT_TRUE(live.position(*until - 1));
    EXPECT_FALSE(live.position(-1)) << "before the stream, or forgotten";
    for (const auto& [t, answer] : answers) {  // what is still remembered has not changed
        const auto p = live.position(t);
        const auto q = live.orientation(t);
        if (p) {
            EXPECT_EQ(norm(p->p_w_m - answer.first), 0.0f);
        }
        if (q) {
            EXPECT_EQ(q->q_wb.w, answer.second.w);
            EXPECT_EQ(q->q_wb.z, answer.second.z);
        }
    }
}

TEST(Live, ForgetsTheOldestPieceAndJoinsLate) {
    const auto encoder = pipeline();
    LiveDecoder<4> small, late;
    bool joined = false;
    for (std::int64_t i = 0; i < 1200; ++i) {
        const Bytes bytes = encoder->push(pose_at(i * period_ns));
        for (std::size_t k = 0; k < bytes.size; ++k) {
            small.push(bytes.data[k]);
            if (i > 300) joined = late.push(bytes.data[k]) || joined;
        }
    }
    ASSERT_TRUE(joined);
    ASSERT_TRUE(small.positions().until_ns());
    EXPECT_FALSE(small.position(0));
    EXPECT_EQ(*small.positions().until_ns(), *late.positions().until_ns());
    const std::int64_t t = *small.positions().until_ns() - 1;
    const auto a = small.position(t), b = late.position(t);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(norm(a->p_w_m - b->p_w_m), 0.0f);
    EXPECT_EQ(norm(a->velocity_m_s - b->velocity_m_s), 0.0f);
}
