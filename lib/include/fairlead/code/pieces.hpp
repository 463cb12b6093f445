#pragma once
// Pieces to symbols and back: one description that encodes, decodes and counts.
//
// Io is a RangeEncoder, a RangeDecoder, or a Counter of bits; the code is the same for all three,
// so that they cannot differ. Whatever a decoder reads, a state stays within the bounds of
// curve/state.hpp: nonsense gives false.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/compiler.hpp"
#include "fairlead/code/model.hpp"
#include "fairlead/code/range_coder.hpp"
#include "fairlead/curve/rotation.hpp"
#include "fairlead/curve/state.hpp"

namespace fairlead::code {

/// One symbol of a row of n costs. @return false where a decoder reads what no encoder writes.
template <class Io>
constexpr bool symbol(Io& io, const std::uint8_t* row, std::size_t n, std::uint8_t& s) noexcept {
    std::uint32_t from = 0;
    if constexpr (Io::writes) {
        if (s >= n) return false;
        for (std::size_t i = 0; i < s; ++i) from += frequency(row[i]);
        io.put(from, frequency(row[s]), frequency_bits);
        return true;
    } else {
        const std::uint32_t place = io.peek(frequency_bits);
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint32_t width = frequency(row[i]);
            if (place < from + width) {
                io.take(from, width, frequency_bits);
                s = static_cast<std::uint8_t>(i);
                return true;
            }
            from += width;
        }
        return false;
    }
}

namespace detail {

/// Code of a piece. Behind a jump all pieces are lines, and told as the quadratics of their length.
template <class Io>
constexpr bool piece_code(Io& io, const std::uint8_t* row, std::size_t codes, bool loose,
                          std::uint8_t& c) noexcept {
    auto s = c;
    if (Io::writes && loose) {
        if (curve::is_line(c))
            s = static_cast<std::uint8_t>(c - curve::code::line);
        else if (c <= curve::code::to_end)
            return false;
    }
    if (!symbol(io, row, codes, s)) return false;
    if (loose && curve::is_line(s)) return false;
    c = loose && s <= curve::code::to_end ? static_cast<std::uint8_t>(s + curve::code::line) : s;
    return true;
}

/// k of one component, relative to the sign of the last k that was not 0.
template <class Io>
constexpr bool value(Io& io, const std::uint8_t* row, std::int8_t sign, std::int32_t& k) noexcept {
    std::uint8_t s = value_symbol(k, sign);
    if (!symbol(io, row, value_symbols, s)) return false;
    const bool turned = sign < 0;
    if (s != value_escape) {
        const std::int32_t x = (s & 1u) != 0 ? (s + 1) / 2 : -(s / 2);
        k = turned ? -x : x;
        return true;
    }
    bool minus = (k < 0) != turned;
    auto size = static_cast<std::uint32_t>(k < 0 ? -k : k) - (value_direct_max + 1);
    if (!exp_golomb(io, size, 0)) return false;
    io.flag(minus, 1, 1);
    if (size > (1u << 30)) return false;
    const auto wide = static_cast<std::int32_t>(size) + value_direct_max + 1;
    k = minus != turned ? -wide : wide;
    return true;
}

/// A signed number below 2^30 in plain bits: 5 for its number of bits, these but the first, a sign.
template <class Io>
constexpr bool plain(Io& io, std::int32_t& k) noexcept {
    const auto size = static_cast<std::uint32_t>(k < 0 ? -k : k);
    std::uint32_t count = bit_count(size);
    io.bits(count, 5);
    if (count > 30) return false;
    if (count == 0) {
        k = 0;
        return true;
    }
    const std::uint32_t first = 1u << (count - 1u);
    std::uint32_t low = size & (first - 1u);
    io.bits(low, count - 1u);
    bool minus = k < 0;
    io.flag(minus, 1, 1);
    const auto wide = static_cast<std::int32_t>(first | low);
    k = minus ? -wide : wide;
    return true;
}

/// How long a jump holds: to the next tick, a number of sub-ticks before it, or more ticks.
template <class Io>
constexpr bool duration(Io& io, std::uint8_t phase, std::uint16_t& subs) noexcept {
    const auto to_tick = static_cast<std::uint32_t>(curve::subs_per_tick - phase);
    bool next = subs == to_tick;
    io.flag(next, tick_ones, tick_bits);
    if (next) {
        subs = static_cast<std::uint16_t>(to_tick);
        return true;
    }
    bool longer = subs > to_tick;
    io.flag(longer, 1, 1);
    // in 1..63 sub-ticks or in 1..64 further ticks
    std::uint32_t n = longer ? (subs - to_tick) / curve::subs_per_tick - 1u : subs;
    if (Io::writes && n > 63) return false;
    io.bits(n, 6);
    const std::uint32_t all = longer ? to_tick + (n + 1u) * curve::subs_per_tick : n;
    if (!longer && (n == 0 || n >= to_tick)) return false;
    subs = static_cast<std::uint16_t>(all);
    return true;
}

}  // namespace detail

/// How a frame ends for the last piece: on the lattice (its k is coded), or at a place that the
/// frame told before (k is not coded).
enum class End : bool { coded, told };

/// Codes one piece and, but for code::rebase and for a last piece whose end was told, steps the
/// state. `left`: sub-ticks to the end of the frame, more than 0.
/// @param told the place of the end where it was told, on the lattice of an axis; ignored (may be
///     null) otherwise. For a rotation that ends where it was told, the caller calls
///     curve::step_onto() instead of this function's step: the return value is true, the state as
///     before, and subs == left.
/// @return false where a decoder reads nonsense, or an encoder was given a piece out of bounds.
template <class Io>
constexpr bool code_piece(Io& io, const CostsView& costs, const curve::StateView& state,
                          std::uint8_t& c, std::uint16_t& subs, std::int32_t* k, std::int32_t left,
                          End end, const std::int32_t* told) noexcept {
    namespace codes = curve::code;
    const curve::History& history = state.history;
    if (left <= 0) return false;
    if (history.phase != 0)
        c = codes::jump;
    else if (!detail::piece_code(io, costs.length + length_row(history) * costs.codes, costs.codes,
                                 history.loose(), c))
        return false;
    if (c == codes::rebase) return state.n == 3;
    if (c == codes::jump) {
        if (!detail::duration(io, history.phase, subs) || subs > left) return false;
        for (std::size_t i = 0; i < state.n; ++i)
            if (!detail::plain(io, k[i])) return false;
        return curve::step(state, c, subs, k);
    }
    const std::size_t index = curve::is_line(c) ? c - codes::line : c;
    const std::int32_t lasts =
        curve::ends_frame(c) ? left : curve::lengths[index] * curve::subs_per_tick;
    if (lasts > left || left > curve::piece_ticks_max * curve::subs_per_tick ||
        left % curve::subs_per_tick != 0)
        return false;
    subs = static_cast<std::uint16_t>(lasts);
    const std::int32_t h = lasts / curve::subs_per_tick;
    const bool ends = end == End::told && lasts == left;
    if (ends && state.n == 3) return true;
    bool before = false;
    for (std::size_t i = 0; i < state.n; ++i) {
        if (ends) {
            const std::int64_t rise = std::int64_t{*told} - state.v[0];
            if (rise > curve::rise_max || rise < -curve::rise_max) return false;
            k[0] = static_cast<std::int32_t>(rise) -
                   curve::predicted_rise(state.s[0], history.fresh, h);
        } else {
            const std::size_t row =
                value_row(costs.lines, state.n, history, state.last_k[i], c, h, i, before);
            if (!detail::value(io, costs.value + row * value_symbols, state.sign[i], k[i]))
                return false;
        }
        before = before || k[i] != 0;
    }
    return curve::step(state, c, subs, k);
}
template <class Kind, class Io, std::size_t N>
constexpr bool code_piece(Io& io, const Costs<Kind, N>& costs, curve::State<N>& state,
                          curve::Piece<N>& piece, std::int32_t left, End end,
                          const std::int32_t* told = nullptr) noexcept {
    return code_piece(io, CostsView{costs}, state.view(), piece.code, piece.subs, piece.k.data(),
                      left, end, told);
}

/// Counts what a RangeEncoder would write, rounded up symbol by symbol: an upper bound of its bits.
/// Works with the functions above as an Io that writes.
class Counter {
  public:
    static constexpr bool writes = true;
    constexpr void put(std::uint32_t, std::uint32_t freq, unsigned bits) noexcept {
        cost_ += 16u * bits - log2_16(freq);
    }
    constexpr void bits(std::uint32_t&, unsigned n) noexcept { cost_ += 16u * n; }
    constexpr void flag(bool& v, std::uint32_t ones, unsigned bits) noexcept {
        put(0, v ? ones : (1u << bits) - ones, bits);
    }
    /// 1/16 bit.
    constexpr Cost cost() const noexcept { return cost_; }

  private:
    /// floor(16 log2(n)), 1 <= n <= 2^15, by the table of powers.
    static constexpr Cost log2_16(std::uint32_t n) noexcept {
        const unsigned whole = bit_count(n) - 1u;
        const std::uint32_t scaled = n << (15u - whole);  // [2^15, 2^16)
        Cost part = 0;
        while (part < 15 && scaled >= 2u * detail::power[15u - part]) ++part;
        return 16u * whole + part;
    }
    Cost cost_{0};
};

}  // namespace fairlead::code
