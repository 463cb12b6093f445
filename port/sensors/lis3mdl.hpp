#pragma once
// ST LIS3MDL magnetometer. read() is one burst of status, field and temperature.
//
// A chip without a FIFO: an overrun (a sample that nobody read) is told by its status and becomes
// gap_before. Source: data sheet DocID024204, self-test limits from AN4602. start(): at most 16
// transactions and 10 ms of pauses.
#include <cstddef>
#include <cstdint>

#include "port/sensors/driver.hpp"

namespace fairlead::port {

namespace lis3mdl {

/// The upper codes set FAST_ODR, where the rate follows from the performance mode.
enum class Rate : std::uint8_t {
    hz_0_625 = 0x00,
    hz_1_25 = 0x04,
    hz_2_5 = 0x08,
    hz_5 = 0x0C,
    hz_10 = 0x10,
    hz_20 = 0x14,
    hz_40 = 0x18,
    hz_80 = 0x1C,
    hz_155 = 0x62,
    hz_300 = 0x42,
    hz_560 = 0x22,
    hz_1000 = 0x02,
};
constexpr std::int64_t period_ns(Rate r) noexcept {
    switch (r) {
        case Rate::hz_155: return 1000000000 / 155;
        case Rate::hz_300: return 1000000000 / 300;
        case Rate::hz_560: return 1000000000 / 560;
        case Rate::hz_1000: return 1000000;
        default: return 1600000000 >> (static_cast<int>(r) >> 2);
    }
}
enum class Range : std::uint8_t { gauss_4, gauss_8, gauss_12, gauss_16 };
constexpr float uT_per_count(Range r) noexcept {
    constexpr float counts_per_gauss[] = {6842.0f, 3421.0f, 2281.0f, 1711.0f};
    return 100.0f / counts_per_gauss[static_cast<int>(r)];
}

inline constexpr Part parts[] = {{0x3D, "LIS3MDL"}};

struct Config {
    Rate rate{Rate::hz_155};
    Range range{Range::gauss_4};
};

enum Reg : std::uint8_t {
    who_am_i = 0x0F,
    ctrl1 = 0x20,
    ctrl2 = 0x21,
    ctrl3 = 0x22,
    ctrl4 = 0x23,
    ctrl5 = 0x24,
    status = 0x27,
    increment = 0x80,
};

}  // namespace lis3mdl

template <class Bus>
class Lis3mdl {
  public:
    using Config = lis3mdl::Config;
    static constexpr std::uint8_t default_address = 0x1C;

    explicit Lis3mdl(Bus& bus, std::uint8_t address = default_address,
                     UnknownId unknown = UnknownId::refuse) noexcept
        : chip_{bus, address}, unknown_{unknown} {}

    Probe probe() const noexcept {
        return probe_for(chip_, lis3mdl::who_am_i, lis3mdl::parts, unknown_);
    }

    Status start(const Config& config) noexcept {
        using namespace lis3mdl;
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        const auto rate = static_cast<std::uint8_t>(config.rate);
        const bool fast = (rate & 0x02) != 0;  // its mode bits are part of the rate
        settings_.clear();
        settings_.add(ctrl1, static_cast<std::uint8_t>(0x80 | rate | (fast ? 0 : 0x60)));
        settings_.add(ctrl2, static_cast<std::uint8_t>(static_cast<int>(config.range) << 5));
        settings_.add(ctrl4, static_cast<std::uint8_t>(fast ? (rate & 0x60) >> 3 : 0x0C));
        settings_.add(ctrl5, 0x40);  // block data update
        settings_.add(ctrl3, 0x00);  // continuous
        return settings_.write(chip_);
    }

    /// Do the settings still stand? bad_data after a reset or a brown-out.
    Status check() const noexcept { return settings_.check(chip_); }

    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(lis3mdl::status);
        if (!status) return status.status();
        return (*status & 0x08) != 0;
    }

    /// One transaction: the newest sample, stamped with the time of its edge.
    Result<Sample> read(std::int64_t edge_ns) noexcept {
        std::uint8_t b[9] = {};
        const Status s = chip_.read(lis3mdl::status | lis3mdl::increment, b, sizeof b);
        if (s != Status::ok) return s;
        const auto raw = triple<little_endian>(b + 1);
        Sample sample;
        sample.t_ns = edge_ns;
        sample.mag_uT = scaled(raw, lis3mdl::uT_per_count(config_.range));
        sample.flags = flag::mag_valid;
        if (at_end(raw)) sample.flags |= flag::clipped | flag::mag_clipped;
        if ((b[0] & 0x80) != 0) sample.flags |= flag::gap_before;  // one was overwritten, at least
        temperature_c_ = static_cast<float>(little_endian(b + 7)) / 8.0f + 25.0f;
        return sample;
    }

    /// Response in uT in the first three; passes at 100 to 300 (x, y) and 10 to 100 (z).
    /// Leaves the chip reset: start() again. At most 0.3 s.
    Status self_test(SelfTest& result) noexcept {
        using namespace lis3mdl;
        result = {};
        Config test;
        test.rate = Rate::hz_80;
        test.range = Range::gauss_12;
        if (const Status s = start(test); s != Status::ok) return s;
        Vec3 off, on;
        if (const Status s = average(off); s != Status::ok) return s;
        const auto with_st = static_cast<std::uint8_t>(0x80 | 0x60 | 0x1C | 0x01);
        if (const Status s = chip_.set(ctrl1, with_st); s != Status::ok) return s;
        if (const Status s = average(on); s != Status::ok) return s;
        const float change[3] = {on.x - off.x, on.y - off.y, on.z - off.z};
        result.passed = true;
        for (std::size_t i = 0; i < 3; ++i) {
            const float response = change[i] < 0 ? -change[i] : change[i];
            result.response[i] = response;
            if (response < (i < 2 ? 100.0f : 10.0f) || response > (i < 2 ? 300.0f : 100.0f))
                result.passed = false;
        }
        return reset();
    }

    float temperature_c() const noexcept { return temperature_c_; }
    std::int64_t period_ns() const noexcept { return lis3mdl::period_ns(config_.rate); }

  private:
    Status reset() noexcept {
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        if (const Status s = chip_.write(lis3mdl::ctrl2, 0x04); s != Status::ok) return s;
        return chip_.await(lis3mdl::ctrl2, 0x04, 0x00, 10, 1000);
    }

    Status average(Vec3& mean) noexcept {
        chip_.bus().pause_us(60000);
        mean = {};
        for (int n = 0; n < 5; ++n) {
            chip_.bus().pause_us(13000);
            const auto sample = read(0);
            if (!sample) return sample.status();
            mean.x += 0.2f * sample->mag_uT.x;
            mean.y += 0.2f * sample->mag_uT.y;
            mean.z += 0.2f * sample->mag_uT.z;
        }
        return Status::ok;
    }

    Registers<Bus> chip_;
    UnknownId unknown_;
    Config config_{};
    Settings<6> settings_{};
    float temperature_c_{0};
};

}  // namespace fairlead::port
