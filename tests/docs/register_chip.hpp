#pragma once
// A chip of registers for the fragments of docs/hal.md: it answers at one I2C address, or behind a
// select; a write sets the register pointer and what follows it. The fragments run against it as
// drivers use them.
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "port/sensors/bus.hpp"

namespace hal {

inline constexpr std::uint8_t chip_address = 0x6A, who_am_i = 0x0F, identity = 0x6C;

struct Chip {
    std::array<std::uint8_t, 256> registers{};
    std::uint8_t pointer{};
    bool pointed{};
    bool stuck{};  // no transfer ends
    std::uint64_t waited_us{};

    Chip() { registers[who_am_i] = identity; }
    void begin() { pointed = false; }
    void put(std::uint8_t byte) {
        if (!pointed)
            pointer = byte;
        else
            registers[pointer++] = byte;
        pointed = true;
    }
    std::uint8_t get() { return registers[pointer++]; }
};
inline Chip chip;

inline void require(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "FAIL %s\n", what);
    std::exit(1);
}

/// What every bus must do. `tells_absence`: I2C does, SPI cannot.
template <class Bus>
void check(Bus& bus, bool tells_absence) {
    using fairlead::Status;
    fairlead::port::Registers<Bus> here{bus, chip_address};
    const auto id = here.read(who_am_i);
    require(id && *id == identity, "one register is read");
    require(here.set(0x10, 0x5C) == Status::ok && chip.registers[0x10] == 0x5C, "one is written");
    for (std::size_t i = 0; i < 12; ++i)
        chip.registers[0x22 + i] = static_cast<std::uint8_t>(i + 1);
    std::array<std::uint8_t, 12> burst{};
    require(here.read(0x22, burst.data(), burst.size()) == Status::ok, "a burst");
    for (std::size_t i = 0; i < burst.size(); ++i) require(burst[i] == i + 1, "a burst's bytes");
    const std::uint8_t many[4] = {0x40, 7, 8, 9};
    const fairlead::port::Transfer write{chip_address, many, 4, nullptr, 0};
    require(bus.transfer(&write, 1) == Status::ok && chip.registers[0x42] == 9, "several bytes");
    std::uint8_t a = 0, b = 0;
    const std::uint8_t from[2] = {0x22, 0x23};
    const fairlead::port::Transfer both[2] = {{chip_address, &from[0], 1, &a, 1},
                                              {chip_address, &from[1], 1, &b, 1}};
    require(bus.transfer(both, 2) == Status::ok && a == 1 && b == 2, "a list of transfers");
    require(bus.read_max() >= 32, "read_max");
    for (const std::uint32_t us : {1u, 999u, 1000u, 31000u}) {
        chip.waited_us = 0;
        bus.pause_us(us);
        require(chip.waited_us >= us, "a pause is never shorter than asked");
    }
    if (!tells_absence) return;
    fairlead::port::Registers<Bus> nobody{bus, chip_address + 1};
    require(nobody.read(who_am_i).status() == Status::no_acknowledge, "an absent chip, read");
    require(nobody.write(0x10, 1) == Status::no_acknowledge, "an absent chip, written");
    chip.stuck = true;
    require(here.read(who_am_i).status() == Status::timeout, "a stuck bus");
    chip.stuck = false;
}

}  // namespace hal
