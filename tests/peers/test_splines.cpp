// The rivals' splines against what must hold for any order, dimension and multiplicity.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host_sim/study/baselines/knots/certificate.hpp"
#include "host_sim/study/baselines/knots/fitpack.hpp"
#include "host_sim/study/baselines/knots/removal.hpp"
#include "host_sim/study/baselines/knots/windowed.hpp"

namespace {

using namespace fairlead::sim;

constexpr unsigned seed = 20;

Spline random_spline(std::mt19937& random, std::size_t order, std::size_t dim) {
    std::uniform_real_distribution<double> real{0, 1};
    std::vector<double> inner;
    for (int i = 0; i < 12; ++i)
        inner.insert(inner.end(), 1 + random() % (order - 1), 0.05 + 0.9 * real(random));
    std::sort(inner.begin(), inner.end());
    Spline out{order, dim, std::vector<double>(order, 0), {}};
    out.knots.insert(out.knots.end(), inner.begin(), inner.end());
    out.knots.insert(out.knots.end(), order, 1);
    for (std::size_t i = 0; i < out.size() * dim; ++i) out.c.push_back(real(random));
    return out;
}

double distance(const Spline& a, const Spline& b) {
    double largest = 0, u[4], v[4];
    for (int i = 0; i <= 1000; ++i) {
        a.evaluate(i / 1000.0, u);
        b.evaluate(i / 1000.0, v);
        for (std::size_t d = 0; d < a.dim; ++d) largest = std::max(largest, std::fabs(u[d] - v[d]));
    }
    return largest;
}

Track wave(std::size_t n, double noise) {
    std::mt19937 random{seed};
    std::normal_distribution<double> normal;
    Track track;
    track.channel = Channel::position;
    track.period_s = 0.01;
    for (std::size_t i = 0; i < n; ++i) {
        const double t = 0.01 * static_cast<double>(i);
        track.t.push_back(t);
        for (const double x : {std::sin(2 * t), 0.3 * std::cos(5 * t), t * t / 20})
            track.x.push_back(x + noise * normal(random));
    }
    return track;
}

TEST(PeerSplines, InsertionKeepsTheCurve) {
    std::mt19937 random{seed};
    for (std::size_t order = 2; order <= order_max; ++order) {
        const Spline g = random_spline(random, order, 3);
        std::vector<double> fine = g.knots;
        for (const double t : {0.11, 0.5, 0.501, 0.77}) fine.push_back(t);
        std::sort(fine.begin(), fine.end());
        EXPECT_LT(distance(g, refined(g, fine)), 1e-13) << "order " << order;
    }
}

TEST(PeerSplines, ElevationKeepsTheCurve) {
    std::mt19937 random{seed};
    std::uniform_real_distribution<double> real{-1, 1};
    Spline linear{2, 1, {0, 0}, {}};
    for (int i = 1; i < 9; ++i) linear.knots.push_back(0.1 * i + 0.04 * real(random));
    linear.knots.insert(linear.knots.end(), 2, 1);
    for (std::size_t i = 0; i < linear.size(); ++i) linear.c.push_back(real(random));
    for (std::size_t order = 3; order <= order_max; ++order)
        EXPECT_LT(distance(linear, elevated(linear, order)), 1e-13) << "order " << order;
}

TEST(PeerSplines, ASuperfluousKnotWeighsNothingAndAnotherBoundsEveryFitWithoutIt) {
    std::mt19937 random{seed};
    for (std::size_t order = 2; order <= order_max; ++order) {
        const Spline g = random_spline(random, order, 2);
        std::vector<double> fine = g.knots;
        const auto at = std::lower_bound(fine.begin(), fine.end(), 0.5);
        const auto i = static_cast<std::size_t>(at - fine.begin());
        fine.insert(at, 0.5);
        EXPECT_LT(knot_weight(refined(g, fine), i), 1e-14);
        for (std::size_t j = order; j < g.size(); ++j) {
            if (!(g.knots[j] < g.knots[j + 1])) continue;
            std::vector<double> less = g.knots;
            less.erase(less.begin() + static_cast<std::ptrdiff_t>(j));
            Spline any{order, 2, less, {}};
            for (std::size_t c = 0; c + 2 < g.c.size(); ++c)  // as near as two choices come
                any.c.push_back(0.5 * (g.c[c] + g.c[c + 2]));
            const Spline back = refined(any, g.knots);
            double moved = 0;
            for (std::size_t c = 0; c < g.c.size(); ++c)
                moved = std::max(moved, std::fabs(back.c[c] - g.c[c]));
            EXPECT_LE(knot_weight(g, j), moved + 1e-12);
        }
    }
}

TEST(PeerSplines, RemovalHoldsItsToleranceAndFindsAPolynomial) {
    Track track = wave(400, 0.001);
    for (const std::size_t order : {2u, 3u, 4u, 5u}) {
        const Spline published = lyche_morken(track, order, 0.01, 0.1);
        const Spline ours = global_removal(track, order, 0.01);
        EXPECT_LE(largest_error(track, published), 0.01);
        EXPECT_LE(largest_error(track, ours), 0.01);
        EXPECT_LT(ours.size(), 80u);
        EXPECT_LT(published.size(), 80u);
    }
    for (std::size_t i = 0; i < track.size(); ++i)
        for (std::size_t d = 0; d < 3; ++d)
            track.x[3 * i + d] = std::pow(track.t[i] - 1, 3) + static_cast<double>(d) * track.t[i];
    EXPECT_EQ(lyche_morken(track, 4, 0.01, 0).size(), 4u);
    EXPECT_EQ(global_removal(track, 4, 0.01).size(), 4u);
    EXPECT_EQ(smoothing_within(track, 0.01).size(), 4u);
}

TEST(PeerSplines, SmoothingMeetsItsSumOfSquares) {
    const Track track = wave(500, 0.01);
    for (const double s : {0.14, 0.3, 3.0}) {
        const Spline spline = smoothing_spline(track, s);
        double sum = 0;
        for (std::size_t i = 0; i < track.size(); ++i) {
            double value[3];
            spline.evaluate(track.t[i], value);
            for (std::size_t d = 0; d < 3; ++d) sum += std::pow(value[d] - track.at(i)[d], 2);
        }
        EXPECT_NEAR(sum / s, 1, 2e-3) << "s " << s;
    }
    EXPECT_LE(largest_error(track, smoothing_within(track, 0.05)), 0.05);
}

TEST(PeerSplines, WiderWindowsRemoveMoreAndStayNearTheFirstCurve) {
    const Track track = wave(400, 0.0005);
    const Spline first = samples_as_control_points(track);
    std::size_t fewest = first.size();
    for (const std::size_t window : {5u, 20u, 50u}) {
        WindowParams params;
        params.window = window;
        params.tolerance = 0.01;
        const Spline reduced = reduce_windowed(first, params);
        EXPECT_LT(reduced.size(), fewest) << "a wider window finds less to remove";
        fewest = reduced.size();
        EXPECT_LT(largest_error(track, reduced), 0.03);
    }
}

/// Error at a proof's last sample of the cubic that passes the other four at alternating lifts
/// (Neville); at the right lift it equals the lift.
double error_with_lift(const Track& track, const Proof& proof, double lift) {
    double p[4];
    const auto t = [&](std::size_t k) { return track.t[proof.samples[k]]; };
    const auto x = [&](std::size_t k) { return track.at(proof.samples[k])[proof.axis]; };
    for (std::size_t k = 0; k < 4; ++k) p[k] = x(k) + (k % 2 == 0 ? lift : -lift);
    for (std::size_t level = 1; level < 4; ++level)
        for (std::size_t k = 0; k + level < 4; ++k)
            p[k] =
                ((t(4) - t(k + level)) * p[k] + (t(k) - t(4)) * p[k + 1]) / (t(k) - t(k + level));
    return p[0] - x(4);
}

TEST(PeerSplines, NoSplineHasFewerControlPointsThanIsProved) {
    const Track track = wave(500, 0.002);
    for (const double tolerance : {0.008, 0.02, 0.1}) {
        const auto proofs = knots_needed(track, tolerance);
        EXPECT_GE(proofs.size(), 2u);
        EXPECT_LE(4 + proofs.size(), global_removal(track, 4, tolerance).size());
        std::size_t end = 0;
        for (const Proof& proof : proofs) {
            EXPECT_GE(proof.samples.front(), end) << "stretches overlap";
            for (std::size_t k = 1; k < 5; ++k) EXPECT_LT(proof.samples[k - 1], proof.samples[k]);
            end = proof.samples.back();
            const double least = least_error(track, proof);
            EXPECT_GT(least, tolerance);
            const double up = error_with_lift(track, proof, least);
            const double down = error_with_lift(track, proof, -least);
            EXPECT_NEAR(std::min(std::fabs(up - least), std::fabs(down + least)), 0, 1e-9)
                << "no cubic has its five errors equal and alternating";
        }
    }
}

TEST(PeerSplines, NothingIsProvedAboutACubic) {
    Track track = wave(300, 0);
    for (std::size_t i = 0; i < track.size(); ++i)
        for (std::size_t d = 0; d < 3; ++d) track.x[3 * i + d] = std::pow(track.t[i] - 1.3, 3);
    EXPECT_TRUE(knots_needed(track, 1e-6).empty());
}

}  // namespace
