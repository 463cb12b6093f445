// The sampling loop in virtual time, on a chip model with injected faults. What the chip produced
// is known sample by sample, so that no loss can hide: every hole in the stream must carry
// gap_before.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "host_sim/chip_models/bmi088_model.hpp"
#include "host_sim/chip_models/bmi_model.hpp"
#include "host_sim/chip_models/icm20948_model.hpp"
#include "host_sim/chip_models/icm42688_model.hpp"
#include "host_sim/chip_models/icm456xx_model.hpp"
#include "host_sim/chip_models/lsm6_model.hpp"
#include "host_sim/chip_models/mpu6xxx_model.hpp"
#include "port/linux/imu_loop.hpp"
#include "port/sensors/chips.hpp"
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
    EXPECT_LT(bus.transfers - before, 110) << "back-off: one look every 40 ms and its timeout";
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

/// A stand-in for the BMI270's configuration file; the model takes this one and no other.
const std::vector<std::uint8_t> the_blob(64, 0x5A);

template <class Config>
Config with_watermark(std::uint8_t watermark) {
    Config config;
    config.watermark = watermark;
    if constexpr (detail::HasBlob<Config>::value) {
        config.blob = the_blob.data();
        config.blob_size = the_blob.size();
    }
    return config;
}

/// A minute of any chip's stream with 1 % of the transfers refused, an edge in 200 missing and two
/// losses of power. The gyroscope tells the true time of each sample, in its own counts, so that no
/// loss can hide: each must be flagged and counted.
template <class Chip, class Make>
void a_minute_of_faults(Chip, Make make, std::uint8_t watermark) {
    SCOPED_TRACE(testing::Message() << Chip::info.parts << ", watermark " << int{watermark});
    using Driver = typename Chip::template Driver<ModelBus>;
    const auto config = with_watermark<typename Driver::Config>(watermark);
    double count = 0;  // rad/s: what a driver knows once it has started
    {
        const auto chip = make([](std::int64_t) { return Truth{}; });
        ModelBus bus;
        bus.chips = {chip.get()};
        Driver imu{bus};
        ASSERT_EQ(imu.start(config), Status::ok);
        count = static_cast<double>(imu.scale().gyro_rad_s);
    }
    const auto face = [&count](std::int64_t t_ns) {
        const std::int64_t tenths = t_ns / 100000;
        Truth truth;
        truth.gyro_rad_s = {static_cast<float>(static_cast<double>(tenths % 10000) * count),
                            static_cast<float>(static_cast<double>(tenths / 10000) * count), 0};
        return truth;
    };
    const auto chip = make(face);
    ModelBus bus;
    bus.chips = {chip.get()};
    ModelEdges edges{bus, *chip};
    Driver imu{bus};
    Sampler<Driver, ModelEdges, VirtualClock> loop{imu, edges, VirtualClock{&bus}};
    ASSERT_EQ(loop.start(config), Status::ok);
    const double period_ms = static_cast<double>(imu.period_ns()) * 1e-6;
    edges.lose_every = 200;
    std::mt19937 random{4711};
    std::uniform_real_distribution<double> chance{0, 1};
    Batch batch;
    std::uint64_t seen = 0, holes = 0, flags = 0, resets = 0;
    double lost = 0, longest_ms = 0, worst_ms = 0, before_ms = -1;
    std::int64_t last_ns = 0;
    const std::int64_t begin_ns = bus.now_ns;
    while (bus.now_ns < begin_ns + 60000000000) {
        if (bus.now_ns > begin_ns + static_cast<std::int64_t>(20000000000 * (resets + 1)) &&
            resets < 2) {
            chip->power_cycle();
            ++resets;
        }
        bus.fail_at = chance(random) < 0.01 ? bus.transfers : -1;
        static_cast<void>(loop.step(batch));
        for (std::size_t i = 0; i < batch.count; ++i) {
            const Sample& s = batch.samples[i];
            const double low = std::round(static_cast<double>(s.gyro_rad_s.x) / count);
            const double high = std::round(static_cast<double>(s.gyro_rad_s.y) / count);
            const double t_ms = 0.1 * low + 1000 * high;
            if (before_ms >= 0) {
                EXPECT_GT(s.t_ns, last_ns);
                EXPECT_GT(t_ms, before_ms) << "a sample came twice";
                const double missing = std::round((t_ms - before_ms) / period_ms) - 1;
                if (missing > 0) {
                    ++holes;
                    lost += missing;
                    longest_ms = std::max(longest_ms, t_ms - before_ms);
                    EXPECT_TRUE(s.flags & flag::gap_before) << "a silent loss at " << t_ms;
                }
                if ((s.flags & flag::gap_before) != 0) ++flags;
            }
            ++seen;
            if (seen > 200)
                worst_ms = std::max(worst_ms, std::abs(static_cast<double>(s.t_ns) * 1e-6 - t_ms));
            before_ms = t_ms;
            last_ns = s.t_ns;
        }
    }
    const SamplerCounts& c = loop.counts();
    EXPECT_EQ(c.samples, seen);
    EXPECT_GT(static_cast<double>(seen) + lost, 59e3 / period_ms);
    EXPECT_LT(lost, 0.05 * 60e3 / period_ms);
    EXPECT_EQ(flags, holes);
    EXPECT_GE(c.restarts, 3u);
    EXPECT_NEAR(static_cast<double>(c.lost), lost, 0.5 * static_cast<double>(holes) + 2);
    EXPECT_LT(longest_ms, 350) << "the stream goes on";
    EXPECT_LT(worst_ms, 1.5 * period_ms + 0.2);
}

TEST(Sampler, AMinuteOfFaultsOfEveryFamilyLosesNothingSilently) {
    using Bmi = sim::BmiModel;
    using Lsm = sim::Lsm6Model;
    for (const std::uint8_t watermark : {std::uint8_t{0}, std::uint8_t{8}}) {
        const auto run = [&](auto chip, auto make) { a_minute_of_faults(chip, make, watermark); };
        run(chips::Icm42688{}, [](auto m) { return std::make_unique<sim::Icm42688Model>(m); });
        run(chips::Icm45686{}, [](auto m) { return std::make_unique<sim::Icm456xxModel>(m); });
        run(chips::Icm20948{}, [](auto m) { return std::make_unique<sim::Icm20948Model>(m); });
        run(chips::Lsm6dso{}, [](auto m) { return std::make_unique<Lsm>(Lsm::Kind::dso, m); });
        run(chips::Lsm6dsv{}, [](auto m) { return std::make_unique<Lsm>(Lsm::Kind::dsv, m); });
        run(chips::Mpu6050{}, [](auto m) { return std::make_unique<sim::Mpu6xxxModel>(m); });
        run(chips::Bmi160{}, [](auto m) { return std::make_unique<Bmi>(Bmi::Kind::bmi160, m); });
        run(chips::Bmi270{},
            [](auto m) { return std::make_unique<Bmi>(Bmi::Kind::bmi270, m, the_blob); });
        run(chips::Bmi088{}, [](auto m) { return std::make_unique<sim::Bmi088Model>(m); });
    }
}

/// How long after a fault has ended the first sample arrives, per family, rate near 400 Hz.
template <class Driver, class Model, class... Arguments>
void recovers(const char* part, std::uint8_t watermark, Arguments... arguments) {
    struct Fault {
        const char* name;
        double chip_ms;   // how long the chip takes to start
        double lasts_ms;  // how long the fault itself lasts
    };
    constexpr double nominal = -1;
    const Fault faults[] = {
        {"reset", nominal, 0},       {"reset, quick start", 0, 0}, {"reset, 35 ms start", 35, 0},
        {"stuck bus", nominal, 120}, {"nacks", nominal, 60},       {"no edges", nominal, 100},
        {"stall", nominal, 700},     {"power off", nominal, 2000},
    };
    for (const Fault& fault : faults) {
        for (int phase = 0; phase < 7; ++phase) {  // of the fault against the FIFO and the edges
            Model chip{arguments...};
            if (fault.chip_ms != nominal)
                chip.start_up_ns = static_cast<std::int64_t>(fault.chip_ms * 1e6);
            ModelBus bus;
            bus.chips = {&chip};
            ModelEdges edges{bus, chip};
            Driver imu{bus};
            Sampler<Driver, ModelEdges, VirtualClock> loop{imu, edges, VirtualClock{&bus}};
            typename Driver::Config config;
            config.watermark = watermark;
            ASSERT_EQ(loop.start(config), Status::ok);
            Batch batch;
            std::int64_t last_ns = 0;
            const auto run_until = [&](std::int64_t t_ns) {
                while (bus.now_ns < t_ns) {
                    static_cast<void>(loop.step(batch));
                    if (batch.count > 0) last_ns = batch.samples[batch.count - 1].t_ns;
                }
            };
            run_until(bus.now_ns + 400000000 + phase * 3100000);
            const std::uint64_t told = loop.counts().lost;
            const std::int64_t end_ns =
                bus.now_ns + static_cast<std::int64_t>(fault.lasts_ms * 1e6);
            const std::string name = fault.name;
            const std::int64_t start_up_ns = chip.start_up_ns;
            if (name == "power off") {
                chip.start_up_ns = end_ns - bus.now_ns;
                chip.power_cycle();
                chip.start_up_ns = start_up_ns;
            }
            if (name == "stuck bus") bus.stuck = true;
            if (name == "nacks") bus.fail_always = true;
            if (name == "no edges") edges.lose_every = 1;
            if (name == "stall") bus.pass(end_ns - bus.now_ns);
            if (name.rfind("reset", 0) == 0) chip.power_cycle();
            run_until(end_ns);
            bus.stuck = bus.fail_always = false;
            edges.lose_every = 0;
            const std::int64_t healed_ns = bus.now_ns, before_ns = last_ns;
            batch.clear();
            while (batch.count == 0 && bus.now_ns < healed_ns + 1000000000)
                static_cast<void>(loop.step(batch));
            const double after_ms = static_cast<double>(bus.now_ns - healed_ns) * 1e-6;
            EXPECT_LT(after_ms, 100) << part << ", watermark " << int{watermark} << ": "
                                     << fault.name << " in phase " << phase;
            ASSERT_GT(batch.count, 0u);
            const std::int64_t hole = batch.samples[0].t_ns - before_ns;
            EXPECT_GT(hole, 0);
            if (hole > imu.period_ns() * 3 / 2) {
                EXPECT_TRUE(batch.samples[0].flags & flag::gap_before) << part << fault.name;
                EXPECT_GT(loop.counts().lost, told) << part << fault.name;
            }
        }
    }
}

TEST(Sampler, GoesOnWithin100MsOfTheEndOfEveryFault) {
    using Kind = sim::Lsm6Model::Kind;
    for (const std::uint8_t watermark : {std::uint8_t{0}, std::uint8_t{8}}) {
        recovers<Icm426xx<ModelBus>, sim::Icm42688Model>("ICM-42688-P", watermark, clock_face);
        recovers<Lsm6dso<ModelBus>, sim::Lsm6Model>("LSM6DSO", watermark, Kind::dso, clock_face);
        recovers<Lsm6dsv<ModelBus>, sim::Lsm6Model>("LSM6DSV", watermark, Kind::dsv, clock_face);
        for (const int id : {0x68, 0x70, 0x71, 0x78})
            recovers<Mpu6xxx<ModelBus>, sim::Mpu6xxxModel>("MPU family", watermark, clock_face,
                                                           static_cast<std::uint8_t>(id));
    }
}

TEST(Sampler, TheSlowestStartOfTheDataSheetIsWaitedFor) {
    sim::Mpu6xxxModel chip{clock_face};
    chip.start_up_ns = 99000000;  // of at most 100 ms
    ModelBus bus;
    bus.chips = {&chip};
    ModelEdges edges{bus, chip};
    Mpu6xxx<ModelBus> imu{bus};
    Sampler<Mpu6xxx<ModelBus>, ModelEdges, VirtualClock> loop{imu, edges, VirtualClock{&bus}};
    ASSERT_EQ(loop.start({}), Status::ok);
    Batch batch;
    const std::int64_t start_ns = bus.now_ns;
    while (bus.now_ns < start_ns + 200000000) static_cast<void>(loop.step(batch));
    chip.power_cycle();
    const std::int64_t fault_ns = bus.now_ns;
    batch.clear();
    while (batch.count == 0 && bus.now_ns < fault_ns + 1000000000)
        static_cast<void>(loop.step(batch));
    EXPECT_LT(static_cast<double>(bus.now_ns - fault_ns) * 1e-6, 99 + 70);
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
