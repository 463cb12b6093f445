// Orientations as C2 cubics: what stays where the anchor moves, readers that join, bounds.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "fairlead/base/crc32.hpp"
#include "fairlead/curve/cubic_rotation.hpp"
#include "fairlead/math/quat.hpp"

namespace fairlead {
namespace {

using curve::CubicRotation;
using curve::CubicSpan;
using curve::CubicVertex;
using curve::Piece;
using Random = std::mt19937_64;
using DVec = BasicVec3<double>;
using DQuat = BasicQuat<double>;

constexpr double unit = static_cast<double>(curve::cubic_unit);
constexpr float step_rad = 0.005f;

DQuat exp_of(const DVec& r) {
    const double n = std::sqrt(dot(r, r)), s = n > 1e-12 ? std::sin(n / 2) / n : 0.5;
    return {std::cos(n / 2), s * r.x, s * r.y, s * r.z};
}
DVec log_of(const DQuat& q) {
    const DVec v{q.x, q.y, q.z};
    const double n = std::sqrt(dot(v, v)), s = n > 1e-12 ? 2 * std::atan2(n, q.w) / n : 2;
    return s * v;
}
DQuat wide(const Quat& q) { return {q.w, q.x, q.y, q.z}; }

/// The curve around a vertex, t ticks from it, as rotations; in double, by the definition alone.
DQuat at(const CubicRotation& r, double t) {
    double x[3];
    for (std::size_t c = 0; c < 3; ++c) {
        const CubicVertex& s = r.chart.at[c];
        x[c] = static_cast<double>(s.p) / (6 * unit) + static_cast<double>(s.v) / (2 * unit) * t +
               static_cast<double>(s.a) / unit * t * t / 2;
    }
    const double step = step_rad;
    return wide(r.anchor) * exp_of({x[0] * step, x[1] * step, x[2] * step});
}

/// Rotation, body rate (rad a tick) and angular acceleration at a vertex, by differences.
struct Motion {
    DQuat q;
    DVec rate, turn;
};
Motion motion(const CubicRotation& r) {
    const double h = 1e-3;
    const auto rate = [&](double t) {
        const DVec one = log_of(conj(at(r, t)) * at(r, t + h / 2));
        const DVec two = log_of(conj(at(r, t)) * at(r, t - h / 2));
        return (1 / h) * (one - two);
    };
    return {at(r, 0), rate(0), (1 / (2 * h)) * (rate(h) - rate(-h))};
}
double size(const DVec& v) { return std::sqrt(dot(v, v)); }
double angle(const DQuat& a, const DQuat& b) {
    const DQuat d = conj(a) * b;
    return size(log_of(d.w < 0 ? -d : d));
}

double uniform(Random& random, double most) {
    return most * (2 * static_cast<double>(random() >> 11) / 9007199254740992.0 - 1);
}
Quat any_rotation(Random& random) {
    return normalised(Quat{static_cast<float>(uniform(random, 1)),
                           static_cast<float>(uniform(random, 1)),
                           static_cast<float>(uniform(random, 1)), 0.3f});
}
/// A state in the middle of a chart: up to `most` rad from the anchor, fast and turning.
CubicRotation moving(Random& random, double most) {
    CubicRotation r = CubicRotation::begin(any_rotation(random));
    const double scale = random() % 4 == 0 ? 1e-3 : 1;  // near the anchor as well
    for (auto& c : r.chart.at) {
        c.p = static_cast<std::int64_t>(uniform(random, scale * most / 1.8 / 0.005) * 6 * unit);
        c.v = static_cast<std::int64_t>(uniform(random, 20) * 2 * unit);
        c.a = static_cast<std::int64_t>(uniform(random, 1) * unit);
    }
    r.chart.last_code = 4;
    return r;
}

void expect_same_motion(const Motion& a, const Motion& b) {
    const double fast = size(a.rate);
    EXPECT_LT(angle(a.q, b.q), 2e-6);
    EXPECT_LT(size(a.rate - b.rate), 1e-6 * (fast + 1e-3));
    // differences of differences of doubles give 1e-8 rad a tick^2 by themselves
    EXPECT_LT(size(a.turn - b.turn), 2e-6 * (size(a.turn) + fast * fast) + 5e-8);
}

TEST(CubicRotation, RateAndAccelerationGoOnWhereTheAnchorFollows) {
    Random random{1};
    for (int trial = 0; trial < 4000; ++trial) {
        CubicRotation r = moving(random, trial % 2 == 0 ? 0.9 : 3.0);
        const Motion before = motion(r);
        ASSERT_TRUE(curve::rebase(r, step_rad));
        for (const CubicVertex& c : r.chart.at) EXPECT_EQ(c.p, 0);
        expect_same_motion(before, motion(r));
        EXPECT_NEAR(norm(Vec3{r.anchor.x, r.anchor.y, r.anchor.z}) *
                            norm(Vec3{r.anchor.x, r.anchor.y, r.anchor.z}) +
                        r.anchor.w * r.anchor.w,
                    1, 1e-6);
    }
}

TEST(CubicRotation, RateAndAccelerationGoOnWhereARunMovesTheAnchor) {
    Random random{2};
    for (int trial = 0; trial < 4000; ++trial) {
        CubicRotation r = moving(random, 1.0);
        ASSERT_TRUE(curve::rebase(r, step_rad));
        const Motion before = motion(r);
        const double away = trial % 3 == 0 ? 1e-3 : 2.4;
        const DQuat to =
            wide(r.anchor) * exp_of({uniform(random, away / 1.8), uniform(random, away / 1.8),
                                     uniform(random, away / 1.8)});
        const Quat target =
            curve::from_grid(curve::to_grid({static_cast<float>(to.w), static_cast<float>(to.x),
                                             static_cast<float>(to.y), static_cast<float>(to.z)},
                                            step_rad),
                             step_rad);
        ASSERT_TRUE(curve::begin_run(r, target, step_rad));
        EXPECT_TRUE(curve::same(r.anchor, target));
        EXPECT_EQ(r.chart.run, 3);
        expect_same_motion(before, motion(r));
    }
}

Piece<3> listed(std::size_t i, std::int32_t x, std::int32_t y, std::int32_t z) {
    Piece<3> p;
    p.code = static_cast<std::uint8_t>(i);
    p.subs = static_cast<std::uint16_t>(curve::lengths[i] * curve::subs_per_tick);
    p.k = {x, y, z};
    return p;
}
std::int32_t drawn(Random& random, std::int32_t most) {
    return static_cast<std::int32_t>(random() % (2 * static_cast<std::uint64_t>(most) + 1)) - most;
}
bool equal(const CubicRotation& a, const CubicRotation& b) {
    return curve::same(a.anchor, b.anchor) && a.chart.at == b.chart.at &&
           a.chart.last_k == b.chart.last_k && a.chart.before_k == b.chart.before_k &&
           a.chart.sign == b.chart.sign && a.chart.last_code == b.chart.last_code &&
           a.chart.last_ticks == b.chart.last_ticks && a.chart.run == b.chart.run &&
           a.chart.known == b.chart.known;
}

TEST(CubicRotation, AReaderThatJoinsHasTheStateBehindTheRunToTheBit) {
    Random random{3};
    for (int trial = 0; trial < 500; ++trial) {
        CubicRotation r = moving(random, 1.0);
        for (auto& c : r.chart.at) c.v /= 8, c.a /= 16;
        ASSERT_TRUE(curve::rebase(r, step_rad));
        const std::size_t length = 2 + random() % 6;
        const std::int32_t h = curve::lengths[length];
        const Motion before = motion(r);
        // the anchor of the run lies where the first control point does
        const DQuat ahead = at(r, 2 * h);
        const Quat target = curve::from_grid(
            curve::to_grid(
                normalised(Quat{static_cast<float>(ahead.w), static_cast<float>(ahead.x),
                                static_cast<float>(ahead.y), static_cast<float>(ahead.z)}),
                step_rad),
            step_rad);
        CubicRotation joined = CubicRotation::join();
        ASSERT_TRUE(curve::begin_run(r, target, step_rad));
        ASSERT_TRUE(curve::begin_run(joined, target, step_rad));
        EXPECT_LT(size(before.rate - motion(r).rate), 1e-6);
        for (int i = 0; i < 3; ++i) {
            const Piece<3> p =
                i == 0 ? listed(length, 0, 0, 0)
                       : listed(length, drawn(random, 20), drawn(random, 20), drawn(random, 20));
            CubicSpan<3> span, other;
            const auto start = r.chart.at;
            ASSERT_TRUE(step(r.chart, p, span));
            ASSERT_TRUE(step(joined.chart, p, other));
            EXPECT_TRUE(span.start == start);  // the curve of a reader in step goes on
            EXPECT_FALSE(other.known);
            if (i == 2) {  // and through the place where the state is set
                for (std::size_t c = 0; c < 3; ++c) {
                    const CubicVertex end = curve::piece_end(span.start[c], h, span.j[c]);
                    EXPECT_NEAR(static_cast<double>(end.p - r.chart.at[c].p) / (6 * unit), 0, 1e-3);
                    EXPECT_NEAR(static_cast<double>(end.v - r.chart.at[c].v) / (2 * unit) * h, 0,
                                1e-3);
                    EXPECT_NEAR(static_cast<double>(end.a - r.chart.at[c].a) / unit * h * h, 0,
                                1e-3);
                }
            }
        }
        for (int i = 0; i < 8; ++i) {
            ASSERT_TRUE(equal(r, joined));
            if (i % 3 == 2) {
                ASSERT_TRUE(curve::rebase(r, step_rad) && curve::rebase(joined, step_rad));
                ASSERT_TRUE(equal(r, joined));
            }
            const Piece<3> p =
                listed(2 + random() % 4, drawn(random, 2), drawn(random, 2), drawn(random, 2));
            CubicSpan<3> span, other;
            ASSERT_TRUE(step(r.chart, p, span));
            ASSERT_TRUE(step(joined.chart, p, other));
            EXPECT_TRUE(span.start == other.start && span.j == other.j);
        }
    }
}

TEST(CubicRotation, ARunKeepsItsAnchorUntilItEnds) {
    Random random{4};
    CubicRotation r = moving(random, 0.5);
    ASSERT_TRUE(curve::rebase(r, step_rad));
    const Quat target = curve::from_grid(curve::to_grid(r.anchor, step_rad), step_rad);
    ASSERT_TRUE(curve::begin_run(r, target, step_rad));
    for (int i = 0; i < 3; ++i) {
        const CubicRotation before = r;
        EXPECT_FALSE(curve::rebase(r, step_rad)) << i;
        EXPECT_TRUE(equal(before, r));
        CubicSpan<3> span;
        ASSERT_TRUE(step(r.chart, listed(1, 0, 0, 0), span));
    }
    EXPECT_TRUE(curve::rebase(r, step_rad));
    CubicRotation joined = CubicRotation::join();
    EXPECT_FALSE(curve::rebase(joined, step_rad));
}

TEST(CubicRotation, StatesBeyondTheBoundsAreRefusedAndNothingOverflows) {
    // run under -fsanitize=undefined,float-cast-overflow by the checks that build the unit tests so
    Random random{5};
    int refused = 0;
    for (int trial = 0; trial < 100000; ++trial) {
        CubicRotation r = moving(random, 1);
        for (auto& c : r.chart.at) {
            const auto how = static_cast<int>(random() % 4);
            c.p = static_cast<std::int64_t>(uniform(random, std::ldexp(6 * unit, 30 - 8 * how)));
            c.v = static_cast<std::int64_t>(uniform(random, std::ldexp(2 * unit, 13 - 4 * how)));
            c.a = static_cast<std::int64_t>(uniform(random, std::ldexp(unit, 11 - 3 * how)));
            ASSERT_TRUE(curve::inside(c));
        }
        const float step = trial % 2 == 0 ? 1.0f : 1e-4f;
        const CubicRotation before = r;
        if (!curve::rebase(r, step)) {
            ++refused;
            EXPECT_TRUE(equal(before, r));
            r.chart.at[0].p = r.chart.at[1].p = r.chart.at[2].p = 0;
        }
        for (const CubicVertex& c : r.chart.at) ASSERT_TRUE(curve::inside(c));
        const CubicRotation again = r;
        const Quat to = curve::from_grid(curve::to_grid(any_rotation(random), step), step);
        if (!curve::begin_run(r, to, step)) {
            ++refused;
            EXPECT_TRUE(equal(again, r));
        }
        for (const CubicVertex& c : r.chart.at) ASSERT_TRUE(curve::inside(c));
    }
    EXPECT_GT(refused, 1000);
    EXPECT_LT(refused, 190000);
}

/// A fixed course with pieces, runs and moves of the anchor; tests/sim/test_cubic.py walks the same
/// one from docs/cubics.md alone, and reads the digest here.
TEST(CubicRotation, WalksAFixedCourseToTheSameBitsEverywhere) {
    constexpr std::uint32_t rotation_digest = 0x618af7ee;  // of tests/sim/test_cubic.py
    std::uint64_t x = 1;
    const auto draw = [&x](std::uint32_t n) {
        x = x * 6364136223846793005u + 1442695040888963407u;
        return static_cast<std::int32_t>((x >> 33) % n);
    };
    CubicRotation r = CubicRotation::begin(curve::from_grid({0, {10, -20, 30}}, step_rad));
    std::uint32_t sum = 0;
    int runs = 0, rebased = 0, refused = 0;
    for (int i = 0; i < 4000; ++i) {
        const std::int32_t what = draw(12);
        if (r.chart.run == 0 && what < 3) {
            if (!curve::rebase(r, step_rad)) ++refused;
            ++rebased;
            curve::GridQuat g = curve::to_grid(r.anchor, step_rad);
            for (auto& n : g.n) n = static_cast<std::int16_t>(n + draw(41) - 20);
            if (what == 0) {
                if (!curve::begin_run(r, curve::from_grid(g, step_rad), step_rad)) ++refused;
                ++runs;
            }
        }
        const auto length = static_cast<std::size_t>(draw(8));
        const std::int32_t k[] = {draw(5) - 2, draw(5) - 2, draw(5) - 2};
        Piece<3> p = listed(length, k[0], k[1], k[2]);
        if (r.chart.loose()) p.code = static_cast<std::uint8_t>(p.code + curve::code::line);
        if (r.chart.run == 1 || r.chart.run == 2)
            p = listed(r.chart.last_code, 3 * k[0], 3 * k[1], 3 * k[2]);
        CubicSpan<3> span;
        if (!step(r.chart, p, span)) {
            ++refused;
            p = listed(0, 0, 0, 0);
            p.code = curve::code::jump;
            ASSERT_TRUE(step(r.chart, p, span)) << i;
        }
        const auto take = [&sum](const auto& n) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, &n, sizeof n);
            std::uint8_t bytes[8];
            for (unsigned b = 0; b < 8; ++b) bytes[b] = static_cast<std::uint8_t>(bits >> (8 * b));
            sum = crc32(bytes, sizeof n, sum);
        };
        for (const CubicVertex& c : r.chart.at) take(c.p), take(c.v), take(c.a);
        take(r.anchor.w), take(r.anchor.x), take(r.anchor.y), take(r.anchor.z);
    }
    EXPECT_GT(runs, 200);
    EXPECT_GT(rebased, 600);
    EXPECT_LT(refused, 400);
    EXPECT_EQ(sum, rotation_digest);
}

}  // namespace
}  // namespace fairlead
