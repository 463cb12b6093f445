// Banded solves against dense Gaussian elimination in long double.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "fairlead/math/banded.hpp"

using namespace fairlead;

namespace {

using Dense = std::vector<std::vector<long double>>;

std::vector<long double> dense_solve(Dense m, std::vector<long double> x) {
    const std::size_t n = x.size();
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t best = k;
        for (std::size_t r = k; r < n; ++r)
            if (std::fabs(m[r][k]) > std::fabs(m[best][k])) best = r;
        std::swap(m[k], m[best]);
        std::swap(x[k], x[best]);
        for (std::size_t r = k + 1; r < n; ++r) {
            const long double f = m[r][k] / m[k][k];
            for (std::size_t c = k; c < n; ++c) m[r][c] -= f * m[k][c];
            x[r] -= f * x[k];
        }
    }
    for (std::size_t k = n; k-- > 0;) {
        for (std::size_t c = k + 1; c < n; ++c) x[k] -= m[k][c] * x[c];
        x[k] /= m[k][k];
    }
    return x;
}

/// Random, symmetric, diagonally dominant.
template <class Real, std::size_t Capacity, std::size_t Band>
void check(unsigned seed, std::size_t n, double tolerance) {
    std::mt19937_64 random{seed};
    std::uniform_real_distribution<Real> uniform{-1, 1};
    auto a = std::make_unique<Banded<Real, Capacity, Band>>();
    a->resize(n);
    Dense dense(n, std::vector<long double>(n));
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i > Band ? i - Band : 0; j <= i; ++j) {
            const Real v = i == j ? Real(2 * Band) + 2 + uniform(random) : uniform(random);
            a->at(j, i) = v;
            dense[i][j] = dense[j][i] = static_cast<long double>(v);
        }
    std::vector<Real> x(n);
    for (Real& v : x) v = uniform(random);
    for (std::size_t i = 0; i < n; ++i) {
        long double product = 0;
        for (std::size_t j = 0; j < n; ++j) product += dense[i][j] * static_cast<long double>(x[j]);
        const auto p = static_cast<double>(product);
        ASSERT_NEAR(static_cast<double>(a->multiplied(i, x.data())), p,
                    tolerance * (1 + std::fabs(p)));
    }
    const auto truth = dense_solve(dense, {x.begin(), x.end()});
    ASSERT_EQ(a->factor(), Status::ok);
    a->solve(x.data());
    for (std::size_t i = 0; i < n; ++i)
        ASSERT_NEAR(static_cast<double>(x[i]), static_cast<double>(truth[i]), tolerance)
            << "seed " << seed << " n " << n << " row " << i;
}

}  // namespace

TEST(Banded, AgreesWithADenseSolve) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        for (const std::size_t n : {1u, 2u, 3u, 5u, 30u, 64u}) {
            check<double, 64, 2>(seed, n, 1e-14);
            check<double, 64, 8>(seed, n, 1e-14);
            check<double, 64, 0>(seed, n, 1e-14);
            check<float, 64, 2>(seed, n, 3e-6);
            check<float, 64, 3>(seed, n, 3e-6);
        }
    }
}

TEST(Banded, SolvesForVectorsAtOnce) {
    Banded<float, 16, 2> a;
    a.resize(12);
    for (std::size_t i = 0; i < 12; ++i) {
        a.at(i, i) = 7;
        if (i >= 1) a.at(i, i - 1) = -4;
        if (i >= 2) a.at(i - 2, i) = 1;
    }
    std::array<Vec3, 12> v{};
    std::array<float, 12> s{};
    for (std::size_t i = 0; i < 12; ++i) {
        s[i] = static_cast<float>(i * i % 5);
        v[i] = {s[i], 2 * s[i], -s[i]};
    }
    ASSERT_EQ(a.factor(), Status::ok);
    a.solve(v.data());
    a.solve(s.data());
    for (std::size_t i = 0; i < 12; ++i) {
        EXPECT_EQ(v[i].x, s[i]);
        EXPECT_EQ(v[i].y, 2 * s[i]);
        EXPECT_EQ(v[i].z, -s[i]);
    }
}

TEST(Banded, SaysWhenNotPositiveDefinite) {
    Banded<float, 4, 1> a;
    a.resize(3);
    EXPECT_EQ(a.factor(), Status::bad_data);  // all zero
    for (std::size_t i = 0; i < 3; ++i) a.at(i, i) = 1;
    a.at(2, 1) = 1;  // singular
    EXPECT_EQ(a.factor(), Status::bad_data);
    a.resize(2);
    a.at(0, 0) = NAN;
    EXPECT_EQ(a.factor(), Status::bad_data);
    EXPECT_DEATH(a.resize(5), "");
    EXPECT_DEATH(static_cast<void>(a.at(0, 2)), "");
}

TEST(Banded, BlocksOfThreeAreTheSameSystem) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        constexpr std::size_t n = 9;
        std::mt19937_64 random{seed};
        std::uniform_real_distribution<double> uniform{-1, 1};
        BlockBanded<double, n, 2> blocks;
        blocks.resize(n);
        Dense dense(3 * n, std::vector<long double>(3 * n));
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = i > 2 ? i - 2 : 0; j <= i; ++j) {
                BlockBanded<double, n, 2>::Block m{};
                for (std::size_t r = 0; r < 3; ++r)
                    for (std::size_t c = 0; c < 3; ++c) m[r][c] = uniform(random);
                for (std::size_t r = 0; r < 3 && i == j; ++r) {
                    for (std::size_t c = 0; c < r; ++c) m[c][r] = m[r][c];
                    m[r][r] += 14;
                }
                blocks.add(i, j, m);
                for (std::size_t r = 0; r < 3; ++r)
                    for (std::size_t c = 0; c < 3; ++c)
                        dense[3 * i + r][3 * j + c] = dense[3 * j + c][3 * i + r] = m[r][c];
            }
        std::array<BasicVec3<double>, n> x{};
        std::vector<long double> flat;
        for (auto& v : x) {
            v = {uniform(random), uniform(random), uniform(random)};
            for (const double c : {v.x, v.y, v.z}) flat.push_back(c);
        }
        const auto truth = dense_solve(dense, flat);
        ASSERT_EQ(blocks.factor(), Status::ok);
        blocks.solve(x.data());
        for (std::size_t i = 0; i < n; ++i) {
            EXPECT_NEAR(x[i].x, static_cast<double>(truth[3 * i]), 1e-14) << "seed " << seed;
            EXPECT_NEAR(x[i].z, static_cast<double>(truth[3 * i + 2]), 1e-14) << "seed " << seed;
        }
    }
}
