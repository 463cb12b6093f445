#pragma once
// QST QMC5883L and QMC5883P magnetometers. The two share a name and nothing else: addresses,
// registers and scales differ, and the P alone has a self test.
//
// read() is one burst of data and status. Neither has a temperature worth the name.
// Source: data sheets QMC5883L rev. 1.0 (13-52-04) and QMC5883P rev. C (13-52-19); register facts
// beside Linux's qmc5883l.c. start(): at most 10 transactions and 12 ms of pauses.
#include <cstddef>
#include <cstdint>

#include "port/sensors/mag_driver.hpp"

namespace fairlead::port {

namespace qmc5883 {

enum class Rate : std::uint8_t { hz_10, hz_50, hz_100, hz_200 };  // the codes of both parts
constexpr std::int64_t period_ns(Rate r) noexcept {
    switch (r) {
        case Rate::hz_10: return 100000000;
        case Rate::hz_50: return 20000000;
        case Rate::hz_100: return 10000000;
        case Rate::hz_200: break;
    }
    return 5000000;
}

struct L {
    enum class Range : std::uint8_t { gauss_2, gauss_8 };
    static constexpr Range widest = Range::gauss_8;
    static constexpr Part parts[] = {{0xFF, "QMC5883L"}};
    static constexpr std::uint8_t address = 0x0D, id_reg = 0x0D, status = 0x06, first = 0x00;
    static constexpr std::uint8_t reset_reg = 0x0A;
    static constexpr bool has_self_test = false;
    static constexpr float uT_per_count(Range r) noexcept {
        return 100.0f / (r == Range::gauss_2 ? 12000.0f : 3000.0f);
    }
    template <class S>
    static void add_settings(Rate rate, Range range, S& settings) noexcept {
        settings.add(0x0B, 0x01);        // period of set and reset, as the data sheet asks
        settings.add(0x0A, 0x41, 0x41);  // the pointer rolls over, no interrupt pin
        settings.add(0x09, static_cast<std::uint8_t>(0x01 | static_cast<int>(rate) << 2 |
                                                     static_cast<int>(range) << 4));
    }
};

struct P {
    enum class Range : std::uint8_t { gauss_30, gauss_12, gauss_8, gauss_2 };
    static constexpr Range widest = Range::gauss_30;
    static constexpr Part parts[] = {{0x80, "QMC5883P"}};
    static constexpr std::uint8_t address = 0x2C, id_reg = 0x00, status = 0x09, first = 0x01;
    static constexpr std::uint8_t reset_reg = 0x0B;
    static constexpr bool has_self_test = true;
    static constexpr float uT_per_count(Range r) noexcept {
        const float counts_per_gauss[4] = {1000, 2500, 3750, 15000};
        return 100.0f / counts_per_gauss[static_cast<int>(r)];
    }
    template <class S>
    static void add_settings(Rate rate, Range range, S& settings) noexcept {
        settings.add(0x29, 0x06);  // signs of the axes, as the data sheet asks
        settings.add(0x0B, static_cast<std::uint8_t>(static_cast<int>(range) << 2));
        settings.add(0x0A, static_cast<std::uint8_t>(0x03 | static_cast<int>(rate) << 2));
    }
};

}  // namespace qmc5883

template <class Bus, class Family>
class Qmc5883 : public MagDriver<Bus, 3> {
    using Base = MagDriver<Bus, 3>;
    using Base::chip_, Base::unknown_, Base::settings_;

  public:
    using Range = typename Family::Range;
    struct Config {
        qmc5883::Rate rate{qmc5883::Rate::hz_100};
        Range range{Family::widest};
    };
    static constexpr std::uint8_t default_address = Family::address;

    explicit Qmc5883(Bus& bus, std::uint8_t address = default_address,
                     UnknownId unknown = UnknownId::refuse) noexcept
        : Base{bus, address, unknown} {}

    Probe probe() const noexcept {
        return probe_for(chip_, Family::id_reg, Family::parts, unknown_);
    }

    Status start(const Config& config) noexcept {
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        settings_.clear();
        Family::add_settings(config.rate, config.range, settings_);
        return settings_.write(chip_);
    }

    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(Family::status);
        if (!status) return status.status();
        return (*status & 0x01) != 0;
    }

    /// One transaction: the newest sample, stamped with the time given.
    Result<Sample> read(std::int64_t t_ns) noexcept {
        std::uint8_t b[9] = {};  // the data, then up to the status: 7 bytes of the L, 9 of the P
        constexpr std::size_t size = Family::status - Family::first + 1u;
        static_assert(size <= sizeof b);
        const Status s = chip_.read(Family::first, b, size);
        if (s != Status::ok) return s;
        const auto raw = triple<little_endian>(b);
        const std::uint8_t status = b[size - 1];
        const bool clipped = (status & 0x02) != 0 || at_end(raw);
        const bool skipped = !Family::has_self_test && (status & 0x04) != 0;  // DOR of the L
        return Base::to_sample(scaled(raw, Family::uT_per_count(config_.range)), t_ns, clipped,
                               skipped);
    }

    /// P: response in uT in the first three, passes from 30 to 400 on every axis; leaves the chip
    /// reset: start() again; at most 0.2 s. L: not_supported, the part has none.
    Status self_test(SelfTest& result) noexcept {
        result = {};
        if constexpr (!Family::has_self_test) {
            return Status::not_supported;
        } else {
            Config test;
            test.range = Range::gauss_8;
            if (const Status s = start(test); s != Status::ok) return s;
            Vec3 off, on;
            const auto look = [this] { return read(0); };
            if (const Status s = Base::average(5, 12000, off, look); s != Status::ok) return s;
            if (const Status s = chip_.write(0x0B, 0x40 | 0x08); s != Status::ok) return s;
            if (const Status s = Base::average(5, 12000, on, look); s != Status::ok) return s;
            Base::judge(off, on, {30, 30, 30}, {400, 400, 400}, result);
            return reset();
        }
    }

    std::int64_t period_ns() const noexcept { return qmc5883::period_ns(config_.rate); }

  private:
    Status reset() noexcept {
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        if (const Status s = chip_.write(Family::reset_reg, 0x80); s != Status::ok) return s;
        chip_.bus().pause_us(1000);
        return chip_.await(Family::reset_reg, 0x80, 0x00, 10, 1000);
    }

    Config config_{};
};

template <class Bus>
using Qmc5883l = Qmc5883<Bus, qmc5883::L>;
template <class Bus>
using Qmc5883p = Qmc5883<Bus, qmc5883::P>;

}  // namespace fairlead::port
