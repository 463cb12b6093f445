// The laws of mask filters on random streams, against a double reference written from the paper.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "fairlead/smooth/filter.hpp"
#include "tests/ref/mask.hpp"

using namespace fairlead;

namespace {

constexpr std::uint32_t both = flag::position_valid | flag::orientation_valid;
constexpr double rounding_rad = 4e-6;  // float, steps up to 1.5 rad

std::vector<Pose> to_poses(const std::vector<ref::Q>& q, const std::vector<ref::V>& p) {
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < q.size(); ++i)
        poses.push_back(
            {static_cast<std::int64_t>(i) * 8'000'000, narrow(p[i]), narrow(q[i]), both});
    return poses;
}

/// Random motion with steps of about `rate` rad, signs of quaternions as they come.
std::vector<Pose> random_stream(unsigned seed, std::size_t n, double rate = 0.2) {
    std::mt19937_64 random{seed};
    std::vector<ref::Q> q{ref::any_rotation(random)};
    std::vector<ref::V> p{ref::normal(random, 1)};
    ref::V velocity = ref::normal(random, rate);
    while (q.size() < n) {
        velocity = 0.8 * velocity + ref::normal(random, rate / 3);
        q.push_back(ref::mul(q.back(), ref::from_vector(velocity)));
        p.push_back(p.back() + 0.1 * velocity);
    }
    return to_poses(q, p);
}

template <class Filter>
std::vector<Pose> run(Filter filter, const std::vector<Pose>& in) {
    std::vector<Pose> out;
    for (const Pose& pose : in)
        if (const auto y = filter.push(pose)) out.push_back(*y);
    while (const auto y = filter.flush()) out.push_back(*y);
    return out;
}

std::vector<ref::Q> orientations(const std::vector<Pose>& poses) {
    std::vector<ref::Q> q;
    for (const Pose& pose : poses) q.push_back(ref::of(pose.q_wb));
    return q;
}
std::vector<ref::V> positions(const std::vector<Pose>& poses) {
    std::vector<ref::V> p;
    for (const Pose& pose : poses) p.push_back(ref::of(pose.p_w_m));
    return p;
}

void expect_same_rotations(const std::vector<Pose>& a, const std::vector<ref::Q>& b,
                           double tolerance) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        ASSERT_LT(ref::angle(ref::of(a[i].q_wb), b[i]), tolerance) << "record " << i;
}

template <class AMask>
ref::Taps taps_of(const AMask& mask) {
    ref::Taps taps;
    for (std::size_t i = 0; i < mask.size(); ++i) taps.push_back(double{mask.tap(i)});
    return taps;
}

/// The law for every kind of mask: centred, causal, lopsided, sharpening.
template <class Law>
void for_all_masks(Law&& law) {
    law(binomial_mask<3>());
    law(binomial_mask<9>());
    law(smoothing_mask(1.0));
    law(sharpening_mask(0.5));
    law(savitzky_golay_mask<11, 3>());
    law(causal_savitzky_golay_mask<12, 2>());
    law(late_mask<9, 2>(1.4, 1.6));
    law(late_mask<5, 0>(2, 0.3));
    law(Mask<4, 0>{{0.4, 0.3, 0.2, 0.1}});
    law(Mask<6, 4>{{0.1, -0.2, 0.1, 0.3, 0.5, 0.2}});
    law(Mask<1>{});
}

template <std::size_t T, std::size_t C>
PoseFilter<T, C> filter_of(const Mask<T, C>& mask) {
    return PoseFilter<T, C>{mask};
}

}  // namespace

TEST(FilterLaws, EqualsThePaperInDouble) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        for_all_masks([seed](const auto& mask) {
            for (const std::size_t n : {1u, 2u, 3u, 4u, 7u, 12u, 40u}) {
                const auto in = random_stream(seed, n);
                const auto out = run(filter_of(mask), in);
                const auto centre = static_cast<long>(mask.centre());
                expect_same_rotations(
                    out, ref::masked_stream(orientations(in), taps_of(mask), centre), rounding_rad);
                const auto p = ref::masked_stream(positions(in), taps_of(mask), centre);
                for (std::size_t i = 0; i < n; ++i) {
                    ASSERT_LT(ref::norm(ref::of(out[i].p_w_m) - p[i]), 2e-6);
                    ASSERT_EQ(out[i].t_ns, in[i].t_ns);
                }
            }
        });
    }
}

TEST(FilterLaws, WholeBufferResultButForTheFirstRecord) {
    const auto in = random_stream(3, 50);
    const auto out = run(filter_of(binomial_mask<9>()), in);
    auto whole = ref::masked(orientations(in), taps_of(binomial_mask<9>()), 4);
    // the outermost tap of the first record: 1/256 of the difference of two steps
    EXPECT_LT(ref::angle(ref::of(out[0].q_wb), whole[0]), 0.02);
    whole[0] = ref::of(out[0].q_wb);
    expect_same_rotations(out, whole, rounding_rad);
}

TEST(FilterLaws, LeftAndRightRotationInvariance) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937_64 random{seed};
        const ref::Q a = ref::any_rotation(random), b = ref::any_rotation(random);
        for_all_masks([&](const auto& mask) {
            const auto in = random_stream(seed, 40);
            auto turned = in;
            for (Pose& pose : turned)
                pose.q_wb = ref::narrow(ref::mul(ref::mul(a, ref::of(pose.q_wb)), b));
            auto expected = orientations(run(filter_of(mask), in));
            for (auto& q : expected) q = ref::mul(ref::mul(a, q), b);
            expect_same_rotations(run(filter_of(mask), turned), expected, rounding_rad);
        });
    }
}

TEST(FilterLaws, TimeInvariance) {
    for_all_masks([](const auto& mask) {
        const auto in = random_stream(5, 60);
        const std::vector<Pose> late(in.begin() + 7, in.end());
        const auto all = run(filter_of(mask), in), part = run(filter_of(mask), late);
        ASSERT_EQ(part.size(), late.size());
        // where the mask sees the same samples the same bits come out, up to the sign of q
        for (std::size_t i = mask.centre(); i < part.size(); ++i) {
            const Quat& q = all[i + 7].q_wb;
            const Quat same = same_side(part[i].q_wb, q);
            EXPECT_EQ(part[i].q_wb.w, same.w);
            EXPECT_EQ(part[i].q_wb.x, same.x);
            EXPECT_EQ(part[i].p_w_m.y, all[i + 7].p_w_m.y);
        }
    });
}

TEST(FilterLaws, SymmetryOfSymmetricMasks) {
    const auto law = [](const auto& mask) {
        const auto in = random_stream(6, 40);
        const auto back = run(filter_of(mask), {in.rbegin(), in.rend()});
        const auto out = run(filter_of(mask), in);
        std::vector<ref::Q> expected = orientations({back.rbegin(), back.rend()});
        // the first record of either run has not seen its outermost tap
        expected.front() = ref::of(out.front().q_wb);
        expected.back() = ref::of(out.back().q_wb);
        expect_same_rotations(out, expected, rounding_rad);
    };
    law(binomial_mask<9>());
    law(smoothing_mask(1.0));
    law(sharpening_mask(0.5));
    law(savitzky_golay_mask<11, 3>());
}

TEST(FilterLaws, SignsOfQuaternionsDoNotMatter) {
    for_all_masks([](const auto& mask) {
        std::mt19937_64 random{7};
        const auto in = random_stream(7, 60);
        auto flipped = in;
        for (std::size_t i = 1; i < in.size(); ++i)
            if (random() & 1) flipped[i].q_wb = -flipped[i].q_wb;
        const auto a = run(filter_of(mask), in), b = run(filter_of(mask), flipped);
        for (std::size_t i = 0; i < a.size(); ++i) {
            ASSERT_EQ(a[i].q_wb.w, b[i].q_wb.w);
            ASSERT_EQ(a[i].q_wb.z, b[i].q_wb.z);
            ASSERT_GT(dot(b[i].q_wb, b[i > 0 ? i - 1 : 0].q_wb), 0);
        }
    });
}

TEST(FilterLaws, FixedAxisIsTheScalarFilter) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
        std::mt19937_64 random{seed};
        ref::V axis = ref::normal(random, 1);
        axis = (1 / ref::norm(axis)) * axis;
        const ref::Q start = ref::any_rotation(random);
        std::normal_distribution<double> step{0.3, 0.5};
        std::vector<double> turn{0};
        while (turn.size() < 60) turn.push_back(turn.back() + step(random));
        std::vector<ref::Q> q;
        for (const double t : turn) q.push_back(ref::mul(start, ref::from_vector(t * axis)));
        const auto in = to_poses(q, std::vector<ref::V>(q.size()));
        for_all_masks([&](const auto& mask) {
            const auto out = run(filter_of(mask), in);
            const std::size_t behind = mask.centre(), ahead = mask.size() - 1 - behind;
            for (std::size_t i = behind; i + ahead < out.size(); ++i) {
                double fir = 0;
                for (std::size_t t = 0; t < mask.size(); ++t)
                    fir += double{mask.tap(t)} * turn[i + t - behind];
                const ref::Q expected = ref::mul(start, ref::from_vector(fir * axis));
                ASSERT_LT(ref::angle(ref::of(out[i].q_wb), expected), rounding_rad);
            }
        });
    }
}

TEST(FilterLaws, ConstantRatePassesUnchanged) {
    const auto law = [](const auto& mask) {
        std::mt19937_64 random{9};
        const ref::Q start = ref::any_rotation(random);
        std::vector<ref::Q> q;
        std::vector<ref::V> p;
        for (int i = 0; i < 50; ++i) {
            q.push_back(ref::mul(start, ref::from_vector({0.4 * i, -0.8 * i, 0.3 * i})));
            p.push_back({0.01 * i, 1 - 0.02 * i, 0});
        }
        const auto in = to_poses(q, p);
        const auto out = run(filter_of(mask), in);  // ends included
        expect_same_rotations(out, q, rounding_rad);
        for (std::size_t i = 0; i < p.size(); ++i)
            ASSERT_LT(ref::norm(ref::of(out[i].p_w_m) - p[i]), 5e-7);
    };
    law(binomial_mask<3>());
    law(binomial_mask<33>());
    law(smoothing_mask(1.5));
    law(sharpening_mask(0.5));
    law(savitzky_golay_mask<11, 2>());
    law(causal_savitzky_golay_mask<12, 1>());
    law(causal_savitzky_golay_mask<12, 2>());
    law(zero_lag_mask<zero_lag_taps(0.4)>(0.4));
}

TEST(FilterLaws, LagIsTheFirstMoment) {
    std::vector<ref::Q> q;
    for (int i = 0; i < 60; ++i) q.push_back(ref::from_vector({0.1 * i, 0, 0}));
    constexpr auto mean = causal_savitzky_golay_mask<9, 0>();
    const auto out = run(filter_of(mean), to_poses(q, std::vector<ref::V>(q.size())));
    for (std::size_t i = 1; i < out.size(); ++i) {  // one sample alone has no rate yet
        const ref::Q late = ref::from_vector({0.1 * (static_cast<double>(i) - 4), 0, 0});
        ASSERT_LT(ref::angle(ref::of(out[i].q_wb), late), rounding_rad);
    }
}

TEST(FilterLaws, NoiseOfOrientationsIsTheMasksNoise) {
    std::mt19937_64 random{11};
    constexpr double gain = 0.4, sigma = 0.02;
    std::vector<ref::Q> q;
    for (int i = 0; i < 40000; ++i)
        q.push_back(ref::mul(ref::from_vector({0.05 * i, 0.02 * i, 0}),
                             ref::from_vector(ref::normal(random, sigma))));
    constexpr auto mask = zero_lag_mask<zero_lag_taps(gain)>(gain);
    const auto out = run(filter_of(mask), to_poses(q, std::vector<ref::V>(q.size())));
    double sum = 0;
    for (std::size_t i = 100; i < q.size(); ++i) {
        const auto t = static_cast<double>(i);
        const ref::Q truth = ref::from_vector({0.05 * t, 0.02 * t, 0});
        sum += std::pow(ref::angle(ref::of(out[i].q_wb), truth), 2);
    }
    const double rms = std::sqrt(sum / 3 / static_cast<double>(q.size() - 100));
    EXPECT_NEAR(rms, gain * sigma, 0.02 * gain * sigma);
}
