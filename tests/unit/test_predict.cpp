// Prediction from two poses: exact at constant rate, its stated error under acceleration.
#include <gtest/gtest.h>

#include <cmath>

#include "fairlead/smooth/predict.hpp"
#include "tests/ref/rotation.hpp"

using namespace fairlead;

namespace {

constexpr std::uint32_t both = flag::position_valid | flag::orientation_valid;

/// Turned by `angle` about one axis, moved by as much.
Pose posed(double t_s, double angle, std::uint32_t flags = both) {
    return {std::llround(t_s * 1e9), ref::narrow(ref::V{angle, 0, 1}),
            ref::narrow(ref::from_vector({0, 0.6 * angle, 0.8 * angle})), flags};
}

double turned(const Pose& a, const Pose& b) { return ref::angle(ref::of(a.q_wb), ref::of(b.q_wb)); }

}  // namespace

TEST(Predict, ConstantRateIsExact) {
    for (const double ahead : {-0.01, 0.0, 0.02, 0.5}) {
        const Pose truth = posed(1.01 + ahead, 3 * (1.01 + ahead));
        Pose flipped = posed(1.01, 3.03);
        flipped.q_wb = -flipped.q_wb;
        const Pose out = predicted(posed(1, 3), flipped, truth.t_ns);
        EXPECT_LT(turned(out, truth), 3e-5);  // two floats 10 ms apart know the rate to 4e-5 rad/s
        EXPECT_NEAR(out.p_w_m.x, truth.p_w_m.x, 3e-5);
        EXPECT_EQ(out.t_ns, truth.t_ns);
        EXPECT_EQ(out.flags, both);
    }
}

TEST(Predict, ErrorUnderConstantAcceleration) {
    const double a = 5, h = 0.01;
    const auto angle = [a](double t) { return 0.5 * a * t * t; };
    for (const double dt : {0.005, 0.02, 0.1, 0.3}) {
        const double t = 0.4 + dt;
        const Pose out = predicted(posed(0.4 - h, angle(0.4 - h)), posed(0.4, angle(0.4)),
                                   std::llround(t * 1e9));
        EXPECT_NEAR(turned(out, posed(t, angle(t))), a * dt * (dt + h) / 2, 2e-5);
        EXPECT_NEAR(angle(t) - double{out.p_w_m.x}, a * dt * (dt + h) / 2, 2e-5);
    }
}

TEST(Predict, TellsWhatItCannotKnow) {
    const Pose older = posed(1, 0), newer = posed(1.01, 0.1);
    const std::int64_t t = newer.t_ns + 1;
    EXPECT_EQ(predicted(newer, older, t).flags, 0u);
    EXPECT_EQ(predicted(older, posed(1.01, 0.1, both | flag::gap_before), t).flags, 0u);
    EXPECT_EQ(predicted(older, posed(1.01, 0.1, both | flag::position_gap), t).flags,
              +flag::orientation_valid);
    EXPECT_EQ(predicted(posed(1, 0, flag::position_valid), newer, t).flags, +flag::position_valid);
}
