// Curves by themselves: time, lattice, state, charts, and the symbols of pieces.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fairlead/code/pieces.hpp"
#include "fairlead/code/tables.hpp"
#include "fairlead/curve/scale.hpp"
#include "tests/unit/curve_check.hpp"

namespace fairlead {
namespace {

using curve::Grid;
using curve::Scale;
using curve::State;

TEST(Grid, MomentsAreExactAndColumnsKeepBeforeLaterSamples) {
    std::mt19937_64 random{1};
    for (int i = 0; i < 20000; ++i) {
        const auto period = static_cast<std::int64_t>(64 + random() % 1'000'000'000);
        const Grid g = Grid::of_period(static_cast<std::int64_t>(random() % 1000), period);
        const auto start = static_cast<std::int64_t>(random() % 100000);
        const auto after =
            static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(200 * period));
        const std::int64_t t = g.time_ns(start) + after;
        const curve::Moment m = g.moment(t, start);
        EXPECT_EQ(m.tick, after / g.tick_ns());
        EXPECT_GE(m.part, 0.0f);
        EXPECT_LT(m.part, 1.0f);
        const double exact =
            static_cast<double>(after % g.tick_ns()) / static_cast<double>(g.tick_ns());
        EXPECT_NEAR(static_cast<double>(m.part), exact, 2e-7);
        const std::int32_t column = g.column(t, start);
        // the next sample is at least spacing_subs_min later: behind the column
        const std::int64_t next = t + std::int64_t{curve::spacing_subs_min} * g.sub_ns;
        EXPECT_GT(next, g.time_ns(start + std::int64_t{64} * column));
        EXPECT_LE(g.time_ns(start + std::int64_t{64} * column), t + 8 * std::int64_t{g.sub_ns});
    }
}

TEST(Grid, TimesEndWhereTheirNumbersEnd) {
    const Grid late{INT64_MAX - 1000, 100}, early{INT64_MIN + 1000, 100}, usual{-5, 100};
    EXPECT_EQ(late.time_ns(10), INT64_MAX);
    EXPECT_EQ(late.time_ns(9), INT64_MAX - 100);
    EXPECT_EQ(late.time_ns(11), INT64_MAX);
    EXPECT_EQ(late.time_ns(-10), INT64_MAX - 2000);
    EXPECT_EQ(early.time_ns(-10), INT64_MIN);
    EXPECT_EQ(early.time_ns(-9), INT64_MIN + 100);
    EXPECT_EQ(early.time_ns(-11), INT64_MIN);
    EXPECT_EQ(early.time_ns(10), INT64_MIN + 2000);
    EXPECT_EQ(usual.time_ns(0), -5);
    EXPECT_EQ(usual.time_ns(3), 295);
    EXPECT_EQ(usual.time_ns(-3), -305);
}

TEST(Scale, StepsAreBelowTheWishAndSamplesAreRoundedExactly) {
    std::mt19937_64 random{2};
    for (int i = 0; i < 200000; ++i) {
        const double wish = std::pow(10, -12 + 20 * static_cast<double>(random() >> 11) * 0x1p-53);
        const Scale s = Scale::of_step(static_cast<float>(wish));
        ASSERT_TRUE(Scale::valid(s.m, s.e));
        EXPECT_LE(s.step(), static_cast<double>(static_cast<float>(wish)));
        EXPECT_GT(s.step(), wish * (1 - 1 / 255.0));
        const double steps = (static_cast<double>(random() >> 11) * 0x1p-52 - 1) *
                             std::pow(2, static_cast<double>(random() % 40) - 16);
        const auto p = static_cast<float>(steps * s.step());
        const double exact = static_cast<double>(p) / s.step() * 1024;
        if (std::fabs(exact) < 1024.0 * curve::value_steps_max) {
            EXPECT_LE(std::fabs(static_cast<double>(s.to_fine(p)) - exact), 0.5 + 1e-9);
        }
    }
}

TEST(State, SlopesOfListedLengthsAreExactAndPiecesJoinSmoothly) {
    std::mt19937_64 random{3};
    State<1> s;
    s.forget(false);
    for (int i = 0; i < 20000; ++i) {
        const State<1> before = s;
        curve::Piece<1> p;
        p.code = static_cast<std::uint8_t>(random() % 16);
        const std::int32_t h = curve::lengths[p.code];
        p.subs = static_cast<std::uint16_t>(64 * h);
        p.k[0] = static_cast<std::int32_t>(random() % 7) - 3;
        if (s.s[0] > 200000 || s.s[0] < -200000 || std::abs(s.v[0]) > 1000000) {
            s = {};
            s.forget(false);
            continue;
        }
        ASSERT_TRUE(curve::step(s, p));
        const double rise = s.v[0] - before.v[0];
        const auto c = curve::polynomial<double>(p.code, before.fresh, before.s[0], rise, h);
        EXPECT_NEAR(c.rise(h), rise, 1e-6);
        EXPECT_NEAR(c.rate(0.0) * 960, before.s[0], 1e-6);
        EXPECT_NEAR(c.rate(h) * 960, s.s[0], 1e-5);  // no rounding: 960 holds every length
    }
}

TEST(State, FreshPiecesForgetTheSlopeAndJumpsLoseIt) {
    for (const std::int32_t slope : {-5000, 0, 777}) {
        State<1> s;
        s.s[0] = slope;
        s.forget(true);
        curve::Piece<1> p{6, 64 * 12, {{24}}};
        const auto c = curve::polynomial<double>(6, true, slope, 24.0, 12);
        EXPECT_NEAR(c.rate(0.0) * 960, slope, 1e-9);
        EXPECT_NEAR(c.rate(12.0), 2, 1e-9);  // the chord's
        ASSERT_TRUE(curve::step(s, p));
        EXPECT_EQ(s.s[0], 2 * 960);
        EXPECT_FALSE(s.fresh);
    }
    State<1> s;
    s.forget(false);
    s.s[0] = 960;
    ASSERT_TRUE(curve::step(s, curve::Piece<1>{curve::code::jump, 20, {{-7}}}));
    EXPECT_EQ(s.v[0], -7);
    EXPECT_EQ(s.s[0], 0);
    EXPECT_EQ(s.phase, 20);
    EXPECT_TRUE(s.loose());
}

TEST(State, StepsOutOfBoundsAreRefusedAndChangeNothing) {
    State<1> s;
    s.forget(false);
    s.s[0] = curve::slope_max;
    const State<1> before = s;
    for (const std::int32_t k : {INT32_MAX, INT32_MIN + 1, 40000, -40000}) {
        EXPECT_FALSE(curve::step(s, curve::Piece<1>{0, 64, {{k}}}));
        EXPECT_EQ(s.v, before.v);
        EXPECT_EQ(s.s, before.s);
    }
}

TEST(State, BoundsAreReachedAndNotPassed) {
    for (const int sign : {1, -1}) {
        State<1> s;
        curve::Piece<1> jump{curve::code::jump, 64, {sign * (curve::vertex_max - 5)}};
        s.v[0] = 0;
        ASSERT_TRUE(curve::step(s, jump));
        jump.k[0] = sign * 6;
        EXPECT_FALSE(curve::step(s, jump));
        jump.k[0] = sign * 5;
        EXPECT_TRUE(curve::step(s, jump));
        EXPECT_EQ(s.v[0], sign * curve::vertex_max);
    }
    // a slope that each piece turns round, around its bound: k moves the slope by twice of it
    std::int32_t largest = 0, least = 0;
    for (std::int32_t slope = -curve::slope_max; slope <= curve::slope_max;
         slope += slope == -curve::slope_max + 3000 ? 2 * (curve::slope_max - 3000) : 1)
        for (std::int32_t k = -2; k <= 2; ++k) {
            State<1> s;
            s.fresh = false;
            s.last_code = 0;
            s.s[0] = slope;
            if (!curve::step(s, curve::Piece<1>{0, 64, {k}})) continue;
            largest = std::max(largest, s.s[0]);
            least = std::min(least, s.s[0]);
        }
    EXPECT_EQ(largest, curve::slope_max);
    EXPECT_EQ(least, -curve::slope_max);
}

TEST(Rotation, RebasingGoesOnWithTheSameOrientationAndRate) {
    std::mt19937_64 random{4};
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
    for (int i = 0; i < 3000; ++i) {
        const float step = 0.004f;
        curve::RotationState s;
        s.anchor =
            normalised(Quat{1, static_cast<float>(unit()), static_cast<float>(unit()), 0.3f});
        std::array<double, 3> v{}, rate{};
        for (std::size_t a = 0; a < 3; ++a) {
            s.chart.v[a] = static_cast<std::int32_t>(unit() * 300);
            s.chart.s[a] = static_cast<std::int32_t>(unit() * 20000);
            v[a] = s.chart.v[a] * static_cast<double>(step);
            rate[a] = s.chart.s[a] / 960.0 * static_cast<double>(step);
        }
        const double dt = 1e-4;
        std::array<double, 3> later{};
        for (std::size_t a = 0; a < 3; ++a) later[a] = v[a] + rate[a] * dt;
        const auto here = test::product(test::wide(s.anchor), test::turned_by(v));
        const auto there = test::product(test::wide(s.anchor), test::turned_by(later));
        curve::rebase(s, step);
        EXPECT_LT(test::angle_between(test::wide(s.anchor), here), 1e-6);
        std::array<double, 3> on{};
        for (std::size_t a = 0; a < 3; ++a)
            on[a] = s.chart.s[a] / 960.0 * static_cast<double>(step) * dt;
        const auto went = test::product(here, test::turned_by(on));
        EXPECT_LT(test::angle_between(went, there), 1e-8 + 1e-3 * test::angle_between(here, there));
    }
}

TEST(Rotation, TheGridIsWithinItsBound) {
    std::mt19937_64 random{5};
    const auto unit = [&] { return static_cast<float>(random() >> 40) * 0x1p-23f - 1.0f; };
    double worst = 0;
    for (int i = 0; i < 40000; ++i) {
        // the worst places have four components alike; steps move them against the grid
        const bool alike = i % 2 != 0;
        const auto half = [&] { return alike ? 0.5f + 0.01f * unit() : unit(); };
        const Quat q = normalised(Quat{half(), half(), half(), half()});
        const float step = 0.0039f + 1e-5f * unit();
        const curve::GridQuat g = curve::to_grid(q, step);
        for (const auto n : g.n) EXPECT_LE(std::abs(n), curve::grid_size(step));
        worst = std::max(worst,
                         test::angle_between(test::wide(curve::from_grid(g, step)), test::wide(q)) /
                             static_cast<double>(step));
    }
    EXPECT_LT(worst, 0.88);  // 0.79 tolerances: a curve may begin on the grid
    EXPECT_GT(worst, 0.7);
}

template <std::size_t N>
void rows_fit() {
    const auto& costs = code::costs<curve::Smooth, N>;
    const auto sum = [](const auto& row) {
        std::uint32_t all = 0;
        for (const auto c : row) all += code::frequency(c);
        return all;
    };
    for (const auto& row : costs.length) {
        EXPECT_LE(sum(row), 32768u);
        EXPECT_GT(sum(row), 32000u);
    }
    for (const auto& row : costs.value) {
        EXPECT_LE(sum(row), 32768u);
        EXPECT_GT(sum(row), 32000u);
    }
}
TEST(Model, FrequenciesOfARowFitTheCoder) {
    rows_fit<1>();
    rows_fit<3>();
    for (unsigned c = 0; c <= code::cost_max; ++c)
        EXPECT_GE(code::frequency(static_cast<std::uint8_t>(c)) * std::pow(2, c / 16.0 - 15),
                  1 - 2.5e-5);  // as code/model.hpp says
}

/// Random pieces of any kind, coded and read again; the counter's cost bounds the bytes.
template <std::size_t N>
void round_trip(std::uint64_t seed) {
    std::mt19937_64 random{seed};
    std::vector<std::uint8_t> bytes(6000);
    std::vector<curve::Piece<N>> pieces;
    code::RangeEncoder out{bytes.data(), bytes.size()};
    code::Counter counter;
    State<N> state, counted;
    const std::int32_t all = 64 * 200;
    for (std::int32_t left = all; left > 0;) {
        curve::Piece<N> p;
        const bool jump = state.phase != 0 || random() % 9 == 0;
        p.code = jump ? curve::code::jump : static_cast<std::uint8_t>(random() % 16);
        if (jump) {
            const std::int32_t tick = 64 - state.phase;
            const auto some = static_cast<std::int32_t>(random() % static_cast<unsigned>(tick));
            const std::int32_t ways[]{tick, some > 0 ? some : tick, tick + 64};
            const std::int32_t way = ways[random() % 3];
            p.subs = static_cast<std::uint16_t>(way <= left ? way : tick);
        } else {
            if (64 * curve::lengths[p.code] >= left) p.code = curve::code::to_end;
            p.subs = static_cast<std::uint16_t>(
                p.code == curve::code::to_end ? left : 64 * curve::lengths[p.code]);
            if (state.loose()) p.code = static_cast<std::uint8_t>(p.code + curve::code::line);
        }
        for (auto& k : p.k) k = static_cast<std::int32_t>(random() % (random() % 4 ? 7 : 400)) - 3;
        State<N> trial = state;
        if (!curve::step(trial, p)) continue;
        const auto& costs = code::costs<curve::Smooth, N>;
        curve::Piece<N> q = p;
        ASSERT_TRUE(
            (code::code_piece<curve::Smooth>(out, costs, state, p, left, code::End::coded)));
        ASSERT_TRUE(
            (code::code_piece<curve::Smooth>(counter, costs, counted, q, left, code::End::coded)));
        pieces.push_back(p);
        left -= p.subs;
    }
    const std::size_t size = out.finish();
    ASSERT_TRUE(out.ok());
    EXPECT_LE(8.0 * static_cast<double>(size), counter.cost() / 16.0 + 16);
    EXPECT_GE(8.0 * static_cast<double>(size), counter.cost() / 16.0 * 0.99 - 8);
    code::RangeDecoder in{bytes.data(), size};
    State<N> read;
    std::int32_t left = all;
    for (const auto& p : pieces) {
        curve::Piece<N> q;
        ASSERT_TRUE((code::code_piece<curve::Smooth>(in, code::costs<curve::Smooth, N>, read, q,
                                                     left, code::End::coded)));
        ASSERT_EQ(q.code, p.code);
        ASSERT_EQ(q.subs, p.subs);
        ASSERT_EQ(q.k, p.k);
        left -= q.subs;
    }
    EXPECT_TRUE(in.finished());
    EXPECT_EQ(read.v, state.v);
    EXPECT_EQ(read.s, state.s);
}
TEST(Pieces, WhatIsCodedIsReadAgainWithinItsCost) {
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        round_trip<1>(seed);
        round_trip<3>(seed);
    }
}

TEST(Pieces, AnyBytesKeepTheStateInBounds) {
    std::mt19937_64 random{6};
    std::vector<std::uint8_t> bytes(60);
    for (int i = 0; i < 20000; ++i) {
        for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
        code::RangeDecoder in{bytes.data(), bytes.size()};
        State<3> s;
        std::int32_t left = 64 * static_cast<std::int32_t>(1 + random() % 255);
        for (int n = 0; n < 400 && left > 0 && in.ok(); ++n) {
            curve::Piece<3> p;
            if (!code::code_piece<curve::Smooth>(in, code::costs<curve::Smooth, 3>, s, p, left,
                                                 code::End::coded))
                break;
            ASSERT_LE(p.subs, left);
            left -= p.subs;
            for (std::size_t a = 0; a < 3; ++a) {
                ASSERT_LE(std::abs(s.v[a]), curve::vertex_max);
                ASSERT_LE(std::abs(s.s[a]), curve::slope_max);
            }
        }
    }
}

}  // namespace
}  // namespace fairlead
