// Errors of math/approx.hpp in units in the last place of float, against libm in double: at random
// and on every float near each threshold of the code. Each test prints the worst that it saw.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <limits>
#include <random>

#include "fairlead/math/approx.hpp"

namespace approx = fairlead::approx;

namespace {

constexpr unsigned seed = 1;
constexpr double pi = 3.14159265358979323846;

/// |value - truth| in ulp of the float nearest to the truth.
double ulp_error(float value, double truth) {
    const float t = static_cast<float>(truth);
    const double ulp = double{std::nextafter(std::fabs(t), INFINITY)} - double{std::fabs(t)};
    return std::fabs(double{value} - truth) / ulp;
}

/// Random arguments of [low, high], then 200 floats on either side of each threshold.
template <class F>
void sweep(double low, double high, std::initializer_list<double> thresholds, F&& at) {
    std::mt19937_64 random{seed};
    std::uniform_real_distribution<double> uniform{low, high};
    for (int i = 0; i < 300000; ++i) at(static_cast<float>(uniform(random)));
    for (const double threshold : thresholds) {
        float up = static_cast<float>(threshold), down = up;
        for (int i = 0; i < 200; ++i) {
            at(up);
            at(down);
            up = std::nextafter(up, INFINITY);
            down = std::nextafter(down, -INFINITY);
        }
    }
}

/// The worst of |own - libm| over a sweep.
template <class Own, class Libm>
double worst_ulp(const char* name, double low, double high,
                 std::initializer_list<double> thresholds, Own own, Libm libm) {
    double worst = 0;
    sweep(low, high, thresholds, [&](float x) {
        if (x >= static_cast<float>(low) && x <= static_cast<float>(high))
            worst = std::max(worst, ulp_error(own(x), libm(double{x})));
    });
    std::printf("%-6s on [%g, %g]: %.2f ulp\n", name, low, high, worst);
    return worst;
}

}  // namespace

TEST(Approx, SinAndCosBelowAnEighthTurn) {
    EXPECT_LT(worst_ulp(
                  "sin", -pi / 4, pi / 4, {0, 1e-30, 1e-8, 1e-4, pi / 4, -pi / 4},
                  [](float x) { return approx::sin(x); }, [](double x) { return std::sin(x); }),
              0.9);
    EXPECT_LT(worst_ulp(
                  "cos", -pi / 4, pi / 4, {0, 1e-8, 1e-4, pi / 4, -pi / 4},
                  [](float x) { return approx::cos(x); }, [](double x) { return std::cos(x); }),
              0.8);
    EXPECT_EQ(approx::sin(1e-30f), 1e-30f);
    EXPECT_EQ(approx::cos(1e-30f), 1.0f);
}

TEST(Approx, SinAndCosOfManyTurns) {
    double worst = 0;
    sweep(-8192, 8192, {pi / 4, 3 * pi / 4, pi / 2, pi, 100 * pi, 1000.5 * pi, -pi}, [&](float x) {
        const auto sc = approx::sin_cos(x);
        worst = std::max(worst, std::fabs(double{sc.sin} - std::sin(double{x})));
        worst = std::max(worst, std::fabs(double{sc.cos} - std::cos(double{x})));
    });
    std::printf("sin, cos on [-8192, 8192]: %.3g absolute\n", worst);
    EXPECT_LT(worst, 8e-8);
    EXPECT_TRUE(approx::is_nan(approx::sin(NAN)));
    EXPECT_TRUE(approx::is_nan(approx::cos(INFINITY)));
    EXPECT_LE(approx::absolute(approx::sin(3e38f)), 1.0f);
}

TEST(Approx, Atan2AllRound) {
    double worst = 0;
    const auto at = [&worst](float y, float x) {
        if (y == 0) y = 0;  // -0 counts as 0 here: angles lie in (-pi, pi]
        const double truth = std::atan2(double{y}, double{x});
        worst = std::max(worst, ulp_error(approx::atan2(y, x), truth));
    };
    // every direction; octants, half-octants where the code folds, and the axes
    sweep(-pi, pi,
          {0, pi / 4, pi / 2, 3 * pi / 4, pi, -pi / 4, -pi / 2, -3 * pi / 4, -pi, std::atan(0.5),
           std::atan(2), -std::atan(0.5), pi - std::atan(0.5), 1e-8, -1e-8, pi - 1e-4},
          [&](float a) {
              at(static_cast<float>(std::sin(double{a})), static_cast<float>(std::cos(double{a})));
          });
    // every ratio, around every threshold of the ratio
    sweep(0, 3, {0, 0.5, 1, 2, 1e-20, 1e-4}, [&](float ratio) {
        for (const float scale : {1.0f, 1e-30f, 7.3e15f})
            for (const float sign : {1.0f, -1.0f})
                at(ratio * scale, sign * scale), at(-scale, sign * ratio * scale);
    });
    std::printf("atan2  all round: %.2f ulp\n", worst);
    EXPECT_LT(worst, 1.6);
    EXPECT_EQ(approx::atan2(0.0f, 0.0f), 0.0f);
    EXPECT_EQ(approx::atan2(0.0f, -1.0f), fairlead::pi_v<float>);
    EXPECT_EQ(approx::atan2(1.0f, 0.0f), fairlead::pi_v<float> / 2);
    EXPECT_EQ(approx::atan2(-INFINITY, 1.0f), -fairlead::pi_v<float> / 2);
    EXPECT_EQ(approx::atan2(INFINITY, INFINITY), fairlead::pi_v<float> / 4);
    EXPECT_TRUE(approx::is_nan(approx::atan2(NAN, 1.0f)));
    EXPECT_TRUE(approx::is_nan(approx::atan2(1.0f, NAN)));
}

TEST(Approx, AsinAndAcos) {
    EXPECT_LT(worst_ulp(
                  "asin", -1, 1, {-1, -0.5, 0, 1e-8, std::sqrt(0.5), 1},
                  [](float x) { return approx::asin(x); }, [](double x) { return std::asin(x); }),
              2.7);
    EXPECT_LT(worst_ulp(
                  "acos", -1, 1, {-1, -0.5, 0, 1e-8, std::sqrt(0.5), 1},
                  [](float x) { return approx::acos(x); }, [](double x) { return std::acos(x); }),
              2.7);
    EXPECT_EQ(approx::acos(1.0000001f), 0.0f);
    EXPECT_EQ(approx::asin(-1.0000001f), -fairlead::pi_v<float> / 2);
}

TEST(Approx, ExpAndLog) {
    const double half_ln2 = 0.5 * std::log(2.0);
    EXPECT_LT(worst_ulp(
                  "exp", -87, 88, {0, half_ln2, -half_ln2, 3 * half_ln2, -87, 88, 1e-8},
                  [](float x) { return approx::exp(x); }, [](double x) { return std::exp(x); }),
              1.1);
    EXPECT_LT(worst_ulp(
                  "log", 1e-30, 4, {1, std::sqrt(2.0), std::sqrt(0.5), 1e-30, 2, 0.5},
                  [](float x) { return approx::log(x); }, [](double x) { return std::log(x); }),
              0.9);
    double worst = 0;
    sweep(-80, 80, {0}, [&worst](float e) {
        const float x = static_cast<float>(std::exp(double{e}));
        worst = std::max(worst, ulp_error(approx::log(x), std::log(double{x})));
    });
    EXPECT_LT(worst, 0.9);
    EXPECT_EQ(approx::exp(0.0f), 1.0f);
    EXPECT_EQ(approx::log(1.0f), 0.0f);
    EXPECT_EQ(approx::exp(-1000.0f), 0.0f);
    EXPECT_TRUE(approx::is_finite(approx::exp(1000.0f)));
    EXPECT_TRUE(approx::is_finite(approx::log(0.0f)));
    constexpr float least = std::numeric_limits<float>::min();  // the domain includes both ends
    constexpr float most = std::numeric_limits<float>::max();
    EXPECT_LT(ulp_error(approx::log(least), std::log(double{least})), 0.9);
    EXPECT_LT(ulp_error(approx::log(most), std::log(double{most})), 0.9);
    EXPECT_EQ(approx::log(least / 2), std::numeric_limits<float>::lowest());
    EXPECT_TRUE(approx::is_nan(approx::exp(NAN)) && approx::is_nan(approx::log(NAN)));
}

TEST(Approx, DoubleInstanceIsAReference) {
    double worst = 0;
    sweep(-100, 100, {0}, [&](float f) {
        const double x = double{f} * 1.0000001;
        worst = std::max(worst, std::fabs(approx::sin(x) - std::sin(x)));
        worst = std::max(worst, std::fabs(approx::cos(x) - std::cos(x)));
        worst = std::max(worst, std::fabs(approx::atan2(x, 3.0) - std::atan2(x, 3.0)));
        worst = std::max(worst, std::fabs(approx::exp(x / 10) / std::exp(x / 10) - 1));
        worst = std::max(worst, std::fabs(approx::log(1 + x * x) - std::log(1 + x * x)) / 10);
    });
    EXPECT_LT(worst, 4e-16);
}
