// Cubics with a continuous second derivative: exact steps, restarts, readers that join, bounds.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "fairlead/base/crc32.hpp"
#include "fairlead/curve/cubic_state.hpp"

namespace fairlead {
namespace {

using curve::CubicSpan;
using curve::CubicState;
using curve::CubicVertex;
using curve::Piece;
using Random = std::mt19937_64;

constexpr double unit = static_cast<double>(curve::cubic_unit);

Piece<1> cubic_of(std::uint8_t code, std::int32_t ticks, std::int32_t k) {
    Piece<1> p;
    p.code = code;
    p.subs = static_cast<std::uint16_t>(ticks * curve::subs_per_tick);
    p.k[0] = k;
    return p;
}
Piece<1> listed(std::size_t i, std::int32_t k) {
    return cubic_of(static_cast<std::uint8_t>(i), curve::lengths[i], k);
}
std::int32_t drawn(Random& random, std::int32_t most) {
    return static_cast<std::int32_t>(
        static_cast<std::int64_t>(random() % (2 * static_cast<std::uint64_t>(most) + 1)) - most);
}
/// A curve in motion: a line to begin with.
CubicState<1> moving(std::int32_t from, std::int32_t rise) {
    auto s = CubicState<1>::begin({from});
    CubicSpan<1> span;
    EXPECT_TRUE(step(s, cubic_of(curve::code::line + 4, 8, rise), span));
    return s;
}

__extension__ typedef __int128 Wide;
/// 6 c h^3 of the control point of a piece by its blossom, in units of 1/cubic_unit.
Wide blossom(const CubicVertex& at, std::int64_t h, std::int64_t j) {
    return Wide{at.p} + Wide{6} * h * at.v + Wide{11} * h * h * at.a + Wide{6} * h * h * h * j;
}

TEST(Cubic, ControlPointsAreMetAndEachStepIsExact) {
    Random random{1};
    for (int trial = 0; trial < 20000; ++trial) {
        CubicVertex at = curve::at_rest(drawn(random, curve::vertex_max - 100000));
        at.p += static_cast<std::int64_t>(random() % 5'000'000'000u);
        at.v = static_cast<std::int64_t>(random()) >> 22;
        at.a = static_cast<std::int64_t>(random()) >> 26;
        ASSERT_TRUE(curve::inside(at));
        const auto h = static_cast<std::int32_t>(1 + random() % 255);
        const std::int32_t c = curve::lattice_near(at) + drawn(random, curve::control_max - 2);
        const std::int64_t j = curve::third_derivative(at, h, c);
        const Wide miss = blossom(at, h, j) - Wide{6} * curve::cubic_unit * c;
        const Wide most = Wide{3} * h * h * h;
        EXPECT_LE(miss, most);
        EXPECT_GE(miss, -most);
        // the end, in wide arithmetic
        const CubicVertex end = curve::piece_end(at, h, j);
        const Wide h1 = h;
        EXPECT_TRUE(Wide{end.p} == at.p + 3 * h1 * at.v + 3 * h1 * h1 * at.a + h1 * h1 * h1 * j);
        EXPECT_TRUE(Wide{end.v} == at.v + 2 * h1 * at.a + h1 * h1 * j);
        EXPECT_TRUE(Wide{end.a} == at.a + h1 * j);
    }
}

TEST(Cubic, CurvesAreTwiceContinuousAtVertices) {
    Random random{2};
    CubicState<1> s = moving(5, 3);
    double value = 0, rate = 0, bend = 0;
    bool begun = false;
    for (int i = 0; i < 5000; ++i) {
        CubicSpan<1> span;
        const std::size_t length = random() % 10;
        ASSERT_TRUE(step(s, listed(length, drawn(random, 2)), span)) << i;
        const auto p = curve::cubic<double>(span.start[0], span.j[0]);
        const double start = curve::value_at<double>(span, 0, 0.0);
        const double size = 1 + std::fabs(start) + std::fabs(rate) * 100 + std::fabs(bend) * 1e4;
        if (begun) {
            EXPECT_NEAR(start, value, 1e-13 * size);
            EXPECT_NEAR(p.rate(0), rate, 1e-13 * size);
            EXPECT_NEAR(p.bend(0), bend, 1e-13 * size);
        }
        const auto h = static_cast<double>(curve::lengths[length]);
        value = curve::value_at<double>(span, 0, h);
        rate = p.rate(h);
        bend = p.bend(h);
        begun = true;
        // what the state says is what the polynomial does
        EXPECT_NEAR(value, static_cast<double>(s.at[0].p) / (6 * unit), 1e-13 * size);
        EXPECT_NEAR(rate, static_cast<double>(s.at[0].v) / (2 * unit), 1e-13 * size);
        EXPECT_NEAR(bend, static_cast<double>(s.at[0].a) / unit, 1e-13 * size);
        if (std::fabs(value) > 1e6) s = moving(5, 3), begun = false;
    }
}

TEST(Cubic, EqualLengthsMakeAUniformSplineOfTheirControlPoints) {
    Random random{3};
    for (const std::int32_t h : curve::lengths) {
        if (h > 48) continue;
        CubicState<1> s = moving(0, 1);
        std::vector<std::int32_t> c;
        for (int i = 0; i < 40; ++i) {
            CubicSpan<1> span;
            const std::int32_t expected = predicted_control(s, 0, h);
            const std::int32_t k = (i % 7 == 3 ? 40 : 0) - expected;  // keeps the curve near 0
            ASSERT_TRUE(step(s, cubic_of(curve::index_of(h), h, k), span)) << h << " " << i;
            c.push_back(expected + k);
        }
        const std::size_t n = c.size();
        const CubicVertex told = curve::behind_run(c[n - 3], c[n - 2], c[n - 1], h);
        const double off = std::pow(h, 3) / (2 * unit) + 1e-12;  // of each control point
        EXPECT_NEAR(static_cast<double>(s.at[0].p - told.p) / (6 * unit), 0, off * 1.01);
        EXPECT_NEAR(static_cast<double>(s.at[0].v - told.v) / (2 * unit), 0, off / h * 1.01);
        EXPECT_NEAR(static_cast<double>(s.at[0].a - told.a) / unit, 0, off * 4 / (h * h) * 1.01);
    }
}

TEST(Cubic, AReaderThatJoinsHasTheStateBehindTheRunToTheBit) {
    Random random{4};
    int runs = 0;
    for (int trial = 0; trial < 400; ++trial) {
        CubicState<1> s = moving(drawn(random, 1000), drawn(random, 20));
        CubicSpan<1> span, other;
        for (int i = 0; i < 5; ++i)
            ASSERT_TRUE(step(s, listed(2 + random() % 4, drawn(random, 1)), span));
        s.restart();
        auto joined = CubicState<1>::join();
        const std::size_t length = 2 + random() % 6;
        const std::int32_t h = curve::lengths[length];
        double value = static_cast<double>(s.at[0].p) / (6 * unit);
        const double rate = static_cast<double>(s.at[0].v) / (2 * unit);
        for (int i = 0; i < 3; ++i) {
            const auto there = static_cast<std::int32_t>(value + rate * h * (i + 2));
            const Piece<1> piece =
                listed(length, there + drawn(random, 2) - predicted_control(s, 0, h));
            EXPECT_EQ(predicted_control(s, 0, h), predicted_control(joined, 0, h));
            ASSERT_TRUE(step(s, piece, span));
            ASSERT_TRUE(step(joined, piece, other));
            EXPECT_TRUE(span.known);
            EXPECT_FALSE(other.known);
            // the curve of a reader in step goes on through the run
            EXPECT_NEAR(curve::value_at<double>(span, 0, 0.0), value, 1e-3);
            value = curve::value_at<double>(span, 0, static_cast<double>(h));
        }
        EXPECT_NEAR(value, static_cast<double>(s.at[0].p) / (6 * unit), 1e-3);
        for (int i = 0; i < 6; ++i) {
            EXPECT_TRUE(s.at == joined.at && s.known && joined.known);
            EXPECT_EQ(s.last_ticks, joined.last_ticks);
            EXPECT_EQ(s.last_code, joined.last_code);
            EXPECT_TRUE(s.last_k == joined.last_k && s.sign == joined.sign);
            const Piece<1> piece = listed(2 + random() % 4, drawn(random, 1));
            ASSERT_TRUE(step(s, piece, span));
            ASSERT_TRUE(step(joined, piece, other));
            EXPECT_TRUE(span.start == other.start && span.j == other.j);
        }
        ++runs;
    }
    EXPECT_EQ(runs, 400);
}

TEST(Cubic, ABreakHasAWayFromEachStateToEachNextValue) {
    Random random{5};
    for (int trial = 0; trial < 20000; ++trial) {
        CubicState<1> s = moving(0, drawn(random, 1000));
        CubicSpan<1> span;
        static_cast<void>(step(s, listed(random() % 4, drawn(random, 30)), span));
        // a line of one tick ends within half a step of any value that 8000 steps reach
        const double wish = curve::lattice_near(s.at[0]) + drawn(random, 8000) + 0.37;
        const auto to = static_cast<std::int32_t>(std::lround(wish));
        const CubicVertex before = s.at[0];
        ASSERT_TRUE(step(s, cubic_of(curve::code::line, 1, to - predicted_end(s, 0, 1)), span));
        EXPECT_EQ(span.start[0].p, before.p);  // C0
        EXPECT_NEAR(curve::value_at<double>(span, 0, 1.0), wish, 0.5 + 1e-6);
        EXPECT_EQ(s.at[0].a, 0);
        // and a jump any other
        const std::int32_t away = drawn(random, curve::vertex_max);
        const std::int32_t k = away - curve::lattice_near(s.at[0]);
        if (std::abs(std::int64_t{away} - curve::lattice_near(s.at[0])) > curve::jump_max) continue;
        ASSERT_TRUE(step(s, cubic_of(curve::code::jump, 1, k), span));
        EXPECT_TRUE(s.at[0] == curve::at_rest(away));
        EXPECT_TRUE(s.loose());
        EXPECT_FALSE(step(s, listed(3, 0), span));  // a line must follow
        EXPECT_TRUE(step(s, cubic_of(curve::code::line + 1, 2, 3), span));
        EXPECT_TRUE(step(s, listed(3, 0), span));
    }
}

TEST(Cubic, StatesAreTheSameInAllTheirPartsAlone) {
    using Same = curve::CubicState<2>;
    const Same a = Same::begin({5, -7});
    ASSERT_TRUE(curve::same(a, Same::begin({5, -7})));
    const auto differs = [&a](auto change) {
        Same b = a;
        change(b);
        return !curve::same(a, b) && !curve::same(b, a);
    };
    EXPECT_TRUE(differs([](Same& s) { ++s.last_code; }));
    EXPECT_TRUE(differs([](Same& s) { ++s.last_ticks; }));
    EXPECT_TRUE(differs([](Same& s) { ++s.phase; }));
    EXPECT_TRUE(differs([](Same& s) { ++s.run; }));
    EXPECT_TRUE(differs([](Same& s) { s.known = !s.known; }));
    for (std::size_t c = 0; c < 2; ++c) {
        EXPECT_TRUE(differs([c](Same& s) { ++s.at[c].p; }));
        EXPECT_TRUE(differs([c](Same& s) { ++s.at[c].v; }));
        EXPECT_TRUE(differs([c](Same& s) { ++s.at[c].a; }));
        EXPECT_TRUE(differs([c](Same& s) { ++s.control[c]; }));
        EXPECT_TRUE(differs([c](Same& s) { ++s.control_before[c]; }));
        EXPECT_TRUE(differs([c](Same& s) { ++s.last_k[c]; }));
        EXPECT_TRUE(differs([c](Same& s) { ++s.before_k[c]; }));
        EXPECT_TRUE(differs([c](Same& s) { ++s.sign[c]; }));
    }
}

TEST(Cubic, PiecesThatAreNotAllowedLeaveTheStateAsItWas) {
    CubicState<1> s = moving(7, 3);
    CubicSpan<1> span;
    const auto refused = [&](const Piece<1>& p) {
        const CubicState<1> before = s;
        const bool taken = step(s, p, span);
        return !taken && s.at == before.at && s.last_code == before.last_code &&
               s.run == before.run && s.last_k == before.last_k && s.phase == before.phase;
    };
    EXPECT_TRUE(refused(cubic_of(3, 5, 0)));                     // length and code differ
    EXPECT_TRUE(refused(cubic_of(curve::code::to_end, 0, 0)));   // no time
    EXPECT_TRUE(refused(cubic_of(curve::code::rebase, 1, 0)));   // of rotations
    EXPECT_TRUE(refused(cubic_of(200, 1, 0)));                   // no code
    EXPECT_TRUE(refused(listed(3, curve::cubic_k_max + 1)));     // out of bounds
    EXPECT_TRUE(refused(listed(0, curve::control_max + 1000)));  // c too far
    EXPECT_TRUE(refused(cubic_of(curve::code::line, 1, 9000)));  // too fast
    Piece<1> part = listed(3, 0);
    part.subs = static_cast<std::uint16_t>(part.subs + 1);
    EXPECT_TRUE(refused(part));
    s.restart();
    EXPECT_TRUE(refused(cubic_of(curve::code::line + 2, 4, 0)));  // no line in a run
    EXPECT_TRUE(refused(cubic_of(curve::code::to_end, 9, 7)));    // its length is not told
    ASSERT_TRUE(step(s, listed(4, 10), span));
    EXPECT_TRUE(refused(listed(5, 0)));  // all three have one length
    ASSERT_TRUE(step(s, listed(4, 0), span));
    // a jump ends a run, its value stands by itself
    ASSERT_TRUE(step(s, cubic_of(curve::code::jump, 1, 12), span));
    EXPECT_TRUE(s.at[0] == curve::at_rest(12));
    EXPECT_EQ(s.run, 0);
    // behind a jump of part of a tick only jumps follow, until the tick is whole again
    Piece<1> half = cubic_of(curve::code::jump, 1, 1);
    half.subs = 20;
    ASSERT_TRUE(step(s, half, span));
    EXPECT_TRUE(refused(cubic_of(curve::code::line, 1, 0)));
    half.subs = 44;
    ASSERT_TRUE(step(s, half, span));
    EXPECT_TRUE(step(s, cubic_of(curve::code::line, 1, 0), span));
}

TEST(Cubic, NoPieceOverflowsWhateverItSays) {
    // run under -fsanitize=undefined by make checks that build the unit tests so
    Random random{6};
    const std::int32_t extremes[] = {0,
                                     1,
                                     -1,
                                     curve::control_max,
                                     -curve::control_max,
                                     curve::cubic_k_max,
                                     curve::vertex_max,
                                     -curve::vertex_max,
                                     curve::jump_max,
                                     (std::numeric_limits<std::int32_t>::max)(),
                                     (std::numeric_limits<std::int32_t>::min)()};
    CubicState<3> s = CubicState<3>::begin({curve::vertex_max, -curve::vertex_max, 0});
    std::size_t taken = 0;
    for (int i = 0; i < 300000; ++i) {
        Piece<3> p;
        p.code = static_cast<std::uint8_t>(random() % 40);
        p.subs = static_cast<std::uint16_t>(random());
        if (random() % 8 != 0 && p.code < 16)
            p.subs = static_cast<std::uint16_t>(curve::lengths[p.code] * 64);
        if (random() % 8 != 0 && curve::is_line(p.code))
            p.subs = static_cast<std::uint16_t>(curve::ends_frame(p.code)
                                                    ? (1 + random() % 255) * 64
                                                    : curve::lengths[p.code - 19u] * 64u);
        for (auto& k : p.k) {
            k = random() % 3 == 0 ? extremes[random() % 11] : drawn(random, 1 << random() % 17);
            if (random() % 2 == 0) k = drawn(random, 3);
        }
        if (random() % 20 == 0) s.restart();
        if (random() % 500 == 0) s = CubicState<3>::join();
        CubicSpan<3> span;
        if (!step(s, p, span)) continue;
        ++taken;
        for (std::size_t c = 0; c < 3; ++c) {
            if (s.known) {
                ASSERT_TRUE(curve::inside(s.at[c])) << i;
            }
            if (span.known) {
                ASSERT_TRUE(std::isfinite(curve::value_at<float>(span, c, 1.0f)));
            }
        }
    }
    EXPECT_GT(taken, 10000u);
}

/// A fixed course of pieces of all sorts; tests/sim/test_cubic.py walks the same one in integers of
/// any size, and reads the digest here.
TEST(Cubic, WalksAFixedCourseToTheSameBitsEverywhere) {
    constexpr std::uint32_t digest = 0x5f4f1fc5;  // of tests/sim/test_cubic.py
    std::uint64_t x = 1;
    const auto draw = [&x](std::uint32_t n) {
        x = x * 6364136223846793005u + 1442695040888963407u;
        return static_cast<std::int32_t>((x >> 33) % n);
    };
    CubicState<1> s = CubicState<1>::begin({100});
    CubicSpan<1> span;
    std::uint32_t sum = 0;
    std::size_t refused = 0;
    for (int i = 0; i < 20000; ++i) {
        if (draw(97) == 0 && s.run == 0) s.restart();
        const std::int32_t what = draw(50), length = draw(10), k = draw(9) - 4;
        Piece<1> p = listed(static_cast<std::size_t>(length), k / 2);
        if (s.loose() || (what == 1 && s.run == 0)) p = listed(static_cast<std::size_t>(length), k);
        if (s.loose() || (what == 1 && s.run == 0))
            p.code = static_cast<std::uint8_t>(p.code + curve::code::line);
        else if (s.run == 3)
            p.k[0] = curve::lattice_near(s.at[0]) + k;
        else if (s.run > 0)
            p = cubic_of(s.last_code, s.last_ticks, k);
        else if (what == 0)
            p = cubic_of(curve::code::jump, 1, 100 * k);
        if (!step(s, p, span)) {
            ++refused;
            ASSERT_TRUE(step(s, cubic_of(curve::code::jump, 1, 0), span)) << i;
        }
        const std::int64_t state[] = {s.at[0].p, s.at[0].v, s.at[0].a, span.j[0]};
        for (const std::int64_t n : state) {
            std::uint8_t bytes[8];
            for (unsigned b = 0; b < 8; ++b)
                bytes[b] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(n) >> (8 * b));
            sum = crc32(bytes, sizeof bytes, sum);
        }
        const std::int8_t past[] = {s.last_k[0], s.before_k[0], s.sign[0]};
        for (const std::int8_t n : past) {
            const auto byte = static_cast<std::uint8_t>(n);
            sum = crc32(&byte, 1, sum);
        }
    }
    EXPECT_LT(refused, 200u);
    EXPECT_EQ(sum, digest);
}

template <std::int64_t D>
void expect_floored(std::mt19937_64& random) {
    for (int i = 0; i < 20000; ++i) {
        auto n = static_cast<std::int64_t>(random()) >> (random() % 62);
        if (i % 3 == 0) n = n / D * D + static_cast<std::int64_t>(random() % 3) - 1;
        ASSERT_EQ(curve::detail::floored_by<D>(n), curve::detail::floored(n, D)) << n;
    }
    for (const std::int64_t n : {std::int64_t{0}, std::int64_t{-1}, INT64_MAX, INT64_MIN})
        ASSERT_EQ(curve::detail::floored_by<D>(n), curve::detail::floored(n, D)) << n;
}
TEST(Cubic, DivisionsByUnitsOf32BitsEqualThoseOf64) {
    std::mt19937_64 random{3};
    expect_floored<6 * curve::cubic_unit>(random);
    expect_floored<6 * curve::cubic_unit / curve::fine>(random);
    expect_floored<2 * curve::cubic_unit / curve::fine>(random);
    expect_floored<curve::cubic_unit / curve::fine>(random);
}

}  // namespace
}  // namespace fairlead
