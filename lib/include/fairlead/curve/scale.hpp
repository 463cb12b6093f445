#pragma once
// The lattice of values: steps of m * 2^e, an exact number in float and double.
//
// Vertex values of curves are integers on this lattice. The step follows from the tolerance: 1.2
// tolerances a step for vectors, 0.9 for rotations; a box of two tolerances then holds two values
// and a bit, which is where bytes are fewest.
#include <cstdint>
#include <cstring>

#include "fairlead/base/compiler.hpp"

namespace fairlead::curve {

/// Samples of vectors are compared as integers of 1/1024 step.
inline constexpr int fine_bits = 10;
inline constexpr std::int32_t fine = 1 << fine_bits;
/// Largest |value| that an intake may let through, in steps.
inline constexpr std::int32_t value_steps_max = 1 << 24;

/// Not valid until it is set: zeros cost a decoder no code.
struct Scale {
    std::uint16_t m{0};  // 256 to 511
    std::int16_t e{0};   // -100 to 60

    /// The largest step of this form that is at most `step`; step in [1e-27, 1e20], else clamped.
    static constexpr Scale of_step(float step) noexcept {
        if (!(step >= 1e-27f)) step = 1e-27f;
        if (step > 1e20f) step = 1e20f;
        std::int16_t e = 0;
        for (int i = 0; i < 160 && step >= 512.0f; ++i) step *= 0.5f, ++e;
        for (int i = 0; i < 160 && step < 256.0f; ++i) step *= 2.0f, --e;
        return {static_cast<std::uint16_t>(step), e};
    }
    static constexpr bool valid(unsigned m, int e) noexcept {
        return m >= 256 && m <= 511 && e >= -100 && e <= 60;
    }
    /// Exact in double and in float, where no double arithmetic is used; valid scales only.
    template <class Real = double>
    constexpr Real step() const noexcept {
        Real x = static_cast<Real>(m);
        for (int i = 0; i < e && i < 60; ++i) x *= Real{2};
        for (int i = 0; i > e && i > -100; --i) x *= Real{1} / Real{2};
        return x;
    }
    /// Value of v lattice steps; exact but for one rounding.
    constexpr double value(double v) const noexcept { return v * step(); }

    /// p in 1/1024 steps, rounded to nearest, from p's bits by integers: exact far from the origin.
    /// The scale must be valid, p finite; |p| beyond value_steps_max steps is clamped there.
    std::int64_t to_fine(float p) const noexcept {
        std::uint32_t bits;
        std::memcpy(&bits, &p, sizeof bits);
        const auto biased = static_cast<int>(bits >> 23 & 0xffu);
        const std::uint32_t low = bits & 0x7fffffu;
        const std::uint32_t mantissa = biased == 0 ? low : low | 0x800000u;
        // |p| = mantissa * 2^(shift) * 2^(e - 10)
        const int shift = (biased == 0 ? 1 : biased) - 150 - e + fine_bits;
        const std::int64_t size = quotient(mantissa, shift);
        return bits >> 31 ? -size : size;
    }

  private:
    std::int64_t quotient(std::uint32_t mantissa, int shift) const noexcept {
        constexpr std::int64_t most = std::int64_t{value_steps_max} << fine_bits;
        if (mantissa == 0) return 0;
        if (shift <= 0) {
            if (shift < -24) return 0;  // below 1/(2 m) of a fine step
            const std::uint64_t divisor = std::uint64_t{m} << -shift;
            if (divisor >> 32) return 0;  // 2^24 / 2^32
            const auto d = static_cast<std::uint32_t>(divisor);
            return static_cast<std::int64_t>((mantissa + d / 2) / d);
        }
        if (shift <= 7) {  // 24 + 7 bits and half of m: still 32 bits
            const std::uint32_t n = mantissa << shift;
            return static_cast<std::int64_t>((n + m / 2u) / m);
        }
        if (shift > 30) return most;
        const std::uint64_t n = std::uint64_t{mantissa} << shift;
        const auto x = static_cast<std::int64_t>((n + m / 2u) / m);
        return x < most ? x : most;
    }
};

}  // namespace fairlead::curve
