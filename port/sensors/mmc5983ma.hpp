#pragma once
// MEMSIC MMC5983MA magnetometer: 18 bits, +-8 G, 16384 counts per gauss.
//
// Its bridge can be magnetised by a strong field; a SET pulse mends that, and the chip gives one by
// itself after every 100 measurements here. The control registers cannot be read back, so check()
// asks another question: does the chip still measure, as start() told it to?
// Source: data sheet MMC5983MA rev. A. start(): 7 transactions and 15 ms of pauses.
#include <cstddef>
#include <cstdint>

#include "port/sensors/mag_driver.hpp"

namespace fairlead::port {

namespace mmc5983ma {

enum class Rate : std::uint8_t { hz_10 = 2, hz_20 = 3, hz_50 = 4, hz_100 = 5, hz_200 = 6 };
constexpr std::int64_t period_ns(Rate r) noexcept {
    switch (r) {
        case Rate::hz_10: return 100000000;
        case Rate::hz_20: return 50000000;
        case Rate::hz_50: return 20000000;
        case Rate::hz_100: return 10000000;
        case Rate::hz_200: break;
    }
    return 5000000;
}
inline constexpr float uT_per_count = 100.0f / 16384.0f;
inline constexpr std::int32_t zero_count = 131072;
inline constexpr Part parts[] = {{0x30, "MMC5983MA"}};

struct Config {
    Rate rate{Rate::hz_100};
};

enum Reg : std::uint8_t {
    out = 0x00,
    status = 0x08,
    control0 = 0x09,
    control1 = 0x0A,
    control2 = 0x0B,
    product_id = 0x2F,
};

}  // namespace mmc5983ma

template <class Bus>
class Mmc5983ma : public MagDriver<Bus, 1> {
    using Base = MagDriver<Bus, 1>;
    using Base::chip_, Base::unknown_;

  public:
    using Config = mmc5983ma::Config;
    static constexpr std::uint8_t default_address = 0x30;

    explicit Mmc5983ma(Bus& bus, std::uint8_t address = default_address,
                       UnknownId unknown = UnknownId::refuse) noexcept
        : Base{bus, address, unknown} {}

    Probe probe() const noexcept {
        return probe_for(chip_, mmc5983ma::product_id, mmc5983ma::parts, unknown_);
    }

    Status start(const Config& config) noexcept {
        using namespace mmc5983ma;
        config_ = config;
        if (const Status s = reset(); s != Status::ok) return s;
        // a bandwidth that measures in 4 ms, or 2 ms at 200 Hz
        const bool fast = config.rate == Rate::hz_200;
        if (const Status s = chip_.write(control1, fast ? 0x02 : 0x01); s != Status::ok) return s;
        if (const Status s = chip_.write(control0, 0x08); s != Status::ok) return s;  // SET
        chip_.bus().pause_us(1000);
        if (const Status s = chip_.write(control0, 0x20); s != Status::ok) return s;  // automatic
        // continuous at the rate, SET after every 100 measurements
        const auto mode =
            static_cast<std::uint8_t>(0x80 | 3 << 4 | 0x08 | static_cast<int>(config.rate));
        return chip_.write(control2, mode);
    }

    /// bad_data when two periods pass without a measurement: the chip has lost its settings. At
    /// most 20 transactions and two periods of pauses.
    Status check() const noexcept {
        using namespace mmc5983ma;
        if (const Status s = chip_.expect(product_id, parts[0].id);
            s != Status::ok && unknown_ == UnknownId::refuse)
            return s;
        // a measurement that waits already may be older than the loss: it is taken first
        std::uint8_t b[7] = {};
        if (const Status s = chip_.read(out, b, sizeof b); s != Status::ok) return s;
        const auto step_us = static_cast<std::uint32_t>(mmc5983ma::period_ns(config_.rate) / 8000);
        for (int i = 0; i < 17; ++i) {
            const auto ready = data_ready();
            if (!ready) return ready.status();
            if (*ready) return Status::ok;
            chip_.bus().pause_us(step_us);
        }
        return Status::bad_data;
    }

    Result<bool> data_ready() const noexcept {
        const auto status = chip_.read(mmc5983ma::status);
        if (!status) return status.status();
        return (*status & 0x01) != 0;
    }

    /// One transaction: the newest sample, stamped with the time given.
    Result<Sample> read(std::int64_t t_ns) noexcept {
        std::uint8_t b[7] = {};
        const Status s = chip_.read(mmc5983ma::out, b, sizeof b);
        if (s != Status::ok) return s;
        bool clipped = false;
        float field[3] = {};
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t low = b[6] >> (6 - 2 * static_cast<int>(i)) & 3;
            const std::int32_t count = b[2 * i] << 10 | b[2 * i + 1] << 2 | low;
            clipped = clipped || count < 16 || count > 262143 - 16;
            field[i] = static_cast<float>(count - mmc5983ma::zero_count) * mmc5983ma::uT_per_count;
        }
        return Base::to_sample({field[0], field[1], field[2]}, t_ns, clipped, false);
    }

    /// The part has no self test of its own; the bridge is tested instead: SET and RESET must turn
    /// the sign of what it measures. Response: half the difference in uT, which is the field
    /// without offset; passes when its length is 10 to 200 uT, so anywhere on Earth away from iron.
    /// Leaves the chip reset: start() again. At most 60 ms.
    Status self_test(SelfTest& result) noexcept {
        using namespace mmc5983ma;
        result = {};
        if (const Status s = reset(); s != Status::ok) return s;
        Vec3 field[2];
        const std::uint8_t pulse[2] = {0x08, 0x10};  // SET, RESET
        for (std::size_t i = 0; i < 2; ++i) {
            if (const Status s = chip_.write(control0, pulse[i]); s != Status::ok) return s;
            chip_.bus().pause_us(1000);
            if (const Status s = chip_.write(control0, 0x01); s != Status::ok) return s;  // one
            if (const Status s = chip_.await(status, 0x01, 0x01, 20, 1000); s != Status::ok)
                return s;
            const auto sample = read(0);
            if (!sample) return sample.status();
            field[i] = sample->mag_uT;
        }
        const Vec3 half = 0.5f * (field[0] - field[1]);
        result.response = {half.x, half.y, half.z, 0, 0, 0};
        const float square = dot(half, half);
        result.passed = square >= 100.0f && square <= 40000.0f;
        return reset();
    }

    std::int64_t period_ns() const noexcept { return mmc5983ma::period_ns(config_.rate); }

  private:
    Status reset() noexcept {
        if (const Probe p = probe(); p.status != Status::ok) return p.status;
        const Status s = chip_.write(mmc5983ma::control1, 0x80);
        chip_.bus().pause_us(12000);  // the data sheet's power-on time is 10 ms
        return s;
    }

    Config config_{};
};

}  // namespace fairlead::port
