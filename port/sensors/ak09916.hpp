#pragma once
// AKM AK09916 magnetometer: alone on the bus, or behind the bypass of an ICM-20948 or an MPU-9250
// board (open_bypass() below, or Mpu6xxx's Config::bypass).
//
// read() is one burst of nine bytes from ST1 to ST2: without reading ST2 the chip never updates
// again. It has no data-ready line here and no temperature; poll data_ready() beside the IMU.
// Source: data sheet AK09916C, DS-000189. start(): at most 8 transactions and 11 ms of pauses.
#include <cstddef>
#include <cstdint>

#include "port/sensors/driver.hpp"

namespace fairlead::port {

namespace ak09916 {

enum class Rate : std::uint8_t { hz_10 = 0x02, hz_20 = 0x04, hz_50 = 0x06, hz_100 = 0x08 };
constexpr std::int64_t period_ns(Rate r) noexcept {
    switch (r) {
        case Rate::hz_10: return 100000000;
        case Rate::hz_20: return 50000000;
        case Rate::hz_50: return 20000000;
        case Rate::hz_100: break;
    }
    return 10000000;
}
inline constexpr float uT_per_count = 0.15f;
inline constexpr Part parts[] = {{0x09, "AK09916"}};

struct Config {
    Rate rate{Rate::hz_100};
};

enum Reg : std::uint8_t { wia2 = 0x01, st1 = 0x10, cntl2 = 0x31, cntl3 = 0x32 };

/// Connects the magnetometer of an ICM-20948 to the bus: awake, own master off, bypass on.
template <class Bus>
Status open_bypass(Bus& bus, std::uint8_t icm20948_address = 0x68) noexcept {
    const Registers<Bus> chip{bus, icm20948_address};
    if (const Status s = chip.write(0x7F, 0x00); s != Status::ok) return s;  // bank 0
    if (const Status s = chip.expect(0x00, 0xEA); s != Status::ok)
        return s == Status::bad_data ? Status::unexpected_id : s;
    if (const Status s = chip.set(0x06, 0x01); s != Status::ok) return s;        // PWR_MGMT_1
    if (const Status s = chip.set(0x03, 0x00, 0x20); s != Status::ok) return s;  // USER_CTRL
    return chip.set(0x0F, 0x02, 0x02);                                           // INT_PIN_CFG
}

}  // namespace ak09916

template <class Bus>
class Ak09916 {
  public:
    using Config = ak09916::Config;
    static constexpr std::uint8_t default_address = 0x0C;

    explicit Ak09916(Bus& bus, std::uint8_t address = default_address,
                     UnknownId unknown = UnknownId::refuse) noexcept
        : chip_{bus, address}, unknown_{unknown} {}

    Probe probe() const noexcept {
        return probe_for(chip_, ak09916::wia2, ak09916::parts, unknown_);
    }

    Status start(const Config& config) noexcept {
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        return chip_.set(ak09916::cntl2, static_cast<std::uint8_t>(config.rate));
    }

    /// Does the mode still stand? bad_data after a reset or a brown-out.
    Status check() const noexcept {
        return chip_.expect(ak09916::cntl2, static_cast<std::uint8_t>(config_.rate));
    }

    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(ak09916::st1);
        if (!status) return status.status();
        return (*status & 0x01) != 0;
    }

    /// One transaction: the newest sample, stamped with the time given.
    Result<Sample> read(std::int64_t t_ns) noexcept {
        std::uint8_t b[9] = {};
        const Status s = chip_.read(ak09916::st1, b, sizeof b);
        if (s != Status::ok) return s;
        Sample sample;
        sample.t_ns = t_ns;
        sample.mag_uT = scaled(triple<little_endian>(b + 1), ak09916::uT_per_count);
        sample.flags = flag::mag_valid;
        if ((b[0] & 0x02) != 0) sample.flags |= flag::gap_before;  // DOR: one was overwritten
        if ((b[8] & 0x08) != 0) sample.flags |= flag::clipped | flag::mag_clipped;  // HOFL
        return sample;
    }

    /// Response in uT in the first three; passes within +-30 (x, y) and -150 to -30 (z).
    /// Leaves the chip in power-down: start() again. At most 40 ms.
    Status self_test(SelfTest& result) noexcept {
        result = {};
        if (const Status s = reset(); s != Status::ok) return s;
        if (const Status s = chip_.write(ak09916::cntl2, 0x10); s != Status::ok) return s;
        if (const Status s = chip_.await(ak09916::st1, 0x01, 0x01, 20, 1000); s != Status::ok)
            return s;
        const auto sample = read(0);
        if (!sample) return sample.status();
        const Vec3& m = sample->mag_uT;
        result.response = {m.x, m.y, m.z, 0, 0, 0};
        const auto within = [](float v, float low, float high) { return v >= low && v <= high; };
        result.passed = within(m.x, -30.1f, 30.1f) && within(m.y, -30.1f, 30.1f) &&
                        within(m.z, -150.1f, -29.9f);
        return reset();
    }

    std::int64_t period_ns() const noexcept { return ak09916::period_ns(config_.rate); }

  private:
    /// Modes change through power-down only, which the reset enters.
    Status reset() noexcept {
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        if (const Status s = chip_.write(ak09916::cntl3, 0x01); s != Status::ok) return s;
        const Status s = chip_.await(ak09916::cntl3, 0x01, 0x00, 10, 1000);
        chip_.bus().pause_us(100);
        return s;
    }

    Registers<Bus> chip_;
    UnknownId unknown_;
    Config config_{};
};

}  // namespace fairlead::port
