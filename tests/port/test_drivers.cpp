// Every driver against its chip's model: identity and refusal, each setting read back, scales,
// bursts, FIFO with times, overrun, lost step, brown-out, self test; and the same with a failure at
// transfer k, for all k, on every path.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "host_sim/chip_models/bmi088_model.hpp"
#include "host_sim/chip_models/bmi_model.hpp"
#include "host_sim/chip_models/icm20948_model.hpp"
#include "host_sim/chip_models/icm42688_model.hpp"
#include "host_sim/chip_models/icm456xx_model.hpp"
#include "host_sim/chip_models/lsm6_model.hpp"
#include "host_sim/chip_models/mpu6xxx_model.hpp"
#include "port/sensors/bmi.hpp"
#include "port/sensors/bmi088.hpp"
#include "port/sensors/icm20948.hpp"
#include "port/sensors/icm426xx.hpp"
#include "port/sensors/icm456xx.hpp"
#include "port/sensors/lsm6.hpp"
#include "port/sensors/mpu6xxx.hpp"
#include "tests/port/driver_rig.hpp"

namespace fairlead::port {
namespace {

using test::fail_everywhere;
using test::ModelBus;
using test::ramp;
using test::Rig;
using test::Truth;

// One description per chip: the rest of this file is written once.
struct Icm42688 {
    using Model = sim::Icm42688Model;
    using Driver = Icm426xx<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(m); }
    static Driver::Config config(std::uint8_t watermark) {
        Driver::Config c;
        c.watermark = watermark;
        return c;
    }
    static constexpr std::uint8_t id = 0x47, id_reg = 0x75, address = 0x68;
    static constexpr double period_ns = 2e6, gyro_scale = 2000 / 32768.0 * sim::pi / 180;
    static constexpr double accel_scale = 16 / 32768.0 * sim::g_m_s2;
    static constexpr const char* name = "ICM-42688-P";
    static constexpr std::size_t fifo_samples = 128;
    static constexpr bool own_clock = true;
    static constexpr int looks = 0;
};
struct Lsm6dsoChip {
    using Model = sim::Lsm6Model;
    using Driver = Lsm6dso<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(Model::Kind::dso, m); }
    static Driver::Config config(std::uint8_t watermark) {
        Driver::Config c;
        c.watermark = watermark;
        return c;
    }
    static constexpr std::uint8_t id = 0x6C, id_reg = 0x0F, address = 0x6A;
    static constexpr double period_ns = 16e9 / 6667, gyro_scale = 70e-3 * sim::pi / 180;
    static constexpr double accel_scale = 0.488e-3 * sim::g_m_s2;
    static constexpr const char* name = "LSM6DSO";
    static constexpr std::size_t fifo_samples = 170;
    static constexpr bool own_clock = true;
    static constexpr int looks = 0;
};
struct Lsm6dsvChip {
    using Model = sim::Lsm6Model;
    using Driver = Lsm6dsv<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(Model::Kind::dsv, m); }
    static Driver::Config config(std::uint8_t watermark) {
        Driver::Config c;
        c.watermark = watermark;
        return c;
    }
    static constexpr std::uint8_t id = 0x70, id_reg = 0x0F, address = 0x6A;
    static constexpr double period_ns = 1e9 / 480, gyro_scale = 70e-3 * sim::pi / 180;
    static constexpr double accel_scale = 0.488e-3 * sim::g_m_s2;
    static constexpr const char* name = "LSM6DSV";
    static constexpr std::size_t fifo_samples = 85;
    static constexpr bool own_clock = true;
    static constexpr int looks = 0;
};
template <std::uint8_t Id>
struct MpuChip {
    using Model = sim::Mpu6xxxModel;
    using Driver = Mpu6xxx<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(m, Id); }
    static Driver::Config config(std::uint8_t watermark) {
        Driver::Config c;
        c.watermark = watermark;
        return c;
    }
    static constexpr std::uint8_t id = Id, id_reg = 0x75, address = 0x68;
    static constexpr double period_ns = 2e6, gyro_scale = 2000 / 32768.0 * sim::pi / 180;
    static constexpr double accel_scale = 16 / 32768.0 * sim::g_m_s2;
    static constexpr const char* name = Id == 0x68   ? "MPU-6050"
                                        : Id == 0x70 ? "MPU-6500"
                                        : Id == 0x71 ? "MPU-9250"
                                                     : "MPU-6880";
    static constexpr std::size_t fifo_samples = Id == 0x68 ? 73 : Id == 0x78 ? 292 : 36;
    static constexpr bool own_clock = false;
    static constexpr int looks = 23;  // one a ms for 11 ms, twice in a self test; and one before
};

/// A stand-in for the BMI270's configuration file; the model takes this one and no other.
std::vector<std::uint8_t> blob() {
    std::vector<std::uint8_t> bytes(250);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(7 * i + 3);
    return bytes;
}
const std::vector<std::uint8_t> the_blob = blob();

template <sim::BmiModel::Kind Kind>
struct BmiChip {
    static constexpr bool is_160 = Kind == sim::BmiModel::Kind::bmi160;
    using Model = sim::BmiModel;
    using Driver = std::conditional_t<is_160, Bmi160<ModelBus>, Bmi270<ModelBus>>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(Kind, m, the_blob); }
    static typename Driver::Config config(std::uint8_t watermark) {
        typename Driver::Config c;
        c.watermark = watermark;
        c.gyro = bmi::GyroRange::dps_1000;  // the ramp's steps stay below a period
        c.blob = the_blob.data();
        c.blob_size = the_blob.size();
        return c;
    }
    static constexpr std::uint8_t id = is_160 ? 0xD1 : 0x24, id_reg = 0x00, address = 0x68;
    static constexpr double period_ns = 2.5e6, gyro_scale = 1000 / 32768.0 * sim::pi / 180;
    static constexpr double accel_scale = 16 / 32768.0 * sim::g_m_s2;
    static constexpr const char* name = is_160 ? "BMI160" : "BMI270";
    static constexpr std::size_t fifo_samples = is_160 ? 84 : 169;
    static constexpr bool own_clock = false;
    static constexpr int looks = 0;
};
using Bmi160Chip = BmiChip<sim::BmiModel::Kind::bmi160>;
using Bmi270Chip = BmiChip<sim::BmiModel::Kind::bmi270>;
struct Bmi088Chip {
    using Model = sim::Bmi088Model;
    using Driver = Bmi088<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(m); }
    static Driver::Config config(std::uint8_t watermark) {
        Driver::Config c;
        c.watermark = watermark;
        c.gyro = bmi088::GyroRange::dps_1000;  // the ramp's steps stay below a period
        return c;
    }
    static constexpr std::uint8_t id = 0x0F, id_reg = 0x00, address = 0x68;
    static constexpr double period_ns = 2.5e6, gyro_scale = 1000 / 32768.0 * sim::pi / 180;
    static constexpr double accel_scale = 24 / 32768.0 * sim::g_m_s2;
    static constexpr const char* name = "BMI088";
    static constexpr std::size_t fifo_samples = 72;  // the accelerometer's FIFO is the shorter one
    static constexpr bool own_clock = false;
    static constexpr int looks = 0;
};
struct Icm45686Chip {
    using Model = sim::Icm456xxModel;
    using Driver = Icm456xx<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(m); }
    static Driver::Config config(std::uint8_t watermark) {
        Driver::Config c;
        c.watermark = watermark;
        c.gyro = icm456xx::GyroRange::dps_1000;  // the ramp's steps stay below a period
        return c;
    }
    static constexpr std::uint8_t id = 0xE9, id_reg = 0x72, address = 0x68;
    static constexpr double period_ns = 2.5e6, gyro_scale = 1000 / 32768.0 * sim::pi / 180;
    static constexpr double accel_scale = 16 / 32768.0 * sim::g_m_s2;
    static constexpr const char* name = "ICM-45686";
    static constexpr std::size_t fifo_samples = 300;  // of 512: as many as six batches hold
    static constexpr bool own_clock = true;
    static constexpr int looks = 0;
};
struct Icm20948Chip {
    using Model = sim::Icm20948Model;
    using Driver = Icm20948<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(m); }
    static Driver::Config config(std::uint8_t watermark) {
        Driver::Config c;
        c.watermark = watermark;
        return c;
    }
    static constexpr std::uint8_t id = 0xEA, id_reg = 0x00, address = 0x68;
    static constexpr double period_ns = 3e9 / 1125, gyro_scale = 2000 / 32768.0 * sim::pi / 180;
    static constexpr double accel_scale = 16 / 32768.0 * sim::g_m_s2;
    static constexpr const char* name = "ICM-20948";
    static constexpr std::size_t fifo_samples = 36;
    static constexpr bool own_clock = false;
    static constexpr int looks = 0;
};

/// How much older than its edge the acceleration of a sample may be.
template <class Chip>
constexpr double accel_late_s = std::is_same_v<Chip, Bmi088Chip> ? 1.25e-3 : 0;

template <class Chip>
constexpr bool has_self_test = !std::is_same_v<Chip, Icm45686Chip>;

template <class Chip>
class ImuDriver : public ::testing::Test {
  protected:
    ImuDriver() { bus.chips = {model.get()}; }

    std::unique_ptr<typename Chip::Model> model = Chip::model();
    ModelBus bus;
    typename Chip::Driver driver{bus};

    /// Until the chip raises its line; the time of the edge.
    std::int64_t next_edge() {
        test::ModelEdges edges{bus, *model};
        const auto edge = edges.wait(bus.now_ns + 1000000000);
        EXPECT_TRUE(edge);
        return edge ? *edge : 0;
    }
    std::int64_t newest_edge() {
        std::int64_t edge = next_edge();
        for (std::size_t i = 1; i < driver.watermark() / driver.samples_per_edge(); ++i)
            edge = next_edge();
        return edge;
    }
    /// The ramp says when the sample was really taken.
    static double true_time_ns(const Sample& s) {
        return static_cast<double>(s.gyro_rad_s.x) / 0.5 * 1e9;
    }
    void start(std::uint8_t watermark) {
        ASSERT_EQ(driver.start(Chip::config(watermark)), Status::ok);
        model->edges.clear();
    }
};

using Chips = ::testing::Types<Icm42688, Lsm6dsoChip, Lsm6dsvChip, MpuChip<0x68>, MpuChip<0x70>,
                               MpuChip<0x71>, MpuChip<0x78>, Bmi160Chip, Bmi270Chip, Icm45686Chip,
                               Icm20948Chip, Bmi088Chip>;
TYPED_TEST_SUITE(ImuDriver, Chips, );

TYPED_TEST(ImuDriver, ProbeReportsWhoAnswered) {
    const Probe p = this->driver.probe();
    EXPECT_EQ(p.status, Status::ok);
    EXPECT_EQ(p.address, TypeParam::address);
    EXPECT_EQ(p.reg, TypeParam::id_reg);
    EXPECT_EQ(p.got, TypeParam::id);
    EXPECT_STREQ(p.part, TypeParam::name);
    this->bus.chips.clear();
    EXPECT_EQ(this->driver.probe().status, Status::no_acknowledge);
}

TYPED_TEST(ImuDriver, SamplesAreInSiUnitsAndCarryTheEdgesTime) {
    this->start(0);
    for (int i = 0; i < 60; ++i) EXPECT_TRUE(this->driver.read(this->next_edge()));  // it settles
    const std::int64_t edge = this->next_edge();
    const auto sample = this->driver.read(edge);
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->t_ns, edge);
    const Truth truth = ramp(edge);
    EXPECT_NEAR(sample->gyro_rad_s.x, truth.gyro_rad_s.x, TypeParam::gyro_scale / 2 * 1.001);
    EXPECT_NEAR(sample->gyro_rad_s.y, truth.gyro_rad_s.y, TypeParam::gyro_scale / 2 * 1.001);
    EXPECT_NEAR(sample->gyro_rad_s.z, truth.gyro_rad_s.z, TypeParam::gyro_scale / 2 * 1.001);
    EXPECT_NEAR(sample->accel_m_s2.x, truth.accel_m_s2.x,
                TypeParam::accel_scale / 2 * 1.001 + accel_late_s<TypeParam>);
    EXPECT_NEAR(sample->accel_m_s2.y, truth.accel_m_s2.y,
                TypeParam::accel_scale / 2 * 1.001 + 2 * accel_late_s<TypeParam>);
    EXPECT_NEAR(sample->accel_m_s2.z, truth.accel_m_s2.z, TypeParam::accel_scale / 2 * 1.001);
    EXPECT_EQ(sample->flags, flag::gyro_valid | flag::accel_valid);
    EXPECT_NEAR(this->driver.temperature_c(), 31.5, 0.01);
}

TYPED_TEST(ImuDriver, DataReadyIsTheChipsOwnBit) {
    this->start(0);
    this->next_edge();
    ASSERT_TRUE(this->driver.data_ready());
    EXPECT_TRUE(this->driver.read(0));
    EXPECT_FALSE(*this->driver.data_ready());
    this->next_edge();
    EXPECT_TRUE(*this->driver.data_ready());
}

TYPED_TEST(ImuDriver, FirstSamplesAreMarkedAsSettling) {
    this->start(0);
    EXPECT_TRUE(this->driver.read(this->next_edge())->flags & flag::settling);
    for (int i = 0; i < 60; ++i) EXPECT_TRUE(this->driver.read(this->next_edge()));
    EXPECT_FALSE(this->driver.read(this->next_edge())->flags & flag::settling);
}

TYPED_TEST(ImuDriver, FifoLosesNothingAndEachSampleHasItsOwnTime) {
    this->model->oscillator_ppm =
        12000;  // 1.2 % fast: the times must follow the chip, not its name
    this->start(16);
    Batch batch;
    double last_true_ns = 0;
    std::int64_t last_ns = 0;
    std::size_t total = 0;
    double worst_ns = 0;
    const double true_period = TypeParam::period_ns / 1.012;
    for (int n = 0; n < 100; ++n) {
        const std::int64_t edge = this->newest_edge();
        ASSERT_EQ(this->driver.read_fifo(edge, this->bus.now_ns, batch), Status::ok);
        this->model->edges.clear();
        EXPECT_EQ(batch.lost, 0u);
        EXPECT_FALSE(batch.more);
        for (std::size_t i = 0; i < batch.count; ++i) {
            const Sample& s = batch.samples[i];
            const double true_ns = this->true_time_ns(s);
            if (total > 0) {
                // one sample after another: the ramp shows it within its own rounding
                const double rounding = TypeParam::gyro_scale / 0.5 * 1e9 + 1;
                EXPECT_NEAR(true_ns - last_true_ns, true_period, rounding);
                EXPECT_GT(s.t_ns, last_ns);
            }
            if (n > 20) {
                const double error = static_cast<double>(s.t_ns) - true_ns;
                worst_ns = std::max(worst_ns, std::abs(error));
            }
            last_true_ns = true_ns;
            last_ns = s.t_ns;
            ++total;
        }
    }
    EXPECT_GE(total, 1600u);
    EXPECT_LE(worst_ns, TypeParam::gyro_scale / 0.5 * 1e9 / 2 + 60000)
        << "60 us beside the rounding";
    EXPECT_NEAR(this->driver.timeline().error_ppm(), -12000, 2500);
}

TYPED_TEST(ImuDriver, OverrunIsSaidAndTheStreamGoesOn) {
    this->start(16);
    Batch batch;
    ASSERT_EQ(this->driver.read_fifo(this->newest_edge(), this->bus.now_ns, batch), Status::ok);
    const double last = this->true_time_ns(batch.samples[batch.count - 1]);
    const int unread = TypeParam::fifo_samples >= 300 ? 900 : 400;  // far more than it holds
    const std::int64_t gap = static_cast<std::int64_t>(TypeParam::period_ns) * unread;
    this->bus.pass(gap);  // nobody reads
    bool overrun = false;
    std::uint32_t lost = 0;
    std::size_t flagged = 0, holes = 0, got = 0;
    double truly_lost = 0, before = last;
    for (int n = 0; n < 40 && got < 100; ++n) {
        this->bus.pass(8 * static_cast<std::int64_t>(TypeParam::period_ns));
        ASSERT_EQ(this->driver.read_fifo(no_edge, this->bus.now_ns, batch), Status::ok);
        overrun = overrun || batch.state == FifoState::overrun;
        lost += batch.lost;
        for (std::size_t i = 0; i < batch.count; ++i) {
            ++got;
            const double t = this->true_time_ns(batch.samples[i]);
            const double missing = (t - before) / TypeParam::period_ns - 1;
            if (missing > 0.6) {
                ++holes;
                truly_lost += missing;
            }
            before = t;
            if (batch.samples[i].flags & flag::gap_before) ++flagged;
        }
    }
    EXPECT_TRUE(overrun);
    EXPECT_GT(truly_lost, 200);
    EXPECT_NEAR(lost, truly_lost, TypeParam::own_clock ? 3 : 12);
    EXPECT_EQ(flagged, holes);
}

TYPED_TEST(ImuDriver, ManySamplesComeInBatches) {
    this->start(16);
    Batch batch;
    const std::size_t waiting = TypeParam::fifo_samples - 6;
    this->bus.pass(static_cast<std::int64_t>(TypeParam::period_ns * static_cast<double>(waiting)));
    std::size_t total = 0;
    for (int n = 0; n < 6; ++n) {
        ASSERT_EQ(this->driver.read_fifo(no_edge, this->bus.now_ns, batch), Status::ok);
        EXPECT_EQ(batch.lost, 0u);
        total += batch.count;
        if (!batch.more) break;
    }
    EXPECT_GE(total + 2, waiting);
}

TYPED_TEST(ImuDriver, ShortBurstsGiveTheSameSamples) {
    this->bus.longest_read = 32;  // what SMBus blocks allow
    this->start(16);
    Batch batch;
    ASSERT_EQ(this->driver.read_fifo(this->newest_edge(), this->bus.now_ns, batch), Status::ok);
    EXPECT_GE(batch.count, 16u);
    for (std::size_t i = 1; i < batch.count; ++i)
        EXPECT_NEAR(this->true_time_ns(batch.samples[i]) - this->true_time_ns(batch.samples[i - 1]),
                    TypeParam::period_ns, TypeParam::gyro_scale / 0.5 * 1e9 + 1);
}

TYPED_TEST(ImuDriver, BrownOutIsNoticedAndStartMendsIt) {
    this->start(16);
    EXPECT_EQ(this->driver.check(), Status::ok);
    Batch batch;
    ASSERT_EQ(this->driver.read_fifo(this->newest_edge(), this->bus.now_ns, batch), Status::ok);
    const std::int64_t last = batch.samples[batch.count - 1].t_ns;
    this->model->power_cycle();
    EXPECT_EQ(this->driver.check(), Status::no_acknowledge) << "it starts";
    this->bus.pass(this->model->start_up_ns);
    EXPECT_EQ(this->driver.check(), Status::bad_data);
    this->bus.pass(50000000);
    this->start(16);
    EXPECT_EQ(this->driver.check(), Status::ok);
    ASSERT_EQ(this->driver.read_fifo(this->newest_edge(), this->bus.now_ns, batch), Status::ok);
    ASSERT_GT(batch.count, 0u);
    EXPECT_TRUE(batch.samples[0].flags & flag::gap_before);
    EXPECT_GT(batch.samples[0].t_ns, last);
    const double missing =
        static_cast<double>(batch.samples[0].t_ns - last) / TypeParam::period_ns - 1;
    EXPECT_NEAR(batch.lost, missing, 1);
}

TYPED_TEST(ImuDriver, SelfTestPassesAndFailsWithTheChip) {
    const auto chip = TypeParam::model([](std::int64_t) { return Truth{}; });  // it must lie still
    this->bus.chips = {chip.get()};
    SelfTest result;
    if constexpr (!has_self_test<TypeParam>) {
        EXPECT_EQ(this->driver.self_test(result), Status::not_supported);
    } else {
        // the configuration of the last start() counts where one is needed (BMI270)
        EXPECT_EQ(this->driver.start(TypeParam::config(0)), Status::ok);
        EXPECT_EQ(this->driver.self_test(result), Status::ok);
        EXPECT_TRUE(result.passed);
        chip->defective = true;
        EXPECT_EQ(this->driver.self_test(result), Status::ok);
        EXPECT_FALSE(result.passed);
    }
}

TYPED_TEST(ImuDriver, FullScaleIsMarkedAsClipped) {
    this->start(0);
    this->bus.until(80000000000);  // the ramp has left a range, which one depends on the chip
    const auto sample = this->driver.read(1);
    ASSERT_TRUE(sample);
    EXPECT_TRUE(sample->flags & flag::clipped);
    EXPECT_TRUE(sample->flags & (flag::gyro_clipped | flag::accel_clipped));
}

TYPED_TEST(ImuDriver, StartFailsCleanlyAtEveryTransfer) {
    fail_everywhere<TypeParam>([](auto& rig) { return rig.driver->start(TypeParam::config(8)); },
                               false, TypeParam::looks);
}

TYPED_TEST(ImuDriver, SelfTestFailsCleanlyAtEveryTransfer) {
    if (!has_self_test<TypeParam>) return;
    fail_everywhere<TypeParam>(
        [](auto& rig) {
            SelfTest result;
            return rig.driver->self_test(result);
        },
        std::is_same_v<TypeParam, Bmi270Chip>, TypeParam::looks);
}

TYPED_TEST(ImuDriver, ReadsFailCleanlyAtEveryTransfer) {
    fail_everywhere<TypeParam>([](auto& rig) { return rig.driver->read(0).status(); }, true);
    fail_everywhere<TypeParam>([](auto& rig) { return rig.driver->data_ready().status(); }, true);
    fail_everywhere<TypeParam>([](auto& rig) { return rig.driver->check(); }, true);
    fail_everywhere<TypeParam>(
        [](auto& rig) {
            Batch batch;
            rig.bus->longest_read = 32;  // many transfers
            return rig.driver->read_fifo(no_edge, rig.bus->now_ns, batch);
        },
        true);
}

TYPED_TEST(ImuDriver, AFailedFifoReadIsNeverASilentLoss) {
    // whatever transfer fails, the samples that arrive are in order, and every hole is counted
    for (int k = 0; k < 8; ++k) {
        Rig<TypeParam> rig;
        rig.bus->longest_read = 64;
        ASSERT_EQ(rig.recover(), Status::ok);
        Batch batch;
        double last = -1;
        std::size_t holes = 0, flagged = 0;
        for (int n = 0; n < 30; ++n) {
            rig.bus->pass(static_cast<std::int64_t>(TypeParam::period_ns * 8));
            rig.bus->fail_at = n == 10 ? rig.bus->transfers + k : -1;
            static_cast<void>(rig.driver->read_fifo(no_edge, rig.bus->now_ns, batch));
            for (std::size_t i = 0; i < batch.count; ++i) {
                const double t = ImuDriver<TypeParam>::true_time_ns(batch.samples[i]);
                if (last >= 0 && t - last > 1.6 * TypeParam::period_ns) ++holes;
                if (last >= 0) {
                    EXPECT_GT(t, last - 1);
                }
                if (batch.samples[i].flags & flag::gap_before) ++flagged;
                last = t;
            }
        }
        EXPECT_EQ(holes, flagged) << "k = " << k;
    }
}

TYPED_TEST(ImuDriver, AStuckBusCostsABoundedTime) {
    this->start(8);
    this->bus.stuck = true;
    const int before = this->bus.transfers;
    Batch batch;
    SelfTest result;
    EXPECT_EQ(this->driver.read(0).status(), Status::timeout);
    EXPECT_EQ(this->driver.read_fifo(no_edge, this->bus.now_ns, batch), Status::timeout);
    EXPECT_EQ(this->driver.check(), Status::timeout);
    EXPECT_EQ(this->driver.start(TypeParam::config(8)), Status::timeout);
    EXPECT_EQ(this->driver.self_test(result),
              has_self_test<TypeParam> ? Status::timeout : Status::not_supported);
    EXPECT_EQ(this->driver.probe().status, Status::timeout);
    EXPECT_EQ(this->bus.transfers - before, has_self_test<TypeParam> ? 6 : 5) << "one each";
}

TYPED_TEST(ImuDriver, ATooLargeWatermarkIsRefused) {
    EXPECT_EQ(this->driver.start(TypeParam::config(65)), Status::bad_argument);
    EXPECT_EQ(this->bus.transfers, 0);
}

// ---- what only one family has

TEST(UnknownIdentity, IsRefusedUnlessToldOtherwise) {
    sim::Mpu6xxxModel chip{ramp, 0x98};  // the number of a well-known clone
    ModelBus bus;
    bus.chips = {&chip};
    Mpu6xxx<ModelBus> strict{bus};
    EXPECT_EQ(strict.start({}), Status::unexpected_id);
    EXPECT_EQ(strict.probe().got, 0x98);
    EXPECT_STREQ(strict.probe().part, "unknown");
    Mpu6xxx<ModelBus> trusting{bus, 0x68, UnknownId::accept};
    EXPECT_EQ(trusting.start({}), Status::ok);
}

TEST(UnknownIdentity, TheSameNumberInAnotherRegisterIsNotTheSamePart) {
    sim::Mpu6xxxModel chip{ramp, 0x70, 0x6A};  // MPU-6500's number is LSM6DSV's, elsewhere
    ModelBus bus;
    bus.chips = {&chip};
    EXPECT_EQ(Lsm6dsv<ModelBus>{bus}.start({}), Status::unexpected_id);
}

/// A body that speeds up and turns ever faster: both halves tell the time, to 0.1 ms.
Truth hasty(std::int64_t t_ns) {
    const auto t = static_cast<float>(static_cast<double>(t_ns - 1000000000) * 1e-9);
    Truth truth;
    truth.gyro_rad_s = {15 * t, 0, 0};
    truth.accel_m_s2 = {25 * t, 0, 9.80665f};
    return truth;
}
struct Pairing {
    std::size_t samples{}, without{};
    double worst_ms{};
};
/// How far from its sample the acceleration is in time, over a second of FIFO batches.
Pairing pairs(bmi088::Rate rate, double accel_ppm, bool edges) {
    Rig<Bmi088Chip> rig;
    auto chip = std::make_unique<sim::Bmi088Model>(hasty);
    chip->accel.oscillator_ppm = accel_ppm;
    rig.bus->chips = {chip.get()};
    auto config = Bmi088Chip::config(8);
    config.rate = rate;
    config.accel = bmi088::AccelRange::g_3;
    EXPECT_EQ(rig.driver->start(config), Status::ok);
    chip->edges.clear();
    test::ModelEdges line{*rig.bus, *chip};
    Pairing out;
    Batch batch;
    while (rig.bus->now_ns < 2000000000) {
        const auto edge = line.wait(rig.bus->now_ns + 200000000);
        EXPECT_TRUE(edge);
        rig.bus->pass(edges ? 0 : 700000);
        EXPECT_EQ(rig.driver->read_fifo(edges ? *edge : no_edge, rig.bus->now_ns, batch),
                  Status::ok);
        EXPECT_EQ(batch.lost, 0u);
        for (std::size_t i = 0; i < batch.count; ++i, ++out.samples) {
            const Sample& s = batch.samples[i];
            if ((s.flags & flag::accel_valid) == 0)
                ++out.without;
            else
                out.worst_ms =
                    std::max(out.worst_ms, std::abs(static_cast<double>(s.accel_m_s2.x) / 25 -
                                                    static_cast<double>(s.gyro_rad_s.x) / 15) *
                                               1e3);
        }
    }
    return out;
}

TEST(Bmi088, EachSampleHasTheAccelerationOfItsTime) {
    using bmi088::Rate;
    for (const Rate rate : {Rate::hz_100, Rate::hz_200, Rate::hz_400, Rate::hz_1000})
        for (const double ppm : {0.0, 20000.0, -20000.0}) {
            SCOPED_TRACE(testing::Message() << bmi088::period_ns(rate) << " ns, " << ppm);
            const double accel_ms = static_cast<double>(bmi088::accel_period_ns(rate)) * 1e-6;
            const double period_ms = static_cast<double>(bmi088::period_ns(rate)) * 1e-6;
            // nine samples wait at most; over that time the clocks part
            const double bound_ms = accel_ms + 9 * period_ms * std::abs(ppm) * 1e-6 + 0.1;
            const Pairing with = pairs(rate, ppm, true);
            EXPECT_GE(static_cast<double>(with.samples), 0.85e3 / period_ms - 8);
            EXPECT_LE(with.without, 2u) << "only the first ones";
            EXPECT_LE(with.worst_ms, bound_ms);
            // without an edge the age of the newest sample is not known: half a period more
            EXPECT_LE(pairs(rate, ppm, false).worst_ms, bound_ms + period_ms / 2);
        }
}

TEST(Bmi088, AForeignFrameInTheFifoIsALossThatIsTold) {
    Rig<Bmi088Chip> rig;
    ASSERT_EQ(rig.recover(), Status::ok);
    Batch batch;
    rig.bus->pass(20000000);
    ASSERT_EQ(rig.driver->read_fifo(no_edge, rig.bus->now_ns, batch), Status::ok);
    rig.model->accel.foreign_frame = true;
    rig.bus->pass(20000000);
    EXPECT_EQ(rig.driver->read_fifo(no_edge, rig.bus->now_ns, batch), Status::bad_data);
    EXPECT_EQ(batch.state, FifoState::resync);
    EXPECT_EQ(batch.count, 0u);
    rig.bus->pass(20000000);
    ASSERT_EQ(rig.driver->read_fifo(no_edge, rig.bus->now_ns, batch), Status::ok);
    ASSERT_GT(batch.count, 0u);
    EXPECT_GE(batch.lost, 7u);
    EXPECT_TRUE(batch.samples[0].flags & flag::gap_before);
}

TEST(Bmi088, EitherHalfIsAskedForItsIdentity) {
    Rig<Bmi088Chip> rig;
    rig.model->accel.start_up_ns = INT64_MAX / 2;
    rig.model->power_cycle();  // the accelerometer never comes up
    rig.bus->pass(rig.model->start_up_ns);
    const Probe p = rig.driver->probe();
    EXPECT_EQ(p.status, Status::no_acknowledge);
    EXPECT_EQ(p.address, 0x18);
    EXPECT_EQ(p.expected, 0x1E);
    EXPECT_EQ(rig.driver->start(Bmi088Chip::config(8)), Status::no_acknowledge);
}

TEST(Lsm6, AnImpossibleTagIsALostStepThatIsFoundAgain) {
    sim::Lsm6Model chip{sim::Lsm6Model::Kind::dso, ramp};
    ModelBus bus;
    bus.chips = {&chip};
    Lsm6dso<ModelBus> driver{bus};
    Lsm6dso<ModelBus>::Config config;
    config.watermark = 8;
    ASSERT_EQ(driver.start(config), Status::ok);
    Batch batch;
    bus.pass(20000000);
    ASSERT_EQ(driver.read_fifo(no_edge, bus.now_ns, batch), Status::ok);
    chip.corrupt_tag = true;
    bus.pass(20000000);
    ASSERT_EQ(driver.read_fifo(no_edge, bus.now_ns, batch), Status::ok);
    EXPECT_EQ(batch.state, FifoState::resync);
    bus.pass(20000000);
    ASSERT_EQ(driver.read_fifo(no_edge, bus.now_ns, batch), Status::ok);
    EXPECT_EQ(batch.state, FifoState::streaming);
    EXPECT_GT(batch.lost, 0u);
    EXPECT_TRUE(batch.samples[0].flags & flag::gap_before);
}

TEST(Lsm6, StartsAgainWhileItsInterruptStands) {
    for (const auto kind : {sim::Lsm6Model::Kind::dso, sim::Lsm6Model::Kind::dsv}) {
        sim::Lsm6Model chip{kind, ramp};
        ModelBus bus;
        bus.chips = {&chip};
        const auto twice = [&](auto driver, auto config) {
            config.watermark = 8;
            ASSERT_EQ(driver.start(config), Status::ok);
            bus.pass(50000000);
            ASSERT_TRUE(chip.line());
            EXPECT_EQ(driver.start(config), Status::ok) << "a reset with INT1 up ends in I3C";
        };
        if (kind == sim::Lsm6Model::Kind::dso)
            twice(Lsm6dso<ModelBus>{bus}, Lsm6dso<ModelBus>::Config{});
        else
            twice(Lsm6dsv<ModelBus>{bus}, Lsm6dsv<ModelBus>::Config{});
    }
}

TEST(Lsm6, TheFactoryTrimSetsTheClock) {
    sim::Lsm6Model chip{sim::Lsm6Model::Kind::dso, ramp};
    chip.trim = -20;  // 3 % slow
    chip.power_cycle();
    ModelBus bus;
    bus.chips = {&chip};
    bus.pass(chip.start_up_ns);
    Lsm6dso<ModelBus> driver{bus};
    ASSERT_EQ(driver.start({}), Status::ok);
    EXPECT_NEAR(static_cast<double>(driver.period_ns()), 16e9 / 6667 / 0.97, 2);
}

TEST(Lsm6, RatesHaveTheirTrueValues) {
    using Dso = lsm6::Dso;
    using Dsv = lsm6::Dsv;
    EXPECT_EQ(Dso::period_ns(Dso::Rate::hz_6667), 1000000000 / 6667);
    EXPECT_EQ(Dso::period_ns(Dso::Rate::hz_12_5), 512000000000 / 6667);  // 13.02 Hz in truth
    EXPECT_EQ(Dsv::period_ns(Dsv::Rate::hz_480), 1000000000 / 480);
    EXPECT_EQ(Dsv::period_ns(Dsv::Rate::hz_7_5), 1000000000 * 2LL / 15);
}

template <class Driver, class Range>
double full_scale_dps(Range r) {
    return static_cast<double>(Driver::rad_s_per_count(r)) * 180 / sim::pi;
}
TEST(Lsm6, RangesHaveTheirTrueValues) {
    using Dso = Lsm6dso<ModelBus>;
    using Dsv = Lsm6dsv<ModelBus>;
    EXPECT_NEAR(full_scale_dps<Dso>(Dso::GyroRange::dps_125), 4.375e-3, 1e-9);
    EXPECT_NEAR(full_scale_dps<Dso>(Dso::GyroRange::dps_250), 8.75e-3, 1e-8);
    EXPECT_NEAR(full_scale_dps<Dso>(Dso::GyroRange::dps_500), 17.5e-3, 1e-8);
    EXPECT_NEAR(full_scale_dps<Dso>(Dso::GyroRange::dps_1000), 35e-3, 1e-8);
    EXPECT_NEAR(full_scale_dps<Dso>(Dso::GyroRange::dps_2000), 70e-3, 1e-8);
    EXPECT_NEAR(full_scale_dps<Dsv>(Dsv::GyroRange::dps_4000), 140e-3, 1e-7);
    EXPECT_NEAR(static_cast<double>(Dso::m_s2_per_count(Dso::AccelRange::g_16)) / sim::g_m_s2,
                0.488e-3, 1e-9);
    EXPECT_NEAR(static_cast<double>(Dso::m_s2_per_count(Dso::AccelRange::g_2)) / sim::g_m_s2,
                0.061e-3, 1e-9);
}

/// Every rate and range of a family is set in the chip and comes back in its samples.
template <class Chip, class Set>
void every_range(int gyro_codes, int accel_codes, Set set) {
    for (int g = 0; g < gyro_codes; ++g)
        for (int a = 0; a < accel_codes; ++a) {
            Rig<Chip> rig;
            auto config = Chip::config(0);
            if (!set(config, g, a)) continue;
            ASSERT_EQ(rig.driver->start(config), Status::ok) << g << " " << a;
            rig.bus->until(1500000000);
            const auto sample = rig.driver->read(0);
            ASSERT_TRUE(sample);
            const Truth truth = ramp(rig.bus->now_ns);
            const double period_s = static_cast<double>(rig.driver->period_ns()) * 1e-9;
            const auto scale = rig.driver->scale();
            EXPECT_NEAR(sample->accel_m_s2.x, truth.accel_m_s2.x,
                        static_cast<double>(scale.accel_m_s2) + 1.1 * period_s);
            if (sample->flags & flag::clipped) continue;  // the narrow gyro ranges
            EXPECT_NEAR(sample->gyro_rad_s.x, truth.gyro_rad_s.x,
                        static_cast<double>(scale.gyro_rad_s) + 0.6 * period_s);
        }
}

TEST(Ranges, OfEveryImuReachTheSamples) {
    using Icm = Icm42688::Driver::Config;
    every_range<Icm42688>(8, 4, [](Icm& c, int g, int a) {
        c.gyro = static_cast<icm426xx::GyroRange>(g);
        c.accel = static_cast<icm426xx::AccelRange>(a);
        return true;
    });
    every_range<Lsm6dsoChip>(7, 4, [](auto& c, int g, int a) {
        c.gyro = static_cast<lsm6::Dso::GyroRange>(g);
        c.accel = static_cast<lsm6::Dso::AccelRange>(a);
        return g != 3 && g != 5;
    });
    every_range<Lsm6dsvChip>(13, 4, [](auto& c, int g, int a) {
        c.gyro = static_cast<lsm6::Dsv::GyroRange>(g);
        c.accel = static_cast<lsm6::Dsv::AccelRange>(a);
        return g < 5 || g == 12;
    });
    every_range<MpuChip<0x70>>(4, 4, [](auto& c, int g, int a) {
        c.gyro = static_cast<mpu6xxx::GyroRange>(g);
        c.accel = static_cast<mpu6xxx::AccelRange>(a);
        return true;
    });
}

/// Counts the chip's own samples over a while.
template <class Chip, class Config>
void expect_rate(const Config& config, std::int64_t period_ns) {
    Rig<Chip> rig;
    ASSERT_EQ(rig.driver->start(config), Status::ok);
    EXPECT_EQ(rig.driver->period_ns(), period_ns);
    const std::uint64_t before = rig.model->produced;
    rig.bus->pass(period_ns * 50 + period_ns / 2);
    EXPECT_NEAR(static_cast<double>(rig.model->produced - before), 50, 1);
}

TEST(Rates, OfEveryImuAreThoseOfTheChip) {
    using icm426xx::Rate;
    for (const Rate r : {Rate::hz_8000, Rate::hz_4000, Rate::hz_2000, Rate::hz_1000, Rate::hz_500,
                         Rate::hz_200, Rate::hz_100, Rate::hz_50, Rate::hz_25, Rate::hz_12_5}) {
        auto c = Icm42688::config(0);
        c.rate = r;
        expect_rate<Icm42688>(c, icm426xx::period_ns(r));
    }
    for (int code = 1; code <= 10; ++code) {
        auto c = Lsm6dsoChip::config(0);
        c.rate = static_cast<lsm6::Dso::Rate>(code);
        expect_rate<Lsm6dsoChip>(c, lsm6::Dso::period_ns(c.rate));
    }
    for (int code = 2; code <= 12; ++code) {
        auto c = Lsm6dsvChip::config(0);
        c.rate = static_cast<lsm6::Dsv::Rate>(code);
        expect_rate<Lsm6dsvChip>(c, lsm6::Dsv::period_ns(c.rate));
    }
    for (const auto r : {mpu6xxx::hz_1000, mpu6xxx::hz_333, mpu6xxx::hz_50}) {
        auto c = MpuChip<0x68>::config(0);
        c.rate = r;
        expect_rate<MpuChip<0x68>>(c, r.period_ns());
    }
}

}  // namespace
}  // namespace fairlead::port
