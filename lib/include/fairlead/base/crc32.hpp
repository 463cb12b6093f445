#pragma once
// CRC-32 of Ethernet, zip and PNG (reflected, polynomial 0x04C11DB7): for plain structs that are
// stored and read back. Sixteen words of table; two look-ups a byte.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

namespace detail {

constexpr std::array<std::uint32_t, 16> crc32_table() noexcept {
    std::array<std::uint32_t, 16> table{};
    for (std::uint32_t i = 0; i < 16; ++i) {
        std::uint32_t c = i;
        for (int bit = 0; bit < 4; ++bit) c = (c & 1u) != 0 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
        table[i] = c;
    }
    return table;
}

}  // namespace detail

inline std::uint32_t crc32(const void* data, std::size_t size, std::uint32_t seed = 0) noexcept {
    static constexpr auto table = detail::crc32_table();
    const auto* bytes = static_cast<const unsigned char*>(data);
    std::uint32_t c = ~seed;
    for (std::size_t i = 0; i < size; ++i) {
        c ^= bytes[i];
        c = table[c & 15u] ^ (c >> 4);
        c = table[c & 15u] ^ (c >> 4);
    }
    return ~c;
}

}  // namespace fairlead
