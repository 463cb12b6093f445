// Every magnetometer driver against its chip's model: identity, units, what was missed, loss of
// settings, self test, bypass, and a failure at transfer k for all k.
#include <type_traits>

#include "host_sim/chip_models/ak8963_model.hpp"
#include "host_sim/chip_models/icm20948_model.hpp"
#include "host_sim/chip_models/iis2mdc_model.hpp"
#include "host_sim/chip_models/magnetometer_models.hpp"
#include "host_sim/chip_models/mmc5983ma_model.hpp"
#include "host_sim/chip_models/mpu6xxx_model.hpp"
#include "host_sim/chip_models/qmc5883_model.hpp"
#include "port/sensors/ak09916.hpp"
#include "port/sensors/ak8963.hpp"
#include "port/sensors/icm20948.hpp"
#include "port/sensors/iis2mdc.hpp"
#include "port/sensors/lis3mdl.hpp"
#include "port/sensors/mmc5983ma.hpp"
#include "port/sensors/mpu6xxx.hpp"
#include "port/sensors/qmc5883.hpp"
#include "tests/port/driver_rig.hpp"

namespace fairlead::port {
namespace {

using test::fail_everywhere;
using test::ModelBus;
using test::ramp;
using test::Rig;
using test::Truth;

struct Lis3mdlChip {
    using Model = sim::Lis3mdlModel;
    using Driver = Lis3mdl<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(m); }
    static Driver::Config config(int) { return {}; }
    static constexpr double period_ns = 1e9 / 155;
    static constexpr std::uint8_t id = 0x3D;
    static constexpr double scale = 100 / 6842.0;
    static constexpr bool tells_missed = true, has_self_test = true;
};
struct Ak09916Chip {
    using Model = sim::Ak09916Model;
    using Driver = Ak09916<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(m); }
    static Driver::Config config(int) { return {}; }
    static constexpr double period_ns = 1e7;
    static constexpr std::uint8_t id = 0x09;
    static constexpr double scale = 0.15;
    static constexpr bool tells_missed = true, has_self_test = true;
};
struct Ak8963Chip {
    using Model = sim::Ak8963Model;
    using Driver = Ak8963<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(m); }
    static Driver::Config config(int) {
        Driver::Config c;
        c.own_axes = true;
        return c;
    }
    static constexpr double period_ns = 1e7;
    static constexpr std::uint8_t id = 0x48;
    static constexpr double scale = 0.2;
    static constexpr bool tells_missed = true, has_self_test = true;
};
template <sim::Qmc5883Model::Kind Kind>
struct QmcChip {
    static constexpr bool is_l = Kind == sim::Qmc5883Model::Kind::l;
    using Model = sim::Qmc5883Model;
    using Driver = std::conditional_t<is_l, Qmc5883l<ModelBus>, Qmc5883p<ModelBus>>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(Kind, m); }
    static typename Driver::Config config(int) { return {}; }
    static constexpr double period_ns = 1e7;
    static constexpr std::uint8_t id = is_l ? 0xFF : 0x80;
    static constexpr double scale = 0.1;
    static constexpr bool tells_missed = is_l, has_self_test = !is_l;
};
struct Iis2mdcChip {
    using Model = sim::Iis2mdcModel;
    using Driver = Iis2mdc<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(m); }
    static Driver::Config config(int) { return {}; }
    static constexpr double period_ns = 1e7;
    static constexpr std::uint8_t id = 0x40;
    static constexpr double scale = 0.15;
    static constexpr bool tells_missed = true, has_self_test = true;
};
struct Mmc5983maChip {
    using Model = sim::Mmc5983maModel;
    using Driver = Mmc5983ma<ModelBus>;
    static auto model(sim::Motion m = ramp) { return std::make_unique<Model>(m); }
    static Driver::Config config(int) { return {}; }
    static constexpr double period_ns = 1e7;
    static constexpr std::uint8_t id = 0x30;
    static constexpr double scale = 100 / 16384.0;
    static constexpr bool tells_missed = false, has_self_test = true;
};

template <class Chip>
class MagDriver : public ::testing::Test {};
using MagChips =
    ::testing::Types<Lis3mdlChip, Ak09916Chip, Ak8963Chip, QmcChip<sim::Qmc5883Model::Kind::l>,
                     QmcChip<sim::Qmc5883Model::Kind::p>, Iis2mdcChip, Mmc5983maChip>;
TYPED_TEST_SUITE(MagDriver, MagChips, );

TYPED_TEST(MagDriver, StartsReadsAndSaysWhatItMissed) {
    Rig<TypeParam> rig;
    EXPECT_EQ(rig.driver->probe().got, TypeParam::id);
    ASSERT_EQ(rig.driver->start(TypeParam::config(0)), Status::ok);
    ASSERT_TRUE(rig.driver->data_ready());
    rig.bus->pass(static_cast<std::int64_t>(TypeParam::period_ns * 1.5));
    EXPECT_TRUE(*rig.driver->data_ready());
    const auto sample = rig.driver->read(77);
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->t_ns, 77);
    const Truth truth = ramp(rig.bus->now_ns);
    EXPECT_NEAR(sample->mag_uT.x, truth.mag_uT.x, TypeParam::scale + 0.02);
    EXPECT_NEAR(sample->mag_uT.y, truth.mag_uT.y, TypeParam::scale + 0.02);
    EXPECT_NEAR(sample->mag_uT.z, truth.mag_uT.z, TypeParam::scale + 0.02);
    EXPECT_EQ(sample->flags, flag::mag_valid);
    EXPECT_FALSE(*rig.driver->data_ready());
    rig.bus->pass(static_cast<std::int64_t>(TypeParam::period_ns * 3.5));
    EXPECT_EQ((rig.driver->read(78)->flags & flag::gap_before) != 0, TypeParam::tells_missed);
    EXPECT_FALSE(rig.driver->read(79)->flags & flag::gap_before);
    EXPECT_EQ(rig.driver->check(), Status::ok);
    rig.model->power_cycle();
    rig.bus->pass(rig.model->start_up_ns);
    EXPECT_EQ(rig.driver->check(), Status::bad_data);
}

TYPED_TEST(MagDriver, SelfTestPassesAndFailsWithTheChip) {
    Rig<TypeParam> rig;
    SelfTest result;
    if (!TypeParam::has_self_test) {
        EXPECT_EQ(rig.driver->self_test(result), Status::not_supported);
        return;
    }
    EXPECT_EQ(rig.driver->self_test(result), Status::ok);
    EXPECT_TRUE(result.passed);
    rig.model->defective = true;
    EXPECT_EQ(rig.driver->self_test(result), Status::ok);
    EXPECT_FALSE(result.passed);
}

TYPED_TEST(MagDriver, FailsCleanlyAtEveryTransfer) {
    fail_everywhere<TypeParam>([](auto& rig) { return rig.driver->start(TypeParam::config(0)); },
                               false);
    fail_everywhere<TypeParam>([](auto& rig) { return rig.driver->read(0).status(); }, true);
    fail_everywhere<TypeParam>([](auto& rig) { return rig.driver->check(); }, true);
    if (!TypeParam::has_self_test) return;
    fail_everywhere<TypeParam>(
        [](auto& rig) {
            SelfTest result;
            return rig.driver->self_test(result);
        },
        false);
}

TEST(Lis3mdl, EveryRateAndRange) {
    using namespace lis3mdl;
    for (const Rate r : {Rate::hz_0_625, Rate::hz_10, Rate::hz_80, Rate::hz_155, Rate::hz_300,
                         Rate::hz_560, Rate::hz_1000}) {
        for (const Range range :
             {Range::gauss_4, Range::gauss_8, Range::gauss_12, Range::gauss_16}) {
            Rig<Lis3mdlChip> rig;
            ASSERT_EQ(rig.driver->start({r, range}), Status::ok);
            const std::uint64_t before = rig.model->produced;
            rig.bus->pass(period_ns(r) * 10 + period_ns(r) / 2);
            EXPECT_NEAR(static_cast<double>(rig.model->produced - before), 10, 1);
            EXPECT_NEAR(rig.driver->read(0)->mag_uT.x, ramp(rig.bus->now_ns).mag_uT.x,
                        0.06 + 1.2e-9 * static_cast<double>(period_ns(r)));
        }
    }
}

TEST(Ak09916, BehindTheBypassOfAnIcm20948) {
    sim::Icm20948Model gate{ramp};
    sim::Ak09916Model mag{ramp, [&] { return gate.bypass(); }};
    ModelBus bus;
    bus.chips = {&gate, &mag};
    Ak09916<ModelBus> driver{bus};
    EXPECT_EQ(driver.start({}), Status::no_acknowledge);
    EXPECT_EQ(ak09916::open_bypass(bus), Status::ok);
    EXPECT_EQ(driver.start({}), Status::ok);
    bus.chips = {&mag};
    EXPECT_EQ(ak09916::open_bypass(bus), Status::no_acknowledge);
}

TEST(Ak09916, BehindTheBypassOfAnMpu9250) {
    sim::Mpu6xxxModel imu{ramp, 0x71};
    sim::Ak09916Model mag{ramp, [&] { return imu.bypass(); }};
    ModelBus bus;
    bus.chips = {&imu, &mag};
    Ak09916<ModelBus> driver{bus};
    EXPECT_EQ(driver.probe().status, Status::no_acknowledge);
    Mpu6xxx<ModelBus> gate{bus};
    Mpu6xxx<ModelBus>::Config config;
    config.bypass = true;
    ASSERT_EQ(gate.start(config), Status::ok);
    EXPECT_EQ(driver.start({}), Status::ok);
    EXPECT_EQ(ak09916::open_bypass(bus), Status::unexpected_id) << "not an ICM-20948";
}

TEST(Ak09916, AStrongFieldIsMarkedAsClipped) {
    sim::Ak09916Model mag{[](std::int64_t) {
        Truth t;
        t.mag_uT = {3000, 3000, 0};
        return t;
    }};
    ModelBus bus;
    bus.chips = {&mag};
    Ak09916<ModelBus> driver{bus};
    ASSERT_EQ(driver.start({}), Status::ok);
    bus.pass(15000000);
    EXPECT_TRUE(driver.read(0)->flags & flag::clipped);
}

TEST(Ak8963, BehindTheBypassOfAnMpu9250InTheImusAxes) {
    sim::Mpu6xxxModel imu{ramp, 0x71};
    sim::Ak8963Model mag{ramp, [&] { return imu.bypass(); }};
    ModelBus bus;
    bus.chips = {&imu, &mag};
    Ak8963<ModelBus> driver{bus};
    EXPECT_EQ(driver.start({}), Status::no_acknowledge);
    Mpu6xxx<ModelBus> gate{bus};
    Mpu6xxx<ModelBus>::Config config;
    config.bypass = true;
    ASSERT_EQ(gate.start(config), Status::ok);
    ASSERT_EQ(driver.start({}), Status::ok);
    bus.pass(15000000);
    const Truth truth = ramp(bus.now_ns);
    const auto sample = driver.read(0);
    ASSERT_TRUE(sample);
    EXPECT_NEAR(sample->mag_uT.x, truth.mag_uT.y, 0.2);
    EXPECT_NEAR(sample->mag_uT.y, truth.mag_uT.x, 0.2);
    EXPECT_NEAR(sample->mag_uT.z, -truth.mag_uT.z, 0.2);
}

TEST(Ak09916, BehindTheBypassThatTheImusDriverOpens) {
    sim::Icm20948Model imu{ramp};
    sim::Ak09916Model mag{ramp, [&] { return imu.bypass(); }};
    ModelBus bus;
    bus.chips = {&imu, &mag};
    Ak09916<ModelBus> driver{bus};
    Icm20948<ModelBus> gate{bus};
    EXPECT_EQ(gate.start({}), Status::ok);
    EXPECT_EQ(driver.probe().status, Status::no_acknowledge);
    Icm20948<ModelBus>::Config config;
    config.bypass = true;
    ASSERT_EQ(gate.start(config), Status::ok);
    EXPECT_EQ(driver.start({}), Status::ok);
}

TEST(Qmc5883, EveryRateAndRange) {
    const auto every = [](auto chip, int ranges) {
        using Chip = decltype(chip);
        for (int rate = 0; rate < 4; ++rate)
            for (int range = 0; range < ranges; ++range) {
                Rig<Chip> rig;
                auto config = Chip::config(0);
                config.rate = static_cast<qmc5883::Rate>(rate);
                config.range = static_cast<typename Chip::Driver::Range>(range);
                ASSERT_EQ(rig.driver->start(config), Status::ok);
                const std::int64_t period = rig.driver->period_ns();
                const std::uint64_t before = rig.model->produced;
                rig.bus->pass(period * 10 + period / 2);
                EXPECT_NEAR(static_cast<double>(rig.model->produced - before), 10, 1);
                EXPECT_NEAR(rig.driver->read(0)->mag_uT.x, ramp(rig.bus->now_ns).mag_uT.x,
                            0.06 + 1.2e-9 * static_cast<double>(period));
            }
    };
    every(QmcChip<sim::Qmc5883Model::Kind::l>{}, 2);
    every(QmcChip<sim::Qmc5883Model::Kind::p>{}, 4);
}

TEST(Mmc5983ma, TheOffsetOfTheBridgeCancelsInTheSelfTest) {
    Rig<Mmc5983maChip> rig;
    rig.model->offset_uT = 300;
    SelfTest result;
    ASSERT_EQ(rig.driver->self_test(result), Status::ok);
    EXPECT_TRUE(result.passed);
    EXPECT_NEAR(result.response[0], ramp(rig.bus->now_ns).mag_uT.x, 0.1);
}

}  // namespace
}  // namespace fairlead::port
