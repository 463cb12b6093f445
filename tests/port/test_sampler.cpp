// The sampling loop in virtual time, on a chip model with injected faults. What the chip produced
// is known sample by sample, so that no loss can hide: every hole in the stream must carry
// gap_before.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "host_sim/models/icm42688_model.hpp"
#include "host_sim/models/lsm6_model.hpp"
#include "host_sim/models/mpu6xxx_model.hpp"
#include "port/linux/sampler.hpp"
#include "port/sensors/icm426xx.hpp"
#include "port/sensors/lsm6.hpp"
#include "port/sensors/mpu6xxx.hpp"
#include "tests/port/model_bus.hpp"

namespace fairlead::port {
namespace {

using sim::Truth;
using test::ModelBus;
using test::ModelEdges;

/// The gyroscope's counts spell the time in steps of 0.1 ms: x holds the low digits, y the high.
constexpr double count_rad_s = 70e-3 * sim::pi / 180;
Truth clock_face(std::int64_t t_ns) {
    const std::int64_t tenths = t_ns / 100000;
    Truth truth;
    truth.gyro_rad_s = {static_cast<float>(static_cast<double>(tenths % 10000) * count_rad_s),
                        static_cast<float>(static_cast<double>(tenths / 10000) * count_rad_s), 0};
    return truth;
}
double true_ms(const Sample& s) {
    return std::round(static_cast<double>(s.gyro_rad_s.x) / count_rad_s) * 0.1 +
           std::round(static_cast<double>(s.gyro_rad_s.y) / count_rad_s) * 1000;
}

struct VirtualClock {
    ModelBus* bus;
    std::int64_t now() const noexcept { return bus->now_ns; }
};

using Imu = Lsm6dso<ModelBus>;
using Loop = Sampler<Imu, ModelEdges, VirtualClock>;

class SamplerTest : public ::testing::Test {
  protected:
    static constexpr double period_ms = 16e3 / 6667;

    SamplerTest() { bus.chips = {&chip}; }

    void start(std::uint8_t watermark) {
        Imu::Config config;
        config.watermark = watermark;
        ASSERT_EQ(loop.start(config), Status::ok);
    }

    /// Runs for a while, and checks the stream against the truth as it comes.
    void run_ms(std::int64_t ms) {
        const std::int64_t end = bus.now_ns + ms * 1000000;
        Batch batch;
        while (bus.now_ns < end) {
            if (nack_chance > 0) bus.fail_at = chance(random) < nack_chance ? bus.transfers : -1;
            const Status s = loop.step(batch);
            if (s != Status::ok) ++failures;
            for (std::size_t i = 0; i < batch.count; ++i) look_at(batch.samples[i]);
        }
        bus.fail_at = -1;
    }

    void look_at(const Sample& s) {
        const double t = true_ms(s);
        if (seen > 0) {
            EXPECT_GT(s.t_ns, last_ns);
            const double missing = std::round((t - last_true_ms) / period_ms) - 1;
            EXPECT_GT(t, last_true_ms) << "a sample came twice";
            if (missing > 0) {
                ++holes;
                truly_lost += missing;
                longest_ms = std::max(longest_ms, t - last_true_ms);
                EXPECT_TRUE(s.flags & flag::gap_before) << "a silent loss at " << t << " ms";
            }
            if (s.flags & flag::gap_before) ++flags;
        }
        if (seen > 200)
            worst_ms = std::max(worst_ms, std::abs(static_cast<double>(s.t_ns) * 1e-6 - t));
        ++seen;
        last_ns = s.t_ns;
        last_true_ms = t;
    }

    sim::Lsm6Model chip{sim::Lsm6Model::Kind::dso, clock_face};
    ModelBus bus;
    ModelEdges edges{bus, chip};
    Imu imu{bus};
    Loop loop{imu, edges, VirtualClock{&bus}};

    std::mt19937 random{4711};
    std::uniform_real_distribution<double> chance{0, 1};
    double nack_chance{0};

    std::uint64_t seen{0}, holes{0}, flags{0}, failures{0};
    double truly_lost{0}, longest_ms{0}, worst_ms{0}, last_true_ms{0};
    std::int64_t last_ns{0};
};

TEST_F(SamplerTest, SixtySecondsLoseNothing) {
    start(8);
    run_ms(60000);
    EXPECT_GE(seen, 24900u);
    EXPECT_EQ(holes, 0u);
    EXPECT_EQ(flags, 0u);
    const SamplerCounts& c = loop.counts();
    EXPECT_EQ(c.lost + c.missed_edges + c.transfer_errors + c.overruns + c.resets + c.clock_jumps,
              0u);
    EXPECT_EQ(c.samples, seen);
    EXPECT_LT(worst_ms, 0.2) << "the truth itself is rounded to 0.1 ms";
}

TEST_F(SamplerTest, DataReadyModeStampsEachSampleWithItsEdge) {
    start(0);
    run_ms(10000);
    EXPECT_GE(seen, 4100u);
    EXPECT_EQ(holes, 0u);
    EXPECT_LT(worst_ms, 0.2);
    EXPECT_EQ(loop.counts().lost, 0u);
}

TEST_F(SamplerTest, MissedEdgesCostNothingWhereThereIsAFifo) {
    edges.lose_every = 20;
    start(8);
    run_ms(20000);
    EXPECT_GT(edges.lost, 20u);
    EXPECT_EQ(loop.counts().missed_edges, edges.lost);
    EXPECT_EQ(holes, 0u);
    EXPECT_EQ(loop.counts().lost, 0u);
    EXPECT_LT(worst_ms, 0.3);
}

TEST_F(SamplerTest, MissedEdgesInDataReadyModeAreCountedLosses) {
    edges.lose_every = 50;
    start(0);
    run_ms(10000);
    EXPECT_GT(edges.lost, 50u);
    EXPECT_EQ(static_cast<double>(loop.counts().lost), truly_lost);
    EXPECT_EQ(flags, holes);
}

TEST_F(SamplerTest, NacksMissedEdgesAndResetsAreNeverSilent) {
    nack_chance = 0.01;
    edges.lose_every = 200;
    start(8);
    run_ms(20000);
    EXPECT_EQ(holes, 0u) << "neither a missing acknowledge nor a missing edge loses a sample";
    chip.power_cycle();
    run_ms(20000);
    chip.power_cycle();
    run_ms(20000);
    const SamplerCounts& c = loop.counts();
    EXPECT_GT(c.transfer_errors, 10u);
    EXPECT_EQ(c.resets, 2u);
    EXPECT_EQ(holes, 2u);
    EXPECT_EQ(flags, holes);
    EXPECT_NEAR(static_cast<double>(c.lost), truly_lost, 2) << "estimated from the time between";
    EXPECT_LT(longest_ms, 100) << "the stream goes on";
}

TEST_F(SamplerTest, AStuckBusIsLeftAloneAndTakenUpAgain) {
    start(8);
    run_ms(1000);
    bus.stuck = true;
    const int before = bus.transfers;
    run_ms(5000);
    EXPECT_LT(bus.transfers - before, 30) << "back-off";
    EXPECT_GT(loop.counts().failed_restarts, 5u);
    bus.stuck = false;
    const std::uint64_t had = seen;
    run_ms(2000);
    EXPECT_GT(seen, had + 500);
    EXPECT_EQ(flags, holes);
    EXPECT_EQ(holes, 1u);
    EXPECT_NEAR(static_cast<double>(loop.counts().lost), truly_lost, 3);
}

TEST_F(SamplerTest, AClockThatJumpsIsNotBelieved) {
    start(8);
    run_ms(2000);
    edges.offset_ns = 1600000000LL * 1000000000LL;  // stamps of another clock
    run_ms(2000);
    EXPECT_GT(loop.counts().clock_jumps, 50u);
    EXPECT_EQ(holes, 0u);
    EXPECT_LT(worst_ms, 1.0) << "the chip's own clock carries on";
    edges.offset_ns = 0;
    run_ms(2000);
    EXPECT_EQ(flags, 0u);
    EXPECT_LT(worst_ms, 1.0);
}

TEST_F(SamplerTest, ALongPauseOfTheProgramIsAnOverrunThatIsSaid) {
    start(8);
    run_ms(1000);
    bus.pass(2000000000);  // the program slept for two seconds
    chip.edges.clear();
    run_ms(1000);
    EXPECT_GE(loop.counts().overruns, 1u);
    EXPECT_GE(holes, 1u);
    EXPECT_EQ(flags, holes);
    EXPECT_EQ(static_cast<double>(loop.counts().lost), truly_lost);
}

TEST_F(SamplerTest, AStepIsBounded) {
    start(8);
    Batch batch;
    edges.lose_every = 1;  // no edge ever again
    for (int i = 0; i < 200; ++i) {
        const std::int64_t before = bus.now_ns;
        const int transfers = bus.transfers;
        static_cast<void>(loop.step(batch));
        EXPECT_LT(bus.now_ns - before, 200000000);
        EXPECT_LT(bus.transfers - transfers, 80);
    }
    EXPECT_GT(loop.counts().samples, 1000u);
}

TEST_F(SamplerTest, AnAbsentSensorIsReportedAndFoundWhenItComes) {
    bus.chips.clear();
    Imu::Config config;
    config.watermark = 8;
    EXPECT_EQ(loop.start(config), Status::no_acknowledge);
    run_ms(1000);
    EXPECT_GT(loop.counts().failed_restarts, 3u);
    EXPECT_EQ(seen, 0u);
    bus.chips = {&chip};
    run_ms(2000);
    EXPECT_GT(seen, 400u);
}

/// The same loop drives every family.
template <class Driver, class Model>
void runs_clean(std::unique_ptr<Model> chip, std::uint8_t watermark, double samples_per_s) {
    ModelBus bus;
    bus.chips = {chip.get()};
    ModelEdges edges{bus, *chip};
    Driver imu{bus};
    Sampler<Driver, ModelEdges, VirtualClock> loop{imu, edges, VirtualClock{&bus}};
    typename Driver::Config config;
    config.watermark = watermark;
    ASSERT_EQ(loop.start(config), Status::ok);
    Batch batch;
    const std::int64_t start = bus.now_ns;
    while (bus.now_ns < start + 10000000000) EXPECT_EQ(loop.step(batch), Status::ok);
    EXPECT_EQ(loop.counts().lost, 0u);
    EXPECT_EQ(loop.counts().missed_edges, 0u);
    EXPECT_NEAR(static_cast<double>(loop.counts().samples), 10 * samples_per_s,
                0.01 * 10 * samples_per_s);
}

TEST(Sampler, DrivesEveryFamily) {
    using Kind = sim::Lsm6Model::Kind;
    for (const std::uint8_t watermark : {std::uint8_t{0}, std::uint8_t{10}}) {
        runs_clean<Icm426xx<ModelBus>>(std::make_unique<sim::Icm42688Model>(clock_face), watermark,
                                       500);
        runs_clean<Lsm6dso<ModelBus>>(std::make_unique<sim::Lsm6Model>(Kind::dso, clock_face),
                                      watermark, 416.7);
        runs_clean<Lsm6dsv<ModelBus>>(std::make_unique<sim::Lsm6Model>(Kind::dsv, clock_face),
                                      watermark, 480);
        runs_clean<Mpu6xxx<ModelBus>>(std::make_unique<sim::Mpu6xxxModel>(clock_face), watermark,
                                      500);
    }
}

}  // namespace
}  // namespace fairlead::port
