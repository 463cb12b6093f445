// Fits of plans: knots are found, portions change nothing, components are weighted apart, and a
// change of the first jump is taken up by those after it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "fairlead/reduce/fit.hpp"

using namespace fairlead;

namespace {

using Channel = VectorChannel<3>;
constexpr std::size_t window = 120, max_knots = 23;
using Fitter = Fit<Channel, window, max_knots, 2>;
using Values = std::vector<std::array<double, 3>>;

constexpr float tolerance = 0.001f;

struct Bench {
    std::unique_ptr<Fitter::Samples> samples = std::make_unique<Fitter::Samples>();
    Fitter::Ahead ahead{};
    Polynomial<3, 4> frozen{};
    Channel::Scale scale = Channel::scale({tolerance, tolerance, tolerance});
    Channel::Judge judge{{tolerance, tolerance, tolerance}, scale};
    std::unique_ptr<Fitter> fitter = std::make_unique<Fitter>();

    /// Values in units of the curve, two ticks apart.
    explicit Bench(const Values& values) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            Waiting<Channel> w;
            w.u = static_cast<float>(2 * i);
            for (std::size_t d = 0; d < 3; ++d)
                w.value[d] = static_cast<float>(values[i][d] * double{scale.unit(d)});
            samples->push(w);
        }
    }
    Fitter::Problem problem() {
        return {*samples, samples->size(), ahead, frozen, judge, false, samples->size()};
    }
    void run(Fitter::KnotPlan& plan, Credit portion = 1 << 30) {
        for (Credit credit = 0; fitter->busy();) {
            credit = std::min(credit + portion, portion);
            fitter->run(problem(), plan, credit);
        }
    }
};

/// A curve that is zero until its first knot, and then turns at each.
const std::vector<int> true_knots{20, 61, 101, 140, 183};
const std::vector<std::array<double, 3>> true_jumps{{2e-3, -1e-3, 1e-3},
                                                    {-5e-3, 3e-3, 2e-3},
                                                    {6e-3, 1e-3, -4e-3},
                                                    {-4e-3, -4e-3, 3e-3},
                                                    {3e-3, 2e-3, -5e-3}};

Values spline() {
    Values out(window);
    for (std::size_t i = 0; i < window; ++i)
        for (std::size_t k = 0; k < true_knots.size(); ++k) {
            const double u = 2.0 * static_cast<double>(i) - true_knots[k];
            for (std::size_t d = 0; d < 3 && u > 0; ++d) out[i][d] += true_jumps[k][d] * u * u * u;
        }
    return out;
}

Fitter::KnotPlan plan_with(const std::vector<int>& knots) {
    Fitter::KnotPlan plan;
    for (const int at : knots) plan.insert(at);
    return plan;
}

/// Largest error of the plan, in tolerances, in double.
double worst(Bench& bench, const Fitter::KnotPlan& plan) {
    double most = 0;
    for (std::size_t i = 0; i < bench.samples->size(); ++i) {
        const auto& sample = (*bench.samples)[i];
        for (std::size_t d = 0; d < 3; ++d) {
            double y = 0;
            for (std::size_t k = 0; k < plan.size; ++k) {
                const double u = double{sample.u} - plan.knot[k];
                if (u > 0) y += double{plan.jump[k][d]} * u * u * u;
            }
            const double unit = double{bench.scale.unit(d)};
            most =
                std::max(most, std::fabs(y * unit - double{sample.value[d]}) / double{tolerance});
        }
    }
    return most;
}

}  // namespace

TEST(Fit, ReproducesASplineFromItsKnots) {
    Bench bench{spline()};
    auto plan = plan_with(true_knots);
    bench.fitter->start(bench.problem(), 0, 0, 0.998f, plan);
    bench.run(plan);
    EXPECT_TRUE(bench.fitter->succeeded());
    EXPECT_LT(worst(bench, plan), 0.02);
    for (std::size_t k = 0; k < plan.size; ++k)
        for (std::size_t d = 0; d < 3; ++d)
            EXPECT_NEAR(double{plan.jump[k][d]}, true_jumps[k][d], 3e-5) << k << ' ' << d;
}

TEST(Fit, SeesWhereKnotsShouldBe) {
    Bench bench{spline()};
    auto moved = true_knots;
    const std::vector<int> by{3, -3, 2, -2, 3};
    for (std::size_t k = 0; k < moved.size(); ++k) moved[k] += by[k];
    auto plan = plan_with(moved);
    bench.fitter->start(bench.problem(), 0, 0, 0.998f, plan);
    bench.run(plan);
    EXPECT_GT(worst(bench, plan), 1);
    bench.fitter->start_shifts(bench.problem(), 0, plan);
    bench.run(plan);
    for (std::size_t k = 0; k < moved.size(); ++k)
        EXPECT_NEAR(bench.fitter->shift(k), static_cast<float>(-by[k]), 0.7f) << k;
}

TEST(Fit, IsTheSameToRoundingInPortionsOfAnySize) {
    std::mt19937 random{11};
    std::normal_distribution<double> noise{0, 0.5};
    auto values = spline();
    for (auto& v : values)
        for (double& x : v) x += noise(random);
    Bench whole{values};
    auto plan = plan_with(true_knots);
    whole.fitter->start(whole.problem(), 1, 5, 0.998f, plan);
    whole.run(plan);
    for (const Credit portion : {1, 700, 5000}) {
        Bench bench{values};
        auto other = plan_with(true_knots);
        bench.fitter->start(bench.problem(), 1, 5, 0.998f, other);
        bench.run(other, portion);
        for (std::size_t k = 0; k < plan.size; ++k)
            for (std::size_t d = 0; d < 3; ++d)
                EXPECT_NEAR(plan.jump[k][d], other.jump[k][d], 1e-6f) << portion;
        EXPECT_EQ(plan.covers, other.covers) << portion;
        EXPECT_EQ(whole.fitter->succeeded(), bench.fitter->succeeded()) << portion;
    }
}

TEST(Fit, LeansTowardsTheWorstOfEachComponentApart) {
    // a few samples of two components stand off by more than the tolerance, to one side: a plain
    // fit misses them, for the many others pull it away
    Values values(window);
    for (std::size_t i = 30; i < window; i += 29) values[i][0] += 1.5;
    for (std::size_t i = 40; i < window; i += 31) values[i][1] -= 1.5;
    Bench bench{values};
    auto plain = plan_with({4, 30, 60, 90, 120, 150, 180, 210});
    auto plan = plain;
    bench.fitter->start(bench.problem(), 0, 0, 0.998f, plain);
    bench.run(plain);
    EXPECT_FALSE(bench.fitter->succeeded());
    bench.fitter->start(bench.problem(), 0, 12, 0.998f, plan);
    bench.run(plan);
    EXPECT_TRUE(bench.fitter->succeeded());
    EXPECT_LE(worst(bench, plan), 1.0);
}

TEST(Plan, LaterJumpsTakeUpAChangeOfTheFirst) {
    auto plan = plan_with({0, 7, 9, 40, 52, 60});
    const std::array<float, 3> change{1e-3f, -2e-4f, 5e-5f};
    const auto taken_up = plan.absorption(change);
    for (std::size_t d = 0; d < 3; ++d) {
        double inside = 0;
        for (const double u : {3.0, 20.0, 53.0, 80.0, 300.0}) {
            double sum = double{change[d]} * u * u * u;
            for (std::size_t k = 1; k <= 4; ++k) {
                const double v = u - plan.knot[k];
                if (v > 0) sum += double{taken_up[k - 1][d]} * v * v * v;
            }
            if (u < 52) inside = std::max(inside, std::fabs(sum));
            if (u > 52) {
                EXPECT_LT(std::fabs(sum), 2e-6 * u * u * u * double{std::fabs(change[d])});
            }
        }
        EXPECT_GT(inside, 0);
    }
    plan.absorb(taken_up);
    EXPECT_EQ(plan.jump[0], (std::array<float, 3>{}));
    EXPECT_EQ(plan.jump[1], taken_up[0]);
    EXPECT_EQ(plan.jump[5], (std::array<float, 3>{}));
}
