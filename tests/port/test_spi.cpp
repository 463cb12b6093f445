// SPI: the bytes on the wire, spidev's system calls, and every driver that has SPI on a model that
// decodes the address bits itself, with faults at every transfer.
#include <gtest/gtest.h>
#include <linux/spi/spidev.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/chip_models/bmi088_model.hpp"
#include "host_sim/chip_models/bmi_model.hpp"
#include "host_sim/chip_models/icm20948_model.hpp"
#include "host_sim/chip_models/icm42688_model.hpp"
#include "host_sim/chip_models/icm456xx_model.hpp"
#include "host_sim/chip_models/lsm6_model.hpp"
#include "host_sim/chip_models/magnetometer_models.hpp"
#include "host_sim/chip_models/mmc5983ma_model.hpp"
#include "host_sim/chip_models/mpu6xxx_model.hpp"
#include "port/linux/any_bus.hpp"
#include "port/linux/imu_loop.hpp"
#include "tests/port/driver_rig.hpp"
#include "tests/port/model_spi.hpp"

namespace fairlead::port {
namespace {

using test::ModelBus;
using test::ModelSpi;
using test::ramp;

struct Wire {
    struct Call {
        std::vector<std::uint8_t> out;
        std::size_t in_size;
    };
    std::vector<Call> calls;
    Status status{Status::ok};
    Status exchange(const std::uint8_t* out, std::size_t out_size, std::uint8_t* in,
                    std::size_t in_size) noexcept {
        calls.push_back({{out, out + out_size}, in_size});
        for (std::size_t i = 0; i < in_size; ++i) in[i] = static_cast<std::uint8_t>(i + 1);
        return status;
    }
    std::size_t read_max() const noexcept { return 4096; }
    void pause_us(std::uint32_t) noexcept {}
};

TEST(SpiBus, SendsTheAddressWithItsBits) {
    Wire wire;
    SpiBus<Wire> bus{wire, {1000000, 1, 0x40}};
    const Registers<SpiBus<Wire>> chip{bus, 0x11};
    EXPECT_EQ(chip.write(0x20, 0xAB), Status::ok);
    EXPECT_EQ(*chip.read(0x0F), 1);
    std::uint8_t six[6] = {};
    EXPECT_EQ(chip.read(0x28, six, 6), Status::ok);
    EXPECT_EQ(six[5], 6);
    using Out = std::vector<std::uint8_t>;
    ASSERT_EQ(wire.calls.size(), 3u);
    EXPECT_EQ(wire.calls[0].out, (Out{0x20, 0xAB}));
    EXPECT_EQ(wire.calls[1].out, (Out{0x8F, 0x00})) << "one register: no increment, a dummy byte";
    EXPECT_EQ(wire.calls[2].out, (Out{0xE8, 0x00}));
    EXPECT_EQ(wire.calls[2].in_size, 6u);
}

TEST(SpiBus, RefusesWhatSpiCannotSay) {
    Wire wire;
    SpiBus<Wire> bus{wire, {1000000, 0, 0}};
    std::uint8_t byte = 0;
    const std::uint8_t two[2] = {1, 2}, high[2] = {0x80, 1};
    const Transfer no_register{0, nullptr, 0, &byte, 1}, write_read{0, two, 2, &byte, 1},
        high_write{0, high, 2, nullptr, 0};
    EXPECT_EQ(bus.transfer(&no_register, 1), Status::bad_argument);
    EXPECT_EQ(bus.transfer(&write_read, 1), Status::bad_argument);
    EXPECT_EQ(bus.transfer(&high_write, 1), Status::bad_argument);
    EXPECT_EQ(bus.transfer(&no_register, 0), Status::bad_argument);
    EXPECT_TRUE(wire.calls.empty());
    wire.status = Status::io_error;
    const Registers<SpiBus<Wire>> chip{bus, 0};
    EXPECT_EQ(chip.write(1, 2), Status::io_error);
}

/// Stands where the kernel's spidev would.
class FakeSpi final : public SpiSystem {
  public:
    std::vector<unsigned long> requests;
    std::vector<spi_ioc_transfer> parts;
    std::uint8_t mode{}, bits{};
    std::uint32_t hz{};
    int open_error{0}, fail_at{-1}, error{EIO}, closed{0};

    int open(const char*) noexcept override {
        errno = open_error;
        return open_error == 0 ? 7 : -1;
    }
    int close(int fd) noexcept override { return closed += fd == 7, 0; }
    int ioctl(int, unsigned long request, unsigned long argument) noexcept override {
        requests.push_back(request);
        if (fail_at == static_cast<int>(requests.size()) - 1) {
            errno = error;
            return -1;
        }
        const auto* const bytes = reinterpret_cast<const std::uint8_t*>(argument);
        if (request == SPI_IOC_WR_MODE) mode = *bytes;
        if (request == SPI_IOC_WR_BITS_PER_WORD) bits = *bytes;
        if (request == SPI_IOC_WR_MAX_SPEED_HZ) std::memcpy(&hz, bytes, sizeof hz);
        if (request == SPI_IOC_MESSAGE(1) || request == SPI_IOC_MESSAGE(2)) {
            parts.resize(request == SPI_IOC_MESSAGE(2) ? 2 : 1);
            std::memcpy(parts.data(), bytes, parts.size() * sizeof parts[0]);
        }
        return 0;
    }
};

TEST(Spidev, OneMessageAnExchange) {
    FakeSpi kernel;
    Spidev wire{kernel};
    std::uint8_t in[3] = {};
    const std::uint8_t out[2] = {0x8F, 0};
    EXPECT_EQ(wire.exchange(out, 2, in, 3), Status::closed);
    ASSERT_EQ(wire.open("/dev/spidev0.0", 2000000), Status::ok);
    EXPECT_EQ(kernel.mode, SPI_MODE_3);
    EXPECT_EQ(kernel.bits, 8);
    EXPECT_EQ(kernel.hz, 2000000u);
    EXPECT_EQ(wire.exchange(out, 2, in, 3), Status::ok);
    ASSERT_EQ(kernel.parts.size(), 2u);
    EXPECT_EQ(kernel.parts[0].tx_buf, reinterpret_cast<unsigned long>(out));
    EXPECT_EQ(kernel.parts[0].len, 2u);
    EXPECT_EQ(kernel.parts[1].rx_buf, reinterpret_cast<unsigned long>(in));
    EXPECT_EQ(kernel.parts[1].len, 3u);
    EXPECT_EQ(kernel.parts[1].speed_hz, 2000000u);
    EXPECT_EQ(kernel.parts[0].cs_change, 0) << "the select stays low until the last byte";
    EXPECT_EQ(wire.exchange(out, 2, nullptr, 0), Status::ok);
    EXPECT_EQ(kernel.parts.size(), 1u);
    EXPECT_EQ(wire.exchange(out, 0, in, 3), Status::bad_argument);
    EXPECT_EQ(wire.exchange(out, 2, in, 1u << 20), Status::bad_argument);
    wire.close();
    EXPECT_EQ(kernel.closed, 1);
}

TEST(Spidev, FailuresKeepTheirErrnoAndLeaveNothingOpen) {
    for (int k = 0; k < 3; ++k) {
        FakeSpi kernel;
        kernel.fail_at = k;
        kernel.error = EINVAL;
        Spidev wire{kernel};
        EXPECT_EQ(wire.open("/dev/spidev0.0", 1000), Status::not_supported);
        EXPECT_EQ(wire.last_errno(), EINVAL);
        EXPECT_EQ(kernel.closed, 1);
    }
    FakeSpi kernel;
    Spidev wire{kernel};
    EXPECT_EQ(wire.open("/dev/spidev0.0", 0), Status::bad_argument);
    kernel.open_error = ENOENT;
    EXPECT_EQ(wire.open("/dev/spidev0.0", 1000), Status::not_found);
    kernel.open_error = EACCES;
    EXPECT_EQ(wire.open("/dev/spidev0.0", 1000), Status::no_permission);
    kernel.open_error = 0;
    ASSERT_EQ(wire.open("/dev/spidev0.0", 1000), Status::ok);
    kernel.fail_at = static_cast<int>(kernel.requests.size());
    kernel.error = ETIMEDOUT;
    const std::uint8_t out = 1;
    EXPECT_EQ(wire.exchange(&out, 1, nullptr, 0), Status::timeout);
    EXPECT_EQ(wire.last_errno(), ETIMEDOUT);
}

TEST(AnyBus, TellsAUserWhatToDo) {
    AnyBus bus;
    const SpiStyle spi{1000000, 0, 0}, none{};
    EXPECT_EQ(bus.open("/dev/spidev250.9", none, 1000000), Status::not_supported);
    EXPECT_EQ(bus.open("/dev/ttyS0", spi, 1000000), Status::bad_argument);
    EXPECT_EQ(bus.open("/dev/i2c-999", spi, 1000000), Status::not_found);
    EXPECT_EQ(bus.open("/dev/spidev250.9", spi, 1000000), Status::not_found);
    EXPECT_NE(std::string{AnyBus::remedy("/dev/i2c-1", Status::not_found)}.find("enable i2c-dev"),
              std::string::npos);
    EXPECT_NE(std::string{AnyBus::remedy("/dev/spidev0.0", Status::not_found)}.find("spidev"),
              std::string::npos);
    EXPECT_NE(std::string{AnyBus::remedy("/dev/i2c-1", Status::no_permission)}.find("group i2c"),
              std::string::npos);
}

// ---- every driver with SPI, on a model

template <class Chip>
std::unique_ptr<sim::ChipModel> model_of();
const std::vector<std::uint8_t> the_blob(64, 0x5A);
template <>
std::unique_ptr<sim::ChipModel> model_of<chips::Icm42688>() {
    return std::make_unique<sim::Icm42688Model>(ramp);
}
template <>
std::unique_ptr<sim::ChipModel> model_of<chips::Icm45686>() {
    return std::make_unique<sim::Icm456xxModel>(ramp);
}
template <>
std::unique_ptr<sim::ChipModel> model_of<chips::Icm20948>() {
    return std::make_unique<sim::Icm20948Model>(ramp);
}
template <>
std::unique_ptr<sim::ChipModel> model_of<chips::Lsm6dso>() {
    return std::make_unique<sim::Lsm6Model>(sim::Lsm6Model::Kind::dso, ramp);
}
template <>
std::unique_ptr<sim::ChipModel> model_of<chips::Lsm6dsv>() {
    return std::make_unique<sim::Lsm6Model>(sim::Lsm6Model::Kind::dsv, ramp);
}
template <>
std::unique_ptr<sim::ChipModel> model_of<chips::Mpu6050>() {
    return std::make_unique<sim::Mpu6xxxModel>(ramp, 0x71);
}
template <>
std::unique_ptr<sim::ChipModel> model_of<chips::Bmi160>() {
    return std::make_unique<sim::BmiModel>(sim::BmiModel::Kind::bmi160, ramp);
}
template <>
std::unique_ptr<sim::ChipModel> model_of<chips::Bmi270>() {
    return std::make_unique<sim::BmiModel>(sim::BmiModel::Kind::bmi270, ramp, the_blob);
}
template <>
std::unique_ptr<sim::ChipModel> model_of<chips::Lis3mdl>() {
    return std::make_unique<sim::Lis3mdlModel>(ramp);
}
template <>
std::unique_ptr<sim::ChipModel> model_of<chips::Mmc5983ma>() {
    return std::make_unique<sim::Mmc5983maModel>(ramp);
}

template <class Chip>
struct OnSpi {
    using Bus = SpiBus<ModelSpi>;
    using Driver = typename Chip::template Driver<Bus>;
    std::unique_ptr<sim::ChipModel> chip = model_of<Chip>();
    ModelBus world;
    ModelSpi wire{world, *chip, Chip::info.spi};
    Bus bus{wire, Chip::info.spi};
    Driver driver{bus};

    OnSpi() {
        world.chips = {chip.get()};
        wire.needs_wake = std::string{Chip::info.header} == "bmi.hpp";
    }
    static typename Driver::Config config(unsigned watermark) {
        typename Driver::Config c;
        if constexpr (detail::HasBlob<typename Driver::Config>::value) {
            c.blob = the_blob.data();
            c.blob_size = the_blob.size();
        }
        set_watermark(c, watermark, 0);
        return c;
    }
    template <class C>
    static auto set_watermark(C& c, unsigned n, int) -> decltype(c.watermark, void()) {
        c.watermark = static_cast<std::uint8_t>(n);
    }
    template <class C>
    static void set_watermark(C&, unsigned, long) {}
};

template <class Chip>
class ImuOnSpi : public ::testing::Test {};
using SpiImus = ::testing::Types<chips::Icm42688, chips::Icm45686, chips::Icm20948, chips::Lsm6dso,
                                 chips::Lsm6dsv, chips::Mpu6050, chips::Bmi160, chips::Bmi270>;
TYPED_TEST_SUITE(ImuOnSpi, SpiImus, );

TYPED_TEST(ImuOnSpi, StreamsThroughItsFifo) {
    OnSpi<TypeParam> rig;
    ASSERT_EQ(rig.driver.start(rig.config(8)), Status::ok);
    EXPECT_EQ(rig.driver.probe().status, Status::ok);
    EXPECT_EQ(rig.driver.check(), Status::ok);
    Batch batch;
    std::size_t total = 0;
    for (int n = 0; n < 20; ++n) {
        rig.world.pass(rig.driver.period_ns() * 8);
        ASSERT_EQ(rig.driver.read_fifo(no_edge, rig.world.now_ns, batch), Status::ok);
        EXPECT_EQ(batch.lost, 0u);
        for (std::size_t i = 0; i < batch.count; ++i)
            EXPECT_NEAR(batch.samples[i].accel_m_s2.z, 9.80665, 0.01);
        total += batch.count;
    }
    EXPECT_GE(total, 155u);
}

TYPED_TEST(ImuOnSpi, ReadsOneSampleInSiUnits) {
    OnSpi<TypeParam> rig;
    ASSERT_EQ(rig.driver.start(rig.config(0)), Status::ok);
    rig.world.pass(300000000);
    const auto sample = rig.driver.read(5);
    ASSERT_TRUE(sample);
    const test::Truth truth = ramp(rig.world.now_ns);
    EXPECT_NEAR(sample->gyro_rad_s.x, truth.gyro_rad_s.x, 0.01);
    EXPECT_NEAR(sample->accel_m_s2.y, truth.accel_m_s2.y, 0.02);
}

TYPED_TEST(ImuOnSpi, AFailedExchangeIsTold) {
    int transfers = 0;
    {
        OnSpi<TypeParam> rig;
        ASSERT_EQ(rig.driver.start(rig.config(8)), Status::ok);
        transfers = rig.world.transfers;
    }
    int untold = 0;  // looks at a chip that resets may fail
    for (int k = 0; k < transfers; ++k) {
        OnSpi<TypeParam> rig;
        rig.world.fail_at = k;
        rig.world.failure = Status::io_error;
        const Status s = rig.driver.start(rig.config(8));
        untold += s == Status::ok;
        rig.world.fail_at = -1;
        EXPECT_EQ(rig.driver.start(rig.config(8)), Status::ok) << "after a failure at " << k;
    }
    EXPECT_LE(untold, std::string{TypeParam::info.name} == "mpu6050" ? 12 : 0);
}

TYPED_TEST(ImuOnSpi, AnAbsentChipIsNotTaken) {
    OnSpi<TypeParam> rig;
    rig.chip->start_up_ns = INT64_MAX / 2;
    rig.chip->power_cycle();  // and never comes up: nobody drives the line
    const Status s = rig.driver.start(rig.config(8));
    EXPECT_TRUE(s == Status::unexpected_id || s == Status::timeout) << to_string(s);
}

TEST(MagOnSpi, Lis3mdlAndMmc5983ma) {
    const auto read = [](auto rig) {
        ASSERT_EQ(rig->driver.start({}), Status::ok);
        rig->world.pass(200000000);
        const auto sample = rig->driver.read(5);
        ASSERT_TRUE(sample);
        EXPECT_NEAR(sample->mag_uT.x, ramp(rig->world.now_ns).mag_uT.x, 0.05);
        EXPECT_NEAR(sample->mag_uT.z, ramp(rig->world.now_ns).mag_uT.z, 0.05);
    };
    read(std::make_unique<OnSpi<chips::Lis3mdl>>());
    read(std::make_unique<OnSpi<chips::Mmc5983ma>>());
}

/// Its two halves behind a chip select each, the accelerometer with a dummy byte and asleep at
/// first.
TEST(Bmi088OnSpi, StreamsThroughBothFifos) {
    sim::Bmi088Model chip{ramp};
    ModelBus world;
    world.chips = {&chip};
    ModelSpi gyro_wire{world, chip, bmi088::gyro_spi};
    ModelSpi accel_wire{world, chip.accel, bmi088::accel_spi};
    accel_wire.needs_wake = true;
    SpiBus<ModelSpi> gyro{gyro_wire, bmi088::gyro_spi}, accel{accel_wire, bmi088::accel_spi};
    BusPair<SpiBus<ModelSpi>> bus{gyro, accel, 0x18};
    Bmi088<BusPair<SpiBus<ModelSpi>>> driver{bus};
    Bmi088<BusPair<SpiBus<ModelSpi>>>::Config config;
    config.watermark = 8;
    ASSERT_EQ(driver.start(config), Status::ok);
    EXPECT_EQ(driver.check(), Status::ok);
    Batch batch;
    std::size_t total = 0, without = 0;
    for (int n = 0; n < 20; ++n) {
        world.pass(driver.period_ns() * 8);
        ASSERT_EQ(driver.read_fifo(no_edge, world.now_ns, batch), Status::ok);
        EXPECT_EQ(batch.lost, 0u);
        for (std::size_t i = 0; i < batch.count; ++i) {
            if ((batch.samples[i].flags & flag::accel_valid) == 0)
                ++without;
            else
                EXPECT_NEAR(batch.samples[i].accel_m_s2.z, 9.80665, 0.01);
        }
        total += batch.count;
    }
    EXPECT_GE(total, 155u);
    EXPECT_LE(without, 2u);
    config.watermark = 0;
    ASSERT_EQ(driver.start(config), Status::ok) << "the reset has put it to sleep again";
    world.pass(50000000);
    const auto sample = driver.read(5);
    ASSERT_TRUE(sample);
    EXPECT_NEAR(sample->accel_m_s2.y, ramp(world.now_ns).accel_m_s2.y, 0.02);
    EXPECT_EQ(bus.transfer(nullptr, 0), Status::bad_argument);
}

// ---- the table

TEST(Chips, TheTableAgreesWithItsDrivers) {
    std::size_t n = 0;
    for (const ChipInfo& info : ImuChips::infos) {
        EXPECT_TRUE(ImuChips::visit(info.name, [&](auto chip) {
            using Driver = typename decltype(chip)::template Driver<ModelBus>;
            EXPECT_EQ(Driver::default_address, info.addresses[0]) << info.name;
            ModelBus bus;
            Driver driver{bus};
            driver.probe();
            ++n;
        }));
        EXPECT_GT(info.ids_used, 0u);
        EXPECT_GT(info.fifo_bytes, 0u);
        EXPECT_EQ(ImuChips::find(info.name)->parts, info.parts);
    }
    EXPECT_EQ(n, ImuChips::infos.size());
    for (const ChipInfo& info : MagChips::infos)
        EXPECT_TRUE(MagChips::visit(info.name, [&](auto chip) {
            using Driver = typename decltype(chip)::template Driver<ModelBus>;
            EXPECT_EQ(Driver::default_address, info.addresses[0]) << info.name;
        }));
    EXPECT_EQ(ImuChips::find("mpu6051"), nullptr);
    EXPECT_FALSE(MagChips::visit("", [](auto) {}));
}

}  // namespace
}  // namespace fairlead::port
