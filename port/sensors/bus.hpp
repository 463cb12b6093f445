#pragma once
// The one primitive that sensor drivers ask of a bus: run a list of transfers as one transaction.
//
// A Bus is any type with these three members; Linux's I2c (port/linux/i2c.hpp) is one, a board's
// HAL needs about 30 lines to be another:
//   Status transfer(const Transfer* list, std::size_t count);  // repeated starts, one stop
//   std::size_t read_max() const;               // longest read in one transfer, bytes
//   void pause_us(std::uint32_t microseconds);  // at least so long; start-up and self-test only
// Nothing on a driver's read path pauses or retries.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"

namespace fairlead::port {

/// Write, then read after a repeated start. Either side may be empty, not both.
struct Transfer {
    std::uint8_t address{};  // 7 bits, unshifted
    const std::uint8_t* out{};
    std::uint16_t out_size{};
    std::uint8_t* in{};
    std::uint16_t in_size{};
};

/// A chip with 8-bit register addresses. Cost: one transaction a call, except where stated.
template <class Bus>
class Registers {
  public:
    Registers(Bus& bus, std::uint8_t address) noexcept : bus_{&bus}, address_{address} {}

    Bus& bus() const noexcept { return *bus_; }
    std::uint8_t address() const noexcept { return address_; }

    Status read(std::uint8_t reg, std::uint8_t* data, std::size_t size) const noexcept {
        const Transfer t{address_, &reg, 1, data, static_cast<std::uint16_t>(size)};
        return bus_->transfer(&t, 1);
    }
    Result<std::uint8_t> read(std::uint8_t reg) const noexcept {
        std::uint8_t value = 0;
        if (const Status s = read(reg, &value, 1); s != Status::ok) return s;
        return value;
    }
    Status write(std::uint8_t reg, std::uint8_t value) const noexcept {
        const std::uint8_t bytes[2] = {reg, value};
        const Transfer t{address_, bytes, 2, nullptr, 0};
        return bus_->transfer(&t, 1);
    }
    /// Does the register hold what it should, in the bits of the mask?
    Status expect(std::uint8_t reg, std::uint8_t value, std::uint8_t mask = 0xFF) const noexcept {
        const auto got = read(reg);
        if (!got) return got.status();
        return (*got & mask) == (value & mask) ? Status::ok : Status::bad_data;
    }
    /// Writes and reads back: bad_data when the chip keeps something else. Two transactions.
    Status set(std::uint8_t reg, std::uint8_t value, std::uint8_t mask = 0xFF) const noexcept {
        if (const Status s = write(reg, value); s != Status::ok) return s;
        return expect(reg, value, mask);
    }
    /// Waits until the bits of the mask read as `value`: `tries` looks, `pause_us` apart.
    Status await(std::uint8_t reg, std::uint8_t mask, std::uint8_t value, int tries,
                 std::uint32_t pause_us) const noexcept {
        for (int i = 0; i < tries; ++i) {
            const auto got = read(reg);
            if (!got) return got.status();
            if ((*got & mask) == value) return Status::ok;
            bus_->pause_us(pause_us);
        }
        return Status::timeout;
    }

  private:
    Bus* bus_;
    std::uint8_t address_;
};

/// A register and the value that start() leaves in it, for checks after the event.
struct Setting {
    std::uint8_t reg{};
    std::uint8_t value{};
    std::uint8_t mask{0xFF};
};

/// The settings of a running chip, written and read back one by one, and compared again when a
/// reset is suspected. At most N of them.
template <std::size_t N>
class Settings {
  public:
    void clear() noexcept { size_ = 0; }
    void add(std::uint8_t reg, std::uint8_t value, std::uint8_t mask = 0xFF) noexcept {
        FAIRLEAD_ASSERT(size_ < N);
        items_[size_] = {reg, value, mask};
        ++size_;
    }
    /// Another value for a register that is already in the list, all bits of it.
    void replace(std::uint8_t reg, std::uint8_t value) noexcept {
        for (std::size_t i = 0; i < size_; ++i)
            if (items_[i].reg == reg) items_[i] = {reg, value, 0xFF};
    }
    template <class Bus>
    Status write(const Registers<Bus>& chip) const noexcept {
        for (std::size_t i = 0; i < size_; ++i) {
            const Setting& s = items_[i];
            if (const Status r = chip.set(s.reg, s.value, s.mask); r != Status::ok) return r;
        }
        return Status::ok;
    }
    template <class Bus>
    Status check(const Registers<Bus>& chip) const noexcept {
        for (std::size_t i = 0; i < size_; ++i) {
            const Setting& s = items_[i];
            if (const Status r = chip.expect(s.reg, s.value, s.mask); r != Status::ok) return r;
        }
        return Status::ok;
    }

  private:
    Setting items_[N]{};
    std::size_t size_{0};
};

}  // namespace fairlead::port
