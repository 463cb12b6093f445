// The way on of a frame that is not right. Encoders whose search uses more than the tolerance make
// frames with samples outside; none of them may leave. Frames that do not fit into their bytes, and
// windows that begin where the decoder is not, are made on purpose as well.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "tests/unit/stream_check.hpp"

namespace fairlead::test {
namespace {

/// Uses 10 % more than the tolerance.
struct Reckless : reduce::BeamSize<2, 24> {
    static constexpr float trust = 1.1f;
};
using Both = wire::Encoder<120, 0, wire::VectorForm<3, Reckless>, wire::RotationForm<Reckless>>;
using Sound =
    wire::Encoder<120, 0, wire::VectorForm<3, wire::Small>, wire::RotationForm<wire::Small>>;

// the channel with the shorter window bounds the records of all
template <std::size_t Positions, std::size_t Orientations>
using Windows = reduce::Reducer<wire::VectorForm<3>::Channel<Positions>,
                                wire::RotationForm<>::Channel<Orientations>>;
static_assert(Windows<40, 24>::records_max == 24 && Windows<24, 40>::records_max == 24);

struct Dice {
    std::mt19937_64 engine;
    double unit() { return static_cast<double>(engine() >> 11) * 0x1p-53; }
    bool chance(double p) { return unit() < p; }
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine() % n); }
};

template <class Check>
std::string what_of(const Check& check) {
    return check.first_fault + "; violations " + std::to_string(check.violations) + " late " +
           std::to_string(check.late) + " uncovered " + std::to_string(check.uncovered) +
           " losses " + std::to_string(check.decoder.frame_counters().losses) + " worst " +
           std::to_string(check.worst);
}
/// Nothing is outside, late or uncovered, and the reader understands all.
template <class Check>
bool kept(const Check& check) {
    return check.violations == 0 && check.late == 0 && check.uncovered == 0 &&
           check.decoder.frame_counters().losses == 0 && check.decoder.counters().nonsense == 0;
}

TEST(ExactFrames, NoFaultOfTheSearchLeaves) {
    std::uint32_t given_up = 0, failures = 0;
    std::size_t refused = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        Dice dice{std::mt19937_64{seed}};
        Both::Params params;
        params.tolerance = {0.001f, dice.chance(0.5) ? 0.0044f : 0.1f};
        params.delay_records = dice.chance(0.3) ? 120 : 8 + dice.below(112);
        params.restart_interval_ns = dice.chance(0.3)   ? wire::every_frame_ns
                                     : dice.chance(0.5) ? wire::never_ns
                                                        : 500'000'000;
        auto check = std::make_unique<StreamCheck<Both, wire::Decoder<3, 1>>>(params);
        const double speed = 0.3 * dice.unit(), leaps = dice.chance(0.5) ? 0.03 : 0.001;
        std::int64_t t = 0;
        std::uint32_t valid = 3;
        for (int i = 0; i < 500; ++i) {
            t += static_cast<std::int64_t>((0.4 + 1.2 * dice.unit()) * 8'333'333);
            if (dice.chance(leaps)) t += static_cast<std::int64_t>(dice.below(900'000'000));
            if (dice.chance(leaps)) valid = 1 + dice.below(3);
            const double x = speed * i, turn = 2.6 * std::sin(0.7 * x);
            check->push(t,
                        {{static_cast<float>(0.3 * std::sin(x)), static_cast<float>(std::cos(x)),
                          static_cast<float>(0.002 * dice.unit())},
                         from_rotation_vector(Vec3{static_cast<float>(turn),
                                                   static_cast<float>(0.3 * std::sin(x)), 0})},
                        valid, dice.chance(leaps) ? 1 + dice.below(3) : 0, dice.chance(leaps));
            if (dice.chance(0.002)) check->flush();
        }
        check->finish();
        ASSERT_TRUE(kept(*check)) << "seed " << seed << ": " << what_of(*check);
        EXPECT_EQ(check->encoder.strays(), 0u);
        given_up += check->encoder.given_up();
        failures += check->encoder.check_failures();
        refused += check->refused;
    }
    EXPECT_GT(given_up, 100u);
    EXPECT_GT(failures, 100u);
    EXPECT_GT(refused, 0u);  // a record waited until such a frame had left
}

using SoundCheck = StreamCheck<Sound, wire::Decoder<3, 1>>;

/// The reducer inside, to plant faults.
auto& reducer_of(SoundCheck& check) {
    const auto& reducer = check.encoder.reducer();
    return const_cast<std::remove_cv_t<std::remove_reference_t<decltype(reducer)>>&>(reducer);
}
Sound::Values quick(int i) {
    const double x = 0.1 * i;
    return {{static_cast<float>(0.3 * std::sin(x)), static_cast<float>(std::cos(x)), 1},
            from_rotation_vector(Vec3{static_cast<float>(std::sin(x)), 0, 0})};
}

TEST(ExactFrames, AFrameThatDoesNotFitLeavesInStretches) {
    // a window that begins anew with many samples of a quick motion leads to the next column by one
    // chain of steps, which costs more than a frame holds
    for (const std::int64_t restart :
         {wire::every_frame_ns, std::int64_t{500'000'000}, wire::never_ns}) {
        Sound::Params params;
        params.tolerance = {0.001f, 0.0044f};
        params.delay_records = 120;
        params.restart_interval_ns = restart;
        auto check = std::make_unique<SoundCheck>(params);
        int begun_anew = 0;
        for (int i = 0; i < 3000; ++i) {
            check->push(i * params.sample_period_ns, {{1, 2, 3}, std::get<1>(quick(i))}, 3);
            auto& reducer = reducer_of(*check);
            if (reducer.waiting() != 90) continue;
            ++begun_anew;
            const curve::RotationState end = reducer.channel<1>().frame_state();
            reducer.resume<1>(&end);
        }
        check->finish();
        ASSERT_TRUE(kept(*check)) << what_of(*check);
        EXPECT_GT(begun_anew, 3);
        EXPECT_GT(check->encoder.overflows(), 3u);
        EXPECT_EQ(check->encoder.given_up(), check->encoder.overflows());
        EXPECT_EQ(check->encoder.strays(), 0u);
    }
}

TEST(ExactFrames, AFrameThatDoesNotFitLeavesInStretchesAtTheEndToo) {
    std::uint32_t overflows = 0;
    for (int more = 0; more < 12; ++more) {
        Sound::Params params;
        params.tolerance = {0.001f, 0.0044f};
        params.delay_records = 120;
        auto check = std::make_unique<SoundCheck>(params);
        int left = -1;
        for (int i = 0; left != 0; ++i) {
            check->push(i * params.sample_period_ns, {{1, 2, 3}, std::get<1>(quick(i))}, 3);
            if (left > 0) --left;
            auto& reducer = reducer_of(*check);
            if (left >= 0 || i < 200 || reducer.waiting() != 90) continue;
            const curve::RotationState end = reducer.channel<1>().frame_state();
            reducer.resume<1>(&end);
            left = more;
        }
        check->finish();
        EXPECT_TRUE(kept(*check)) << more << ": " << what_of(*check);
        overflows += check->encoder.overflows();
    }
    EXPECT_GT(overflows, 3u);
}

TEST(ExactFrames, AFrameThatBeginsWhereTheDecoderIsNotIsGivenUp) {
    std::uint32_t strays = 0;
    for (const std::int64_t restart : {wire::every_frame_ns, wire::never_ns}) {
        Sound::Params params;
        params.tolerance = {0.001f, 0.0044f};
        params.delay_records = 60;
        params.restart_interval_ns = restart;
        auto check = std::make_unique<SoundCheck>(params);
        Dice dice{std::mt19937_64{1}};
        for (int i = 0; i < 6000; ++i) {
            check->push(i * params.sample_period_ns, quick(i), 3);
            if (!dice.chance(0.003)) continue;
            auto& reducer = reducer_of(*check);
            if (dice.chance(0.5)) {
                curve::RotationState wrong = reducer.channel<1>().frame_state();
                wrong.chart.s[dice.below(3)] += 5;
                reducer.resume<1>(&wrong);
            } else {
                std::array<curve::State<1>, 3> wrong{};
                for (auto& state : wrong) state.v[0] = static_cast<std::int32_t>(dice.below(1000));
                reducer.resume<0>(wrong.data());
            }
        }
        check->finish();
        ASSERT_TRUE(kept(*check)) << what_of(*check);
        // each of them is given up; what is given up besides are frames of the steps behind it
        EXPECT_LE(check->encoder.strays(), check->encoder.given_up());
        strays += check->encoder.strays();
    }
    EXPECT_GT(strays, 10u);
}

TEST(ExactFrames, CurvesEndAndBeginAtOnceWhileOthersGoOn) {
    // samples as close as they may be, channels that come and go, pauses and gaps: frames of no
    // tick for a single sample, beside curves that end, go on, or have ended already
    for (std::uint64_t seed = 1; seed <= 150; ++seed) {
        Dice dice{std::mt19937_64{seed}};
        Sound::Params params;
        params.tolerance = {0.001f, dice.chance(0.5) ? 1.2e-4f : 0.0044f};
        params.sample_period_ns = 6'400'000;
        params.delay_records = 8 + dice.below(112);
        params.restart_interval_ns = dice.chance(0.5)   ? wire::every_frame_ns
                                     : dice.chance(0.5) ? wire::never_ns
                                                        : 20'000'000;
        auto check = std::make_unique<SoundCheck>(params);
        const double gaps = 0.3 * dice.unit(), pauses = 0.5 * dice.unit();
        const double range = dice.chance(0.5) ? 20'000 : 30;
        std::int64_t t = 0;
        std::uint32_t valid = 3;
        for (int i = 0; i < 300; ++i) {
            const auto any = [&dice](double size) {
                return static_cast<float>(size * (2 * dice.unit() - 1));
            };
            if (dice.chance(0.1)) valid = 1 + dice.below(3);
            if (dice.chance(0.3)) valid = 3;
            check->push(t,
                        {{any(range), any(range), any(range)},
                         normalised(Quat{any(1), any(1), any(1), any(1)})},
                        valid, dice.chance(gaps) ? 1 + dice.below(3) : 0);
            t += 2'000'000;
            if (dice.chance(pauses)) t += std::int64_t{dice.below(60)} * params.sample_period_ns;
        }
        check->finish();
        ASSERT_TRUE(check->good()) << "seed " << seed << ": " << what_of(*check);
        EXPECT_EQ(check->encoder.given_up(), 0u);
    }
}

}  // namespace
}  // namespace fairlead::test
