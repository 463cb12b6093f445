#pragma once
// Pieces of C2 cubics to symbols and back: one description for both directions, as pieces.hpp.
#include <cstddef>
#include <cstdint>

#include "fairlead/code/cubic_model.hpp"
#include "fairlead/code/pieces.hpp"
#include "fairlead/curve/cubic_state.hpp"

namespace fairlead::code {

namespace detail {

/// A jump or not, with P = 1 / 2^bits.
template <class Io>
constexpr bool is_jump(Io& io, std::uint8_t c, unsigned bits) noexcept {
    bool jumps = c == curve::code::jump;
    io.flag(jumps, 1, bits);
    return jumps;
}

/// Code of a piece of a run: the first tells its length, the others have it; or a jump.
template <class Io>
constexpr bool run_code(Io& io, const CubicCosts& costs, std::uint8_t run, std::uint8_t last_code,
                        std::uint8_t& c) noexcept {
    if (is_jump(io, c, run_jump_bits)) {
        c = curve::code::jump;
        return true;
    }
    if (run < 3) {
        if (Io::writes && c != last_code) return false;
        c = last_code;
        return true;
    }
    return symbol(io, costs.length[cubic_length_row(last_code, true)], curve::length_count, c);
}

/// Code of a break: a line with its length, or a jump.
template <class Io>
constexpr bool break_code(Io& io, const CubicCosts& costs, std::uint8_t& c) noexcept {
    if (is_jump(io, c, break_jump_bits)) {
        c = curve::code::jump;
        return true;
    }
    if (Io::writes && !curve::is_line(c)) return false;
    auto line = static_cast<std::uint8_t>(c - curve::code::line);
    if (!symbol(io, costs.line, cubic_line_symbols, line)) return false;
    c = static_cast<std::uint8_t>(curve::code::line + line);
    return true;
}

/// Code of a piece; left: ticks to the channel's end in the frame.
template <class Io, std::size_t N>
constexpr bool cubic_code(Io& io, const CubicCosts& costs, const curve::CubicState<N>& s,
                          std::int32_t left, std::uint8_t& c) noexcept {
    if (s.run > 0) return run_code(io, costs, s.run, s.last_code, c);
    if (s.loose()) return break_code(io, costs, c);
    const Way told = c == curve::code::to_end  ? Way::to_end
                     : c < curve::length_count ? Way::listed
                                               : Way::breaks;
    auto way = static_cast<std::uint8_t>(told);
    if (!symbol(io, costs.way[cubic_way_row(s.last_code, s.last_ticks, left)], cubic_way_symbols,
                way))
        return false;
    if (way == static_cast<std::uint8_t>(Way::breaks)) return break_code(io, costs, c);
    if (way == static_cast<std::uint8_t>(Way::listed))
        return symbol(io, costs.length[cubic_length_row(s.last_code, false)], curve::length_count,
                      c);
    c = curve::code::to_end;
    return true;
}

}  // namespace detail

/// Codes one piece and steps the state. `left`: sub-ticks to the end of the channel in its frame.
/// The first control point of a run is told elsewhere: piece.k holds it before, of a cubic there.
/// span: how the piece is drawn, if this is known.
/// @return false where a decoder reads nonsense, or an encoder was given a piece out of bounds.
template <class Io, std::size_t N>
constexpr bool code_cubic(Io& io, const CubicCosts& costs, curve::CubicState<N>& s,
                          curve::Piece<N>& piece, std::int32_t left,
                          curve::CubicSpan<N>& span) noexcept {
    namespace codes = curve::code;
    if (left <= 0) return false;
    if (s.phase != 0)
        piece.code = codes::jump;
    else if (!detail::cubic_code(io, costs, s, left / curve::subs_per_tick, piece.code))
        return false;
    if (piece.code == codes::jump) {
        if (!detail::duration(io, s.phase, piece.subs) || piece.subs > left) return false;
        for (auto& k : piece.k)
            if (!detail::plain(io, k)) return false;
        return curve::step(s, piece, span);
    }
    const bool line = curve::is_line(piece.code);
    const std::size_t index = line ? piece.code - codes::line : piece.code;
    const std::int32_t lasts =
        curve::ends_frame(piece.code) ? left : curve::lengths[index] * curve::subs_per_tick;
    if (lasts > left || left > curve::piece_ticks_max * curve::subs_per_tick ||
        left % curve::subs_per_tick != 0)
        return false;
    piece.subs = static_cast<std::uint16_t>(lasts);
    for (std::size_t c = 0; c < N && s.run != 3; ++c) {
        const std::size_t row = cubic_value_row(s, c, line, lasts / curve::subs_per_tick);
        const std::int8_t sign = s.run > 0 || line ? std::int8_t{0} : s.sign[c];
        if (!detail::value(io, costs.value[row], sign, piece.k[c])) return false;
    }
    return curve::step(s, piece, span);
}

}  // namespace fairlead::code
