#pragma once
// Numbers in few bits, for both directions: a writer reads what it is given, a reader fills it in.
#include <array>
#include <cstddef>
#include <cstdint>

#include "host_sim/study/baselines/earlier/wire/bits.hpp"

namespace fairlead::earlier::wire {

template <class Io>
bool flag(Io& io, bool value) noexcept {
    std::uint32_t v = value;
    io.bits(v, 1);
    return v != 0;
}

/// Its width, then what follows its first one. Up to 2^length_bits - 1 bits wide.
template <class Io>
void unsigned_number(Io& io, std::uint64_t& v, unsigned length_bits) noexcept {
    std::uint32_t width = bit_width(v);
    io.bits(width, length_bits);
    if (width > 64) width = 64;
    std::uint64_t out = width > 0 ? 1 : 0;
    for (std::uint32_t left = width > 0 ? width - 1 : 0; left > 0;) {
        const std::uint32_t part = left < 16 ? left : 16;
        left -= part;
        auto piece = static_cast<std::uint32_t>(v >> left) & 0xffffu;
        io.bits(piece, part);
        out = (out << part) | (piece & ((1u << part) - 1u));
    }
    if constexpr (!Io::writes) v = out;
}

/// Small numbers mostly, large ones at twice their width (exponential Golomb code of order k).
template <class Io>
void mostly_small(Io& io, std::uint32_t& v, unsigned k) noexcept {
    const std::uint64_t raised = std::uint64_t{v} + (std::uint64_t{1} << k);
    unsigned width = bit_width(raised) - 1, n = k;
    while (flag(io, n < width) && n < 32) ++n;
    if constexpr (!Io::writes) width = n;
    std::uint32_t low = static_cast<std::uint32_t>(raised - (std::uint64_t{1} << width));
    io.bits(low, width);
    if constexpr (!Io::writes)
        v = static_cast<std::uint32_t>((std::uint64_t{1} << width) + low - (std::uint64_t{1} << k));
}

/// The difference to what both ends expect, modulo 2^32.
template <class Io>
void near_expected(Io& io, std::uint32_t& v, std::uint32_t expected, unsigned k) noexcept {
    std::uint32_t z = zigzag(static_cast<std::int32_t>(v - expected));
    mostly_small(io, z, k);
    v = expected + static_cast<std::uint32_t>(unzigzag(z));
}

/// A row of signed numbers of one common width, which is likely to be `usual`.
/// @return the width.
template <class Io, std::size_t D>
std::uint32_t row(Io& io, std::array<std::int32_t, D>& values, std::uint32_t usual) noexcept {
    std::uint32_t width = 0;
    if constexpr (Io::writes)
        for (const auto v : values) {
            const std::uint32_t w = bit_width(zigzag(v));
            width = w > width ? w : width;
        }
    near_expected(io, width, usual, 1);
    if (width > 32) width = 32;
    for (auto& v : values) {
        std::uint32_t z = zigzag(v);
        io.bits(z, width);
        if constexpr (!Io::writes) v = unzigzag(z);
    }
    return width;
}

/// A length of time: two decimal digits and a power of ten where that is exact, else all of it.
template <class Io>
void duration(Io& io, std::uint32_t& ns) noexcept {
    std::uint32_t digits = ns, power = 0;
    for (; power < 7 && digits > 99 && digits % 10 == 0; digits /= 10) ++power;
    if (flag(io, digits > 99)) return io.bits(ns, 32);
    io.bits(digits, 7);
    io.bits(power, 3);
    for (; power > 0; --power) digits *= 10;
    ns = digits;
}

/// A point in time: shorter where it is a whole number of microseconds, and not before zero.
template <class Io>
void instant(Io& io, std::int64_t& ns) noexcept {
    const bool whole = flag(io, ns >= 0 && ns % 1000 == 0);
    auto v = static_cast<std::uint64_t>(ns);
    if (whole) {
        v /= 1000;
        unsigned_number(io, v, 6);
        v *= 1000;
    } else {
        unsigned_number(io, v, 7);
    }
    ns = static_cast<std::int64_t>(v);
}

}  // namespace fairlead::earlier::wire
