// The pipeline around its encoder: which records reach it, with which flags and limits, what each
// call says, what refused parameters do. The encoder is a book that notes what it is given; the
// bytes of the real one are tested with it.
#include "fairlead/pipeline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace fairlead;

constexpr std::int64_t ms = 1'000'000;
constexpr flag::Bits both = flag::position_valid | flag::orientation_valid;
constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();

/// Notes what a pipeline asks of its encoder. Limits as the real one has them: an eighth of a tick.
template <class Board>
struct Book {
    using Stream = StreamParams<typename Board::Channels, Board::delay_records_max>;
    using Record = typename detail::InputTraits<typename Board::Input>::Record;

    static constexpr Check check(const Stream& stream) noexcept {
        if (stream.stream_id == 666) return {Status::bad_argument, "stream_id"};
        return {};
    }
    static constexpr IntakeLimits limits(const Stream&, std::int64_t period_ns) noexcept {
        IntakeLimits out;
        out.spacing_min_ns = period_ns / 8;
        out.gap_ns = default_gap_ns(period_ns);
        out.gap_ns_max = 64 * period_ns;
        out.position_max_m = 3e5f;
        return out;
    }
    Book(const Stream&, std::uint32_t delay) noexcept : delay_records{delay} {}

    void set_period(std::int64_t period_ns) { periods.push_back(period_ns); }
    Bytes push(const Record& record) {
        const bool run = fresh || (record.flags & flag::new_run) != 0;
        fresh = false;
        if (run) {
            grid_ns = periods.back();
        } else {
            EXPECT_GE(record.t_ns - records.back().t_ns, grid_ns / 8);
            EXPECT_TRUE((record.flags & flag::gap_before) ||
                        record.t_ns - records.back().t_ns <= 64 * grid_ns);
        }
        records.push_back(record);
        return {&byte, 1, Status::ok};
    }
    Bytes idle() {
        ++idles;
        return {};
    }
    bool busy() const { return false; }
    Bytes flush() { return ++flushes % 3 == 0 ? Bytes{nullptr, 0, Status::end} : Bytes{&byte, 1}; }
    bool push_event(const Event& event) {
        events.push_back(event);
        return true;
    }
    void reset() {
        ++resets;
        fresh = true;
    }

    std::uint32_t delay_records;
    std::vector<Record> records;
    std::vector<std::int64_t> periods;
    std::vector<Event> events;
    std::int64_t grid_ns{0};
    int idles{0}, flushes{0}, resets{0};
    std::uint8_t byte{7};
    bool fresh{true};
};

template <class In, class Chosen, class AFilter = NoFilter>
struct BoardOf {
    using Input = In;
    using Channels = Chosen;
    using Filter = AFilter;
    static constexpr std::size_t delay_records_max = 120;
    static constexpr Beam beam = Beam::narrow;
    static constexpr std::size_t events_max = 4;
};
using PoseBoard = BoardOf<Pose, Channels<Position, Orientation>>;
using FilteredBoard = BoardOf<Pose, Channels<Position, Orientation>, PoseFilter<5>>;
using ImuBoard = BoardOf<Imu<AttitudeMode::imu>, Channels<Orientation>>;
using GyroBoard = BoardOf<Imu<AttitudeMode::gyro>, Channels<Orientation>>;
using ImuMagBoard = BoardOf<Imu<>, Channels<Orientation>, PoseFilter<3>>;
using JointBoard = BoardOf<VectorSample<5>, Channels<Vector<5>>>;

template <class Board>
using Chain = BasicPipeline<Board, Book>;

Pose pose_at(std::int64_t t_ns) {
    const auto t = static_cast<float>(static_cast<double>(t_ns % 1'000'000'007) * 1e-9);
    return {t_ns, {t, 1 - t, 2}, from_rotation_vector(Vec3{0.1f * t, 0.2f, 0}), both};
}

Sample sample_at(std::int64_t t_ns, flag::Bits flags) {
    return {t_ns, {0.01f, 0, 0}, {0, 0.1f, 9.8f}, {20, 0, -40}, flags, 25};
}

template <class Board>
std::unique_ptr<Chain<Board>> make(std::int64_t period_ns) {
    typename Chain<Board>::Params params;
    params.sample_period_ns = period_ns;
    return std::make_unique<Chain<Board>>(params);
}

/// Calls flush() until the end. @return bytes.
template <class AChain>
std::size_t drain(AChain& chain) {
    std::size_t bytes = 0;
    for (int calls = 0; calls < 100; ++calls) {
        const Bytes out = chain.flush();
        bytes += out.size;
        if (out.status == Status::end) return bytes;
    }
    ADD_FAILURE() << "flush() never ends";
    return bytes;
}

}  // namespace

TEST(Pipeline, GivesAcceptedRecordsToTheEncoder) {
    const auto chain = make<PoseBoard>(10 * ms);
    for (int i = 0; i < 20; ++i) {
        const Bytes out = chain->push(pose_at(i * 10 * ms));
        EXPECT_EQ(out.status, Status::ok);
        EXPECT_EQ(out.end() - out.begin(), 1);
        ASSERT_TRUE(chain->filtered());
        EXPECT_EQ(chain->filtered()->t_ns, i * 10 * ms);
    }
    EXPECT_EQ(chain->push(pose_at(190 * ms)).status, Status::refused);
    EXPECT_FALSE(chain->filtered());
    EXPECT_EQ(chain->push(pose_at(191 * ms)).status, Status::refused);
    EXPECT_EQ(chain->push(pose_at(191 * ms + 250'000)).status, Status::ok);
    EXPECT_EQ(chain->encoder().records.size(), 21u);
    EXPECT_EQ(chain->encoder().idles, 2);
    // of the delay, one record is the intake's
    EXPECT_EQ(chain->encoder().delay_records, 119u);
    EXPECT_EQ(chain->sample_period_ns(), 10 * ms);
}

TEST(Pipeline, SaysWhenNothingIsValid) {
    const auto poses = make<PoseBoard>(10 * ms);
    Pose pose = pose_at(0);
    pose.flags = 0;  // the valid bits forgotten
    EXPECT_EQ(poses->push(pose).status, Status::no_valid_data);
    pose = pose_at(10 * ms);
    pose.q_wb = {nan_f, 0, 0, 0};
    EXPECT_EQ(poses->push(pose).status, Status::ok);  // one channel is left
    pose.t_ns += 10 * ms;
    pose.p_w_m = {nan_f, 0, 0};
    EXPECT_EQ(poses->push(pose).status, Status::no_valid_data);
    EXPECT_EQ(poses->encoder().records.size(), 3u);  // each tells the time

    const auto only = make<BoardOf<Pose, Channels<Position>>>(10 * ms);
    pose = pose_at(0);
    pose.flags = flag::orientation_valid;
    EXPECT_EQ(only->push(pose).status, Status::no_valid_data);

    const auto imu = make<ImuBoard>(10 * ms);
    for (int i = 0; i < 50; ++i)
        EXPECT_EQ(imu->push(sample_at(i * 10 * ms, 0)).status, Status::no_valid_data);
    for (int i = 50; i < 100; ++i)
        EXPECT_EQ(imu->push(sample_at(i * 10 * ms, flag::gyro_valid)).status,
                  Status::no_valid_data);  // no gravity, no inclination
    EXPECT_TRUE(imu->encoder().records.empty());
    EXPECT_EQ(imu->push(sample_at(1000 * ms, flag::gyro_valid | flag::accel_valid)).status,
              Status::ok);
    ASSERT_TRUE(imu->pose());
    EXPECT_TRUE(imu->pose()->flags & flag::settling);
}

TEST(Pipeline, RefusedParametersMakeItInertAndNamed) {
    const auto field = [](auto change) {
        Chain<PoseBoard>::Params params;
        change(params);
        const auto chain = std::make_unique<Chain<PoseBoard>>(params);
        EXPECT_FALSE(chain->check());
        EXPECT_EQ(chain->check().status, Status::bad_argument);
        for (int i = 0; i < 3; ++i)
            EXPECT_EQ(chain->push(pose_at(i * 10 * ms)).status, Status::bad_argument);
        EXPECT_EQ(chain->idle().status, Status::bad_argument);
        EXPECT_FALSE(chain->push_event({}));
        EXPECT_EQ(drain(*chain), 0u);
        chain->reset();
        EXPECT_EQ(chain->push(pose_at(0)).status, Status::bad_argument);
        EXPECT_TRUE(chain->encoder().records.empty() && chain->encoder().events.empty());
        return std::string{chain->check().field};
    };
    static_assert(Chain<PoseBoard>::check({}), "the defaults are good");
    EXPECT_EQ(field([](auto& p) { p.sample_period_ns = -1; }), "sample_period_ns");
    EXPECT_EQ(field([](auto& p) { p.sample_period_ns = 124'999; }), "sample_period_ns");
    EXPECT_EQ(field([](auto& p) { p.sample_period_ns = 1'000'000'001; }), "sample_period_ns");
    EXPECT_EQ(field([](auto& p) { p.tolerance.position_m = 0; }), "tolerance.position_m");
    EXPECT_EQ(field([](auto& p) { p.tolerance.position_m[2] = nan_f; }), "tolerance.position_m");
    EXPECT_EQ(field([](auto& p) { p.tolerance.orientation_rad = 4e-7f; }),
              "tolerance.orientation_rad");
    EXPECT_EQ(field([](auto& p) { p.delay_records = 121; }), "delay_records");
    EXPECT_EQ(field([](auto& p) { p.delay_records = 15; }), "delay_records");
    EXPECT_EQ(field([](auto& p) { p.restart_interval_ns = -1; }), "restart_interval_ns");
    EXPECT_EQ(field([](auto& p) { p.header_interval_ns = 999'999'999; }), "header_interval_ns");
    EXPECT_EQ(field([](auto& p) { p.event_delay_records = 1'000'001; }), "event_delay_records");
    EXPECT_EQ(field([](auto& p) { p.stream_id = 666; }), "stream_id");  // the encoder's own check
    EXPECT_EQ(field([](auto& p) { p.intake.gap_ns = -1; }), "gap_ns");
    EXPECT_EQ(field([](auto& p) {
                  p.sample_period_ns = 10 * ms;
                  p.intake.gap_ns = 641 * ms;
              }),
              "gap_ns");
    EXPECT_EQ(field([](auto& p) { p.intake.position_max_m = 4e5f; }), "position_max_m");
}

TEST(Pipeline, RefusesAnAttitudeOrACalibrationThatCannotWork) {
    Chain<ImuBoard>::Params params;
    EXPECT_TRUE(Chain<ImuBoard>::check(params));
    params.attitude.step_s = 0;
    EXPECT_STREQ(Chain<ImuBoard>::check(params).field, "step_s");
    params.attitude = {};
    params.calibration.mag.matrix.z.y = nan_f;
    EXPECT_STREQ(Chain<ImuBoard>::check(params).field, "calibration");
    const auto chain = std::make_unique<Chain<ImuBoard>>(params);
    EXPECT_EQ(chain->push(sample_at(0, flag::gyro_valid | flag::accel_valid)).status,
              Status::bad_argument);
}

TEST(Pipeline, TheEdgesOfTheRangesAreGood) {
    Chain<PoseBoard>::Params params;
    params.sample_period_ns = 125'000;
    params.tolerance.position_m = std::array<float, 3>{1e-6f, 1e6f, 1};
    params.tolerance.orientation_rad = 1.2e-4f;
    params.delay_records = 16;
    params.restart_interval_ns = 0;
    params.header_interval_ns = never_ns;
    params.intake.gap_ns = 64 * 125'000;
    EXPECT_TRUE(Chain<PoseBoard>::check(params));
    params.sample_period_ns = 1'000'000'000;
    params.tolerance.orientation_rad = 0.5f;
    params.intake.gap_ns = 64'000 * ms;
    EXPECT_STREQ(Chain<PoseBoard>::check(params).field, "leap_ns");  // at least a gap
    params.intake.leap_ns = 64'000 * ms;
    EXPECT_TRUE(Chain<PoseBoard>::check(params));
}

TEST(Pipeline, ALoneWrongStampAndANewClockReachTheEncoderAsTheyShould) {
    const auto chain = make<FilteredBoard>(10 * ms);
    std::vector<std::int64_t> expected;
    const auto push = [&](std::int64_t t_ns, bool good = true) {
        chain->push(pose_at(t_ns));
        if (good) expected.push_back(t_ns);
    };
    for (int i = 0; i < 20; ++i) push(5000 * ms + i * 10 * ms);
    push(7, false);
    for (int i = 20; i < 40; ++i) push(5000 * ms + i * 10 * ms);
    for (int i = 0; i < 40; ++i) push(10 * ms + i * 10 * ms);
    for (int i = 0; i < 40; ++i) push(1'700'000'000'000 * ms + i * 10 * ms);
    drain(*chain);
    const auto& records = chain->encoder().records;
    ASSERT_EQ(records.size(), expected.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
        EXPECT_EQ(records[i].t_ns, expected[i]);
        EXPECT_EQ((records[i].flags & flag::new_run) != 0, i == 40 || i == 80) << i;
    }
    EXPECT_EQ(chain->intake().faults()[Fault::backward_time], 1u);
}

// The attitude filter stands between the intake and the encoder, and hands on that a run begins.
// first: valid bits of the sample with which it begins.
template <class Board>
void a_new_clock_reaches_the_encoder(flag::Bits first) {
    constexpr flag::Bits all = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
    const auto chain = make<Board>(10 * ms);
    std::vector<std::int64_t> expected;
    for (const std::int64_t base : {5000 * ms, 10 * ms, 1'700'000'000'000 * ms, 20 * ms})
        for (int i = 0; i < 40; ++i) {
            expected.push_back(base + i * 10 * ms);
            chain->push(sample_at(expected.back(), i == 0 && expected.size() > 1 ? first : all));
        }
    drain(*chain);
    const auto& records = chain->encoder().records;
    ASSERT_EQ(records.size(), expected.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
        EXPECT_EQ(records[i].t_ns, expected[i]);
        EXPECT_EQ((records[i].flags & flag::new_run) != 0, i > 0 && i % 40 == 0) << i;
        if (i % 40 != 0) {
            EXPECT_NE(records[i].flags & flag::orientation_valid, 0u) << i;
        }
    }
}
TEST(Pipeline, ANewClockPassesTheAttitudeFilter) {
    for (const flag::Bits first : {flag::gyro_valid | flag::accel_valid, +flag::accel_valid}) {
        a_new_clock_reaches_the_encoder<ImuBoard>(first);
        a_new_clock_reaches_the_encoder<ImuMagBoard>(first);
        a_new_clock_reaches_the_encoder<GyroBoard>(first);
    }
}

// Nothing given but the period itself, or not even that.
TEST(Pipeline, MeasuresThePeriod) {
    for (const std::int64_t period : {ms / 4, 8'333'333 * std::int64_t{1}, 40 * ms, 1000 * ms}) {
        const auto chain = make<FilteredBoard>(0);
        EXPECT_EQ(chain->sample_period_ns(), 0);
        for (int i = 0; i < 100; ++i) chain->push(pose_at(i * period));
        drain(*chain);
        EXPECT_EQ(chain->sample_period_ns(), period);
        EXPECT_EQ(chain->encoder().periods.size(), 1u);
        ASSERT_EQ(chain->encoder().records.size(), 100u);
        for (const Pose& pose : chain->encoder().records) EXPECT_EQ(pose.flags, both);
    }
}

// The first step tells nothing of the period: a run on the right grid follows, and every record is
// there, spaced as the grid of its run demands (the book checks it).
TEST(Pipeline, AWrongFirstStepIsMended) {
    constexpr std::int64_t period = 8 * ms;
    for (const std::int64_t first : {std::int64_t{20'000}, ms, 3 * ms, 30 * ms, 900 * ms}) {
        for (const bool filter : {false, true}) {
            SCOPED_TRACE(first);
            std::vector<std::int64_t> times{-first};
            for (int i = 0; i < 100; ++i) times.push_back(i * period);
            const auto run = [&](auto& chain) {
                for (const std::int64_t t : times) chain.push(pose_at(t));
                drain(chain);
                EXPECT_EQ(chain.sample_period_ns(), period);
                const auto& records = chain.encoder().records;
                ASSERT_EQ(records.size(), times.size());
                int runs = 0;
                for (std::size_t i = 0; i < records.size(); ++i) {
                    EXPECT_EQ(records[i].t_ns, times[i]);
                    runs += (records[i].flags & flag::new_run) != 0;
                }
                EXPECT_GE(runs, 1);
                EXPECT_LE(runs, 2);
                EXPECT_EQ(chain.encoder().grid_ns, period);
            };
            if (filter)
                run(*make<FilteredBoard>(0));
            else
                run(*make<PoseBoard>(0));
        }
    }
}

// Any steps at all while the period is measured, with a user's gap_ns beside: each record is taken
// or counted, and suits the grid of its run (the book checks it).
TEST(Pipeline, AnyStepsWhileThePeriodIsMeasured) {
    for (unsigned seed = 1; seed <= 3000; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937_64 random{seed};
        Chain<FilteredBoard>::Params params;
        const std::int64_t gaps[] = {0, 5 * ms, 300 * ms, 30'000 * ms};
        params.intake.gap_ns = gaps[random() % 4];
        const auto chain = std::make_unique<Chain<FilteredBoard>>(params);
        ASSERT_TRUE(chain->check()) << chain->check().field;
        const auto usual = static_cast<std::int64_t>(100'000 << random() % 14);
        std::int64_t t = static_cast<std::int64_t>(random() % 1000) * ms;
        std::size_t pushed = 0;
        for (int i = 0; i < 80; ++i) {
            std::int64_t step = usual;
            if (random() % 3 == 0) step = static_cast<std::int64_t>(10'000 << random() % 17);
            if (random() % 20 == 0) step = -step;
            chain->push(pose_at(t));
            ++pushed;
            t += step;
        }
        drain(*chain);
        const FaultCounts& f = chain->intake().faults();
        EXPECT_EQ(pushed, chain->encoder().records.size() + f[Fault::repeated_time] +
                              f[Fault::backward_time] + f[Fault::leap] + f[Fault::too_close]);
        EXPECT_FALSE(chain->intake().waiting());
        if (HasFailure()) return;
    }
}

TEST(Pipeline, OneRecordAloneIsCoveredThoughNoPeriodIsKnown) {
    const auto chain = make<PoseBoard>(0);
    chain->push(pose_at(123 * ms));
    EXPECT_TRUE(chain->encoder().records.empty());
    EXPECT_GT(drain(*chain), 0u);
    ASSERT_EQ(chain->encoder().records.size(), 1u);
    EXPECT_EQ(chain->encoder().periods.size(), 1u);
}

TEST(Pipeline, ResetForgetsEverythingButTheCounts) {
    for (const std::int64_t period : {std::int64_t{0}, 10 * ms}) {
        const auto chain = make<ImuMagBoard>(period);
        const flag::Bits all = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
        const auto feed = [&](std::int64_t from) {
            for (int i = 0; i < 300; ++i) chain->push(sample_at(from + i * 10 * ms, all));
        };
        feed(1'000'000 * ms);
        chain->push(sample_at(3, all));  // doubtful, and forgotten
        const auto first = chain->encoder().records;
        chain->reset();
        EXPECT_EQ(chain->encoder().resets, 1);
        EXPECT_FALSE(chain->pose());
        feed(0);
        chain->push(sample_at(-3, all));
        const auto& records = chain->encoder().records;
        ASSERT_EQ(records.size(), 2 * first.size());
        for (std::size_t i = 0; i < first.size(); ++i) {
            const auto &a = first[i], &b = records[first.size() + i];
            EXPECT_EQ(a.t_ns - 1'000'000 * ms, b.t_ns);
            EXPECT_EQ(a.flags, b.flags);
            EXPECT_EQ(a.q_wb.w, b.q_wb.w);
            EXPECT_EQ(a.q_wb.z, b.q_wb.z);
        }
    }
}

TEST(Pipeline, IdleGivesWhatWaitsAndEventsPass) {
    const auto chain = make<PoseBoard>(10 * ms);
    EXPECT_TRUE(chain->push_event({5, 1, 1, 0}));
    EXPECT_EQ(chain->idle().status, Status::ok);
    EXPECT_EQ(chain->encoder().events.size(), 1u);
    EXPECT_EQ(chain->encoder().idles, 1);
    chain->push(pose_at(500 * ms));
    chain->push(pose_at(10 * ms));
    EXPECT_EQ(chain->idle().size, 0u);  // doubtful: it stays
    chain->push(pose_at(20 * ms));
    EXPECT_EQ(chain->encoder().records.size(), 2u);
    EXPECT_EQ(chain->idle().size, 1u);
    EXPECT_EQ(chain->encoder().records.back().t_ns, 20 * ms);
    EXPECT_EQ(chain->push(pose_at(30 * ms)).size, 1u);
    EXPECT_EQ(chain->encoder().records.back().t_ns, 30 * ms);
}

TEST(Pipeline, FlushGivesTheFiltersLastRecordsOneACall) {
    const auto chain = make<FilteredBoard>(10 * ms);
    for (int i = 0; i < 6; ++i) chain->push(pose_at(i * 10 * ms));
    EXPECT_EQ(chain->encoder().records.size(), 4u);
    for (std::size_t n = 5; n <= 6; ++n) {
        EXPECT_EQ(chain->flush().status, Status::ok);
        EXPECT_EQ(chain->encoder().records.size(), n);
    }
    EXPECT_EQ(chain->encoder().flushes, 0);
    EXPECT_EQ(drain(*chain), 2u);
    EXPECT_EQ(chain->encoder().flushes, 3);
    EXPECT_EQ(chain->encoder().records.size(), 6u);
}

TEST(Pipeline, VectorsTakeTheSameWay) {
    const auto chain = make<JointBoard>(10 * ms);
    VectorSample<5> sample{0, {1, 2, 3, 4, 5}, flag::vector_valid};
    EXPECT_EQ(chain->push(sample).status, Status::ok);
    sample.t_ns = 10 * ms;
    sample.value[4] = nan_f;
    EXPECT_EQ(chain->push(sample).status, Status::no_valid_data);
    ASSERT_EQ(chain->encoder().records.size(), 2u);
    EXPECT_EQ(chain->encoder().records[0].value[4], 5);
}

// A range is the chip's: neither the calibration's scale nor the mounting may hide its end.
TEST(Pipeline, NoticesTheEndOfARangeBeforeCalibrationMovesIt) {
    Chain<ImuBoard>::Params params;
    params.sample_period_ns = 4 * ms;
    params.attitude.gyro_full_scale_rad_s = 4;
    params.attitude.accel_full_scale_m_s2 = 40;
    params.calibration.gyro.matrix = {{0.9f, 0, 0}, {0, 0.9f, 0}, {0, 0, 0.9f}};
    params.calibration.q_bs = from_rotation_vector(Vec3{0.5f, 0.4f, 0.3f});
    const auto chain = std::make_unique<Chain<ImuBoard>>(params);
    for (int i = 0; i < 1000; ++i) {
        Sample s = sample_at(i * 4 * ms, flag::gyro_valid | flag::accel_valid);
        const bool gyro = i == 700, accel = i == 800;
        if (gyro) s.gyro_rad_s.z = -4;
        if (accel) s.accel_m_s2.x = 40;
        chain->push(s);
        ASSERT_TRUE(chain->pose());
        ASSERT_EQ((chain->pose()->flags & flag::clipped) != 0, gyro || accel) << i;
    }
}

TEST(PeriodMeter, IsTheMedianOfTheFirstSteps) {
    PeriodMeter meter;
    EXPECT_EQ(meter.period_ns(), sample_period_max_ns);
    std::int64_t t = -77 * ms;
    int pushes = 0;
    for (const int step : {0, 900, 1, 5, 5, 4, 6, 5, 7, 3, 5, 900, 900, 900, 1, 1, 6, 5}) {
        t += step * ms;
        ++pushes;
        EXPECT_FALSE(meter.known());
        EXPECT_EQ(meter.push(t), pushes == 18);
        if (pushes == 6) {  // a pause does not count as a step
            meter.pause();
            t += 100'000 * ms;
            EXPECT_FALSE(meter.push(t));
        }
    }
    EXPECT_EQ(meter.period_ns(), 5 * ms);
    EXPECT_FALSE(meter.push(t + 50 * ms));
    EXPECT_EQ(meter.period_ns(), 5 * ms);
    meter.reset();
    EXPECT_FALSE(meter.known());
    EXPECT_EQ(PeriodMeter::clamped(124'999), 125'000);
    EXPECT_EQ(PeriodMeter::clamped(2'000'000'000), 1'000'000'000);
}
