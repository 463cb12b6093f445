#pragma once
// A test at run time: does this program round each operation on a float as IEEE 754 says? Some
// flags that break the rule are announced to no header (base/compiler.hpp refuses those that are),
// and a start-up object of -ffast-math can switch the processor even for code that was compiled
// without it. Call it once at start, on the board.
#include <cfloat>
#include <cstdint>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

/// What the program was found to do beside IEEE 754.
enum class Arithmetic : std::uint8_t {
    exact,      // nothing: the bits are those of every other machine
    fused,      // a * b + c is rounded once: -ffp-contract=fast, GCC's default where the CPU can
                // (or all of it is rounded late, by an x87 unit)
    reordered,  // (a + b) - a became b: -fassociative-math
    inverted,   // a / b became a * (1 / b): -freciprocal-math
    unsigned_zero,  // -0 + 0 became -0: -fno-signed-zeros
    flushed,  // numbers below 1.2e-38 became 0: flush-to-zero mode, set by -ffast-math at link time
};

constexpr const char* to_string(Arithmetic a) noexcept {
    switch (a) {
        case Arithmetic::exact: return "exact";
        case Arithmetic::fused: return "fused";
        case Arithmetic::reordered: return "reordered";
        case Arithmetic::inverted: return "inverted";
        case Arithmetic::unsigned_zero: return "unsigned zero";
        case Arithmetic::flushed: return "flushed";
        default: break;
    }
    return "unknown";
}

/// @return the first departure found. `exact` is evidence, not proof: a compiler may use a flag in
/// one place and not in another. Cost: about twenty operations on floats.
inline Arithmetic check_arithmetic() noexcept {
    // the compiler must not compute the answers itself
    const volatile float in[] = {0x1.001p0f, 0x1.002p0f, 1, 1e-9f, 5, -0.0f, FLT_MIN};
    const float x = in[0], y = in[1], one = in[2], tiny = in[3];  // x = 1 + 2^-12, y = 1 + 2^-11
    const float five = in[4], minus_zero = in[5], smallest = in[6];
    const volatile float product_less = x * x - y;  // x * x = y + 2^-24, which rounds to y
    if (product_less > 0 || product_less < 0) return Arithmetic::fused;
    const volatile float kept = (one + tiny) - one;
    if (kept > 0) return Arithmetic::reordered;
    const volatile float third = five / 3, expected = 1.66666663f;  // 5 * (1 / 3) is one place more
    if (third < expected || third > expected) return Arithmetic::inverted;
    const volatile float zero = minus_zero + 0;
    // its bit: the same flag makes a comparison of __builtin_signbit, and that takes -0 for 0
    const float kept_zero = zero;
    std::uint32_t bits = 0;
    __builtin_memcpy(&bits, &kept_zero, sizeof bits);
    if (bits >> 31 != 0) return Arithmetic::unsigned_zero;
    const volatile float half = smallest * 0.5f;
    if (!(half > 0)) return Arithmetic::flushed;
    return Arithmetic::exact;
}

}  // namespace fairlead
