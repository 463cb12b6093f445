#pragma once
// CRC-16/CCITT (x^16 + x^12 + x^5 + 1), a byte at a time, without a table: finds every error burst
// of up to 16 bits.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

/// The register after one more byte. Eight bits t leave it and come back as t (z^12 + z^5 + 1);
/// what of t z^12 leaves again is t >> 4, so that it is added to t first.
constexpr std::uint16_t crc16(std::uint8_t byte, std::uint16_t seed) noexcept {
    unsigned t = unsigned{seed} >> 8 ^ byte;
    t ^= t >> 4;
    return static_cast<std::uint16_t>(unsigned{seed} << 8 ^ t << 12 ^ t << 5 ^ t);
}
/// The register before this byte, from the one after it: the same backwards. The low byte after is
/// that of t ^ t << 5, which gives t.
constexpr std::uint16_t crc16_before(std::uint8_t byte, std::uint16_t after) noexcept {
    const unsigned y = after & 0xffu, t = (y ^ y << 5) & 0xffu;
    const unsigned low = unsigned{after} >> 8 ^ t << 4 ^ t >> 3, high = t ^ t >> 4 ^ byte;
    return static_cast<std::uint16_t>(high << 8 | (low & 0xffu));
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
