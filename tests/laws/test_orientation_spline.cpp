// Orientation splines: smoothness, rotation invariance, local control, constant rate.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "fairlead/math/orientation_spline.hpp"
#include "tests/ref/rotation.hpp"

using namespace fairlead;

namespace {

using Curve = OrientationSpline<double, 4, 32>;
using Vd = BasicVec3<double>;
using Qd = BasicQuat<double>;

Qd own(const ref::Q& q) { return {q[0], q[1], q[2], q[3]}; }
ref::Q ref_of(const Qd& q) { return {q.w, q.x, q.y, q.z}; }
double distance(const Vd& a, const Vd& b) { return norm(a - b); }

struct Case {
    std::vector<double> knots;
    std::vector<Qd> controls;
    Curve curve;
};

/// Uneven simple knots, random control orientations up to 2 rad apart, signs as they come.
Case random_case(unsigned seed, std::size_t n = 12) {
    std::mt19937_64 random{seed};
    std::uniform_real_distribution<double> step{0.1, 1};
    Case c;
    double t = 0;
    for (std::size_t i = 0; i < n + 4; ++i) c.knots.push_back(t += step(random));
    ref::Q q = ref::any_rotation(random);
    for (std::size_t i = 0; i < n; ++i) {
        c.controls.push_back(random() & 1 ? own(q) : -own(q));
        ref::V turn = ref::normal(random, 0.6);
        if (ref::norm(turn) > 2) turn = (2 / ref::norm(turn)) * turn;
        q = ref::mul(q, ref::from_vector(turn));
    }
    EXPECT_EQ(c.curve.set(c.knots.data(), c.controls.data(), n), Status::ok);
    return c;
}

}  // namespace

TEST(OrientationSpline, RateAndAccelerationAreDerivatives) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        const Case c = random_case(seed);
        const double h = 1e-4;
        for (double t = c.curve.begin() + h; t < c.curve.end() - h; t += 0.0371) {
            const auto before = c.curve.at(t - h), now = c.curve.at(t), after = c.curve.at(t + h);
            const ref::V turn =
                ref::to_vector(ref::mul(ref::inverse(ref_of(before.q)), ref_of(after.q)));
            const Vd rate{turn[0] / (2 * h), turn[1] / (2 * h), turn[2] / (2 * h)};
            const double scale = 1 + norm(now.rate) * norm(now.rate) + norm(now.acceleration);
            EXPECT_LT(distance(rate, now.rate), 1e-4 * scale) << "seed " << seed << " t " << t;
            const Vd a = (0.5 / h) * (after.rate - before.rate);
            EXPECT_LT(distance(a, now.acceleration), 2e-3 * scale) << "seed " << seed << " t " << t;
            EXPECT_NEAR(dot(now.q, now.q), 1, 1e-14);
        }
    }
}

TEST(OrientationSpline, IsC2AtItsKnots) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const Case c = random_case(seed);
        for (std::size_t k = 4; k < 12; ++k) {
            const double t = c.knots[k], h = 1e-9;
            const auto left = c.curve.at(t - h), right = c.curve.at(t);
            EXPECT_LT(ref::angle(ref_of(left.q), ref_of(right.q)), 1e-7);
            EXPECT_LT(distance(left.rate, right.rate), 1e-6);
            EXPECT_LT(distance(left.acceleration, right.acceleration), 1e-5)
                << "seed " << seed << " knot " << k;
        }
    }
}

TEST(OrientationSpline, LeftAndRightRotationInvariance) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        std::mt19937_64 random{seed};
        const Case c = random_case(seed);
        const Qd a = own(ref::any_rotation(random)), b = own(ref::any_rotation(random));
        std::vector<Qd> turned;
        for (const Qd& q : c.controls) turned.push_back(a * q * b);
        Curve other;
        ASSERT_EQ(other.set(c.knots.data(), turned.data(), turned.size()), Status::ok);
        for (double t = c.curve.begin(); t < c.curve.end(); t += 0.043) {
            const auto p = c.curve.at(t), q = other.at(t);
            EXPECT_LT(ref::angle(ref_of(a * p.q * b), ref_of(q.q)), 1e-13);
            EXPECT_LT(distance(rotate(conj(b), p.rate), q.rate), 1e-11);
            EXPECT_LT(distance(rotate(conj(b), p.acceleration), q.acceleration), 1e-10);
        }
    }
}

TEST(OrientationSpline, ControlIsLocal) {
    const Case c = random_case(3);
    for (std::size_t i = 0; i < c.controls.size(); ++i) {
        auto moved = c.controls;
        moved[i] = moved[i] * exp(Vd{0.2, -0.1, 0.1});
        Curve other;
        ASSERT_EQ(other.set(c.knots.data(), moved.data(), moved.size()), Status::ok);
        bool changed = false;
        for (double t = c.curve.begin(); t < c.curve.end(); t += 0.011) {
            const double angle = ref::angle(ref_of(c.curve.at(t).q), ref_of(other.at(t).q));
            if (t < c.knots[i] || t >= c.knots[i + 4])
                EXPECT_LT(angle, 1e-14) << "control " << i << " t " << t;
            else
                changed = changed || angle > 1e-3;
        }
        EXPECT_TRUE(changed) << "control " << i;
    }
}

TEST(OrientationSpline, ReproducesConstantRate) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        std::mt19937_64 random{seed};
        Case c = random_case(seed);
        const Qd start = own(ref::any_rotation(random));
        const Vd rate{0.7, -1.1, 0.4};
        for (std::size_t i = 0; i < c.controls.size(); ++i) {
            const double greville = (c.knots[i + 1] + c.knots[i + 2] + c.knots[i + 3]) / 3;
            c.controls[i] = start * from_rotation_vector(greville * rate);
        }
        ASSERT_EQ(c.curve.set(c.knots.data(), c.controls.data(), c.controls.size()), Status::ok);
        for (double t = c.curve.begin(); t <= c.curve.end(); t += 0.017) {
            const auto out = c.curve.at(t);
            EXPECT_LT(ref::angle(ref_of(out.q), ref_of(start * from_rotation_vector(t * rate))),
                      1e-13);
            EXPECT_LT(distance(out.rate, rate), 1e-12);
            EXPECT_LT(norm(out.acceleration), 1e-10);
        }
    }
}

TEST(OrientationSpline, ClampedEndsMeetTheirControls) {
    Case c = random_case(5, 8);
    for (std::size_t i = 0; i < 4; ++i) c.knots[i] = c.knots[3], c.knots[8 + i] = c.knots[8];
    ASSERT_EQ(c.curve.set(c.knots.data(), c.controls.data(), 8), Status::ok);
    EXPECT_LT(ref::angle(ref_of(c.curve.at(c.curve.begin()).q), ref_of(c.controls[0])), 1e-14);
    EXPECT_LT(ref::angle(ref_of(c.curve.at(c.curve.end()).q), ref_of(c.controls[7])), 1e-14);
    c.knots[6] = NAN;
    EXPECT_EQ(c.curve.set(c.knots.data(), c.controls.data(), 8), Status::bad_argument);
}

TEST(OrientationSpline, FloatAgreesWithDouble) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        const Case c = random_case(seed);
        OrientationSpline<float, 4, 12> narrow;
        std::vector<float> knots(c.knots.begin(), c.knots.end());
        std::vector<Quat> controls;
        for (const Qd& q : c.controls) controls.push_back(ref::narrow(ref_of(q)));
        ASSERT_EQ(narrow.set(knots.data(), controls.data(), controls.size()), Status::ok);
        for (double t = c.curve.begin(); t < c.curve.end(); t += 0.043)
            EXPECT_LT(ref::angle(ref::of(narrow.at(static_cast<float>(t)).q),
                                 ref_of(c.curve.at(double{static_cast<float>(t)}).q)),
                      2e-5);  // knots of up to 16 s, rounded to float
    }
}
