#pragma once
// CRC-16/CCITT (x^16 + x^12 + x^5 + 1), a nibble at a time: finds every error burst of up to 16
// bits.
#include <array>
#include <cstddef>
#include <cstdint>

namespace fairlead {

constexpr std::uint16_t crc16(const std::uint8_t* data, std::size_t size,
                              std::uint16_t seed) noexcept {
    constexpr std::uint16_t table[16] = {0x0000, 0x1021, 0x2042, 0x3063, 0x4084, 0x50a5,
                                         0x60c6, 0x70e7, 0x8108, 0x9129, 0xa14a, 0xb16b,
                                         0xc18c, 0xd1ad, 0xe1ce, 0xf1ef};
    unsigned crc = seed;
    for (std::size_t i = 0; i < size; ++i) {
        crc = ((crc << 4) ^ table[((crc >> 12) ^ (data[i] >> 4)) & 15u]) & 0xffffu;
        crc = ((crc << 4) ^ table[((crc >> 12) ^ data[i]) & 15u]) & 0xffffu;
    }
    return static_cast<std::uint16_t>(crc);
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
