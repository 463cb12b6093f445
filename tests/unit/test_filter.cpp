// How records, gaps and channels pass a mask filter. The laws of the filter itself: tests/laws.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "fairlead/smooth/filter.hpp"
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
        poses.push_back({static_cast<std::int64_t>(i) * 1000, ref::narrow(ref::normal(random, 1)),
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

void expect_equal(const Pose& a, const Pose& b) {
    EXPECT_EQ(a.t_ns, b.t_ns);
    EXPECT_EQ(a.flags, b.flags);
    EXPECT_EQ(a.p_w_m.x, b.p_w_m.x);
    EXPECT_EQ(a.p_w_m.z, b.p_w_m.z);
    EXPECT_EQ(a.q_wb.w, b.q_wb.w);
    EXPECT_EQ(a.q_wb.y, b.q_wb.y);
}

}  // namespace

TEST(Filter, LatencyIsInTheTypeAndKept) {
    static_assert(OrientationFilter<9, 4>::latency == 4);
    static_assert(OrientationFilter<9, 8>::latency == 0);
    static_assert(PositionFilter<5, 0>::latency == 4);
    PoseFilter<9> filter{binomial_mask<9>()};
    const auto in = noisy_stream(1, 30);
    for (std::size_t i = 0; i < in.size(); ++i) {
        const auto out = filter.push(in[i]);
        ASSERT_EQ(out.has_value(), i >= 4);
        if (out) {
            EXPECT_EQ(out->t_ns, in[i - 4].t_ns);
        }
    }
    for (std::size_t i = in.size() - 4; i < in.size(); ++i) {
        const auto out = filter.flush();
        ASSERT_TRUE(out);
        EXPECT_EQ(out->t_ns, in[i].t_ns);
    }
    EXPECT_FALSE(filter.flush());
}

TEST(Filter, IsAsNewAfterFlush) {
    PoseFilter<7> used{binomial_mask<7>()};
    run(used, noisy_stream(1, 23));
    const auto in = noisy_stream(2, 20);
    PoseFilter<7> fresh{binomial_mask<7>()};
    const auto a = run(used, in), b = run(fresh, in);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) expect_equal(a[i], b[i]);
}

TEST(Filter, AGapSeparatesSegments) {
    const auto first = noisy_stream(3, 12), second = noisy_stream(4, 15);
    for (const std::uint32_t gap :
         {+flag::gap_before, flag::position_gap | flag::orientation_gap}) {
        auto in = first;
        in.insert(in.end(), second.begin(), second.end());
        in[first.size()].flags |= gap;
        PoseFilter<9> filter{binomial_mask<9>()};
        const auto out = run(filter, in);
        PoseFilter<9> alone{binomial_mask<9>()};
        auto expected = run(alone, first);
        const auto tail = run(alone, second);
        expected.insert(expected.end(), tail.begin(), tail.end());
        ASSERT_EQ(out.size(), expected.size());
        for (std::size_t i = 0; i < out.size(); ++i) {
            expected[i].flags = in[i].flags;
            expect_equal(out[i], expected[i]);
        }
    }
}

TEST(Filter, AGapOfOneChannelLeavesTheOtherAlone) {
    const auto in = noisy_stream(5, 30);
    auto broken = in;
    broken[13].flags |= flag::position_gap;
    PoseFilter<9> filter{binomial_mask<9>()};
    const auto whole = run(filter, in), cut = run(filter, broken);
    int differing = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
        EXPECT_EQ(whole[i].q_wb.x, cut[i].q_wb.x);
        if (whole[i].p_w_m.x != cut[i].p_w_m.x) ++differing;
    }
    EXPECT_GT(differing, 0);
    EXPECT_LE(differing, 8);  // four on either side
}

TEST(Filter, AGapFlaggedOnAnInvalidRecordIsNotForgotten) {
    auto in = noisy_stream(6, 30);
    in[13].flags = flag::orientation_valid | flag::position_gap;
    auto other = in;
    other[13].flags = flag::orientation_valid;
    other[14].flags |= flag::position_gap;
    PoseFilter<9> filter{binomial_mask<9>()};
    const auto a = run(filter, in), b = run(filter, other);
    for (std::size_t i = 0; i < in.size(); ++i) EXPECT_EQ(a[i].p_w_m.x, b[i].p_w_m.x);
}

TEST(Filter, SamplesOfAChannelAreItsValidRecords) {
    // one record without a position: its neighbours are neighbours, as if it had never been
    const auto in = noisy_stream(7, 40);
    auto holed = in;
    holed[20].flags &= ~flag::position_valid;
    auto without = in;
    without.erase(without.begin() + 20);
    PositionFilter<9> filter{binomial_mask<9>()};
    const auto a = run(filter, holed), b = run(filter, without);
    EXPECT_EQ(a[20].p_w_m.x, in[20].p_w_m.x);  // invalid: passed as it is
    for (std::size_t i = 0; i < 39; ++i) {
        const std::size_t j = i < 20 ? i : i + 1;
        // records 16..19 fall due with one sample less ahead of them; all others are the same
        if (i < 16 || i > 19) {
            EXPECT_EQ(a[j].p_w_m.x, b[i].p_w_m.x) << i;
        }
    }
}

TEST(Filter, ALostChannelHoldsNothingUp) {
    auto in = noisy_stream(8, 60);
    for (std::size_t i = 20; i < 50; ++i) in[i].flags &= ~flag::orientation_valid;
    in[50].flags |= flag::orientation_gap;
    PoseFilter<9> filter{binomial_mask<9>()};
    const auto out = run(filter, in);
    ASSERT_EQ(out.size(), in.size());
    std::vector<ref::Q> head;
    for (std::size_t i = 0; i < 20; ++i) head.push_back(ref::of(in[i].q_wb));
    ref::Taps taps;
    for (std::size_t i = 0; i < 9; ++i) taps.push_back(double{binomial_mask<9>().tap(i)});
    const auto expected = ref::masked_stream(head, taps, 4);
    for (std::size_t i = 0; i < 20; ++i)
        EXPECT_LT(ref::angle(ref::of(out[i].q_wb), expected[i]), 2e-6) << i;
    for (std::size_t i = 20; i < 50; ++i)
        expect_equal(Pose{out[i].t_ns, {}, out[i].q_wb, 0}, Pose{in[i].t_ns, {}, in[i].q_wb, 0});
}

TEST(Filter, OneChannelPassesBesideTheOther) {
    const auto in = noisy_stream(9, 30);
    OrientationFilter<9, 4> orientation{binomial_mask<9>()};
    PositionFilter<9, 4> position{binomial_mask<9>()};
    PoseFilter<9, 4> pose{binomial_mask<9>()};
    const auto o = run(orientation, in), p = run(position, in), b = run(pose, in);
    for (std::size_t i = 0; i < in.size(); ++i) {
        expect_equal(o[i], Pose{in[i].t_ns, in[i].p_w_m, b[i].q_wb, in[i].flags});
        expect_equal(p[i], Pose{in[i].t_ns, b[i].p_w_m, in[i].q_wb, in[i].flags});
    }
}

TEST(Filter, MasksOfRunTimeGiveTheSameBits) {
    const auto in = noisy_stream(10, 50);
    const auto same = [&in](auto fixed, const AnyMask<40>& mask) {
        AnyPoseFilter<40> any{mask};
        EXPECT_EQ(any.delay(), decltype(fixed)::latency);
        const auto a = run(fixed, in), b = run(any, in);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) expect_equal(a[i], b[i]);
    };
    same(PoseFilter<9>{binomial_mask<9>()}, *AnyMask<40>::binomial(9));
    same(PoseFilter<5>{smoothing_mask(0.8)}, *AnyMask<40>::smoothing(0.8));
    same(PoseFilter<12, 11>{causal_savitzky_golay_mask<12, 2>()},
         *AnyMask<40>::savitzky_golay(12, 2, 11));
}

TEST(Filter, ChannelsMayHaveMasksOfTheirOwn) {
    const auto in = noisy_stream(11, 30);
    PoseFilter<9> filter{binomial_mask<9>(), savitzky_golay_mask<9, 2>()};
    PoseFilter<9> rotation{binomial_mask<9>()}, position{savitzky_golay_mask<9, 2>()};
    const auto a = run(filter, in), r = run(rotation, in), p = run(position, in);
    for (std::size_t i = 0; i < in.size(); ++i)
        expect_equal(a[i], Pose{in[i].t_ns, p[i].p_w_m, r[i].q_wb, in[i].flags});
}

namespace {
struct CountingSpace : detail::OrientationSpace<float> {
    static inline int logs = 0, exps = 0;
    static Vec3 step(const Quat& from, const Quat& to) noexcept {
        ++logs;
        return OrientationSpace::step(from, to);
    }
    static Quat moved(const Quat& from, const Vec3& by) noexcept {
        ++exps;
        return OrientationSpace::moved(from, by);
    }
};
}  // namespace

TEST(Filter, OneLogAndOneExpPerRecordWhateverTheLength) {
    const auto in = noisy_stream(12, 200);
    const auto count = [&in](auto mask, auto latency) {
        detail::MaskTrack<CountingSpace, decltype(mask), decltype(latency)::value> track{mask};
        CountingSpace::logs = CountingSpace::exps = 0;
        for (std::size_t i = 0; i < in.size(); ++i) {
            if (i % 50 == 0) track.restart();
            static_cast<void>(track.push(in[i].q_wb));
            if (i >= latency) static_cast<void>(track.take(in[i - latency].q_wb));
            EXPECT_LE(CountingSpace::logs, static_cast<int>(i) + 1);
            EXPECT_LE(CountingSpace::exps, static_cast<int>(i) + 1);
        }
        EXPECT_EQ(CountingSpace::logs, 196);  // none at the start of a segment
    };
    count(binomial_mask<3>(), std::integral_constant<std::size_t, 1>{});
    count(binomial_mask<65>(), std::integral_constant<std::size_t, 32>{});
    count(causal_savitzky_golay_mask<40, 2>(), std::integral_constant<std::size_t, 0>{});
}
