#pragma once
// How long a piece of a curve may be, and the codes that tell lengths and types of pieces.
//
// A piece lasts a number of ticks from a short list. All of the list divide 960, the denominator of
// slopes, so that the slope at the end of a piece is an integer again and no rounding accumulates.
// Pieces of other lengths exist only where they end a frame (to_end) and as jumps (jump).
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/compiler.hpp"

namespace fairlead::curve {

/// Slopes are integers in units of 1/960 lattice step a tick.
inline constexpr std::int32_t slope_unit = 960;
/// The shortest unit of time in a curve: 1/64 of a tick.
inline constexpr std::int32_t subs_per_tick = 64;
/// The longest piece that is not a jump, in ticks; also the longest frame.
inline constexpr std::int32_t piece_ticks_max = 255;

inline constexpr std::size_t length_count = 16;
inline constexpr std::array<std::uint8_t, length_count> lengths{1,  2,  4,  6,  8,  10, 12, 16,
                                                                20, 24, 32, 40, 48, 64, 80, 120};

/// Codes of pieces; [0, length_count) are quadratics of lengths[code].
namespace code {
inline constexpr std::uint8_t to_end = 16;  // a quadratic to the end of the frame
inline constexpr std::uint8_t jump = 17;    // the value jumps, then holds
inline constexpr std::uint8_t rebase = 18;  // no time passes; a rotation changes its anchor
inline constexpr std::uint8_t line = 19;    // [line, line + length_count): straight lines
inline constexpr std::uint8_t line_to_end = 35;
inline constexpr std::uint8_t none = 255;
}  // namespace code

/// The kinds of curve that a stream may hold; the header of the stream names one by its id.
struct Smooth {  // quadratics whose slope is continuous
    static constexpr std::uint8_t id = 1;
    static constexpr bool cubic = false, lines = false;
    static constexpr std::size_t codes = 19;
};
struct Corners {  // the same, and straight lines, where the slope may jump at both ends
    static constexpr std::uint8_t id = 2;
    static constexpr bool cubic = false, lines = true;
    static constexpr std::size_t codes = 36;
};
struct Cubics {  // cubics whose second derivative is continuous (cubic.hpp); vectors only
    static constexpr std::uint8_t id = 3;
    static constexpr bool cubic = true;
};

constexpr bool is_line(std::uint8_t c) noexcept {
    return c >= code::line && c <= code::line_to_end;
}
constexpr bool ends_frame(std::uint8_t c) noexcept {
    return c == code::to_end || c == code::line_to_end;
}

namespace detail {
constexpr std::array<std::uint8_t, 121> index_of_length() noexcept {
    std::array<std::uint8_t, 121> index{};
    for (auto& i : index) i = code::none;
    for (std::size_t i = 0; i < length_count; ++i) index[lengths[i]] = static_cast<std::uint8_t>(i);
    return index;
}
inline constexpr auto length_index = index_of_length();
constexpr bool all_divide_the_unit() noexcept {
    for (const auto h : lengths)
        if (slope_unit % h != 0) return false;
    return true;
}
static_assert(all_divide_the_unit());
}  // namespace detail

/// Index of a length in ticks, or code::none where it is not in the list.
constexpr std::uint8_t index_of(std::int32_t ticks) noexcept {
    return ticks >= 1 && ticks <= 120 ? detail::length_index[static_cast<std::size_t>(ticks)]
                                      : code::none;
}

}  // namespace fairlead::curve
