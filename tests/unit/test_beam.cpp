// The searches and the reducer: guarantee, delay, coverage on streams that look for their failure.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/unit/curve_check.hpp"
#include "tests/unit/random_motion.hpp"

namespace fairlead {
namespace {

using Vectors = reduce::VectorChannel<3, curve::Smooth, reduce::BeamSize<3, 32>, 240>;
using Rotations = reduce::RotationChannel<curve::Smooth, reduce::BeamSize<3, 32>, 240>;
using Check = test::CurveCheck<Vectors, Rotations>;
using reduce::Seam;

Check::Reducer& reducer() {
    static const auto one = std::make_unique<Check::Reducer>();
    return *one;
}

/// One random stream; what it is follows from the seed alone.
test::Report stream(std::uint64_t seed) {
    test::RandomMotion motion{seed};
    std::mt19937_64 random{seed * 77 + 1};
    const auto below = [&](unsigned n) { return static_cast<int>(random() % n); };
    motion.next();
    reduce::Window window;
    window.records = 4 + below(below(3) != 0 ? 60 : 237);
    window.gap_ticks = 1 + below(64);
    window.cost_max = 16 * (8 * 247 - 268);
    Check check{reducer(),
                curve::Grid::of_period(motion.t_ns, motion.period_ns),
                {motion.tolerance, motion.tolerance_rad},
                window};
    const int length = 20 + below(300), mode = below(3);
    const double often = below(2) != 0 ? 0.02 : 0.3;
    for (int i = 0; i < length; ++i) {
        if (i > 0) motion.next();
        Seam seam = mode == 2 ? Seam::independent : Seam::carry;
        if (mode == 1 && motion.chance(often)) seam = Seam::restart;
        check.push(motion.t_ns, {motion.p, motion.q}, motion.valid, motion.gaps, seam);
    }
    check.finish();
    return check.report;
}

TEST(Beam, RandomStreamsAreCoveredInToleranceAndInTime) {
    test::Report all;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        const test::Report r = stream(seed);
        ASSERT_TRUE(r.good()) << "seed " << seed << ": " << r.first << ", worst " << r.worst;
        all.add(r);
    }
    EXPECT_LE(all.worst, 1);
    EXPECT_GT(all.worst, 0.98);  // the tolerance is used
    EXPECT_GT(all.jumps, 1000u);
    EXPECT_GT(all.rebases, 100u);
    EXPECT_LE(all.most_bits, 8 * 247 - 268);  // every frame fits, heads and restarts beside
}

TEST(Beam, AColumnIsNotOfferedBeforeASampleThatIsTaken) {
    // a sample out of the window's reach ended the frame at its push; the column of that push was
    // offered at the next one, before a sample that all hypotheses had taken
    for (const std::uint64_t seed : {13677u, 20610u, 20949u, 21236u, 24628u})
        EXPECT_TRUE(stream(seed).good()) << seed;
}

/// A smooth motion whose samples lie at a phase of the grid: pieces must not depend on it.
double bits_at(double phase) {
    const auto period = std::int64_t{8'333'312};
    Check check{
        reducer(), curve::Grid::of_period(0, period), {0.001f, 0.00436f}, {118, 32, 16 * 1700}};
    for (int i = 0; i < 1200; ++i) {
        const double t = i * 0.0083333;
        const auto wave = [&](double rate, double size) {
            return static_cast<float>(size * std::sin(rate * t));
        };
        const std::int64_t at =
            i * period +
            (i > 0 ? static_cast<std::int64_t>(phase * static_cast<double>(period)) : 0);
        const Vec3 turn{wave(9, 0.8), wave(6.5, 0.6), wave(11, 0.5)};
        check.push(at, {{wave(5, 0.3), wave(7.3, 0.2), wave(3.1, 0.4)}, from_rotation_vector(turn)},
                   3, 0, i % 240 > 200 ? Seam::restart : Seam::carry);
    }
    check.finish();
    EXPECT_TRUE(check.report.good()) << phase << check.report.first;
    EXPECT_LE(check.report.jumps, 6u) << phase;  // at the start, which knows no slope
    return check.report.bits;
}
TEST(Beam, ThePhaseOfTheSamplesCostsLittle) {
    const double on = bits_at(0);
    for (const double phase : {0.001, 0.05, 0.3, 0.5, 0.7, 0.9, 0.999})
        EXPECT_LT(bits_at(phase), 1.15 * on) << phase;
}

TEST(Beam, RestCostsAboutOnePieceAFrame) {
    Check check{
        reducer(), curve::Grid::of_period(0, 10'000'000), {0.001f, 0.005f}, {100, 32, 16 * 900}};
    for (int i = 0; i < 2000; ++i)
        check.push(i * 10'000'000ll, {{1.0f, 2.0f, -3.0f}, Quat{}}, 3, 0, Seam::carry);
    check.finish();
    EXPECT_TRUE(check.report.good());
    EXPECT_LE(check.report.pieces, 6 * check.report.frames);
    EXPECT_LE(check.report.bits, 25.0 * static_cast<double>(check.report.frames));
}

TEST(Beam, ALeapOfOneAxisIsAJumpAndNotMore) {
    Check check{
        reducer(), curve::Grid::of_period(0, 10'000'000), {0.001f, 0.005f}, {100, 32, 16 * 900}};
    for (int i = 0; i < 400; ++i) {
        const float x = i < 200 ? 0.0f : i < 300 ? 5.0f : 5000.0f;  // the second leaves the window
        check.push(i * 10'000'000ll, {{x, 0.0f, 0.0f}, Quat{}}, 3, 0, Seam::carry);
    }
    check.finish();
    EXPECT_TRUE(check.report.good()) << check.report.first;
    EXPECT_GE(check.report.jumps, 2u);
    EXPECT_LE(check.report.jumps, 8u);
}

}  // namespace
}  // namespace fairlead
