// Errors of math/approx.hpp in units in the last place of float, against libm in double.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fairlead/math/approx.hpp"

namespace approx = fairlead::approx;

namespace {

/// |value - truth| in ulp of the float nearest to the truth.
double ulp_error(float value, double truth) {
    const float t = static_cast<float>(truth);
    const double ulp = std::nextafter(std::fabs(t), INFINITY) - std::fabs(t);
    return std::fabs(static_cast<double>(value) - truth) / ulp;
}

template <class F>
void sweep(double low, double high, F&& at) {
    std::mt19937_64 random{1};
    std::uniform_real_distribution<double> uniform{low, high};
    for (int i = 0; i < 200000; ++i) at(static_cast<float>(uniform(random)));
}

}  // namespace

TEST(Approx, SinCosWithinTwoUlpOfOne) {
    double worst = 0;
    sweep(-8192, 8192, [&](float x) {
        const auto sc = approx::sin_cos(x);
        worst = std::max(worst, std::fabs(static_cast<double>(sc.sin) - std::sin(double{x})));
        worst = std::max(worst, std::fabs(static_cast<double>(sc.cos) - std::cos(double{x})));
    });
    EXPECT_LT(worst, 1.2e-7);
}

TEST(Approx, SinRelativeErrorNearZero) {
    double worst = 0;
    sweep(-0.785, 0.785, [&](float x) {
        worst = std::max(worst, ulp_error(approx::sin(x), std::sin(double{x})));
    });
    EXPECT_LT(worst, 1.0);
    EXPECT_EQ(approx::sin(1e-30f), 1e-30f);
}

TEST(Approx, Atan2EveryOctant) {
    double worst = 0;
    sweep(-3.14159, 3.14159, [&](float a) {
        const float y = static_cast<float>(std::sin(double{a})),
                    x = static_cast<float>(std::cos(double{a}));
        worst = std::max(worst, ulp_error(approx::atan2(y, x), std::atan2(double{y}, double{x})));
    });
    EXPECT_LT(worst, 3.0);
    EXPECT_EQ(approx::atan2(0.0f, 0.0f), 0.0f);
    EXPECT_FLOAT_EQ(approx::atan2(0.0f, -1.0f), fairlead::pi_v<float>);
    EXPECT_FLOAT_EQ(approx::atan2(1.0f, 0.0f), fairlead::pi_v<float> / 2);
    EXPECT_TRUE(approx::is_nan(approx::atan2(NAN, 1.0f)));
}

TEST(Approx, ExpAndLog) {
    double worst_exp = 0, worst_log = 0;
    sweep(-80, 80, [&](float x) {
        worst_exp = std::max(worst_exp, ulp_error(approx::exp(x), std::exp(double{x})));
    });
    sweep(-80, 80, [&](float e) {
        const float x = static_cast<float>(std::exp(double{e}));
        worst_log = std::max(worst_log, ulp_error(approx::log(x), std::log(double{x})));
    });
    EXPECT_LT(worst_exp, 1.5);
    EXPECT_LT(worst_log, 2.0);
    EXPECT_EQ(approx::exp(-1000.0f), 0.0f);
    EXPECT_TRUE(approx::is_finite(approx::exp(1000.0f)));
    EXPECT_TRUE(approx::is_finite(approx::log(0.0f)));
}

TEST(Approx, DoubleInstanceIsAReference) {
    double worst = 0;
    sweep(-100, 100, [&](float f) {
        const double x = double{f} * 1.0000001;
        worst = std::max(worst, std::fabs(approx::sin(x) - std::sin(x)));
        worst = std::max(worst, std::fabs(approx::atan2(x, 3.0) - std::atan2(x, 3.0)));
        worst = std::max(worst, std::fabs(approx::exp(x / 10) / std::exp(x / 10) - 1));
        worst = std::max(worst, std::fabs(approx::log(1 + x * x) - std::log(1 + x * x)) / 10);
    });
    EXPECT_LT(worst, 4e-16);
}
