// The run-time filter chain: its grammar, and that a chain is its filters one after another.
#include "host_sim/replay/filter_chain.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <vector>

#include "host_sim/generate/generate.hpp"
#include "host_sim/recording/spec.hpp"

using namespace fairlead;
using namespace fairlead::sim;

namespace {

constexpr double step_s = 1 / 120.0;

template <class Filter>
std::vector<Pose> filtered(Filter& filter, const std::vector<Pose>& poses) {
    std::vector<Pose> out;
    for (const Pose& pose : poses)
        if (const auto y = filter.push(pose)) out.push_back(*y);
    while (const auto y = filter.flush()) out.push_back(*y);
    return out;
}

std::vector<Pose> filtered(const char* spec, const std::vector<Pose>& poses) {
    const auto chain = std::make_unique<FilterChain>(parse_filters(spec, step_s));
    return filtered(*chain, poses);
}

bool same_bits(const std::vector<Pose>& a, const std::vector<Pose>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Pose)) == 0;
}

}  // namespace

TEST(FilterChain, IsTheFiltersOneAfterAnother) {
    const auto poses = generate("reach:0.6:4+lose:position:0.2+turn:0.5", 4).poses;
    PoseFilter<9> binomial{binomial_mask<9>()};
    PoseFilter<7, 6> causal{causal_savitzky_golay_mask<7, 2>()};
    const auto expected = filtered(causal, filtered(binomial, poses));
    EXPECT_EQ(expected.size(), poses.size());
    EXPECT_TRUE(same_bits(filtered("binomial:9+csg:7:2", poses), expected));
    EXPECT_TRUE(same_bits(filtered("", poses), poses));
    EXPECT_EQ(parse_filters("binomial:9+csg:7:2+sg:5:2", step_s).delay(), 6u);
}

TEST(FilterChain, KnowsEveryMask) {
    const auto poses = generate("reach:0.6:4", 4).poses;
    const auto same = [&](const char* a, const char* b) {
        return same_bits(filtered(a, poses), filtered(b, poses));
    };
    EXPECT_TRUE(same("binomial:5", "taps:0.0625,0.25,0.375,0.25,0.0625@2"));
    EXPECT_TRUE(same("hs:1.5", "taps:-0.0625,0.25,0.625,0.25,-0.0625@2"));
    EXPECT_TRUE(same("hu:1", "taps:-0.0625,-0.25,1.625,-0.25,-0.0625@2"));
    EXPECT_TRUE(same("taps:0,1@1", ""));
    EXPECT_FALSE(same("sg:7:2", "csg:7:2"));
    EXPECT_TRUE(same("late:7:2:0", "csg:7:2"));
    EXPECT_TRUE(same("late:4:1:1.5", "taps:0.25,0.25,0.25,0.25@1"));
    EXPECT_TRUE(same("zerolag:1", "taps:0,1@1"));
}

TEST(FilterChain, KnowsTheAdaptiveFilter) {
    const auto poses = generate("reach:0.6:4", 4).poses;
    AdaptivePoseFilter adaptive{{2, 0.5f}, {2, 0.5f}};
    EXPECT_TRUE(same_bits(filtered("adaptive:2:0.5", poses), filtered(adaptive, poses)));
    EXPECT_EQ(parse_filters("adaptive:2:0.5+binomial:5", step_s).delay(), 2u);
}

TEST(FilterChain, KnowsStrainSmoothing) {
    const auto poses =
        generate("reach:0.6:4+lose:position:0.2+turn:0.5+gap:0.2+reach:0.6", 4).poses;
    const auto step = static_cast<float>(step_s);
    const auto params = *StrainParams::from_cutoff(5, step, 1);
    const auto four = std::make_unique<StrainSmoother<4>>(params);
    const auto expected = filtered(*four, poses);
    ASSERT_EQ(expected.size(), poses.size());
    EXPECT_TRUE(same_bits(filtered("strain:5:4", poses), expected));
    const auto stated = std::make_unique<StrainSmoother<strain_lag(5, 1 / 120.0f)>>(params);
    EXPECT_TRUE(same_bits(filtered("strain:5", poses), filtered(*stated, poses)));
    EXPECT_EQ(parse_filters("strain:5:0+strain:5:4", step_s).delay(), 4u);
    EXPECT_EQ(parse_filters("strain:5", step_s).delay(), strain_lag(5, step));
}

TEST(FilterChain, KnowsFairing) {
    const auto poses =
        generate("reach:0.6:4+lose:position:0.2+turn:0.5+gap:0.2+reach:0.6", 4).poses;
    FairingParams params;
    params.damping_p = params.damping_q = 0.3f;
    FairingWindow<2, 6> second{params};
    EXPECT_TRUE(same_bits(filtered("fair:2:0.3:6", poses), filtered(second, poses)));
    EXPECT_EQ(parse_filters("fair:2:0.3:6", step_s).delay(), second.latency);
    FairingWindow<3, 7, true> third{params};
    EXPECT_TRUE(same_bits(filtered("fair:3:0.3:7", poses), filtered(third, poses)));
    params.bound_m = 0.0002f;
    params.bound_rad = 0.001f;
    FairingWindow<3, 100, true> bounded{params};
    EXPECT_TRUE(
        same_bits(filtered("fair:3:0.3:100:0.0002:0.001", poses), filtered(bounded, poses)));
    EXPECT_FALSE(same_bits(filtered("fair:3:0.3:7", poses), filtered("fair:2:0.3:7", poses)));
}

TEST(FilterChain, ACopyOfALargeStageIsItsOwn) {
    const auto poses = generate("reach:0.6:2", 4).poses;
    const FilterChain fresh = parse_filters("strain:5:9+fair:2:0.3:3", step_s);
    FilterChain used = fresh, other = fresh;
    const auto expected = filtered(used, poses);
    EXPECT_TRUE(same_bits(filtered(other, poses), expected));
    other.push(poses[0]);
    other = fresh;
    EXPECT_TRUE(same_bits(filtered(other, poses), expected));
}

TEST(FilterChain, SaysWhyACutOffIsRefused) {
    const auto why = [](const char* spec, double step) -> std::string {
        try {
            parse_filters(spec, step);
        } catch (const BadSpec& error) {
            return error.what();
        }
        return {};
    };
    EXPECT_NE(why("strain:0.9", step_s).find("below 0.008"), std::string::npos);
    EXPECT_NE(why("strain:0.9", step_s).find("120 records a second"), std::string::npos);
    EXPECT_EQ(why("strain:0.9", 1 / 60.0), "");
    EXPECT_NE(why("strain:60", step_s).find("below 0.5"), std::string::npos);
    EXPECT_NE(why("strain:5", 0).find("step must be positive"), std::string::npos);
    EXPECT_NE(why("median:5", step_s).find("strain or fair"), std::string::npos);
}

TEST(FilterChain, CanBeUsedAgainAfterFlushAndReset) {
    const auto poses = generate("reach:0.6:2", 4).poses;
    const auto chain =
        std::make_unique<FilterChain>(parse_filters("binomial:9+binomial:5", step_s));
    const auto first = filtered(*chain, poses);
    EXPECT_TRUE(same_bits(filtered(*chain, poses), first));
    chain->push(poses[0]);
    chain->reset();
    EXPECT_TRUE(same_bits(filtered(*chain, poses), first));
}

TEST(FilterChain, BadSpecsAreUsageErrors) {
    for (const char* spec : {"binomial",
                             "binomial:4",
                             "binomial:0",
                             "binomial:259",
                             "binomial:5:2",
                             "hs",
                             "hs:x",
                             "sg:5",
                             "sg:4:2",
                             "sg:5:5",
                             "csg:5:-1",
                             "late:7:1",
                             "late:7:3:1",
                             "late:7:1:7",
                             "zerolag:0.01",
                             "zerolag:1.1",
                             "taps:1",
                             "taps:@0",
                             "taps:0.5,0.4@0",
                             "taps:0.5,0.5@2",
                             "taps:0.5,0.5@0.5",
                             "taps:0.5,nan@0",
                             "median:5",
                             "strain",
                             "strain:5:401",
                             "strain:5:-1",
                             "strain:5:1:1",
                             "strain:nan",
                             "fair:2:0.3",
                             "fair:4:0.3:5",
                             "fair:2:0.5:5",
                             "fair:2:0.3:0",
                             "fair:2:0.3:101",
                             "fair:2:0.3:5:0.1",
                             "fair:2:0.3:5:-1:1",
                             "+",
                             "binomial:5+",
                             "hs:1+hs:1+hs:1+hs:1+hs:1+hs:1+hs:1+hs:1+hs:1"})
        EXPECT_THROW(parse_filters(spec, step_s), BadSpec) << spec;
}
