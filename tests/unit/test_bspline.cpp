// B-splines against the recursive definition in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "fairlead/math/bspline.hpp"

using namespace fairlead;

namespace {

using Knots = std::vector<double>;

/// N_{j,k}(t) by its definition, right-continuous.
long double basis(const Knots& u, std::size_t j, std::size_t k, long double t) {
    if (k == 1) return u[j] <= t && t < u[j + 1] ? 1 : 0;
    long double sum = 0;
    if (u[j + k - 1] > u[j]) sum += (t - u[j]) / (u[j + k - 1] - u[j]) * basis(u, j, k - 1, t);
    if (u[j + k] > u[j + 1])
        sum += (u[j + k] - t) / (u[j + k] - u[j + 1]) * basis(u, j + 1, k - 1, t);
    return sum;
}

/// Its derivatives, by the derivative formula.
long double basis(const Knots& u, std::size_t j, std::size_t k, long double t, std::size_t order) {
    if (order == 0) return basis(u, j, k, t);
    long double sum = 0;
    const auto f = static_cast<long double>(k - 1);
    if (u[j + k - 1] > u[j]) sum += f / (u[j + k - 1] - u[j]) * basis(u, j, k - 1, t, order - 1);
    if (u[j + k] > u[j + 1])
        sum -= f / (u[j + k] - u[j + 1]) * basis(u, j + 1, k - 1, t, order - 1);
    return sum;
}

/// Rising knots, some of them multiple (at most `most` times); the ends as they come.
Knots random_knots(std::mt19937_64& random, std::size_t count, std::size_t most) {
    std::uniform_real_distribution<double> step{0.2, 1};
    Knots u{step(random)};
    std::size_t times = 1;
    while (u.size() < count) {
        const bool same = times < most && random() % 3 == 0;
        u.push_back(same ? u.back() : u.back() + step(random));
        times = same ? times + 1 : 1;
    }
    return u;
}

template <std::size_t Order, std::size_t D>
struct Case {
    Knots u;
    BSpline<double, Order, D, 40> curve;
};

template <std::size_t Order, std::size_t D>
Case<Order, D> random_case(unsigned seed, std::size_t n, std::size_t most = Order - 1) {
    std::mt19937_64 random{seed};
    std::uniform_real_distribution<double> value{-1, 1};
    Case<Order, D> c;
    std::vector<std::array<double, D>> points(n);
    for (auto& p : points)
        for (double& x : p) x = value(random);
    Status s = Status::bad_argument;
    while (s != Status::ok) {  // a domain without length is refused
        c.u = random_knots(random, n + Order, most);
        s = c.curve.set(c.u.data(), points.data(), n);
    }
    return c;
}

template <std::size_t Order, std::size_t D>
void agrees_with_the_definition() {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        const auto c = random_case<Order, D>(seed, Order + 2 * seed);
        for (int s = 0; s < 60; ++s) {
            const double t = c.curve.begin() + (c.curve.end() - c.curve.begin()) * s / 60;
            for (std::size_t r = 0; r <= Order; ++r) {
                const auto out = c.curve.at(t, r);
                for (std::size_t d = 0; d < D; ++d) {
                    long double sum = 0, size = 1;
                    for (std::size_t j = 0; j < c.curve.size() && r < Order; ++j) {
                        const long double term = basis(c.u, j, Order, t, r) * c.curve.point(j)[d];
                        sum += term, size += std::fabs(term);
                    }
                    ASSERT_NEAR(out[d], static_cast<double>(sum),
                                static_cast<double>(1e-14L * size))
                        << "order " << Order << " derivative " << r << " seed " << seed;
                }
            }
        }
    }
}

template <std::size_t Order>
void insertion_changes_nothing() {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        std::mt19937_64 random{seed};
        const auto c = random_case<Order, 3>(seed, Order + seed % 7);
        auto more = c.curve;
        std::uniform_real_distribution<double> inside{more.begin(), more.end()};
        for (int k = 0; k < 12; ++k) {
            // new places, old knots, the ends; up to the full multiplicity
            const std::size_t any = random() % (c.u.size());
            const double t = k % 3 == 0 ? inside(random)
                             : k == 1   ? more.begin()
                             : k == 4   ? more.end()
                                        : c.u[any];
            const std::size_t n = more.size();
            std::size_t times = 0;
            for (std::size_t i = 0; i < n + Order; ++i) times += more.knot(i) == t ? 1u : 0u;
            const bool fits = t >= more.begin() && t <= more.end() && times < Order;
            ASSERT_EQ(more.insert(t) == Status::ok, fits);
            ASSERT_EQ(more.size(), n + (fits ? 1 : 0));
            for (std::size_t i = 1; i < more.size() + Order; ++i)
                ASSERT_LE(more.knot(i - 1), more.knot(i));
        }
        for (int s = 0; s < 200; ++s) {
            const double t = c.curve.begin() + (c.curve.end() - c.curve.begin()) * s / 200;
            for (std::size_t d = 0; d < 3; ++d)
                ASSERT_NEAR(more.at(t)[d], c.curve.at(t)[d], 1e-13) << "seed " << seed;
        }
    }
}

}  // namespace

TEST(BSpline, AgreesWithTheDefinition) {
    agrees_with_the_definition<2, 1>();
    agrees_with_the_definition<3, 3>();
    agrees_with_the_definition<4, 3>();
    agrees_with_the_definition<5, 4>();
    agrees_with_the_definition<6, 2>();
}

TEST(BSpline, InsertionLeavesTheCurve) {
    insertion_changes_nothing<2>();
    insertion_changes_nothing<3>();
    insertion_changes_nothing<4>();
    insertion_changes_nothing<5>();
    insertion_changes_nothing<6>();
}

TEST(BSpline, ClampedEndsAndLines) {
    const double u[] = {0, 0, 0, 0, 1, 2.5, 3, 3, 3, 3};
    std::array<std::array<double, 2>, 6> points{};
    for (std::size_t i = 0; i < 6; ++i) {  // on a line, at the Greville abscissae
        const double g = (u[i + 1] + u[i + 2] + u[i + 3]) / 3;
        points[i] = {g, 2 - g};
    }
    BSpline<double, 4, 2, 8> curve;
    ASSERT_EQ(curve.set(u, points.data(), 6), Status::ok);
    for (double t = 0; t <= 3; t += 0.125) {
        EXPECT_NEAR(curve.at(t)[0], t, 1e-15);
        EXPECT_NEAR(curve.at(t)[1], 2 - t, 1e-15);
        EXPECT_NEAR(curve.at(t, 1)[0], 1, 1e-14);
        EXPECT_NEAR(curve.at(t, 2)[0], 0, 1e-14);
        EXPECT_EQ(curve.at(t, 4)[0], 0);
    }
    EXPECT_EQ(curve.at(0), points[0]);
    EXPECT_EQ(curve.at(3), points[5]);
    EXPECT_EQ(curve.insert(3), Status::bad_argument);  // four times already
    EXPECT_EQ(curve.insert(1), Status::ok);
    EXPECT_EQ(curve.insert(1), Status::ok);
    EXPECT_EQ(curve.insert(1), Status::bad_argument);  // full
}

TEST(BSpline, TakesWhatItWasToldAndNoMore) {
    BSpline<float, 3, 1, 6> curve;
    EXPECT_EQ(curve.size(), 0u);
    EXPECT_EQ(curve.insert(0), Status::bad_argument) << "there is no curve yet";
    const float knots[] = {0, 0, 0, 1, 2, 2, 2, 77};
    const std::array<float, 1> points[] = {{1}, {2}, {4}, {8}, {55}};
    ASSERT_EQ(curve.set(knots, points, 4), Status::ok);
    EXPECT_EQ(curve.size(), 4u);
    EXPECT_EQ(curve.knot(6), 2);
    EXPECT_EQ(curve.knot(7), 0);
    EXPECT_EQ(curve.point(3)[0], 8);
    EXPECT_EQ(curve.point(4)[0], 0);
}

TEST(BSpline, RefusesWhatIsNoCurve) {
    const std::array<double, 1> p[6]{};
    BSpline<double, 3, 1, 5> curve;
    const double good[] = {0, 0, 0, 1, 1, 1};
    EXPECT_EQ(curve.set(good, p, 3), Status::ok);
    EXPECT_EQ(curve.set(good, p, 2), Status::bad_argument);
    const double long_one[] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    EXPECT_EQ(curve.set(long_one, p, 6), Status::bad_argument);
    const double falling[] = {0, 0, 2, 1, 3, 3}, four_times[] = {0, 0, 0, 0, 1, 1, 1};
    EXPECT_EQ(curve.set(falling, p, 3), Status::bad_argument);
    EXPECT_EQ(curve.set(four_times, p, 4), Status::bad_argument);
    const double no_number[] = {0, 0, 0, 1, 1, NAN};
    EXPECT_EQ(curve.set(no_number, p, 3), Status::bad_argument);
    EXPECT_EQ(curve.insert(NAN), Status::bad_argument);
    EXPECT_EQ(curve.insert(2), Status::bad_argument);
    BSpline<double, 3, 1, 5> empty;
    EXPECT_EQ(empty.insert(0), Status::bad_argument);
    EXPECT_DEATH(static_cast<void>(empty.at(0)), "");
}
