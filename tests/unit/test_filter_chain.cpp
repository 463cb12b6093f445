// The run-time filter chain: its grammar, and that a chain is its filters one after another.
#include "host_sim/filter_chain.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <vector>

#include "host_sim/generate.hpp"
#include "host_sim/spec.hpp"

using namespace fairlead;
using namespace fairlead::sim;

namespace {

template <class Filter>
std::vector<Pose> filtered(Filter& filter, const std::vector<Pose>& poses) {
    std::vector<Pose> out;
    for (const Pose& pose : poses)
        if (const auto y = filter.push(pose)) out.push_back(*y);
    while (const auto y = filter.flush()) out.push_back(*y);
    return out;
}

std::vector<Pose> filtered(const char* spec, const std::vector<Pose>& poses) {
    const auto chain = std::make_unique<FilterChain>(parse_filters(spec));
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
    EXPECT_EQ(parse_filters("binomial:9+csg:7:2+sg:5:2").delay(), 6u);
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
}

TEST(FilterChain, KnowsTheAdaptiveFilter) {
    const auto poses = generate("reach:0.6:4", 4).poses;
    AdaptivePoseFilter adaptive{{2, 0.5f}, {2, 0.5f}};
    EXPECT_TRUE(same_bits(filtered("adaptive:2:0.5", poses), filtered(adaptive, poses)));
    EXPECT_EQ(parse_filters("adaptive:2:0.5+binomial:5").delay(), 2u);
}

TEST(FilterChain, CanBeUsedAgainAfterFlushAndReset) {
    const auto poses = generate("reach:0.6:2", 4).poses;
    const auto chain = std::make_unique<FilterChain>(parse_filters("binomial:9+binomial:5"));
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
                             "taps:1",
                             "taps:@0",
                             "taps:0.5,0.4@0",
                             "taps:0.5,0.5@2",
                             "taps:0.5,0.5@0.5",
                             "taps:0.5,nan@0",
                             "median:5",
                             "+",
                             "binomial:5+",
                             "hs:1+hs:1+hs:1+hs:1+hs:1+hs:1+hs:1+hs:1+hs:1"})
        EXPECT_THROW(parse_filters(spec), BadSpec) << spec;
}
