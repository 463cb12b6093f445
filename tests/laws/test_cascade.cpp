// n passes of a filter are n whole-buffer passes; chains keep every record.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "fairlead/smooth/cascade.hpp"
#include "tests/ref/mask.hpp"

using namespace fairlead;

namespace {

constexpr std::uint32_t both = flag::position_valid | flag::orientation_valid;

std::vector<Pose> noisy_stream(unsigned seed, std::size_t n) {
    std::mt19937_64 random{seed};
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < n; ++i) {
        const double t = 0.1 * static_cast<double>(i);
        const ref::Q q = ref::mul(ref::from_vector({t, std::sin(t), 0.3}),
                                  ref::from_vector(ref::normal(random, 0.1)));
        poses.push_back({static_cast<std::int64_t>(i), ref::narrow(ref::normal(random, 1)),
                         ref::narrow(q), both});
    }
    return poses;
}

template <class Filter>
std::vector<Pose> run(Filter& filter, const std::vector<Pose>& in) {
    std::vector<Pose> out;
    for (const Pose& pose : in)
        if (const auto y = filter.push(pose)) out.push_back(*y);
    while (const auto y = filter.flush()) out.push_back(*y);
    return out;
}

}  // namespace

TEST(Cascade, TenPassesAreTenWholePasses) {
    using Once = PoseFilter<5>;
    Cascade<Once, 10> ten{Once{smoothing_mask(1.0)}};
    static_assert(Cascade<Once, 10>::latency == 20);
    EXPECT_EQ(ten.delay(), 20u);
    ref::Taps taps;
    for (std::size_t i = 0; i < 5; ++i) taps.push_back(double{smoothing_mask(1.0).tap(i)});
    for (const std::size_t n : {1u, 2u, 5u, 19u, 20u, 21u, 60u}) {
        const auto in = noisy_stream(static_cast<unsigned>(n), n);
        const auto out = run(ten, in);
        ASSERT_EQ(out.size(), n);
        std::vector<ref::Q> q;
        std::vector<ref::V> p;
        for (const Pose& pose : in)
            q.push_back(ref::of(pose.q_wb)), p.push_back(ref::of(pose.p_w_m));
        for (int pass = 0; pass < 10; ++pass)
            q = ref::masked_stream(q, taps, 2), p = ref::masked_stream(p, taps, 2);
        for (std::size_t i = 0; i < n; ++i) {
            EXPECT_EQ(out[i].t_ns, in[i].t_ns);
            EXPECT_LT(ref::angle(ref::of(out[i].q_wb), q[i]), 1e-5) << n << " records, at " << i;
            EXPECT_LT(ref::norm(ref::of(out[i].p_w_m) - p[i]), 2e-6) << n << " records, at " << i;
        }
    }
}

TEST(Cascade, AGapSeparatesEveryPass) {
    const auto first = noisy_stream(1, 30), second = noisy_stream(2, 25);
    Cascade<PoseFilter<9>, 3> filter{PoseFilter<9>{binomial_mask<9>()}};
    auto expected = run(filter, first);
    const auto tail = run(filter, second);
    expected.insert(expected.end(), tail.begin(), tail.end());
    auto in = first;
    in.insert(in.end(), second.begin(), second.end());
    in[30].flags |= flag::gap_before;
    const auto out = run(filter, in);
    ASSERT_EQ(out.size(), in.size());
    for (std::size_t i = 0; i < in.size(); ++i) {
        EXPECT_EQ(out[i].q_wb.x, expected[i].q_wb.x);
        EXPECT_EQ(out[i].p_w_m.y, expected[i].p_w_m.y);
        EXPECT_EQ(out[i].flags, in[i].flags);
    }
}

TEST(Cascade, AChainOfDifferentMasks) {
    Chain<AnyPoseFilter<20>, 2> chain;
    const auto in = noisy_stream(3, 40);
    const auto untouched = run(chain, in);
    ASSERT_EQ(untouched.size(), in.size());
    for (std::size_t i = 0; i < in.size(); ++i) EXPECT_EQ(untouched[i].q_wb.x, in[i].q_wb.x);

    const AnyPoseFilter<20> a{*AnyMask<20>::binomial(7)};
    const AnyPoseFilter<20> b{*AnyMask<20>::savitzky_golay(12, 1, 11)};
    EXPECT_EQ(chain.append(a), Status::ok);
    EXPECT_EQ(chain.append(b), Status::ok);
    EXPECT_EQ(chain.append(b), Status::bad_argument);
    EXPECT_EQ(chain.delay(), 3u);
    AnyPoseFilter<20> one = a, two = b;
    const auto expected = run(two, run(one, in));
    const auto out = run(chain, in);
    ASSERT_EQ(out.size(), in.size());
    for (std::size_t i = 0; i < in.size(); ++i) EXPECT_EQ(out[i].q_wb.x, expected[i].q_wb.x);
}
