// Records through encoder and decoder: every accepted sample within its tolerance, covered, in
// time, checked in double from the bytes. Uneven times, gaps of channels, leaps of the clock,
// jumps, noise.
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <random>

#include "tests/unit/stream_check.hpp"

namespace fairlead::test {
namespace {

using Both = wire::Encoder<120, 2, wire::VectorForm<3>, wire::RotationForm<>>;
using Alone = wire::Encoder<64, 0, wire::VectorForm<2, wire::Small>>;
using Pair =
    wire::Encoder<60, 0, wire::VectorForm<1, wire::Small>, wire::VectorForm<1, wire::Small>>;
using Turning = wire::Encoder<32, 0, wire::RotationForm<wire::Small>>;

struct Dice {
    std::mt19937_64 engine;
    double unit() { return static_cast<double>(engine() >> 11) * 0x1p-53; }
    bool chance(double p) { return unit() < p; }
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine() % n); }
};

/// A smooth walk that rests, moves, and now and then leaps.
struct Walk {
    double x{0}, v{0}, aim{0};
    double step(Dice& dice, double dt, double speed) {
        if (dice.chance(0.02)) aim = dice.chance(0.4) ? 0 : speed * (2 * dice.unit() - 1);
        v += (aim - v) * (dt < 0.1 ? dt * 8 : 0.8);
        x += v * dt;
        return x;
    }
};

struct Kind {
    double jitter, missing, noise, leap, speed;
};

template <class Check>
void run_stream(Check& check, const typename Check::Params& params, Dice& dice, int records,
                const Kind& kind, typename Check::Values (*value)(std::array<double, 6>)) {
    std::array<Walk, 6> walks{};
    const std::int64_t period = params.sample_period_ns;
    const std::int64_t spacing = Check::Encoder::limits(params).spacing_min_ns;
    std::int64_t t = static_cast<std::int64_t>(dice.engine()) / 8, before = t;
    std::uint32_t valid = (1u << Check::channels) - 1u;
    bool new_run = true;
    for (int i = 0; i < records; ++i) {
        std::uint32_t gaps = 0;
        if (dice.chance(0.002)) {  // the clock leaps
            t = static_cast<std::int64_t>(dice.engine()) / 8;
            new_run = true;
        } else if (dice.chance(0.003)) {
            t += period * (20 + dice.below(3000));  // a pause
            gaps = dice.below(4);
        }
        if (dice.chance(0.01)) valid = 1 + dice.below((1u << Check::channels) - 1u);
        if (dice.chance(0.05)) valid = (1u << Check::channels) - 1u;
        std::array<double, 6> x{};
        for (std::size_t k = 0; k < 6; ++k) {
            if (dice.chance(kind.leap)) walks[k].x += kind.speed * (2 * dice.unit() - 1);
            x[k] = walks[k].step(dice, static_cast<double>(period) * 1e-9, kind.speed) +
                   kind.noise * (2 * dice.unit() - 1);
        }
        t += period;
        if (dice.chance(kind.missing)) continue;
        std::int64_t at = t + static_cast<std::int64_t>(kind.jitter * (2 * dice.unit() - 1) *
                                                        static_cast<double>(period));
        if (!new_run && at < before + spacing) at = before + spacing;
        check.push(at, value(x), valid, gaps, new_run);
        before = at;
        new_run = false;
    }
    check.finish();
}

template <class Enc>
struct Checked {
    using Encoder = Enc;
    using Params = typename Enc::Params;
    using Values = typename Enc::Values;
    static constexpr std::size_t channels = Enc::channel_count;
    StreamCheck<Enc, wire::Decoder<3, 1>> check;
    explicit Checked(const Params& params) : check{params} {}
    void push(std::int64_t t, const Values& v, std::uint32_t valid, std::uint32_t gaps, bool run) {
        check.push(t, v, valid, gaps, run);
    }
    void finish() { check.finish(); }
};

Quat turned(double a, double b, double c) {
    const auto q = from_rotation_vector(BasicVec3<double>{a, b, c});
    return {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
            static_cast<float>(q.z)};
}

template <class Encoder>
void search(int streams, int records, decltype(Encoder::Params::tolerance) tolerance,
            typename Encoder::Values (*value)(std::array<double, 6>), std::uint64_t seed) {
    std::size_t accepted = 0;
    for (int i = 0; i < streams; ++i) {
        Dice dice{std::mt19937_64{seed + static_cast<std::uint64_t>(i)}};
        typename Encoder::Params params;
        params.tolerance = tolerance;
        const double rate = std::exp(dice.unit() * std::log(8000.0));
        params.sample_period_ns = static_cast<std::int64_t>(1e9 / rate);
        params.delay_records = 8 + dice.below(Encoder::records_max - 7);
        if (dice.chance(0.3)) params.delay_records = Encoder::records_max;
        params.restart_interval_ns = dice.chance(0.2) ? wire::every_frame_ns
                                     : dice.chance(0.2)
                                         ? wire::never_ns
                                         : static_cast<std::int64_t>(3e9 * dice.unit());
        params.header_interval_ns = 1'000'000'000;
        const Kind kind{dice.chance(0.5) ? 0.0 : 0.3 * dice.unit(), dice.chance(0.5) ? 0.0 : 0.1,
                        dice.chance(0.7) ? 0.0002 : 0.02, dice.chance(0.7) ? 0.0 : 0.01,
                        0.01 + 3 * dice.unit()};
        ASSERT_EQ(Encoder::check(params).status, Status::ok);
        auto run = std::make_unique<Checked<Encoder>>(params);
        run_stream(*run, params, dice, records, kind, value);
        const auto& check = run->check;
        ASSERT_TRUE(check.good()) << "seed " << seed + static_cast<std::uint64_t>(i) << ": "
                                  << check.first_fault << "; violations " << check.violations
                                  << " late " << check.late << " uncovered " << check.uncovered
                                  << " losses " << check.decoder.frame_counters().losses
                                  << " overflows " << check.encoder.overflows() << " worst "
                                  << check.worst;
        accepted += check.accepted;
    }
    EXPECT_GT(accepted, static_cast<std::size_t>(streams * records / 2));
}

TEST(StreamEncoder, BothChannels) {
    search<Both>(
        16, 600, {0.001f, 0.0044f},
        [](std::array<double, 6> x) -> Both::Values {
            return {{static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])},
                    turned(x[3], x[4], x[5])};
        },
        1);
}
TEST(StreamEncoder, AVectorAlone) {
    search<Alone>(
        40, 900, {0.002f},
        [](std::array<double, 6> x) -> Alone::Values {
            return {{static_cast<float>(x[0]), static_cast<float>(x[1])}};
        },
        1000);
}
TEST(StreamEncoder, EachAxisHasItsOwnTolerance) {
    search<Alone>(
        20, 900, {std::array<float, 2>{0.002f, 0.05f}},
        [](std::array<double, 6> x) -> Alone::Values {
            return {{static_cast<float>(x[0]), static_cast<float>(x[1])}};
        },
        4000);
    // the same motion of both axes: the one that may err more costs less
    const auto bytes_of = [](float first, float second) {
        Alone::Params params;
        params.tolerance = {std::array<float, 2>{first, second}};
        auto encoder = std::make_unique<Alone>(params);
        std::size_t bytes = 0;
        for (int i = 0; i < 2400; ++i) {
            const auto x = static_cast<float>(std::sin(0.02 * i) + 0.2 * std::sin(0.07 * i));
            bytes += encoder->push(i * params.sample_period_ns, {{x, x}}, 1, 0, false).size;
        }
        return bytes;
    };
    const std::size_t fine = bytes_of(0.002f, 0.002f), own = bytes_of(0.002f, 0.05f),
                      coarse = bytes_of(0.05f, 0.05f);
    EXPECT_LT(coarse, own - own / 10);
    EXPECT_LT(own, fine - fine / 10);
}
TEST(StreamEncoder, AnOrientationAlone) {
    search<Turning>(
        40, 900, {0.0175f},
        [](std::array<double, 6> x) -> Turning::Values { return {turned(x[0], x[1], x[2])}; },
        2000);
}

TEST(StreamEncoder, RecordsWithoutAValueCountForTheDelay) {
    // after a few records a channel is lost, all at once or one behind the other
    for (const std::uint32_t delay : {8u, 16u, 24u, 60u, 120u}) {
        for (const double spacing : {0.35, 0.5, 1.0, 1.7}) {
            for (std::uint32_t some = 1; some < 40; some += 3) {
                typename Both::Params params;
                params.tolerance = {0.001f, 0.0044f};
                params.sample_period_ns = 6'400'000;
                params.delay_records = delay;
                Checked<Both> run{params};
                std::int64_t t = 0;
                for (std::uint32_t i = 0; i < 3 * (some + 150); ++i) {
                    const std::uint32_t at = i % (some + 150);
                    const float x = 0.01f * std::sin(0.1f * static_cast<float>(i));
                    // every other time a channel has its first sample where the others have their
                    // last
                    const std::uint32_t most = some % 2 == 0 ? 2 : 3;
                    const std::uint32_t valid = at < some              ? most
                                                : at == some           ? 3
                                                : at < some + some / 4 ? 2
                                                                       : 0;
                    run.push(t, {{x, -x, 0}, turned(x, 0, 0)}, valid, 0, i == 0);
                    t += static_cast<std::int64_t>(spacing *
                                                   static_cast<double>(params.sample_period_ns));
                }
                run.finish();
                ASSERT_TRUE(run.check.good())
                    << "delay " << delay << ", spacing " << spacing << ", " << some << ": "
                    << run.check.first_fault << ", late " << run.check.late << ", overflows "
                    << run.check.encoder.overflows();
            }
        }
    }
}

/// A frame that ends early leaves a sample behind its end, which goes on to age with every record,
/// also with one that has no value and at which the frame ends.
TEST(StreamEncoder, ASampleThatAnEarlyFrameLeavesGoesOnToAge) {
    for (const std::uint32_t delay : {8u, 16u, 23u, 31u, 48u, 60u})
        for (std::uint32_t some = 2; some < 60; some += some < 20 ? 1 : 7)
            for (std::uint32_t empty = 0; empty < delay; empty += empty < 6 ? 1 : 5)
                for (const float leap : {0.0f, 3e4f})  // one that a window cannot reach
                    for (const double offset : {0.0, 0.1, 0.4}) {
                        typename Pair::Params params;
                        params.tolerance = {0.01f, 0.01f};
                        params.delay_records = delay;
                        params.gap_ns = 12 * params.sample_period_ns;
                        StreamCheck<Pair, wire::Decoder<2, 0>> check{params};
                        const auto period = static_cast<double>(params.sample_period_ns);
                        for (std::uint32_t i = 0; i < some + empty + 2 * delay; ++i) {
                            // one channel is lost at once, the other for a while
                            const bool lost = i >= some && i < some + empty;
                            const float x = i < some ? 0.0f : leap;
                            const double at = static_cast<double>(i) + (i > 0 ? offset : 0.0);
                            check.push(static_cast<std::int64_t>(at * period),
                                       Pair::Values{{x}, {x}},
                                       i == 0 ? 3
                                       : lost ? 0
                                              : 1,
                                       0, i == 0);
                        }
                        check.finish();
                        ASSERT_TRUE(check.good())
                            << "delay " << delay << ", " << some << " and " << empty << ", leap "
                            << leap << ", offset " << offset << ": " << check.first_fault;
                    }
}

/// Channels that come and go by themselves, with and without a gap, records without a value, leaps.
TEST(StreamEncoder, ChannelsThatComeAndGoLeaveInTime) {
    for (unsigned seed = 0; seed < 3000; ++seed) {
        Dice dice{std::mt19937_64{seed}};
        typename Pair::Params params;
        params.tolerance = {0.01f, 0.01f};
        params.delay_records = 8 + dice.below(16);
        const auto period = static_cast<double>(params.sample_period_ns);
        params.gap_ns = static_cast<std::int64_t>((1 + 20 * dice.unit()) * period);
        StreamCheck<Pair, wire::Decoder<2, 0>> check{params};
        const double spacing = 0.35 + dice.unit(), jitter = dice.unit();
        const double empty = dice.unit(), leap = dice.chance(0.5) ? 0.0 : 0.1 * dice.unit();
        double at = 0;
        float x = 0;
        std::uint32_t valid = 3;
        for (std::uint32_t i = 0, left = 5; i < 200; ++i) {
            if (left-- == 0) {
                valid = dice.chance(empty) ? 0 : dice.below(4);
                left = static_cast<std::uint32_t>(25 * dice.unit() * dice.unit());
            }
            if (dice.chance(leap)) x = static_cast<float>(6e4 * (dice.unit() - 0.5));
            x += static_cast<float>(0.005 * (dice.unit() - 0.5));
            const std::uint32_t gaps = dice.chance(0.02) ? dice.below(4) : 0;
            check.push(static_cast<std::int64_t>(at * period), Pair::Values{{x}, {x}}, valid, gaps,
                       i == 0);
            at += std::max(0.33, spacing * (1 + jitter * (2 * dice.unit() - 1)));
        }
        check.finish();
        ASSERT_TRUE(check.good()) << "seed " << seed << ", delay " << params.delay_records << ": "
                                  << check.first_fault;
    }
}

TEST(StreamEncoder, OrientationsThatLeapAreHeldWhileAFrameIsStillInside) {
    // charts change while the frame before is checked and coded
    for (unsigned seed = 0; seed < 40; ++seed) {
        Dice dice{std::mt19937_64{seed}};
        typename Turning::Params params;
        params.tolerance = {0.0044f};
        params.delay_records = 24 + seed % 9;
        params.restart_interval_ns = seed % 3 == 0 ? wire::every_frame_ns : wire::never_ns;
        Checked<Turning> run{params};
        std::int64_t t = 0;
        double turn = 0;
        for (int i = 0; i < 300; ++i) {
            if (dice.chance(0.2)) turn = 6 * dice.unit() - 3;
            run.push(t, {turned(turn, 0.01 * dice.unit(), 0)}, 1, 0, i == 0);
            t += static_cast<std::int64_t>((0.6 + 0.8 * dice.unit()) *
                                           static_cast<double>(params.sample_period_ns));
        }
        run.finish();
        ASSERT_TRUE(run.check.good()) << "seed " << seed << ": " << run.check.first_fault;
    }
}

/// Positions and orientations in turn, several records a tick: each channel keeps its own columns.
TEST(StreamEncoder, ChannelsInTurnKeepTheirOwnColumns) {
    for (unsigned seed = 0; seed < 60; ++seed) {
        Dice dice{std::mt19937_64{seed}};
        typename Both::Params params;
        params.tolerance = {0.001f, 0.0044f};
        params.delay_records = seed % 2 == 0 ? 120 : 8 + dice.below(112);
        const double spacing = 0.34 + 0.3 * dice.unit(), noise = seed % 3 == 0 ? 0.05 : 0.0005;
        Checked<Both> run{params};
        std::int64_t t = 0;
        for (int i = 0; i < 400; ++i) {
            const double x = 0.1 * std::sin(0.05 * i) + noise * dice.unit();
            const auto value = static_cast<float>(x);
            run.push(t, {{value, value, value}, turned(x, -x, x)}, i % 2 == 0 ? 1 : 2, 0, i == 0);
            t += static_cast<std::int64_t>(spacing * static_cast<double>(params.sample_period_ns));
        }
        run.finish();
        ASSERT_TRUE(run.check.good())
            << "seed " << seed << ": " << run.check.first_fault << ", overflows "
            << run.check.encoder.overflows() << ", failures " << run.check.encoder.check_failures();
    }
}

/// Values that leap over the whole range with every record, records as close as they may be: no
/// frame may grow beyond its bytes.
TEST(StreamEncoder, NoFrameOverflowsWhateverComes) {
    for (unsigned seed = 0; seed < 60; ++seed) {
        Dice dice{std::mt19937_64{seed}};
        typename Both::Params params;
        params.sample_period_ns = 6'400'000;
        params.tolerance = {0.001f, seed % 2 == 0 ? 0.0044f : 1.2e-4f};
        params.delay_records = 8 + dice.below(113);
        params.restart_interval_ns = seed % 3 == 0   ? wire::every_frame_ns
                                     : seed % 3 == 1 ? 10'000'000
                                                     : wire::never_ns;
        const double size = std::pow(10.0, 4.3 * dice.unit()), often = dice.unit();
        Checked<Both> run{params};
        std::int64_t t = 0;
        double x[3]{}, turn[3]{};
        for (int i = 0; i < 400; ++i) {
            for (auto& one : x)
                if (dice.chance(often)) one = size * (dice.chance(0.5) ? 1 : -1) * dice.unit();
            for (auto& one : turn)
                if (dice.chance(often)) one = 1.8 * (2 * dice.unit() - 1);
            run.push(
                t,
                {{static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])},
                 turned(turn[0], turn[1], turn[2])},
                3, 0, i == 0);
            t += params.sample_period_ns * (20 + (dice.chance(0.2) ? dice.below(60) : 0)) / 64;
        }
        run.finish();
        ASSERT_TRUE(run.check.good())
            << "seed " << seed << ": " << run.check.first_fault << ", overflows "
            << run.check.encoder.overflows() << ", failures " << run.check.encoder.check_failures();
    }
}

TEST(StreamEncoder, AFlushMayComeAtAnyTime) {
    for (const double spacing : {0.35, 0.5, 0.8, 1.0}) {
        typename Both::Params params;
        params.sample_period_ns = 6'400'000;
        params.tolerance = {0.001f, 0.0044f};
        Checked<Both> run{params};
        std::int64_t t = 0;
        for (int i = 0; i < 500; ++i) {
            const float x = 0.1f * std::sin(0.9f * static_cast<float>(i));
            run.push(t, {{x, -x, 0}, turned(x, 0, 0)}, 3, 0, i == 0);
            t += static_cast<std::int64_t>(spacing * static_cast<double>(params.sample_period_ns));
            if (i % 7 < 2) run.check.flush();  // with 0.5 a record comes at the very end
        }
        run.finish();
        ASSERT_TRUE(run.check.good()) << "spacing " << spacing << ": " << run.check.first_fault;
    }
}

TEST(StreamEncoder, ATimeThatDoesNotRiseBeginsARunWithoutItsFlag) {
    typename Turning::Params params;
    params.tolerance = {0.0044f};
    params.sample_period_ns = 10'000'000;
    params.delay_records = 30;
    auto encoder = std::make_unique<Turning>(params);
    std::mt19937 random{7};
    std::int64_t t = 0;
    std::uint32_t back = 0;
    for (int i = 0; i < 4000; ++i) {
        const bool falls = random() % 97 == 0;
        back += falls ? 1 : 0;
        t = falls ? t - static_cast<std::int64_t>(random()) * (random() % 2 == 0 ? 1 : 100'000)
                  : t + 10'000'000;
        static_cast<void>(
            encoder->push(t, {turned(0.001f * static_cast<float>(i % 500), 0, 0)}, 1, 0, i == 0));
    }
    EXPECT_EQ(encoder->run(), back);  // the first run has the number 0
    EXPECT_EQ(encoder->check_failures(), 0u);
}

TEST(StreamEncoder, RefusedParametersNameTheirField) {
    Both::Params params;
    params.tolerance = {0.001f, 0.0044f};
    EXPECT_EQ(Both::check(params).status, Status::ok);
    const auto refused = [&](auto change) {
        Both::Params p = params;
        change(p);
        const Check check = Both::check(p);
        EXPECT_EQ(check.status, Status::bad_argument);
        Both encoder{p};
        EXPECT_EQ(encoder.push(0, {}, 3, 0, false).status, Status::bad_argument);
        EXPECT_FALSE(encoder.push_event({}));
        return std::string{check.field};
    };
    EXPECT_EQ(refused([](auto& p) { p.sample_period_ns = 0; }), "sample_period_ns");
    EXPECT_EQ(refused([](auto& p) { p.delay_records = 121; }), "delay_records");
    EXPECT_EQ(refused([](auto& p) { p.delay_records = 0; }), "delay_records");
    EXPECT_EQ(refused([](auto& p) { p.tolerance[0] = 0; }), "tolerance");
    EXPECT_EQ(refused([](auto& p) { p.tolerance[1] = 1e-5f; }), "tolerance");
    EXPECT_EQ(refused([](auto& p) { p.tolerance[0] = NAN; }), "tolerance");
    EXPECT_EQ(refused([](auto& p) { p.restart_interval_ns = -1; }), "restart_interval_ns");
    EXPECT_EQ(refused([](auto& p) { p.header_interval_ns = 0; }), "header_interval_ns");
    EXPECT_EQ(refused([](auto& p) { p.gap_ns = -1; }), "gap_ns");
}

TEST(StreamEncoder, TheHeaderTellsEachToleranceAndHardlyMore) {
    Dice dice{std::mt19937_64{11}};
    const auto decade = [&dice](double from, double to) {
        return static_cast<float>(std::pow(10, from + (to - from) * dice.unit()));
    };
    for (int i = 0; i < 100; ++i) {
        Both::Params params;
        const std::array<float, 3> metres{decade(-4, 0), decade(-4, 0), decade(-4, 0)};
        params.tolerance = {metres, decade(-3, -1)};
        ASSERT_TRUE(Both::check(params));
        auto encoder = std::make_unique<Both>(params);
        std::vector<std::uint8_t> bytes;
        const auto keep = [&bytes](const Bytes& out) {
            bytes.insert(bytes.end(), out.begin(), out.end());
            return out.status != Status::end;
        };
        for (int k = 0; k < 5; ++k)
            keep(encoder->push(k * params.sample_period_ns, {{0, 0, 0}, Quat{}}, 3, 0, k == 0));
        while (keep(encoder->flush())) continue;
        wire::Header header;
        const std::size_t size = wire::frame_size(bytes[0], bytes[1]);
        ASSERT_EQ(read_header(bytes.data(), size, header), wire::HeaderFault::none);
        for (std::size_t c = 0; c < 2; ++c) {
            const wire::ChannelShape& shape = header.shape.channel[c];
            double most = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const double step = shape.step[a].step<double>();
                const double due = static_cast<double>(params.tolerance[c][c == 0 ? a : 0]);
                most = std::max(most, due / step * 32768);
            }
            EXPECT_GE(shape.tolerance, most);
            EXPECT_LE(shape.tolerance, most + 2) << "rounded up once";
        }
    }
}

/// What the header of an encoder with these parameters says of times.
wire::FrameTiming timing_of(const Turning::Params& params) {
    auto encoder = std::make_unique<Turning>(params);
    const Bytes bytes = encoder->push(0, {Quat{}}, 1, 0, true);
    wire::Header header;
    if (bytes.empty() ||
        wire::read_header(bytes.data, wire::frame_size(bytes.data[0], bytes.data[1]), header) !=
            wire::HeaderFault::none)
        ADD_FAILURE() << "no header with the first record";
    return header.shape.timing;
}

TEST(StreamEncoder, TheHeaderTellsHowFarApartRestartsAreAndEnoughOfATime) {
    Turning::Params params;
    params.tolerance = {0.0044f};
    params.sample_period_ns = 6'400'000;
    params.delay_records = 32;
    const wire::FrameTiming usual = timing_of(params);
    const std::int64_t tick_ns = std::int64_t{usual.sub_ns} * 64;
    EXPECT_EQ(tick_ns, params.sample_period_ns);
    const std::int64_t frame_ns = usual.usual_ticks * tick_ns;
    const auto told = [&](std::int64_t interval_ns) {
        params.restart_interval_ns = interval_ns;
        return int{timing_of(params).restart_frames};
    };
    for (const int frames : {2, 3, 254, 255}) {
        EXPECT_EQ(told(frames * frame_ns), frames);
        EXPECT_EQ(told((frames + 1) * frame_ns - 1), frames);
    }
    EXPECT_EQ(told(frame_ns), 2) << "never one behind the other";
    EXPECT_EQ(told(256 * frame_ns), 0) << "more than the header tells";
    EXPECT_EQ(told(wire::never_ns), 0);
    EXPECT_EQ(told(wire::every_frame_ns), 0);
    params.restart_interval_ns = 1'000'000'000;
    for (const std::int64_t ms : {1000, 5000, 14'000, 15'000, 16'000, 60'000, 3'600'000}) {
        params.header_interval_ns = ms * 1'000'000;
        const std::int64_t reach_ns = std::min<std::int64_t>(2 * ms, 30'000) * 1'000'000;
        const std::int64_t span_ns = tick_ns * wire::unwraps << timing_of(params).time_bits;
        EXPECT_GE(span_ns, reach_ns + tick_ns) << ms;
        EXPECT_LT(span_ns / 2, std::max(reach_ns + 3 * tick_ns, tick_ns * wire::unwraps * 32))
            << ms;
    }
}

TEST(StreamEncoder, EventsComeOutExactlyAndOnce) {
    Both::Params params;
    params.tolerance = {0.001f, 0.0044f};
    params.event_delay_records = 3;
    auto encoder = std::make_unique<Both>(params);
    wire::Decoder<3, 1> decoder;
    std::vector<Event> sent, told;
    Dice dice{std::mt19937_64{3}};
    const auto take = [&](const Bytes& bytes) {
        for (const std::uint8_t b : bytes) {
            if (!decoder.push(b)) continue;
            Event event;
            while (decoder.next_event(event)) told.push_back(event);
        }
    };
    for (int i = 0; i < 3000; ++i) {
        if (dice.chance(0.1)) {
            const Event event{static_cast<std::int64_t>(dice.engine()),
                              static_cast<std::uint16_t>(dice.below(4)),
                              static_cast<std::uint16_t>(dice.engine()), 0};
            if (encoder->push_event(event)) sent.push_back(event);
        }
        take(encoder->push(i * params.sample_period_ns, {{0, 0, 0}, Quat{}}, 3, 0, false));
    }
    for (Bytes out; out.status != Status::end; take(out)) out = encoder->flush();
    ASSERT_EQ(told.size(), sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) {
        EXPECT_EQ(told[i].t_ns, sent[i].t_ns);
        EXPECT_EQ(told[i].channel, sent[i].channel);
        EXPECT_EQ(told[i].value, sent[i].value);
    }
    EXPECT_EQ(decoder.event_counters().lost, encoder->refused_events());
}

TEST(StreamEncoder, ACurveMayBeginAtTheWorstPlacesOfTheGrid) {
    // four components alike: each of the three that are told moves the fourth
    Dice dice{std::mt19937_64{9}};
    for (int i = 0; i < 300; ++i) {
        Turning::Params params;
        params.tolerance = {static_cast<float>(0.002 + 0.05 * dice.unit())};
        params.delay_records = 16;
        StreamCheck<Turning, wire::Decoder<3, 1>> check{params};
        const auto near_half = [&] {
            return static_cast<float>(dice.chance(0.5) ? 0.5 : -0.5) +
                   static_cast<float>(1e-4 * dice.unit());
        };
        const Quat q = normalised(Quat{near_half(), near_half(), near_half(), near_half()});
        for (int k = 0; k < 20; ++k) check.push(k * params.sample_period_ns, {q}, 1, 0, false);
        check.finish();
        ASSERT_TRUE(check.good()) << i << ": " << check.first_fault;
    }
}

std::size_t bytes_of_a_minute_at_rest(std::int64_t header_interval_ns) {
    Both::Params params;
    params.tolerance = {0.001f, 0.0043633f};
    params.delay_records = 120;
    params.header_interval_ns = header_interval_ns;
    auto encoder = std::make_unique<Both>(params);
    std::size_t bytes = 0;
    for (int i = 0; i < 7200; ++i)
        bytes += encoder
                     ->push(i * params.sample_period_ns,
                            {{0.3f, 1.2f, 1.6f}, Quat{0.5f, 0.5f, 0.5f, 0.5f}}, 3, 0, false)
                     .size;
    for (Bytes out; out.status != Status::end; bytes += out.size) out = encoder->flush();
    return bytes;
}

TEST(StreamEncoder, AMinuteAtRestIsSmall) {
    const std::size_t bytes = bytes_of_a_minute_at_rest(Both::Params{}.header_interval_ns);
    EXPECT_LE(bytes, 800u);
    std::printf("%zu bytes\n", bytes);
}

TEST(StreamEncoder, AHeaderCostsFortyBytesAtMost) {
    // docs/gateway.md has the price of each interval; restarts tell shorter times between headers
    const std::size_t usual = bytes_of_a_minute_at_rest(60'000'000'000);
    for (const std::int64_t seconds : {30, 15, 10}) {
        const std::size_t bytes = bytes_of_a_minute_at_rest(seconds * 1'000'000'000);
        const auto more = static_cast<std::size_t>(60 / seconds - 1);
        EXPECT_LE(bytes, usual + 40 * more) << seconds;
        EXPECT_GE(bytes, usual + 30 * more) << seconds;
        std::printf("a header every %d s: %zu bytes\n", static_cast<int>(seconds), bytes);
    }
}

}  // namespace
}  // namespace fairlead::test
