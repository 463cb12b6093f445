#pragma once
// CRC-16/CCITT (x^16 + x^12 + x^5 + 1), a nibble at a time: finds every error burst of up to 16
// bits.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

/// Of four bits each. Not in the function, where compilers copy it to the stack in every call.
inline constexpr std::array<std::uint16_t, 16> crc16_table{
    0x0000, 0x1021, 0x2042, 0x3063, 0x4084, 0x50a5, 0x60c6, 0x70e7,
    0x8108, 0x9129, 0xa14a, 0xb16b, 0xc18c, 0xd1ad, 0xe1ce, 0xf1ef};

/// The register after one more byte.
constexpr std::uint16_t crc16(std::uint8_t byte, std::uint16_t seed) noexcept {
    unsigned crc = seed;
    crc = ((crc << 4) ^ crc16_table[((crc >> 12) ^ (byte >> 4)) & 15u]) & 0xffffu;
    crc = ((crc << 4) ^ crc16_table[((crc >> 12) ^ byte) & 15u]) & 0xffffu;
    return static_cast<std::uint16_t>(crc);
}

/// The register before this byte, from the one after it.
constexpr std::uint16_t crc16_before(std::uint8_t byte, std::uint16_t after) noexcept {
    // a step forward maps the top nibble t to table[t]; the low nibble of table[t] is t, so a step
    // back knows t
    unsigned crc = after;
    for (unsigned shift = 0; shift <= 4; shift += 4) {
        const unsigned t = crc & 15u;
        crc = ((crc ^ crc16_table[t]) >> 4) | ((t ^ (byte >> shift & 15u)) << 12);
    }
    return static_cast<std::uint16_t>(crc);
}

constexpr std::uint16_t crc16(const std::uint8_t* data, std::size_t size,
                              std::uint16_t seed) noexcept {
    for (std::size_t i = 0; i < size; ++i) seed = crc16(data[i], seed);
    return seed;
}

/// Puts the checksum of `size` bytes behind them. @return the size with it.
constexpr std::size_t append_crc16(std::uint8_t* data, std::size_t size,
                                   std::uint16_t seed) noexcept {
    const std::uint16_t crc = crc16(data, size, seed);
    data[size] = static_cast<std::uint8_t>(crc >> 8);
    data[size + 1] = static_cast<std::uint8_t>(crc & 0xffu);
    return size + 2;
}

}  // namespace fairlead
