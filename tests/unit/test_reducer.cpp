// What the reducer owes beside the guarantee of the stream (test_stream.cpp): cheap rests, and the
// same choices for the same motion in other units and at another time.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "host_sim/study/baselines/earlier/wire/encoder.hpp"

using namespace fairlead;
using namespace fairlead::earlier;

namespace {

using Position = VectorChannel<3>;
constexpr std::int64_t period_ns = 8333333;

struct Choice {  // what a frame says of knots, without scale and origin
    bool begins, covers;
    std::vector<std::int32_t> numbers;
    bool operator==(const Choice& other) const {
        return begins == other.begins && covers == other.covers && numbers == other.numbers;
    }
};

struct Outcome {
    std::vector<Choice> choices;
    std::size_t control_points{0}, breaks{0};
    std::uint32_t longest{0};  // records that a sample waited
};

template <std::size_t N, class Channel>
Outcome reduce(const std::vector<typename Channel::Value>& samples,
               const typename Channel::Tolerance& tol, std::int64_t start_ns,
               Credit slice = slice_medium) {
    using Reduction = Reducer<Channel, N>;
    const auto reducer = std::make_unique<Reduction>(
        typename Reduction::Params{tol, static_cast<std::uint32_t>(period_ns / 2), N, N / 3});
    reducer->set_epoch(start_ns);
    Outcome out;
    const auto take = [&](bool last) {
        const auto batch = reducer->take(last);
        Choice choice{batch.begins, batch.covers, {}};
        if (batch.begins) {
            out.control_points += Channel::order;
            for (const auto& row : batch.start.span.c)
                choice.numbers.insert(choice.numbers.end(), row.begin(), row.end());
        }
        for (std::size_t i = 0; i < batch.size; ++i) {
            choice.numbers.push_back(static_cast<std::int32_t>(batch.knot[i].ticks));
            choice.numbers.push_back(batch.knot[i].shift);
            for (const std::int32_t j : batch.knot[i].jump) choice.numbers.push_back(j);
        }
        if (batch.covers) choice.numbers.push_back(static_cast<std::int32_t>(batch.cover_ticks));
        out.control_points += batch.size;
        out.choices.push_back(choice);
    };
    for (std::size_t i = 0; i < samples.size(); ++i) {
        reducer->push(start_ns + static_cast<std::int64_t>(i) * period_ns, samples[i], false);
        out.longest = std::max(out.longest, reducer->age());
        reducer->allot(slice, reducer->closing());
        for (int frames = 0; reducer->due() && frames < 2; ++frames) take(frames == 1);
        EXPECT_FALSE(reducer->due()) << "record " << i;
        reducer->work();
    }
    while (!reducer->empty()) {
        reducer->close(slice);
        take(false);
    }
    out.breaks = reducer->counters().breaks;
    return out;
}

std::vector<std::array<float, 3>> wandering(unsigned seed, std::size_t n) {
    std::mt19937 random{seed};
    std::normal_distribution<float> normal;
    std::vector<std::array<float, 3>> out;
    std::array<float, 3> p{0.5f, -0.25f, 1.0f}, v{}, a{};
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t d = 0; d < 3; ++d) {
            a[d] += 0.05f * (normal(random) - a[d]);
            v[d] += 0.02f * a[d] - 0.01f * v[d];
            p[d] += 0.008f * v[d];
        }
        out.push_back(p);
    }
    return out;
}

template <std::size_t N>
void rest_costs_little() {
    std::mt19937 random{N};
    std::normal_distribution<float> normal;
    std::vector<std::array<float, 3>> samples;
    for (int i = 0; i < 60 * 120; ++i)
        samples.push_back({0.3f + 1e-4f * normal(random), -1.2f + 1e-4f * normal(random),
                           0.8f + 1e-4f * normal(random)});
    const Outcome out = reduce<N, Position>(samples, {1e-3f, 1e-3f, 1e-3f}, 0);
    EXPECT_LE(out.control_points, 8u) << "delay " << N;
    EXPECT_EQ(out.breaks, 0u);
}

}  // namespace

TEST(Reducer, AMinuteAtRestCostsAtMostEightControlPoints) {
    rest_costs_little<60>();
    rest_costs_little<120>();
    rest_costs_little<240>();
}

TEST(Reducer, ChoosesTheSameInUnitsOfAnotherPowerOfTwo) {
    const auto samples = wandering(3, 2000);
    const Outcome plain = reduce<60, Position>(samples, {1e-3f, 2e-3f, 1e-3f}, 0);
    for (const float scale : {0.0078125f, 4.0f, 1024.0f}) {
        auto scaled = samples;
        for (auto& p : scaled)
            for (float& x : p) x *= scale;
        const Outcome other =
            reduce<60, Position>(scaled, {1e-3f * scale, 2e-3f * scale, 1e-3f * scale}, 0);
        EXPECT_EQ(plain.choices, other.choices) << "scale " << scale;
    }
}

TEST(Reducer, ChoosesTheSameAtAnotherTime) {
    const auto samples = wandering(4, 2000);
    const Outcome plain = reduce<60, Position>(samples, {1e-3f, 1e-3f, 1e-3f}, 0);
    for (const std::int64_t start : {std::int64_t{1234567890123}, std::int64_t{-987654321}})
        EXPECT_EQ(plain.choices,
                  (reduce<60, Position>(samples, {1e-3f, 1e-3f, 1e-3f}, start).choices));
}

TEST(Reducer, MoreWorkMeansFewerKnotsAndNoOtherDelay) {
    const auto samples = wandering(5, 4000);
    std::size_t before = SIZE_MAX;
    for (const Credit slice : {slice_small, slice_medium, slice_large}) {
        const Outcome out = reduce<120, Position>(samples, {2e-4f, 2e-4f, 2e-4f}, 0, slice);
        EXPECT_LE(out.longest, 120u);
        EXPECT_LT(out.control_points, before + before / 50) << "slice " << slice;
        before = out.control_points;
    }
}

TEST(Reducer, DoesNotBreakASmoothMotion) {
    constexpr std::size_t records = 3000;
    std::size_t breaks = 0;
    for (unsigned seed = 1; seed <= 20; ++seed)
        breaks += reduce<120, Position>(wandering(seed, records), {5e-4f, 5e-4f, 5e-4f}, 0).breaks;
    EXPECT_EQ(breaks, 0u);
}
