#pragma once
// Checksums of any piece of a buffer from those of its prefixes: what the receiver of this
// yardstick counts in.
//
// A register is a polynomial modulo that of the CRC-16, and a zero byte multiplies it by x^8. So
// what a start value or a prefix adds to the checksum of a longer piece is a product, and the
// checksum of any piece follows from those of two prefixes, at a cost that does not depend on its
// length.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/wire/crc.hpp"

namespace fairlead::earlier::wire {

/// What four bits become that leave the register.
inline constexpr std::array<std::uint16_t, 16> crc16_table{
    0x0000, 0x1021, 0x2042, 0x3063, 0x4084, 0x50a5, 0x60c6, 0x70e7,
    0x8108, 0x9129, 0xa14a, 0xb16b, 0xc18c, 0xd1ad, 0xe1ce, 0xf1ef};

/// The product of two registers, four bits at a time.
constexpr std::uint16_t crc16_product(std::uint16_t a, std::uint16_t b) noexcept {
    unsigned product = 0;
    for (unsigned i = 0, bits = b; i < 4; ++i, bits <<= 4) {
        const unsigned four = bits >> 12;
        const unsigned part = (four & 8u) * a ^ (four & 4u) * a ^ (four & 2u) * a ^ (four & 1u) * a;
        product = (product << 4) ^ crc16_table[(product >> 12) & 15u] ^ part ^
                  crc16_table[(part >> 16) & 15u];
    }
    return static_cast<std::uint16_t>(product);
}

/// x^(8 n) for n up to Max, as products of two.
template <std::size_t Max>
struct Crc16Powers {
    std::array<std::uint16_t, 16> low{};
    std::array<std::uint16_t, Max / 16 + 1> high{};

    constexpr Crc16Powers() noexcept {
        std::uint16_t power = 1;
        for (std::size_t i = 0; i <= Max || i < 16; ++i, power = crc16(0, power)) {
            if (i < 16) low[i] = power;
            if (i % 16 == 0) high[i / 16] = power;
        }
    }
    /// The register after n zero bytes.
    constexpr std::uint16_t after_zeros(std::uint16_t crc, std::size_t n) const noexcept {
        return crc16_product(crc16_product(crc, high[n / 16]), low[n % 16]);
    }
};

}  // namespace fairlead::earlier::wire
