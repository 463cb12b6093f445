// Rotations against an independent double reference, over the families where such code fails:
// identity, 1e-8, every threshold +-1 ulp, random, pi - 1e-4, pi, -q.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "fairlead/math/quat.hpp"
#include "tests/ref/rotation.hpp"

using namespace fairlead;

namespace {

constexpr unsigned seed = 1;
constexpr double eps = 1.0 / (1 << 24);  // half an ulp of 1

/// Full rotation angles worth a look, each with its float neighbours.
std::vector<double> angles() {
    std::vector<double> out{0, 1e-30, 1e-20, M_PI - 1e-4, M_PI - 1e-7};
    for (const double a : {1e-8, 2e-15, 2e-2, 1.0, M_PI / 2, M_PI}) {
        const auto f = static_cast<float>(a);
        out.push_back(double{f});
        out.push_back(double{std::nextafter(f, 0.0f)});
        out.push_back(double{std::nextafter(f, 4.0f)});
    }
    return out;
}

/// Calls f with rotation vectors of every family, each about 200 axes.
template <class F>
void families(F&& f) {
    std::mt19937_64 random{seed};
    for (const double a : angles())
        for (int i = 0; i < 200; ++i) {
            ref::V axis = i == 0   ? ref::V{1, 0, 0}
                          : i == 1 ? ref::V{0, 0, -1}
                                   : ref::normal(random, 1);
            f(a / ref::norm(axis) * axis);
        }
    std::uniform_real_distribution<double> any{0, M_PI};
    for (int i = 0; i < 20000; ++i) {
        const ref::V axis = ref::normal(random, 1);
        f(any(random) / ref::norm(axis) * axis);
    }
}

/// Distance in R^4 between quaternions as they stand, signs included.
double distance(const ref::Q& a, const ref::Q& b) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum);
}

}  // namespace

TEST(Quat, ExpAgreesAndIsUnit) {
    double worst = 0, worst_vector = 0, worst_norm = 0;
    families([&](const ref::V& r) {
        const Vec3 f = ref::narrow(r);
        const Quat q = from_rotation_vector(f);
        const ref::Q truth = ref::from_vector(ref::of(f));
        worst = std::max(worst, distance(ref::of(q), truth));
        const ref::V v{double{q.x}, double{q.y}, double{q.z}}, t{truth[1], truth[2], truth[3]};
        if (ref::norm(t) > 1e-35)
            worst_vector = std::max(worst_vector, ref::norm(v - t) / ref::norm(t));
        const ref::Q d = ref::of(q);
        worst_norm = std::max(worst_norm,
                              std::fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + d[3] * d[3] - 1));
    });
    std::printf("exp: %.2f eps absolute, %.2f eps of the vector part, |q|^2 - 1 %.2f eps\n",
                worst / eps, worst_vector / eps, worst_norm / eps);
    EXPECT_LT(worst, 4 * eps);
    EXPECT_LT(worst_vector, 6 * eps);
    EXPECT_LT(worst_norm, 6 * eps);
    const Quat one = exp(Vec3{});
    EXPECT_EQ(one.w, 1.0f);
    EXPECT_EQ(one.x, 0.0f);
    EXPECT_EQ(exp(Vec3{1e-30f, 0, 0}).x, 1e-30f);
}

TEST(Quat, LogIsExactToRoundingAllTheWay) {
    double worst = 0;
    families([&worst](const ref::V& r) {
        for (const double sign : {1.0, -1.0}) {
            ref::Q d = ref::from_vector(r);
            for (double& c : d) c *= sign;
            const Quat q = ref::narrow(d);
            const ref::V truth = ref::to_vector(ref::of(q));  // of the float q itself
            const ref::V out = ref::of(rotation_vector(q));
            if (ref::norm(truth) > 1e-35)
                worst = std::max(worst, ref::norm(out - truth) / ref::norm(truth));
            else
                EXPECT_EQ(ref::norm(out), 0);
        }
    });
    std::printf("log: %.2f eps relative\n", worst / eps);
    EXPECT_LT(worst, 7 * eps);
    EXPECT_EQ(log(Quat{}).x, 0.0f);
    EXPECT_EQ(log(-Quat{}).x, 0.0f);
    EXPECT_EQ(rotation_vector(Quat{0, 0, 1, 0}).y, pi_v<float>);
    EXPECT_EQ(rotation_vector(Quat{-1, 1e-20f, 0, 0}).x, -2e-20f);
}

TEST(Quat, LogDoesNotCareForSignOrLength) {
    families([](const ref::V& r) {
        const Quat q = ref::narrow(ref::from_vector(r));
        const Vec3 a = log(q), b = log(-q);
        if (q.w != 0) {
            EXPECT_EQ(a.x, b.x);
            EXPECT_EQ(a.y, b.y);
            EXPECT_EQ(a.z, b.z);
        }
        const Vec3 c = log(Quat{2 * q.w, 2 * q.x, 2 * q.y, 2 * q.z});
        if (dot(a, a) > 1e-20f) {
            EXPECT_EQ(a.x, c.x);
        }
    });
}

TEST(Quat, ExpAndLogAreInverse) {
    double worst = 0;
    families([&worst](const ref::V& r) {
        if (ref::norm(r) > M_PI - 1e-6 || ref::norm(r) < 1e-30) return;
        const ref::V back = ref::of(rotation_vector(from_rotation_vector(ref::narrow(r))));
        worst = std::max(worst, ref::norm(back - r) / ref::norm(r));
    });
    std::printf("log(exp(v)) - v: %.2f eps relative\n", worst / eps);
    EXPECT_LT(worst, 12 * eps);
}

TEST(Quat, RotationAngle) {
    std::mt19937_64 random{seed};
    double worst = 0;
    families([&](const ref::V& r) {
        const ref::Q a = ref::any_rotation(random), b = ref::mul(a, ref::from_vector(r));
        const Quat fa = ref::narrow(a), fb = ref::narrow(b);
        const double truth = ref::angle(ref::of(fa), ref::of(fb));
        worst = std::max(worst, std::fabs(double{rotation_angle(fa, fb)} - truth));
        EXPECT_EQ(rotation_angle(fa, fb), rotation_angle(fa, -fb));
    });
    std::printf("rotation_angle: %.3g rad absolute\n", worst);
    EXPECT_LT(worst, 1e-6);  // the product of two float quaternions has no more digits
    EXPECT_EQ(rotation_angle(Quat{}, Quat{}), 0.0f);
    EXPECT_EQ(rotation_angle(Quat{}, Quat{0, 1, 0, 0}), pi_v<float>);
}

TEST(Quat, SlerpKeepsToTheGeodesic) {
    std::mt19937_64 random{seed};
    families([&](const ref::V& r) {
        if (ref::norm(r) > M_PI - 1e-5) return;  // both ways are equally short
        const ref::Q a = ref::any_rotation(random), b = ref::mul(a, ref::from_vector(r));
        for (const float s : {0.0f, 0.3f, 0.5f, 1.0f, 1.5f}) {
            const ref::Q truth = ref::mul(a, ref::from_vector(double{s} * r));
            const Quat fa = ref::narrow(a), fb = ref::narrow(b);
            EXPECT_LT(ref::angle(ref::of(slerp(fa, fb, s)), truth), 1.5e-6);
            EXPECT_LT(ref::angle(ref::of(slerp(fa, -fb, s)), truth), 1.5e-6);
        }
    });
}

TEST(Quat, RotateIsTheSandwichProduct) {
    std::mt19937_64 random{seed};
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const ref::Q q = ref::any_rotation(random);
        const ref::V v = ref::normal(random, 1);
        const ref::Q t = ref::mul(ref::mul(q, {0, v[0], v[1], v[2]}), ref::inverse(q));
        const ref::V out = ref::of(rotate(ref::narrow(q), ref::narrow(v)));
        worst = std::max(worst, ref::norm(out - ref::V{t[1], t[2], t[3]}) / ref::norm(v));
    }
    EXPECT_LT(worst, 8 * eps);
    // frames: q_wb * q_ba = q_wa
    const Quat q_wb = from_rotation_vector(Vec3{0.3f, 1, -2}), q_ba = exp(Vec3{0.1f, 0, 0.7f});
    const Vec3 v_a{1, 2, 3};
    const Vec3 two = rotate(q_wb, rotate(q_ba, v_a)), one = rotate(q_wb * q_ba, v_a);
    EXPECT_NEAR(two.x, one.x, 2e-6f);
    EXPECT_NEAR(two.y, one.y, 2e-6f);
    EXPECT_NEAR(two.z, one.z, 2e-6f);
}

TEST(Quat, NormalisedAndSides) {
    const Quat long_one = normalised(Quat{3, 0, -4, 0});
    EXPECT_FLOAT_EQ(long_one.w, 0.6f);
    EXPECT_FLOAT_EQ(long_one.y, -0.8f);
    for (const Quat& q : {Quat{0, 0, 0, 0}, Quat{NAN, 0, 0, 0}, Quat{INFINITY, 0, 0, 0},
                          Quat{3e38f, 3e38f, 0, 0}, Quat{1e-30f, 0, 0, 0}}) {
        const Quat n = normalised(q);
        EXPECT_EQ(n.w, 1.0f);
        EXPECT_EQ(n.x, 0.0f);
    }
    const Quat a = from_rotation_vector(Vec3{0.1f, 0, 0}), b = from_rotation_vector(Vec3{0, 3, 0});
    EXPECT_GE(dot(a, same_side(a, b)), 0);
    EXPECT_GE(dot(a, same_side(a, -b)), 0);
    EXPECT_EQ(same_side(a, -b).y, b.y);
}
