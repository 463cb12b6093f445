#pragma once
// Symbols of the pieces of C2 cubics: alphabets, contexts, and the table of their costs.
//
// The costs are those of model.hpp: 1/16 bit in a byte. A piece tells how it goes on (Way), then
// its length, then k. What predicts the way is what is left of the frame over the last length: a
// piece to the end of the frame is likely where little is left. What predicts the size of k is that
// of the last two, and how much the curve bends within the piece. docs/stream.md, Cubics.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/code/model.hpp"
#include "fairlead/curve/cubic_state.hpp"

namespace fairlead::code {

/// How a curve of cubics goes on, outside a run: a piece of a listed length, one to the end of the
/// channel in its frame, or a break (a line or a jump).
enum class Way : std::uint8_t { listed, to_end, breaks };

inline constexpr std::size_t cubic_way_rows = 17 * 8, cubic_way_symbols = 3;
inline constexpr std::size_t cubic_length_rows = 18;  // by the last code; one for runs
inline constexpr std::size_t cubic_line_symbols = curve::length_count + 1;
inline constexpr std::size_t cubic_value_rows = 81;
/// First rows of values: those of runs, of the classes of k outside runs, of lines.
inline constexpr std::size_t cubic_run_values = 0, cubic_class_values = 6, cubic_line_values = 78;

/// P(a piece of a run is a jump) = 1 / 2^run_jump_bits; P(a break is a jump) = 1 /
/// 2^break_jump_bits.
inline constexpr unsigned run_jump_bits = 6, break_jump_bits = 5;

struct CubicCosts {
    std::uint8_t way[cubic_way_rows][cubic_way_symbols];
    std::uint8_t length[cubic_length_rows][curve::length_count];
    std::uint8_t line[cubic_line_symbols];
    std::uint8_t value[cubic_value_rows][value_symbols];
};

/// Row of the way on; left: ticks to the channel's end in the frame.
constexpr std::size_t cubic_way_row(std::uint8_t last_code, std::uint8_t last_ticks,
                                    std::int32_t left) noexcept {
    constexpr std::array<std::int32_t, 7> tenths{4, 7, 10, 13, 17, 25, 40};  // of the last length
    std::size_t bucket = 0;
    while (bucket < tenths.size() && 10 * left >= tenths[bucket] * last_ticks) ++bucket;
    return (last_code < 16 ? last_code : std::size_t{16}) * 8 + bucket;
}
constexpr std::size_t cubic_length_row(std::uint8_t last_code, bool in_run) noexcept {
    return in_run ? 17u : last_code < 16 ? last_code : std::size_t{16};
}
/// Class of a length.
constexpr std::size_t cubic_length_class(std::int32_t h) noexcept {
    return h <= 12 ? 0u : h <= 30 ? 1u : 2u;
}
/// Row of k of a line of h ticks, and of a piece in a run with `run` pieces left, 1 or 2.
constexpr std::size_t cubic_line_row(std::int32_t h) noexcept {
    return cubic_line_values + cubic_length_class(h);
}
constexpr std::size_t cubic_run_row(std::uint8_t run, std::int32_t h) noexcept {
    return cubic_run_values + (run == 2 ? 0u : 3u) + cubic_length_class(h);
}
/// Row of k of a cubic outside a run. bend: h^2 a in 1/1024 steps, rounded down (curve::ahead);
/// last_k, before_k: of the last two cubics.
constexpr std::size_t cubic_value_row(std::int32_t last_k, std::int32_t before_k, std::int64_t bend,
                                      std::int32_t h, std::uint8_t last_ticks) noexcept {
    constexpr std::array<std::int64_t, 7> limit{358, 819, 1536, 2662, 4301, 7168, 12288};
    const auto size_of = [](std::int64_t x) { return x < 0 ? -x : x; };
    const std::int64_t size =
        512 * size_of(last_k) + 256 * size_of(before_k) + size_of(bend) / 4 + 12;
    std::size_t of = 0;
    while (of < limit.size() && size > limit[of]) ++of;
    return cubic_class_values + (of * 3 + curve::length_ratio(h, last_ticks)) * 3 +
           cubic_length_class(h);
}
/// Row of k of component c of the next piece, of h ticks; not of the first piece of a run.
template <std::size_t N>
constexpr std::size_t cubic_value_row(const curve::CubicState<N>& s, std::size_t c, bool line,
                                      std::int32_t h) noexcept {
    if (line) return cubic_line_row(h);
    if (s.run > 0) return cubic_run_row(s.run, h);
    return cubic_value_row(s.last_k[c], s.before_k[c], curve::ahead(s.at[c], h).bend, h,
                           s.last_ticks);
}

}  // namespace fairlead::code
