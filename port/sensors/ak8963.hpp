#pragma once
// AKM AK8963 magnetometer, inside MPU-9250 and MPU-9255: behind the bypass of its IMU
// (Mpu6xxx's Config::bypass), at 0x0C.
//
// start() reads the factory's sensitivity adjustment from the fuse ROM; read() is one burst of
// eight bytes from ST1 to ST2: without reading ST2 the chip never updates again. 16 bits, 0.15 uT a
// count before the adjustment H * ((ASA - 128) / 256 + 1). The axes are the chip's own: inside an
// MPU-9250 its x and y are exchanged and its z points the other way against the IMU's; read() turns
// them into the IMU's axes unless Config::own_axes says otherwise. Source: data sheet MS1356-E-02;
// PS-MPU-9250A, section 9.1. start(): at most 14 transactions and 12 ms of pauses.
#include <cstddef>
#include <cstdint>

#include "port/sensors/mag_driver.hpp"

namespace fairlead::port {

namespace ak8963 {

enum class Rate : std::uint8_t { hz_8 = 0x12, hz_100 = 0x16 };  // with the bit for 16 bits
constexpr std::int64_t period_ns(Rate r) noexcept { return r == Rate::hz_8 ? 125000000 : 10000000; }
inline constexpr float uT_per_count = 0.15f;
inline constexpr Part parts[] = {{0x48, "AK8963"}};

struct Config {
    Rate rate{Rate::hz_100};
    bool own_axes{false};
};

enum Reg : std::uint8_t {
    wia = 0x00,
    st1 = 0x02,
    cntl1 = 0x0A,
    cntl2 = 0x0B,
    astc = 0x0C,
    asax = 0x10,
};

/// Multiplier by the factory's byte.
constexpr float adjustment(std::uint8_t asa) noexcept {
    return static_cast<float>(static_cast<int>(asa) - 128) / 256.0f + 1.0f;
}

}  // namespace ak8963

template <class Bus>
class Ak8963 : public MagDriver<Bus, 1> {
    using Base = MagDriver<Bus, 1>;
    using Base::chip_, Base::unknown_, Base::settings_;

  public:
    using Config = ak8963::Config;
    static constexpr std::uint8_t default_address = 0x0C;

    explicit Ak8963(Bus& bus, std::uint8_t address = default_address,
                    UnknownId unknown = UnknownId::refuse) noexcept
        : Base{bus, address, unknown} {}

    Probe probe() const noexcept { return probe_for(chip_, ak8963::wia, ak8963::parts, unknown_); }

    Status start(const Config& config) noexcept {
        using namespace ak8963;
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        std::uint8_t asa[3] = {};
        if (const Status s = chip_.set(cntl1, 0x0F, 0x0F); s != Status::ok) return s;  // fuse ROM
        if (const Status s = chip_.read(asax, asa, sizeof asa); s != Status::ok) return s;
        scale_ = {adjustment(asa[0]) * uT_per_count, adjustment(asa[1]) * uT_per_count,
                  adjustment(asa[2]) * uT_per_count};
        if (const Status s = power_down(); s != Status::ok) return s;
        settings_.clear();
        settings_.add(cntl1, static_cast<std::uint8_t>(config.rate));
        return settings_.write(chip_);
    }

    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(ak8963::st1);
        if (!status) return status.status();
        return (*status & 0x01) != 0;
    }

    /// One transaction: the newest sample, stamped with the time given.
    Result<Sample> read(std::int64_t t_ns) noexcept {
        std::uint8_t b[8] = {};
        const Status s = chip_.read(ak8963::st1, b, sizeof b);
        if (s != Status::ok) return s;
        const auto raw = triple<little_endian>(b + 1);
        const Vec3 own{static_cast<float>(raw[0]) * scale_.x, static_cast<float>(raw[1]) * scale_.y,
                       static_cast<float>(raw[2]) * scale_.z};
        const Vec3 field = config_.own_axes ? own : Vec3{own.y, own.x, -own.z};
        return Base::to_sample(field, t_ns, (b[7] & 0x08) != 0, (b[0] & 0x02) != 0);
    }

    /// Response in uT, the chip's own axes, in the first three; passes within +-30 (x, y) and -480
    /// to -120 (z). Leaves the chip in power-down: start() again. At most 40 ms.
    Status self_test(SelfTest& result) noexcept {
        using namespace ak8963;
        result = {};
        Config test;
        test.own_axes = true;
        if (const Status s = start(test); s != Status::ok) return s;
        if (const Status s = power_down(); s != Status::ok) return s;
        if (const Status s = chip_.write(astc, 0x40); s != Status::ok) return s;
        if (const Status s = chip_.write(cntl1, 0x18); s != Status::ok) return s;
        if (const Status s = chip_.await(st1, 0x01, 0x01, 20, 1000); s != Status::ok) return s;
        const auto sample = read(0);
        if (!sample) return sample.status();
        const Vec3& m = sample->mag_uT;
        result.response = {m.x, m.y, m.z, 0, 0, 0};
        const auto within = [](float v, float low, float high) { return v >= low && v <= high; };
        result.passed = within(m.x, -30, 30) && within(m.y, -30, 30) && within(m.z, -480, -120);
        if (const Status s = chip_.write(astc, 0x00); s != Status::ok) return s;
        return reset();
    }

    std::int64_t period_ns() const noexcept { return ak8963::period_ns(config_.rate); }

  private:
    Status reset() noexcept {
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        if (const Status s = chip_.write(ak8963::cntl2, 0x01); s != Status::ok) return s;
        const Status s = chip_.await(ak8963::cntl2, 0x01, 0x00, 10, 1000);
        chip_.bus().pause_us(100);
        return s;
    }
    /// Modes change through power-down only, which lasts at least 100 us.
    Status power_down() noexcept {
        const Status s = chip_.set(ak8963::cntl1, 0x00, 0x0F);
        chip_.bus().pause_us(100);
        return s;
    }

    Config config_{};
    Vec3 scale_{ak8963::uT_per_count, ak8963::uT_per_count, ak8963::uT_per_count};
};

}  // namespace fairlead::port
