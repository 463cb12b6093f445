// Any time of the live window: values that never change, within tolerance of the records, and
// derivatives against differences of the decoder's own evaluation in double.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <random>

#include "fairlead/pipeline.hpp"
#include "fairlead/wire/live.hpp"

using namespace fairlead;

namespace {

constexpr std::int64_t period_ns = 8333333, second_ns = 1000000000;

struct Board {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, fairlead::Orientation>;
    using Filter = NoFilter;
    static constexpr std::size_t delay_records_max = 60;
    static constexpr Beam beam = Beam::medium;
    static constexpr std::size_t events_max = 2;
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

std::unique_ptr<Pipeline<Board>> pipeline() {
    Pipeline<Board>::Params params;
    params.sample_period_ns = period_ns;
    params.tolerance.position_m = 0.002f;
    params.tolerance.orientation_rad = 0.01f;
    return std::make_unique<Pipeline<Board>>(params);
}

BasicVec3<double> wide(const Vec3& v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
double angle(const BasicQuat<double>& a, const BasicQuat<double>& b) {
    return 2 * norm(vec(conj(a) * b));  // small ones
}

}  // namespace

TEST(LiveDecoder, KnowsPoseAtAnyTimeOfTheWindow) {
    const auto encoder = pipeline();
    const auto live = std::make_unique<wire::LiveDecoder<64>>();
    std::mt19937 random{11};
    std::map<std::int64_t, std::pair<Vec3, Quat>> answers;
    for (std::int64_t i = 0; i < 1200; ++i) {
        for (const std::uint8_t byte : encoder->push(pose_at(i * period_ns))) live->push(byte);
        if (i < 62) continue;
        // a frame that comes while the reader is not in doubt is believed at once
        const std::int64_t newest = i - 60;
        std::uniform_int_distribution<std::int64_t> ago{0, std::min<std::int64_t>(newest, 120)};
        const std::int64_t t = (newest - ago(random)) * period_ns;
        const auto p = live->position(t);
        const auto q = live->orientation(t);
        ASSERT_TRUE(p && q) << "record " << i << " time " << t;
        const Pose truth = pose_at(t);
        EXPECT_LE(std::abs(p->p_w_m.x - truth.p_w_m.x), 0.002001f);
        EXPECT_LE(std::abs(p->p_w_m.y - truth.p_w_m.y), 0.002001f);
        EXPECT_LE(std::abs(p->p_w_m.z - truth.p_w_m.z), 0.002001f);
        EXPECT_LE(rotation_angle(q->q_wb, truth.q_wb), 0.01001f);
        answers[t] = {p->p_w_m, q->q_wb};
    }
    EXPECT_GT(answers.size(), 600u);
    const auto until = live->position_until_ns();
    ASSERT_TRUE(until);
    EXPECT_TRUE(live->position(*until));
    EXPECT_FALSE(live->position(*until + 1)) << "not final yet";
    EXPECT_FALSE(live->position(-1)) << "before the stream";
    std::size_t remembered = 0;
    for (const auto& [t, answer] : answers) {
        const auto p = live->position(t);
        const auto q = live->orientation(t);
        if (p) {
            EXPECT_EQ(norm(p->p_w_m - answer.first), 0.0f);
            ++remembered;
        }
        if (q) {
            EXPECT_EQ(norm(vec(q->q_wb) - vec(answer.second)), 0.0f);
        }
    }
    EXPECT_GT(remembered, 60u);
}

TEST(LiveDecoder, VelocitiesAreThoseOfTheCurve) {
    const auto encoder = pipeline();
    wire::Decoder<3, 1> decoder;
    constexpr double h = 1e-4;
    constexpr std::int64_t h_ns = 100000;
    std::size_t compared = 0;
    for (std::int64_t i = 0; i < 600; ++i) {
        for (const std::uint8_t byte : encoder->push(pose_at(i * period_ns))) {
            if (!decoder.push(byte)) continue;
            for (wire::CurvePiece piece; decoder.next(piece);) {
                const curve::Grid& grid = decoder.grid();
                const std::int64_t t = grid.time_ns(piece.start) +
                                       (grid.time_ns(piece.end) - grid.time_ns(piece.start)) / 3;
                if (piece.jumps || piece.end == piece.start) continue;
                ++compared;
                if (!piece.rotates) {
                    const auto at = wire::axis_motion(piece, grid, t);
                    const double a = wire::axis_motion<double>(piece, grid, t - h_ns).value,
                                 b = wire::axis_motion<double>(piece, grid, t).value,
                                 c = wire::axis_motion<double>(piece, grid, t + h_ns).value;
                    EXPECT_NEAR(at.value, b, 1e-6);
                    EXPECT_NEAR(at.velocity, (c - a) / (2 * h), 1e-4);
                    EXPECT_NEAR(at.acceleration, (c - 2 * b + a) / (h * h), 2e-3);
                    continue;
                }
                const auto at = wire::orientation_motion(piece, grid, t);
                const auto a = wire::orientation_motion<double>(piece, grid, t - h_ns).q_wb,
                           b = wire::orientation_motion<double>(piece, grid, t).q_wb,
                           c = wire::orientation_motion<double>(piece, grid, t + h_ns).q_wb;
                const auto over = [](const BasicQuat<double>& from, const BasicQuat<double>& to,
                                     double s) { return (2 / s) * vec(conj(from) * to); };
                const auto rate = over(a, c, 2 * h);
                const auto change = (1 / h) * (over(b, c, h) - over(a, b, h));
                EXPECT_LT(norm(wide(at.rates.velocity) - rate), 1e-4);
                EXPECT_LT(norm(wide(at.rates.acceleration) - change), 2e-2);
                EXPECT_LT(angle({static_cast<double>(at.q_wb.w), static_cast<double>(at.q_wb.x),
                                 static_cast<double>(at.q_wb.y), static_cast<double>(at.q_wb.z)},
                                b),
                          1e-6);
            }
        }
    }
    EXPECT_GT(compared, 60u);
}

TEST(LiveDecoder, ForgetsTheOldestPieceAndJoinsLate) {
    const auto encoder = pipeline();
    const auto small = std::make_unique<wire::LiveDecoder<2>>();
    for (std::int64_t i = 0; i < 1200; ++i)
        for (const std::uint8_t byte : encoder->push(pose_at(i * period_ns))) small->push(byte);
    ASSERT_TRUE(small->position_until_ns());
    EXPECT_TRUE(small->position(*small->position_until_ns()));
    EXPECT_FALSE(small->position(second_ns)) << "forgotten";
}

TEST(LiveDecoder, ANewRunForgetsTheOneBefore) {
    const auto encoder = pipeline();
    const auto live = std::make_unique<wire::LiveDecoder<64>>();
    const auto push = [&](std::int64_t t_ns, std::int64_t truth_ns) {
        Pose pose = pose_at(truth_ns);
        pose.t_ns = t_ns;
        for (const std::uint8_t byte : encoder->push(pose)) live->push(byte);
    };
    for (std::int64_t i = 0; i < 300; ++i) push(second_ns * 100 + i * period_ns, i * period_ns);
    ASSERT_TRUE(live->position(second_ns * 101));
    for (std::int64_t i = 0; i < 300; ++i) push(i * period_ns, (300 + i) * period_ns);
    EXPECT_FALSE(live->position(second_ns * 101)) << "the clock that it belonged to is gone";
    EXPECT_TRUE(live->position(second_ns));
}
