#pragma once
// What the pieces of C2 cubics cost: contexts, costs in 1/16 bit as the coder's tables have them
// (code/model.hpp), and the counts from which they are trained.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "fairlead/code/model.hpp"
#include "fairlead/curve/cubic_rotation.hpp"

namespace fairlead::sim::cubics {

template <std::size_t N>
using State = curve::CubicState<N>;
template <std::size_t N>
using Piece = curve::Piece<N>;
template <std::size_t N>
using Span = curve::CubicSpan<N>;

/// How a piece goes on, outside a run.
enum class Way : std::uint8_t { listed, to_end, breaks };

/// Rows of symbols. way: by the last code and by what is left over the last length; length: by the
/// last code, and one for runs; line: its length; value: k by its context.
struct Rows {
    static constexpr std::size_t way_count = 17 * 8, way_size = 3;
    static constexpr std::size_t length_count = 18, length_size = curve::length_count;
    static constexpr std::size_t line_size = curve::length_count + 1;
    static constexpr std::size_t value_count = 81, value_size = code::value_symbols;
};

template <class Number>
struct Model {
    std::array<std::array<Number, Rows::way_size>, Rows::way_count> way{};
    std::array<std::array<Number, Rows::length_size>, Rows::length_count> length{};
    std::array<Number, Rows::line_size> line{};
    std::array<std::array<Number, Rows::value_size>, Rows::value_count> value{};
};
using Costs = Model<std::uint8_t>;
using Counts = Model<double>;

template <std::size_t N>
std::size_t way_row(const State<N>& state, std::int32_t left);
template <std::size_t N>
std::size_t length_row(const State<N>& state);
/// Row of k of component c of a piece of h ticks. `line`: it is a line; `moved`: a k of a component
/// before is not 0.
template <std::size_t N>
std::size_t value_row(const State<N>& state, std::size_t c, std::int32_t h, bool line, bool moved);
/// The sign that k of component c is told relative to; 0 counts as plus.
template <std::size_t N>
std::int8_t told_sign(const State<N>& state, std::size_t c, bool line) {
    return state.run > 0 || line ? std::int8_t{0} : state.sign[c];
}

/// Adds the symbols of a piece. left: ticks to the end of its frame.
template <std::size_t N>
void count(Counts& counts, const State<N>& state, std::int32_t left, const Piece<N>& piece);
/// Costs of what was counted, with something expected of each symbol.
Costs train(const Counts& counts);
/// Writes code/cubic_tables.hpp. @return false: the file could not be written.
bool write_tables(const Costs& costs, const std::string& file);

/// Bits of a k in its row.
double value_bits(const Costs& costs, std::size_t row, std::int32_t k, std::int8_t sign);
/// Bits of a plain number: 5 for its size, then its bits and its sign.
double plain_bits(std::int32_t k);

}  // namespace fairlead::sim::cubics
