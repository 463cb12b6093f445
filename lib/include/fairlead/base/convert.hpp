#pragma once
// A 64-bit difference of times as a float, rounded once to nearest as IEEE 754 has it. Compilers
// call a helper for it that brings along soft floating point, 500 bytes, even where there is a
// floating-point unit. Cost: at most 32 turns of the loop.
#include <cstdint>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

constexpr float to_float(std::int64_t v) noexcept {
    const bool negative = v < 0;
    std::uint64_t left = static_cast<std::uint64_t>(v);
    if (negative) left = 0 - left;
    float unit = 1;
    // what is cut off leaves its mark in the last bit, far below the 24 that stay
    for (; (left >> 31) != 0; unit *= 2) left = (left >> 1) | (left & 1u);
    const float size = static_cast<float>(static_cast<std::int32_t>(left)) * unit;
    return negative ? -size : size;
}

}  // namespace fairlead
