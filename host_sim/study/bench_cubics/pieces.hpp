#pragma once
// Pieces of C2 cubics to symbols and back: one description for both directions (code/pieces.hpp).
#include "fairlead/code/pieces.hpp"
#include "host_sim/study/bench_cubics/tables.hpp"

namespace fairlead::sim::cubics {

namespace detail {

template <class Io, std::size_t N>
bool length(Io& io, const Costs& costs, const State<N>& s, std::int32_t left, Piece<N>& p) {
    if (s.run == 1 || s.run == 2) {
        bool jumps = p.code == curve::code::jump;
        io.flag(jumps, 1, 6);
        p.code = jumps ? curve::code::jump : s.last_code;
        return true;
    }
    std::uint8_t way = p.code == curve::code::jump || curve::is_line(p.code)
                           ? static_cast<std::uint8_t>(Way::breaks)
                       : p.code == curve::code::to_end ? static_cast<std::uint8_t>(Way::to_end)
                                                       : static_cast<std::uint8_t>(Way::listed);
    if (s.run == 3) {
        bool jumps = p.code == curve::code::jump;
        io.flag(jumps, 1, 6);
        way = static_cast<std::uint8_t>(jumps ? Way::breaks : Way::listed);
        if (jumps) return p.code = curve::code::jump, true;
    } else if (s.loose()) {
        way = static_cast<std::uint8_t>(Way::breaks);
    } else if (!code::symbol(io, costs.way[way_row(s, left)].data(), Rows::way_size, way)) {
        return false;
    }
    if (way == static_cast<std::uint8_t>(Way::to_end)) return p.code = curve::code::to_end, true;
    if (way == static_cast<std::uint8_t>(Way::listed))
        return code::symbol(io, costs.length[length_row(s)].data(), Rows::length_size, p.code);
    bool jumps = p.code == curve::code::jump;
    io.flag(jumps, 1, 5);
    std::uint8_t line = static_cast<std::uint8_t>(p.code - curve::code::line);
    if (!jumps && !code::symbol(io, costs.line.data(), Rows::line_size, line)) return false;
    p.code = jumps ? curve::code::jump : static_cast<std::uint8_t>(curve::code::line + line);
    return true;
}

}  // namespace detail

/// Codes one piece and steps the state; left: ticks to the end of the frame. c1 of a run is told
/// elsewhere: it is in p.k already. Jumps last a tick. @return false: nonsense.
template <class Io, std::size_t N>
bool code_piece(Io& io, const Costs& costs, State<N>& s, std::int32_t left, Piece<N>& p,
                Span<N>& span) {
    if (left <= 0 || !detail::length(io, costs, s, left, p)) return false;
    const bool line = curve::is_line(p.code), jump = p.code == curve::code::jump;
    const std::int32_t h = jump ? 1
                           : curve::ends_frame(p.code)
                               ? left
                               : curve::lengths[line ? p.code - curve::code::line : p.code];
    if (h > left) return false;
    p.subs = static_cast<std::uint16_t>(h * curve::subs_per_tick);
    bool moved = false;
    for (std::size_t c = 0; c < N && (jump || s.run != 3); ++c) {
        if (jump) {
            if (!code::detail::plain(io, p.k[c])) return false;
            continue;
        }
        const std::uint8_t* row = costs.value[value_row(s, c, h, line, moved)].data();
        if (!code::detail::value(io, row, told_sign(s, c, line), p.k[c])) return false;
        moved = moved || p.k[c] != 0;
    }
    return curve::step(s, p, span);
}

}  // namespace fairlead::sim::cubics
