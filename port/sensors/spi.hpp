#pragma once
// SPI under the same primitive as I2C: a Bus (bus.hpp) made of a Wire, which is one chip select.
//
// A Wire is any type with these three members; Linux's Spidev (port/linux/spidev.hpp) is one, a
// board's HAL needs about 20 lines to be another (docs/hal.md):
//   Status exchange(const std::uint8_t* out, std::size_t out_size,   // select low; out, then in;
//                   std::uint8_t* in, std::size_t in_size);          // select high
//   std::size_t read_max() const;
//   void pause_us(std::uint32_t microseconds);
//
// On the wire a transfer is: the register's address, with bit 7 set for a read; dummy bytes where
// the chip has them; the data. A list of transfers is a list of such exchanges: drivers never rely
// on more than the order. The I2C address of a transfer is ignored, since the select says who is
// meant.
#include <cstddef>
#include <cstdint>

#include "port/sensors/bus.hpp"

namespace fairlead::port {

/// What differs from chip to chip. The table of chips (chips.hpp) has it for each.
struct SpiStyle {
    std::uint32_t hz_max{0};    // 0: the chip has no SPI
    std::uint8_t dummy{0};      // bytes between the address and what is read
    std::uint8_t increment{0};  // bit of the address that makes it count up over several bytes
};

template <class Wire>
class SpiBus {
  public:
    SpiBus(Wire& wire, const SpiStyle& style) noexcept : wire_{&wire}, style_{style} {}

    /// bad_argument: a transfer without a register, or a write to an address beyond 7 bits.
    Status transfer(const Transfer* list, std::size_t count) noexcept {
        if (count == 0) return Status::bad_argument;
        for (std::size_t i = 0; i < count; ++i)
            if (const Status s = exchange(list[i]); s != Status::ok) return s;
        return Status::ok;
    }
    std::size_t read_max() const noexcept { return wire_->read_max(); }
    void pause_us(std::uint32_t microseconds) noexcept { wire_->pause_us(microseconds); }

  private:
    static constexpr std::uint8_t read_bit = 0x80;
    static constexpr std::size_t dummy_max = 2;

    Status exchange(const Transfer& t) noexcept {
        if (t.out_size == 0 || style_.dummy > dummy_max) return Status::bad_argument;
        if (t.in_size == 0) {
            if ((t.out[0] & read_bit) != 0) return Status::bad_argument;
            return wire_->exchange(t.out, t.out_size, nullptr, 0);
        }
        if (t.out_size != 1) return Status::bad_argument;  // write, then read: no register has it
        std::uint8_t head[1 + dummy_max] = {static_cast<std::uint8_t>(t.out[0] | read_bit)};
        if (t.in_size > 1) head[0] = static_cast<std::uint8_t>(head[0] | style_.increment);
        return wire_->exchange(head, 1u + style_.dummy, t.in, t.in_size);
    }

    Wire* wire_;
    SpiStyle style_;
};

/// Two buses as one: a transfer to an address of the second goes there, any other to the first. For
/// a part that is two chips with a chip select each: BMI088's accelerometer has an address of
/// 0x18 or 0x19 and a dummy byte, its gyroscope neither.
template <class First, class Second = First>
class BusPair {
  public:
    /// Addresses a with (a & mask) == address are the second's.
    BusPair(First& one, Second& other, std::uint8_t address, std::uint8_t mask = 0x7E) noexcept
        : first_{&one}, second_{&other}, address_{address}, mask_{mask} {}

    Status transfer(const Transfer* list, std::size_t count) noexcept {
        if (count == 0) return Status::bad_argument;
        for (std::size_t i = 0; i < count; ++i) {
            const bool other = (list[i].address & mask_) == address_;
            const Status s = other ? second_->transfer(&list[i], 1) : first_->transfer(&list[i], 1);
            if (s != Status::ok) return s;
        }
        return Status::ok;
    }
    std::size_t read_max() const noexcept {
        const std::size_t a = first_->read_max(), b = second_->read_max();
        return a < b ? a : b;
    }
    void pause_us(std::uint32_t microseconds) noexcept { first_->pause_us(microseconds); }

  private:
    First* first_;
    Second* second_;
    std::uint8_t address_, mask_;
};

}  // namespace fairlead::port
