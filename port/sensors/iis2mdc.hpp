#pragma once
// ST IIS2MDC magnetometer, and LIS2MDL, which is the same die: 0.15 uT a count, one range.
//
// read() is one burst of nine bytes: status, field, temperature. Temperature compensation, offset
// cancellation and the low-pass filter are on. SPI is three-wire from the start (4WSPI turns it
// into four) and is not offered here. Source: data sheet DS12069 (LIS2MDL DS12144); register facts
// beside Linux's st_magn_core.c. start(): at most 12 transactions and 10 ms of pauses.
#include <cstddef>
#include <cstdint>

#include "port/sensors/mag_driver.hpp"

namespace fairlead::port {

namespace iis2mdc {

enum class Rate : std::uint8_t { hz_10, hz_20, hz_50, hz_100 };
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
inline constexpr Part parts[] = {{0x40, "IIS2MDC"}};

struct Config {
    Rate rate{Rate::hz_100};
};

enum Reg : std::uint8_t {
    who_am_i = 0x4F,
    cfg_a = 0x60,
    cfg_b = 0x61,
    cfg_c = 0x62,
    status = 0x67
};

}  // namespace iis2mdc

template <class Bus>
class Iis2mdc : public MagDriver<Bus, 3> {
    using Base = MagDriver<Bus, 3>;
    using Base::chip_, Base::unknown_, Base::settings_, Base::temperature_c_;

  public:
    using Config = iis2mdc::Config;
    static constexpr std::uint8_t default_address = 0x1E;

    explicit Iis2mdc(Bus& bus, std::uint8_t address = default_address,
                     UnknownId unknown = UnknownId::refuse) noexcept
        : Base{bus, address, unknown} {}

    Probe probe() const noexcept {
        return probe_for(chip_, iis2mdc::who_am_i, iis2mdc::parts, unknown_);
    }

    Status start(const Config& config) noexcept {
        using namespace iis2mdc;
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        settings_.clear();
        settings_.add(cfg_b, 0x03);  // offset cancellation, low-pass filter
        settings_.add(cfg_c, 0x11);  // block data update, data-ready on the pin
        settings_.add(cfg_a, static_cast<std::uint8_t>(0x80 | static_cast<int>(config.rate) << 2));
        return settings_.write(chip_);
    }

    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(iis2mdc::status);
        if (!status) return status.status();
        return (*status & 0x08) != 0;
    }

    /// One transaction: the newest sample, stamped with the time of its edge.
    Result<Sample> read(std::int64_t edge_ns) noexcept {
        std::uint8_t b[9] = {};
        const Status s = chip_.read(iis2mdc::status, b, sizeof b);
        if (s != Status::ok) return s;
        const auto raw = triple<little_endian>(b + 1);
        temperature_c_ = static_cast<float>(little_endian(b + 7)) / 8.0f + 25.0f;
        return Base::to_sample(scaled(raw, iis2mdc::uT_per_count), edge_ns, at_end(raw),
                               (b[0] & 0x80) != 0);
    }

    /// Response in uT in the first three; passes at 1.5 to 50 on every axis (15 to 500 mG).
    /// Leaves the chip reset: start() again. At most 1.3 s.
    Status self_test(SelfTest& result) noexcept {
        using namespace iis2mdc;
        result = {};
        if (const Status s = start({}); s != Status::ok) return s;
        Vec3 off, on;
        const auto look = [this] { return read(0); };
        chip_.bus().pause_us(20000);
        if (const Status s = Base::average(50, 10500, off, look); s != Status::ok) return s;
        if (const Status s = chip_.set(cfg_c, 0x13); s != Status::ok) return s;
        chip_.bus().pause_us(60000);
        if (const Status s = Base::average(50, 10500, on, look); s != Status::ok) return s;
        Base::judge(off, on, {1.5f, 1.5f, 1.5f}, {50, 50, 50}, result);
        return reset();
    }

    std::int64_t period_ns() const noexcept { return iis2mdc::period_ns(config_.rate); }

  private:
    Status reset() noexcept {
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        if (const Status s = chip_.write(iis2mdc::cfg_a, 0x20); s != Status::ok) return s;
        return chip_.await(iis2mdc::cfg_a, 0x20, 0x00, 10, 1000);
    }

    Config config_{};
};

}  // namespace fairlead::port
