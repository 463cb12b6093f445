#pragma once
// Symbols of pieces: alphabets, contexts, and the table of costs that search and coder share.
//
// A table row holds a cost in 1/16 bit for each symbol. The coder's frequency of a symbol follows
// from it: frequency(cost) out of 2^15, rounded up, so that a cost is never more than 4e-5 bit
// below the coded ones; the frequencies of a row sum to at most 2^15 and what remains is not used.
// One byte a symbol serves the search (costs), the encoder and the decoder.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/compiler.hpp"
#include "fairlead/curve/state.hpp"

namespace fairlead::code {

inline constexpr unsigned frequency_bits = 15;
inline constexpr unsigned cost_max = 240;  // 15 bits
using Cost = std::uint32_t;                // 1/16 bit

namespace detail {
// 2^15 2^(-i / 16), rounded: the only copy, tests/tables/tables.py reads it here
inline constexpr std::array<std::uint16_t, 16> power{32768, 31379, 30049, 28775, 27555, 26386,
                                                     25268, 24196, 23171, 22188, 21248, 20347,
                                                     19484, 18658, 17867, 17109};
}  // namespace detail

/// Frequency out of 2^15 of a symbol with this cost: 2^(15 - cost / 16), not below it by more than
/// 2.5e-5 of it; at least 1.
constexpr std::uint32_t frequency(std::uint8_t cost) noexcept {
    const unsigned shift = cost >> 4;
    return (std::uint32_t{detail::power[cost & 15u]} + (1u << shift) - 1u) >> shift;
}

/// k = -15..15 in the order 0 1 -1 2 -2 ..., then the escape to larger ones.
inline constexpr std::size_t value_symbols = 32;
inline constexpr std::int32_t value_direct_max = 15;
inline constexpr std::uint8_t value_escape = 31;

/// Rows for the code of a piece: by the code of the piece before (quadratics and lines alike,
/// to_end, jump), and for a fresh piece.
inline constexpr std::size_t length_rows = 19;
/// Rows for k of one component: 3 for pieces that are fresh or follow a jump, then 5 classes of the
/// last k, 3 of the ratio of lengths, and 2 of length (axis) or 3 of the place among the components
/// (rotation).
inline constexpr std::size_t axis_value_rows = 3 + 5 * 3 * 2;
inline constexpr std::size_t rotation_value_rows = 3 + 5 * 3 * 3;

template <std::size_t N>
inline constexpr std::size_t value_rows = N == 1 ? axis_value_rows : rotation_value_rows;

/// The trained costs of one kind of curve and N components. Lines have value rows of their own.
template <class Kind, std::size_t N>
struct Costs {
    static constexpr std::size_t codes = Kind::codes;
    static constexpr std::size_t rows = value_rows<N> * (Kind::lines ? 2 : 1);
    std::uint8_t length[length_rows][codes];
    std::uint8_t value[rows][value_symbols];
};

/// The same, as the coder takes them: one code for all kinds and numbers of components.
struct CostsView {
    const std::uint8_t *length, *value;  // rows of `codes` and of value_symbols
    std::uint8_t codes;
    bool lines;

    template <class Kind, std::size_t N>
    constexpr CostsView(const Costs<Kind, N>& costs) noexcept
        : length{costs.length[0]},
          value{costs.value[0]},
          codes{static_cast<std::uint8_t>(Kind::codes)},
          lines{Kind::lines} {}
};

constexpr std::size_t length_row(const curve::History& history) noexcept {
    return history.fresh ? length_rows - 1 : history.last_code;
}

/// Row of k of component c of n, for a piece of h ticks. `before`: a component before c had k != 0.
constexpr std::size_t value_row(bool lines, std::size_t n, const curve::History& history,
                                std::int32_t last_k, std::uint8_t piece_code, std::int32_t h,
                                std::size_t c, bool before) noexcept {
    const std::size_t all = n == 1 ? axis_value_rows : rotation_value_rows;
    const std::size_t first = lines && curve::is_line(piece_code) ? all : 0;
    if (history.fresh || history.loose()) return first + (h <= 12 ? 0u : h <= 30 ? 1u : 2u);
    const std::int32_t size = last_k < 0 ? -last_k : last_k;
    const std::size_t last = size <= 2 ? static_cast<std::size_t>(size) : size <= 4 ? 3 : 4;
    const std::size_t ratio = h < history.last_ticks ? 0u : h == history.last_ticks ? 1u : 2u;
    const std::size_t group = last * 3 + ratio;
    if (n == 1) return first + 3 + group * 2 + (h >= 16 ? 1u : 0u);
    return first + 3 + group * 3 + (c == 0 ? 0u : before ? 2u : 1u);
}
template <class Kind, std::size_t N>
constexpr std::size_t value_row(const curve::State<N>& state, std::uint8_t piece_code,
                                std::int32_t h, std::size_t c, bool before) noexcept {
    return value_row(Kind::lines, N, state, state.last_k[c], piece_code, h, c, before);
}

/// Number of bits of n: 0 for 0.
constexpr unsigned bit_count(std::uint32_t n) noexcept {
    return n == 0 ? 0u : 32u - static_cast<unsigned>(__builtin_clz(n));
}

/// Symbol of k, whose sign is taken relative to `sign` (-1: turned).
constexpr std::uint8_t value_symbol(std::int32_t k, std::int8_t sign) noexcept {
    const std::int32_t x = sign < 0 ? -k : k;
    if (x > value_direct_max || x < -value_direct_max) return value_escape;
    return static_cast<std::uint8_t>(x > 0 ? 2 * x - 1 : -2 * x);
}

/// Cost of k in a row. |k| < 2^31.
constexpr Cost value_cost(const std::uint8_t (&row)[value_symbols], std::int32_t k,
                          std::int8_t sign) noexcept {
    const std::uint8_t symbol = value_symbol(k, sign);
    if (symbol != value_escape) return row[symbol];
    const auto size = static_cast<std::uint32_t>(k < 0 ? -k : k);
    // exp-Golomb code of order 0 of size - 16, and the sign
    return row[value_escape] + 16u * (2u * bit_count(size - value_direct_max) - 1u + 1u);
}

// ---- durations and values of jumps: rare, in plain codes

inline constexpr std::uint32_t tick_ones = 29;  // P(a jump lasts to the next tick) = 29 / 32
inline constexpr unsigned tick_bits = 5;
inline constexpr Cost tick_cost = 3;  // 1/16 bit, rounded up
inline constexpr Cost other_duration_cost = 55 + 16 * 7;

/// Cost of one jump behind its code: duration and N values.
constexpr Cost jump_value_cost(std::int32_t k) noexcept {
    return 16u * (5u + bit_count(static_cast<std::uint32_t>(k < 0 ? -k : k)));
}

}  // namespace fairlead::code
