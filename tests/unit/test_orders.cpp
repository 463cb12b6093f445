// Splines of every order from 2 to 6, of one to three components, on uneven times: every sample
// within its tolerance of the curve in double, and in time. Smooth motion takes fewer control
// points in parabolas, cubics and quartics than in lines, and no breaks. (Order 6 holds the
// guarantee, but breaks: docs/reducer.md.)
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "fairlead/wire/encoder.hpp"

using namespace fairlead;

namespace {

constexpr std::size_t window = 100;
constexpr std::uint32_t tick_ns = 5800000;

struct Track {
    std::vector<std::int64_t> t_ns;
    std::vector<std::array<float, 3>> p;
};

/// Smooth, with every frequency of a hand; uneven times.
Track motion(unsigned seed, std::size_t n) {
    std::mt19937 random{seed};
    std::uniform_real_distribution<double> phase{0, 6.28}, uneven{0.7, 1.3};
    std::array<std::array<double, 6>, 3> phases;
    for (auto& row : phases)
        for (double& x : row) x = phase(random);
    Track out;
    double t = 5;
    for (std::size_t i = 0; i < n; ++i) {
        std::array<float, 3> p;
        for (std::size_t d = 0; d < 3; ++d) {
            double x = 0;
            for (std::size_t k = 0; k < 6; ++k) {
                const double w = 1.5 * static_cast<double>(k + 1);
                x += 0.3 / (w * w) * std::sin(w * t + phases[d][k]);
            }
            p[d] = static_cast<float>(x);
        }
        out.t_ns.push_back(static_cast<std::int64_t>(t * 1e9));
        out.p.push_back(p);
        t += 0.00833 * uneven(random);
    }
    return out;
}

/// A span in double, in units.
template <class Span>
double value(const Span& span, std::size_t d, std::int64_t t_ns) {
    const double u = static_cast<double>(t_ns - span.t0_ns) / tick_ns;
    double out = 0;
    for (std::size_t m = Span::order; m-- > 0;)
        out = out * u + std::ldexp(span.c[m][d], -8 - 6 * static_cast<int>(m));
    return out;
}

struct Result {
    std::size_t control_points{0}, breaks{0}, checked{0};
    double worst{0};  // in tolerances
    std::uint32_t longest{0};
};

template <std::size_t D, std::size_t Order>
Result reduce(const Track& track, float tol) {
    using Channel = VectorChannel<D, Order>;
    using Reduction = Reducer<Channel, window>;
    std::array<float, D> tols;
    for (std::size_t d = 0; d < D; ++d) tols[d] = tol * static_cast<float>(d + 1);
    const auto reducer =
        std::make_unique<Reduction>(typename Reduction::Params{tols, tick_ns, window, window / 3});
    reducer->set_epoch(track.t_ns[0]);
    Result out;
    Curve<Channel> curve;
    const auto check = [&](std::int64_t until_ns) {
        for (; out.checked < track.t_ns.size() && track.t_ns[out.checked] < until_ns; ++out.checked)
            for (std::size_t d = 0; d < D; ++d) {
                const double unit = reducer->scale().unit(d), p = track.p[out.checked][d];
                const double off = value(curve.span, d, track.t_ns[out.checked]) * unit - p;
                out.worst = std::max(out.worst, std::abs(off) / double{tols[d]});
            }
    };
    const auto take = [&](bool last) {
        const auto batch = reducer->take(last);
        if (batch.begins) {
            curve = batch.start;
            out.control_points += Order;
        }
        for (std::size_t i = 0; i < batch.size; ++i) {
            const auto& k = batch.knot[i];
            check(curve.span.t0_ns + std::int64_t{k.ticks} * tick_ns);
            if (k.shift == stop_shift)
                curve.stop(k.ticks, tick_ns);
            else
                curve.advance(k.ticks, k.jump, k.shift, tick_ns);
        }
        if (batch.covers) check(curve.span.t0_ns + std::int64_t{batch.cover_ticks} * tick_ns);
        out.control_points += batch.size;
    };
    for (std::size_t i = 0; i < track.t_ns.size(); ++i) {
        std::array<float, D> p;
        for (std::size_t d = 0; d < D; ++d) p[d] = track.p[i][d];
        reducer->push(track.t_ns[i], p, false);
        out.longest = std::max(out.longest, reducer->age());
        reducer->allot(slice_large, reducer->closing());
        for (int frames = 0; reducer->due() && frames < 2; ++frames) take(frames == 1);
        EXPECT_FALSE(reducer->due()) << "record " << i;
        reducer->work();
    }
    while (!reducer->empty()) {
        reducer->close(slice_large);
        take(false);
    }
    EXPECT_EQ(out.checked, track.t_ns.size());
    EXPECT_EQ(reducer->counters().refused, 0u);
    out.breaks = reducer->counters().breaks;
    return out;
}

template <std::size_t D, std::size_t Order>
double mean_control_points(float tol) {
    std::size_t sum = 0;
    for (const unsigned seed : {1u, 2u, 3u}) {
        const Result out = reduce<D, Order>(motion(seed, 1500), tol);
        EXPECT_LE(out.worst, 1) << "D " << D << " order " << Order << " seed " << seed;
        EXPECT_LE(out.longest, window) << "D " << D << " order " << Order << " seed " << seed;
        if (Order > 2 && Order < 6) {
            EXPECT_EQ(out.breaks, 0u) << "D " << D << " order " << Order << " seed " << seed;
        }
        sum += out.control_points;
    }
    return static_cast<double>(sum) / 3;
}

template <std::size_t D>
void every_order(float tol) {
    const std::array<double, 5> counts{
        mean_control_points<D, 2>(tol), mean_control_points<D, 3>(tol),
        mean_control_points<D, 4>(tol), mean_control_points<D, 5>(tol),
        mean_control_points<D, 6>(tol)};
    for (const std::size_t order : {3u, 4u, 5u})
        EXPECT_LT(counts[order - 2], 0.9 * counts[0]) << "D " << D << " order " << order;
}

}  // namespace

TEST(Orders, TwoToSixHoldTheGuarantee) {
    every_order<1>(0.001f);
    every_order<2>(0.001f);
    every_order<3>(0.001f);
}
