// The defaults hold the guarantee at every usual rate: a board with nothing set but its sample
// period, or not even that, judged from the bytes. Stamps jitter by up to 30 % of the period.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include "tests/pipeline/pipeline_check.hpp"

namespace fairlead::test {
namespace {

struct DefaultBoard {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, Orientation>;
    using Filter = NoFilter;
    static constexpr std::size_t delay_records_max = 120;
    static constexpr Beam beam = Beam::narrow;
    static constexpr std::size_t events_max = 0;
};

void judge(double hz, bool told, unsigned seed) {
    const double period = 1e9 / hz;
    typename Pipeline<DefaultBoard>::Params params;
    params.sample_period_ns = told ? static_cast<std::int64_t>(period) : 0;
    PipelineCheck<DefaultBoard> check{params};
    ASSERT_TRUE(check.chain().check()) << check.chain().check().field;
    std::mt19937 random{seed};
    std::uint64_t refused = 0;
    const std::uint64_t records = 600;
    for (std::uint64_t i = 0; i < records; ++i) {
        const double jitter = 0.6 * (static_cast<double>(random()) * 0x1p-32 - 0.5);
        const double t = (static_cast<double>(i) + 1 + jitter) * period, s = 1e-9 * t;
        Pose pose;
        pose.t_ns = static_cast<std::int64_t>(t);
        pose.p_w_m = {static_cast<float>(0.3 * std::sin(2 * s)),
                      static_cast<float>(0.2 * std::cos(3 * s)), 1.0f};
        const double half = 0.4 * std::sin(1.5 * s);
        pose.q_wb = {static_cast<float>(std::cos(half)), static_cast<float>(std::sin(half)), 0, 0};
        pose.flags = flag::position_valid | flag::orientation_valid;
        check.push(pose);
        if (check.chain().intake().refused()) ++refused;
    }
    check.finish();
    const Verdict& v = check.verdict();
    EXPECT_TRUE(v.good()) << v.first << ": outside " << v.violations << ", late " << v.late
                          << ", uncovered " << v.uncovered;
    EXPECT_EQ(refused, 0u);
    EXPECT_EQ(v.accepted, records);
    EXPECT_EQ(v.values, 2 * records);
}

}  // namespace

TEST(DefaultRates, HoldWhateverTheRateAndTheJitter) {
    for (const bool told : {true, false})
        for (const double hz : {25.0, 60.0, 100.0, 120.0, 200.0, 400.0, 1000.0})
            for (unsigned seed = 1; seed <= 5; ++seed) {
                SCOPED_TRACE(std::to_string(hz) + " Hz, period " + (told ? "told" : "measured") +
                             ", seed " + std::to_string(seed));
                judge(hz, told, seed);
            }
}

}  // namespace fairlead::test
