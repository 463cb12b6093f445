// C2 cubics as a stream, positions and orientations: whatever the motion does, decoded bytes keep
// the tolerance, and a reader that joins at a restart agrees with one in step.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "fairlead/math/quat.hpp"
#include "host_sim/study/bench_cubics/motion.hpp"
#include "host_sim/study/bench_cubics/stream.hpp"

namespace {

using namespace fairlead::sim;
namespace c2 = fairlead::sim::cubics;
using Random = std::mt19937;

constexpr double tolerance = 1e-3;

Track track(std::size_t n, const std::function<double(std::size_t, std::size_t)>& value) {
    Track t;
    t.channel = Channel::position;
    t.period_s = 1 / 120.0;
    for (std::size_t i = 0; i < n; ++i) {
        t.t.push_back(static_cast<double>(i) * t.period_s);
        for (std::size_t a = 0; a < 3; ++a) t.x.push_back(value(i, a));
    }
    return t;
}

constexpr double angle_tolerance = 0.25 * 3.14159265358979323846 / 180;

/// Orientations that turn about the world's axes by these angles, one after another.
Track turning(std::size_t n, const std::function<double(std::size_t, std::size_t)>& angle) {
    Track t;
    t.channel = Channel::orientation;
    t.period_s = 1 / 120.0;
    for (std::size_t i = 0; i < n; ++i) {
        t.t.push_back(static_cast<double>(i) * t.period_s);
        auto q = c2::exp_of({angle(i, 0), 0, 0}) * c2::exp_of({0, angle(i, 1), 0}) *
                 c2::exp_of({0, 0, angle(i, 2)});
        if (i > 0) {
            const double* last = t.at(i - 1);
            if (q.w * last[0] + q.x * last[1] + q.y * last[2] + q.z * last[3] < 0) q = -q;
        }
        t.x.insert(t.x.end(), {q.w, q.x, q.y, q.z});
    }
    return t;
}

c2::Result coded_rotation(const Track& t, std::int32_t delay, int repeats = 1) {
    c2::StreamParams params = c2::usual_params(Channel::orientation);
    params.delay = delay;
    params.search.repeats = repeats;
    c2::Counts counts;
    return c2::run(t, angle_tolerance, params, c2::train({}), counts);
}

c2::Result coded(const Track& t, std::int32_t delay, std::int32_t look_ahead = 4) {
    c2::StreamParams params;
    params.delay = delay;
    params.look_ahead = look_ahead;
    c2::Counts counts;
    return c2::run(t, tolerance, params, c2::train({}), counts);
}

double swing(std::size_t i, std::size_t axis) {
    const double t = static_cast<double>(i) / 120;
    return 0.3 * std::sin(2 * t + static_cast<double>(axis)) + 0.05 * std::sin(9 * t);
}

TEST(Cubics, SmoothMotionNeedsNoBreak) {
    for (const std::int32_t delay : {16, 60, 120, 240}) {
        const c2::Result r = coded(track(1500, swing), delay);
        EXPECT_EQ(r.fault, "");
        EXPECT_LE(r.error, 1);
        EXPECT_EQ(r.breaks, 0u) << delay;
        EXPECT_LT(r.pieces, 3 * 1500u / (delay < 60 ? 6 : 8)) << delay;
        EXPECT_LT(r.seam, 1e-3) << delay;  // where a restart sets the state
        EXPECT_LT(c2::motion_errors(track(1500, swing), r.decoded).velocity.rms, 0.05) << delay;
    }
}

TEST(Cubics, AnyMotionFindsAWayOn) {
    Random random{3};
    std::normal_distribution<double> normal;
    std::size_t breaks = 0;
    for (int trial = 0; trial < 12; ++trial) {
        double noise = std::pow(10, -4 + trial % 4);  // up to 100 tolerances, sample by sample
        double at[3]{};
        const Track t = track(400, [&](std::size_t i, std::size_t a) {
            if (i % 90 == 89) at[a] += normal(random);  // teleports
            return at[a] + swing(i, a) + noise * normal(random);
        });
        const c2::Result r = coded(t, trial % 2 == 0 ? 60 : 120, trial % 3 == 0 ? 0 : 4);
        EXPECT_EQ(r.fault, "") << trial;
        EXPECT_LE(r.error, 1) << trial;
        breaks += r.breaks;
    }
    EXPECT_GT(breaks, 100u);
}

TEST(Cubics, ShortTracksAndFramesWork) {
    for (const std::size_t n : {2u, 3u, 5u, 8u, 9u, 40u}) {
        const c2::Result r = coded(track(n, swing), 8);
        EXPECT_EQ(r.fault, "") << n;
        EXPECT_LE(r.error, 1) << n;
    }
}

TEST(Cubics, SmoothRotationNeedsNoBreakAndMovesItsChart) {
    // 5 rad/s: several charts a frame, and several turns
    const auto spin = [](std::size_t i, std::size_t axis) {
        return axis == 0 ? 5 * static_cast<double>(i) / 120 : swing(i, axis);
    };
    for (const std::int32_t delay : {60, 120, 240}) {
        const c2::Result r = coded_rotation(turning(900, spin), delay);
        EXPECT_EQ(r.fault, "");
        EXPECT_LE(r.error, 1);
        EXPECT_EQ(r.breaks, 0u) << delay;
        EXPECT_LT(r.seam, 1e-3) << delay;
    }
}

TEST(Cubics, AnyRotationFindsAWayOn) {
    Random random{4};
    std::normal_distribution<double> normal;
    std::size_t breaks = 0;
    for (int trial = 0; trial < 6; ++trial) {
        const double noise = std::pow(10, -4 + trial % 4);
        double at[3]{};
        const Track t = turning(300, [&](std::size_t i, std::size_t a) {
            if (i % 90 == 89) at[a] += normal(random);
            return at[a] + swing(i, a) + noise * normal(random);
        });
        const c2::Result r = coded_rotation(t, trial % 2 == 0 ? 60 : 120, 0);
        EXPECT_EQ(r.fault, "") << trial;
        EXPECT_LE(r.error, 1) << trial;
        breaks += r.breaks;
    }
    EXPECT_GT(breaks, 20u);
}

TEST(Cubics, FewerControlPointsWhereTheyCount) {
    const Track t = track(1500, swing);
    const c2::Result bytes = coded(t, 120);
    c2::StreamParams params = c2::knot_params(Channel::position, 20);
    c2::Counts counts;
    const c2::Result few = c2::run(t, tolerance, params, c2::train({}), counts);
    EXPECT_EQ(few.fault, "");
    EXPECT_LE(few.error, 1);
    EXPECT_EQ(few.breaks, 0u);
    EXPECT_LT(3 * few.control_points, bytes.control_points);  // vertices of three axes in one
    EXPECT_EQ(few.control_points, few.pieces + 3);            // one spline
}

TEST(Cubics, TrainingSavesBytes) {
    const Track t = track(3000, swing);
    c2::StreamParams params;
    c2::Counts counts, unused;
    const c2::Result first = c2::run(t, tolerance, params, c2::train({}), counts);
    const c2::Result second = c2::run(t, tolerance, params, c2::train(counts), unused);
    EXPECT_EQ(second.fault, "");
    EXPECT_LE(second.error, 1);
    EXPECT_LT(second.bytes, first.bytes * 95 / 100);
}

}  // namespace
