#pragma once
// What the drivers of all families share, written once: who is there, what the chip was told and
// whether it still stands, the way from ticks to times, and how long it settles.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "port/sensors/bus.hpp"
#include "port/sensors/fifo.hpp"
#include "port/sensors/imu.hpp"
#include "port/sensors/timeline.hpp"

namespace fairlead::port {

/// A member of a family, by what it answers.
struct Part {
    std::uint8_t id;
    const char* name;
};

/// Who answers at this address? Kind: anything with an id and a name. One transaction.
template <class Bus, class Kind, std::size_t N>
Probe probe_for(const Registers<Bus>& chip, std::uint8_t reg, const Kind (&parts)[N],
                UnknownId unknown) noexcept {
    Probe p;
    p.address = chip.address();
    p.reg = reg;
    p.expected = parts[0].id;
    const auto id = chip.read(reg);
    p.status = id.status();
    if (!id) return p;
    p.got = *id;
    p.status = unknown == UnknownId::accept ? Status::ok : Status::unexpected_id;
    for (const Kind& part : parts)
        if (part.id == p.got) {
            p.status = Status::ok;
            p.part = part.name;
        }
    return p;
}

/// The part of an inertial driver that does not depend on the family. `Most`: settings at most.
template <class Bus, std::size_t Most>
class ImuDriver {
  public:
    /// Do the settings still stand? bad_data after a reset or a brown-out. One transaction each.
    Status check() const noexcept { return settings_.check(chip_); }

    /// Of the gyroscope's die, as last read; not a number until then (a FIFO without temperatures).
    float temperature_c() const noexcept { return temperature_c_; }
    std::int64_t period_ns() const noexcept { return line_.period_ns(); }
    const Timeline& timeline() const noexcept { return line_; }
    const ImuScale& scale() const noexcept { return scale_; }

  protected:
    ImuDriver(Bus& bus, std::uint8_t address, UnknownId unknown) noexcept
        : chip_{bus, address}, unknown_{unknown} {}

    /// flag::settling until the sensors have started, in samples counted from start().
    void settle_for(std::int64_t ns) noexcept {
        settling_ = static_cast<std::uint32_t>(ns / line_.period_ns());
    }
    std::uint32_t settle() noexcept {
        if (settling_ == 0) return 0;
        --settling_;
        return flag::settling;
    }

    /// Mean counts over 200 samples at 1 kHz from registers of big-endian words, gyro x y z first.
    template <std::size_t Size>
    Status average(std::uint8_t reg, std::size_t gyro_at, std::size_t accel_at,
                   std::uint32_t settle_us, std::array<float, 6>& mean) const noexcept {
        chip_.bus().pause_us(settle_us);
        std::array<std::int32_t, 6> sum{};
        for (int n = 0; n < 200; ++n) {
            std::uint8_t b[Size] = {};
            const Status s = chip_.read(reg, b, Size);
            if (s != Status::ok) return s;
            for (std::size_t i = 0; i < 3; ++i) {
                sum[i] += big_endian(b + gyro_at + 2 * i);
                sum[3 + i] += big_endian(b + accel_at + 2 * i);
            }
            chip_.bus().pause_us(1000);
        }
        for (std::size_t i = 0; i < 6; ++i) mean[i] = static_cast<float>(sum[i]) / 200.0f;
        return Status::ok;
    }

    Registers<Bus> chip_;
    UnknownId unknown_;
    Settings<Most> settings_{};
    ImuScale scale_{};
    Timeline line_{};
    std::uint32_t settling_{0};
    float temperature_c_{std::numeric_limits<float>::quiet_NaN()};
};

}  // namespace fairlead::port
