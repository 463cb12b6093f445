// Records through the encoder of C2 cubics and a decoder: every accepted sample within its
// tolerance, covered, in time, checked in double from the bytes; on streams that look for their
// failure. FAIRLEAD_STREAMS=N tries N of them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>

#include "tests/unit/random_motion.hpp"
#include "tests/unit/stream_check.hpp"

namespace fairlead::test {
namespace {

using Position = wire::VectorForm<3, wire::Medium, curve::Cubics>;
using Alone = wire::Encoder<120, 0, Position>;
using Wide = wire::Encoder<60, 2, wire::VectorForm<3, wire::Large, curve::Cubics>>;
using Both = wire::Encoder<120, 0, Position, wire::RotationForm<>>;
using Narrow = wire::Encoder<24, 0, wire::VectorForm<3, wire::Small, curve::Cubics>>;
/// Trusts more than the whole tolerance: many committed curves do not hold their samples.
struct Faulty : wire::Medium {
    static constexpr float trust = 1.3f;
};
using Broken = wire::Encoder<60, 0, wire::VectorForm<3, Faulty, curve::Cubics>>;

struct Sum {
    std::size_t accepted{}, pieces{}, breaks{}, given_up{}, failures{}, frames{};
    double worst{};
};

template <class Encoder>
auto values(const RandomMotion& m) {
    if constexpr (Encoder::rotations > 0)
        return typename Encoder::Values{m.p, m.q};
    else
        return typename Encoder::Values{m.p};
}

/// One random stream: what it is follows from the seed alone.
template <class Encoder>
void stream(std::uint64_t seed, int records, Sum& sum) {
    RandomMotion motion{seed};
    typename Encoder::Params params;
    params.sample_period_ns = motion.period_ns;
    params.tolerance[0] = motion.tolerance;
    if constexpr (Encoder::rotations > 0) params.tolerance[1] = motion.tolerance_rad;
    params.delay_records =
        8 + static_cast<std::uint32_t>(motion.uniform(0, Encoder::records_max - 7));
    if (motion.chance(0.3)) params.delay_records = Encoder::records_max;
    params.restart_interval_ns =
        motion.chance(0.2) ? wire::never_ns
                           : 1 + static_cast<std::int64_t>(motion.uniform(0, 300) *
                                                           static_cast<double>(motion.period_ns));
    params.header_interval_ns = 1'000'000'000;
    ASSERT_TRUE(Encoder::check(params));
    using Decoder = wire::Decoder<3, 1, wire::KindSet<curve::Smooth, curve::Cubics>>;
    auto check = std::make_unique<StreamCheck<Encoder, Decoder>>(params);
    const std::int64_t spacing = Encoder::limits(params).spacing_min_ns;
    motion.next();
    std::int64_t before = motion.t_ns - 2 * spacing;
    for (int i = 0; i < records; ++i) {
        const std::int64_t t = std::max(motion.t_ns, before + spacing);
        const std::uint32_t valid = motion.valid & ((1u << Encoder::channel_count) - 1u);
        check->push(t, values<Encoder>(motion), valid, motion.gaps, i == 0);
        before = t;
        motion.next();
    }
    check->finish();
    const bool good = check->violations == 0 && check->late == 0 && check->uncovered == 0 &&
                      check->encoder.strays() == 0 && check->decoder.counters().nonsense == 0 &&
                      check->decoder.frame_counters().losses == 0;
    ASSERT_TRUE(good) << "seed " << seed << ": " << check->first_fault << "; violations "
                      << check->violations << " late " << check->late << " uncovered "
                      << check->uncovered << " strays " << check->encoder.strays() << " losses "
                      << check->decoder.frame_counters().losses << " worst " << check->worst;
    sum.accepted += check->accepted;
    sum.pieces += check->pieces;
    sum.breaks += check->breaks;
    sum.given_up += check->encoder.given_up();
    sum.failures += check->encoder.check_failures();
    sum.frames += check->encoder.frames();
    sum.worst = std::max(sum.worst, check->worst);
}

std::uint64_t streams(std::uint64_t usual) {
    const char* text = std::getenv("FAIRLEAD_STREAMS");
    return text != nullptr ? std::strtoull(text, nullptr, 10) : usual;
}

template <class Encoder>
Sum search(std::uint64_t count, std::uint64_t seed) {
    Sum sum;
    for (std::uint64_t i = 0; i < count; ++i) {
        stream<Encoder>(seed + i, 20 + static_cast<int>(i * 37 % 300), sum);
        if (testing::Test::HasFatalFailure()) break;
    }
    EXPECT_LE(sum.worst, 1.0);
    std::printf("%zu samples, %zu pieces, %zu breaks, %zu of %zu frames given up, %zu failures\n",
                sum.accepted, sum.pieces, sum.breaks, sum.given_up, sum.frames, sum.failures);
    return sum;
}

TEST(CubicEncoder, RandomStreamsAreCoveredInToleranceAndInTime) {
    const Sum sum = search<Alone>(streams(150), 1);
    EXPECT_EQ(sum.failures, 0u);
    EXPECT_GT(sum.worst, 0.98);  // the tolerance is used
    EXPECT_LT(sum.given_up * 100, sum.frames);
}
TEST(CubicEncoder, AlsoWithAWideBeamAndAShortDelay) {
    search<Wide>(streams(60), 1000000);
    search<Narrow>(streams(60), 2000000);
}
TEST(CubicEncoder, AlsoBesideOrientations) { search<Both>(streams(80), 3000000); }

TEST(CubicEncoder, AFrameThatDoesNotHoldItsSamplesLeavesAsSteps) {
    const Sum sum = search<Broken>(streams(60), 4000000);
    EXPECT_GT(sum.failures, 100u);
    EXPECT_GT(sum.given_up, 100u);
}

TEST(CubicEncoder, IndependentFramesAreRefusedByName) {
    Alone::Params params;
    params.tolerance[0] = 0.001f;
    params.restart_interval_ns = wire::every_frame_ns;
    const fairlead::Check check = Alone::check(params);
    EXPECT_EQ(check.status, Status::bad_argument);
    EXPECT_STREQ(check.field, "restart_interval_ns");
}

}  // namespace
}  // namespace fairlead::test
