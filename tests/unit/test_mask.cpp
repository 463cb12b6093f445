// Masks: their taps against the papers and against dense fits, and what checks refuse.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "fairlead/smooth/mask.hpp"

using namespace fairlead;

namespace {

/// Least-squares polynomial by normal equations in long double, read at x = 0: tap i is the answer
/// to a unit sample at i.
std::vector<double> fitted(std::size_t size, std::size_t centre, std::size_t degree) {
    const std::size_t n = degree + 1;
    std::vector<std::vector<long double>> m(n, std::vector<long double>(n + size));
    for (std::size_t i = 0; i < size; ++i) {
        const long double x =
            (static_cast<long double>(i) - static_cast<long double>(centre)) / size;
        for (std::size_t r = 0; r < n; ++r) {
            for (std::size_t c = 0; c < n; ++c) m[r][c] += std::pow(x, r + c);
            m[r][n + i] += std::pow(x, r);
        }
    }
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t best = k;
        for (std::size_t r = k; r < n; ++r)
            if (std::fabs(m[r][k]) > std::fabs(m[best][k])) best = r;
        std::swap(m[k], m[best]);
        for (std::size_t r = 0; r < n; ++r) {
            if (r == k) continue;
            const long double f = m[r][k] / m[k][k];
            for (std::size_t c = k; c < n + size; ++c) m[r][c] -= f * m[k][c];
        }
    }
    std::vector<double> taps;
    for (std::size_t i = 0; i < size; ++i)
        taps.push_back(static_cast<double>(m[0][n + i] / m[0][0]));
    return taps;
}

template <class AMask>
void expect_taps(const AMask& mask, const std::vector<double>& expected, double tolerance) {
    ASSERT_EQ(mask.size(), expected.size());
    for (std::size_t i = 0; i < mask.size(); ++i)
        EXPECT_NEAR(double{mask.tap(i)}, expected[i], tolerance) << "tap " << i;
}

}  // namespace

TEST(Mask, BinomialIsThePaperOne) {
    constexpr auto five = binomial_mask<5>();
    static_assert(five.centre() == 2 && five.size() == 5);
    expect_taps(five, {1 / 16., 4 / 16., 6 / 16., 4 / 16., 1 / 16.}, 0);
    // eq. (24)
    const std::vector<float> b{-1 / 16.f, -5 / 16.f, 5 / 16.f, 1 / 16.f};
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(five.step(i), b[i]);
    const auto wide = binomial_mask<65>();
    double variance = 0, sum = 0;
    for (std::size_t i = 0; i < 65; ++i) {
        const double m = static_cast<double>(i) - 32;
        sum += double{wide.tap(i)};
        variance += double{wide.tap(i)} * m * m;
    }
    EXPECT_NEAR(sum, 1, 1e-7);
    EXPECT_NEAR(variance, 16, 1e-5);  // (Taps - 1) / 4
}

TEST(Mask, LateMasksReadTheLineAndTheParabolaAnywhere) {
    const auto mean = late_mask<4, 2>(1, 1.5);  // half-way between two samples: the mean
    expect_taps(mean, {0.25, 0.25, 0.25, 0.25}, 3e-8);
    EXPECT_FLOAT_EQ(first_moment(mean), 0.5f);
    const auto parabola = late_mask<9, 4>(2, 4);
    const auto usual = savitzky_golay_mask<9, 2>();
    for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(parabola.tap(i), usual.tap(i));
    const auto now = late_mask<7, 0>(1, 0);
    for (std::size_t i = 0; i < 7; ++i)
        EXPECT_EQ(now.tap(i), (causal_savitzky_golay_mask<7, 1>().tap(i)));
    using Any = AnyMask<40>;
    EXPECT_FALSE(Any::late(41, 1, 1));
    EXPECT_FALSE(Any::late(1, 1, 0));
    EXPECT_FALSE(Any::late(5, 0.9, 1));
    EXPECT_FALSE(Any::late(5, 2.1, 1));
    EXPECT_FALSE(Any::late(5, 1, -0.1));
    EXPECT_FALSE(Any::late(5, 1, 4.1));
    EXPECT_FALSE(Any::late(5, std::nan(""), 1));
}

/// Against the least-norm solution of its three conditions, by a dense pseudo-inverse.
TEST(Mask, APolynomialThroughItsSamplesReadsThem) {
    for (std::size_t size = 2; size < 5; ++size)
        for (const double degree : {1.0, 2.0, 3.0})
            for (std::size_t place = 0; place < size; ++place) {
                if (degree < static_cast<double>(size - 1)) continue;
                double a[8]{};
                detail::fill_savitzky_golay(a, size, static_cast<double>(place), degree);
                for (std::size_t i = 0; i < size; ++i)
                    EXPECT_NEAR(a[i], i == place ? 1 : 0, 1e-12) << size << ' ' << degree;
            }
}

TEST(Mask, LateMasksLeaveTheLeastNoiseForTheirErrors) {
    std::minstd_rand random{5};
    const auto uniform = [&] { return static_cast<double>(random()) / 2147483647.0; };
    for (int trial = 0; trial < 300; ++trial) {
        const std::size_t n = 3 + random() % 30;
        const double degree = trial % 7 == 0 ? 1 + trial % 2 : 1 + uniform();
        const double late = uniform() * static_cast<double>(n - 1);
        SCOPED_TRACE(testing::Message() << n << " taps, degree " << degree << ", late " << late);
        const auto mask = AnyMask<40, double>::late(n, degree, late);
        ASSERT_TRUE(mask);
        EXPECT_EQ(mask->centre(), n - 1 - static_cast<std::size_t>(late + 0.5));
        // samples at x, 0 where the mask is read; rows: what a constant, a rate and an
        // acceleration weigh
        Eigen::MatrixXd rows(3, n);
        for (std::size_t i = 0; i < n; ++i) {
            const double x = static_cast<double>(i) - (static_cast<double>(n - 1) - late);
            rows.col(static_cast<Eigen::Index>(i)) << 1, x, x * x / 2;
        }
        // the line's error about an acceleration, of which the mask may have a share
        const Eigen::MatrixXd two = rows.topRows(2);
        const Eigen::VectorXd line =
            two.transpose() * (two * two.transpose()).ldlt().solve(Eigen::Vector2d(1, 0));
        const double allowed = (2 - degree) * (rows.row(2) * line).value();
        const Eigen::VectorXd least =
            rows.transpose() *
            (rows * rows.transpose()).fullPivLu().solve(Eigen::Vector3d(1, 0, allowed));
        for (std::size_t i = 0; i < n; ++i)
            EXPECT_NEAR(mask->tap(i), least(static_cast<Eigen::Index>(i)), 1e-9) << "tap " << i;
    }
}

TEST(Mask, SmoothingAndSharpeningHaveThePapersSteps) {
    constexpr double lambda = 0.7;
    constexpr auto s = smoothing_mask(lambda);
    const double l = lambda / 24;
    expect_taps(s, {-l, 4 * l, 1 - 6 * l, 4 * l, -l}, 3e-8);
    const double bs[] = {l, -3 * l, 3 * l, -l};  // eq. (22)
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(double{s.step(i)}, bs[i], 1e-8);
    constexpr auto u = sharpening_mask(lambda);
    const double k = lambda / 16, bu[] = {k, 5 * k, -5 * k, -k};  // eq. (25)
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(double{u.step(i)}, bu[i], 1e-8);
    // the gain that the header states
    for (double f = 0; f <= 0.5; f += 0.05) {
        double gs = 0, gu = 0;
        for (std::size_t i = 0; i < 5; ++i) {
            const double c = std::cos(2 * M_PI * f * (static_cast<double>(i) - 2));
            gs += double{s.tap(i)} * c;
            gu += double{u.tap(i)} * c;
        }
        EXPECT_NEAR(gs, 1 - l * std::pow(2 * std::sin(M_PI * f), 4), 1e-6);
        EXPECT_NEAR(gu, 1 + lambda * (1 - std::pow(std::cos(M_PI * f), 4)), 1e-6);
    }
}

TEST(Mask, SavitzkyGolayIsTheLeastSquaresPolynomial) {
    expect_taps(savitzky_golay_mask<5, 2>(), {-3 / 35., 12 / 35., 17 / 35., 12 / 35., -3 / 35.},
                3e-8);
    expect_taps(savitzky_golay_mask<21, 4>(), fitted(21, 10, 4), 1e-7);
    expect_taps(causal_savitzky_golay_mask<3, 1>(), {-1 / 6., 2 / 6., 5 / 6.}, 3e-8);
    expect_taps(causal_savitzky_golay_mask<31, 3>(), fitted(31, 30, 3), 1e-7);
    static_assert(causal_savitzky_golay_mask<31, 3>().centre() == 30);
    for (std::size_t degree = 0; degree < 6; ++degree)
        for (std::size_t size = degree + 1; size < 40; size += 3)
            for (std::size_t centre = 0; centre < size; centre += 4) {
                const auto mask = AnyMask<40>::savitzky_golay(size, degree, centre);
                ASSERT_TRUE(mask);
                expect_taps(*mask, fitted(size, centre, degree), 4e-6);
            }
}

TEST(Mask, FirstMomentAndNoise) {
    EXPECT_EQ(first_moment(binomial_mask<9>()), 0.0f);
    EXPECT_NEAR(first_moment(causal_savitzky_golay_mask<15, 1>()), 0.0f, 2e-6f);
    EXPECT_NEAR(first_moment(causal_savitzky_golay_mask<15, 3>()), 0.0f, 2e-6f);
    // the mean of the last five samples is two samples late
    EXPECT_NEAR(first_moment(causal_savitzky_golay_mask<5, 0>()), -2.0f, 1e-6f);
    EXPECT_NEAR(noise_variance(causal_savitzky_golay_mask<5, 0>()), 0.2f, 1e-6f);
    // the newest point of a line through N: (4 N - 2) / (N (N + 1))
    EXPECT_NEAR(noise_variance(causal_savitzky_golay_mask<15, 1>()), 58.0f / 240, 1e-6f);
}

TEST(Mask, ZeroLagMasksHaveTheWantedNoise) {
    constexpr auto half = zero_lag_mask<zero_lag_taps(0.5)>(0.5);
    static_assert(half.centre() == half.size() - 1);
    EXPECT_NEAR(noise_variance(half), 0.25f, 1e-6f);
    EXPECT_NEAR(first_moment(half), 0.0f, 1e-5f);
    constexpr auto whole = zero_lag_mask<zero_lag_taps(1)>(1);
    EXPECT_EQ(noise_variance(whole), 1.0f);
    using M = AnyMask<500>;
    for (double gain = 0.09; gain <= 1; gain += 0.0137) {
        const auto mask = M::zero_lag(gain);
        ASSERT_TRUE(mask) << gain;
        EXPECT_NEAR(double{noise_variance(*mask)}, gain * gain, 2e-6) << gain;
        double moment = 0;
        for (std::size_t i = 0; i < mask->size(); ++i)
            moment += double{mask->tap(i)} * (static_cast<double>(i) - double(mask->centre()));
        EXPECT_NEAR(moment, 0, 2e-4) << gain;
        // no shorter mask of zero lag can do it: the line through fewer samples is too noisy
        if (mask->size() > 2) {
            const auto shorter = M::savitzky_golay(mask->size() - 1, 1, mask->size() - 2);
            EXPECT_GT(double{noise_variance(*shorter)}, gain * gain);
        }
    }
    EXPECT_FALSE(M::zero_lag(0));
    EXPECT_FALSE(M::zero_lag(1.1));
    EXPECT_FALSE(M::zero_lag(NAN));
    EXPECT_FALSE(M::zero_lag(0.01));
}

TEST(Mask, ByHand) {
    constexpr Mask<3, 0> forward{{0.5, 0.25, 0.25}};
    static_assert(forward.tap(0) == 0.5f && forward.step(0) == 0.5f && forward.step(1) == 0.25f);
    constexpr auto checked = Mask<3>::checked({0.25, 0.5, 0.25});
    static_assert(checked);
    static_assert(!Mask<3>::checked({0.25, 0.5, 0.2501}));
    EXPECT_EQ(Mask<3>::checked({0.25, 0.5, 0.26}).status(), Status::bad_argument);
    // seven decimals: the sum may be off by a millionth, and by no more
    static_assert(Mask<3>::checked({0.25, 0.5, 0.2500009}) &&
                  Mask<3>::checked({0.2499991, 0.5, 0.25}));
    static_assert(!Mask<3>::checked({0.25, 0.5, 0.2500011}));
    static_assert(!Mask<3>::checked({0.2499989, 0.5, 0.25}));
    EXPECT_EQ(Mask<3>::checked({NAN, 0.5, 0.5}).status(), Status::bad_argument);
    EXPECT_EQ(Mask<3>::checked({1e9, 1 - 2e9, 1e9}).status(), Status::bad_argument);
    EXPECT_DEATH((Mask<2>{{0.5, 0.6}}), "");
    // seven decimals are enough, and the mask used is affine-invariant all the same
    const auto thirds = Mask<3>::checked({0.3333333, 0.3333333, 0.3333333});
    ASSERT_TRUE(thirds);
    EXPECT_NEAR(double{thirds->tap(0)} + double{thirds->tap(1)} + double{thirds->tap(2)}, 1, 1e-7);
}

TEST(Mask, AnyMaskRefusesWhatItCannotHold) {
    using M = AnyMask<9>;
    EXPECT_FALSE(M::binomial(11));
    EXPECT_FALSE(M::binomial(4));
    EXPECT_FALSE(M::binomial(0));
    EXPECT_TRUE(M::binomial(9));
    EXPECT_FALSE(M::savitzky_golay(5, 5, 4));
    EXPECT_FALSE(M::savitzky_golay(0, 0, 0));
    EXPECT_FALSE(M::savitzky_golay(5, 1, 5));
    EXPECT_FALSE(M::savitzky_golay(11, 1, 5));
    EXPECT_FALSE(M::smoothing(1e9));
    EXPECT_FALSE(M::sharpening(NAN));
    const double taps[] = {0.5, 0.5};
    EXPECT_FALSE(M::from_taps(taps, 2, 2));
    EXPECT_TRUE(M::from_taps(taps, 2, 1));
    EXPECT_FALSE(AnyMask<3>::smoothing(1));
}

// The table of docs/filter.md, and that its columns agree with what each mask is for.
TEST(Mask, FiguresOfTheManual) {
    struct Figures {
        double half_power, largest;
    };
    const auto of = [](const AnyMask<65>& mask) {
        Figures f{0.5, 1};
        for (double at = 0.5; at > 0; at -= 0.0005) {
            double re = 0, im = 0;
            for (std::size_t i = 0; i < mask.size(); ++i) {
                const double m = static_cast<double>(i) - static_cast<double>(mask.centre());
                re += double{mask.tap(i)} * std::cos(2 * M_PI * at * m);
                im += double{mask.tap(i)} * std::sin(2 * M_PI * at * m);
            }
            const double power = re * re + im * im;
            if (power < 0.5) f.half_power = at;
            f.largest = std::max(f.largest, std::sqrt(power));
        }
        return f;
    };
    using M = AnyMask<65>;
    const struct {
        const char* name;
        Result<M> mask;
    } rows[] = {{"binomial:5", M::binomial(5)},
                {"binomial:9", M::binomial(9)},
                {"binomial:33", M::binomial(33)},
                {"hs:1", M::smoothing(1)},
                {"hu:0.5", M::sharpening(0.5)},
                {"sg:11:2", M::savitzky_golay(11, 2, 5)},
                {"sg:21:4", M::savitzky_golay(21, 4, 10)},
                {"csg:9:1", M::savitzky_golay(9, 1, 8)},
                {"csg:15:2", M::savitzky_golay(15, 2, 14)},
                {"late:9:1:1", M::late(9, 1, 1)},
                {"late:9:1.7:1", M::late(9, 1.7, 1)},
                {"zero_lag 0.7", M::zero_lag(0.7)},
                {"zero_lag 0.5", M::zero_lag(0.5)},
                {"zero_lag 0.3", M::zero_lag(0.3)}};
    std::printf("%-13s %5s %8s %7s %7s %11s %8s\n", "mask", "taps", "latency", "lag", "noise",
                "half power", "largest");
    for (const auto& row : rows) {
        ASSERT_TRUE(row.mask) << row.name;
        const M& mask = *row.mask;
        const Figures f = of(mask);
        const double noise = std::sqrt(double{noise_variance(mask)});
        const double lag = -double{first_moment(mask)};
        std::printf("%-13s %5zu %8zu %7.1f %7.3f %11.3f %8.3f\n", row.name, mask.size(),
                    mask.size() - 1 - mask.centre(), std::fabs(lag) < 0.05 ? 0 : lag, noise,
                    f.half_power, f.largest);
        EXPECT_NEAR(lag, 0, 2e-5);  // all of these keep a constant rate
        const bool sharpens = row.name[1] == 'u';
        EXPECT_EQ(noise > 1, sharpens);
        EXPECT_EQ(f.half_power < 0.5, !sharpens) << row.name;
    }
}
