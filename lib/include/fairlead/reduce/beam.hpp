#pragma once
// What the searches of axes and rotations share: sizes, costs of the seam, traces back.
//
// The search is a beam over vertices: every column (a tick with a sample) may hold a vertex, each
// vertex is an open hypothesis of a piece that begins there, and takes each sample in constant time
// by running bounds on its quadratic coefficient. At a column a hypothesis of a length from the
// list closes: its bounds allow some lattice values for the vertex there. The cheapest few in bits
// are the column's children, and open hypotheses of their own. Nothing is ever searched again.
#include <cstddef>
#include <cstdint>

#include "fairlead/code/model.hpp"
#include "fairlead/code/tables.hpp"
#include "fairlead/curve/state.hpp"
#include "fairlead/reduce/paths.hpp"

namespace fairlead::reduce {

using code::Cost;

/// Sizes of a search. Width: children a column; Open: open hypotheses; Spare: pushes over which a
/// frame is checked and coded, at most; they are lost to its window. Tests: comparisons of
/// rotations with samples a column, about. wire/encoder.hpp has the sizes of the boards' beams.
/// Wider costs work and memory and saves bytes, and so does less spare: docs/choosing.md.
template <std::size_t WidthN, std::size_t OpenN, std::uint32_t SpareN = 6, int TestsN = 120>
struct BeamSize {
    static constexpr std::size_t width = WidthN;
    static constexpr std::size_t open = OpenN;
    static constexpr std::uint32_t spare = SpareN;
    static constexpr int tests = TestsN;
    /// Part of the tolerance that the search uses, less its margin. Tests plant faults with more
    /// than 1, and show that no frame with a fault leaves.
    static constexpr float trust = 1.0f;
    static_assert(width >= 1 && width <= 8, "a beam keeps 1 to 8 children a column");
    static_assert(tests >= 1 && tests <= 1000, "a beam tests 1 to 1000 samples a column");
    static_assert(open >= 2 * width && open <= 200, "a beam needs room for two columns at least");
};

/// Hypotheses dearer than the cheapest by more than this are dropped (1/16 bit).
inline constexpr Cost margin_cost = 160;
/// At the end of a frame one child goes on, so that few need to be kept.
inline constexpr std::size_t end_width = 2;
/// The least that a hypothesis still pays at a column; part of the same rule.
inline constexpr Cost step_cost_min = 24;
/// A jump is considered only where it saves at least this over its value: its code's cost, about.
inline constexpr Cost jump_code_cost_min = 64;
/// Seam at the end of a frame: 0.3 ((value error + 10 slope error) / tolerance)^2 bits.
inline constexpr float seam_weight = 0.3f * 16.0f;
inline constexpr float seam_ticks = 10.0f;
/// Vertices keep within this many steps of where the window began: they are stored in 16 bits.
inline constexpr std::int32_t window_steps_max = 32000;
/// A column gives a frame at most this, and costs stay below it.
inline constexpr Cost cost_limit = 60000;
/// Tolerance lost to the rounding of float bounds, as a part of the numbers involved. Chosen
/// with room and held by the searches of make pipeline-search; not derived.
inline constexpr float rounding = 0x1p-19f;
inline constexpr float far_away = 1e30f;
inline constexpr float slope_steps = 1.0f / static_cast<float>(curve::slope_unit);

/// Bits of one jump between two columns of a window, at most: of so many samples, each with a part
/// of its own, one part to the target, two parts without a value at ticks between, four codes, and
/// the margin by which the vertex that is chosen may be dearer. No other piece has more.
constexpr Cost jump_bits_max(std::size_t components, std::size_t samples = 4) noexcept {
    const auto n = static_cast<Cost>(components);
    const auto own = static_cast<Cost>(samples < 7 ? samples : 7) + 1;
    const Cost duration = code::other_duration_cost / 16 + 1, code_bits = code::cost_max / 16;
    return own * (n * (5 + 17) + duration) + 2 * (n * 5 + duration) + 4 * code_bits +
           margin_cost / 16;
}

/// Code of a piece of h ticks.
constexpr std::uint8_t code_of(std::uint8_t way, std::int32_t h) noexcept {
    if ((way & how::jump) != 0) return curve::code::jump;
    const bool line = (way & how::line) != 0;
    if ((way & how::to_end) != 0) return line ? curve::code::line_to_end : curve::code::to_end;
    const std::uint8_t index = curve::index_of(h);
    return line ? static_cast<std::uint8_t>(index + curve::code::line) : index;
}

/// Rises of one component.
struct Range {
    float low{-far_away}, high{far_away};

    constexpr void within(float l, float h) noexcept {
        if (l > low) low = l;
        if (h < high) high = h;
    }
    constexpr bool whole() const noexcept { return low <= high; }
    /// The first and the last integer between the bounds, which are small.
    constexpr std::int32_t first() const noexcept {
        const auto i = static_cast<std::int32_t>(low);
        return static_cast<float>(i) < low ? i + 1 : i;
    }
    constexpr std::int32_t last() const noexcept {
        const auto i = static_cast<std::int32_t>(high);
        return static_cast<float>(i) > high ? i - 1 : i;
    }
};

/// A vertex must leave a way to the sample behind its column: as far as a piece bends in the time
/// to it, in steps a tick^2.
inline constexpr float bend_likely = 2.0f;

/// Bounds of a rise p so that the piece behind the vertex can reach a sample: from v + p with the
/// slope at the end of a piece of h ticks (2 p / h - s, or p / h where it is the chord's) it must
/// come within `room` of `later` after `after` ticks. s, room and later - v in the same unit as p.
constexpr Range reach(float s, bool chord, float h, float ahead, float after, float room) noexcept {
    const float turns = 1.0f / (1.0f + (chord ? 1.0f : 2.0f) * after / h);
    const float middle = chord ? ahead : ahead + s * after;
    return {(middle - room) * turns, (middle + room) * turns};
}

/// Shape of the piece that begins at an open vertex.
enum class Shape : std::uint8_t { quadratic, fresh, line };

template <std::size_t N>
constexpr Shape shape_of(const curve::State<N>& s) noexcept {
    return s.fresh ? Shape::fresh : s.loose() ? Shape::line : Shape::quadratic;
}

/// Where a column is, and what surrounds it; N components, in steps against the origin.
template <std::size_t N>
struct Column {
    std::int32_t tick{};  // from the window's start; > 0
    std::size_t last{};   // one behind the last sample at or before it
    std::array<float, N> middle{};
    bool known{};                        // middle bounds the vertex
    std::array<float, N> later{};        // the sample behind the column,
    float after{};                       // this many ticks; 0: none
    bool end{};                          // the frame ends here
    const std::array<float, N>* told{};  // at this place, if it tells where
};

/// A vertex that a column offers.
template <std::size_t N>
struct Vertex {
    std::array<std::int32_t, N> s{};
    std::array<std::int16_t, N> v{};
    std::uint16_t cost{};
    std::uint8_t before{}, way{};  // its vertex before, in Paths; how::...
    std::array<std::int8_t, N> last_k{}, sign{};
    std::uint8_t last_code{}, last_ticks{};
};

/// A piece that begins at a vertex and has no end yet.
template <std::size_t N>
struct Hypothesis {
    std::array<float, N> low, high;  // bounds of (p - s h) / h^2
    std::array<float, N> s;          // slope as an integer of 1/960 step a tick: exact
    std::array<std::int16_t, N> v;
    std::uint16_t cost;
    std::uint8_t tick, vertex;  // where it begins; the vertex in Paths
    std::uint8_t first;         // no sample before this one is behind its start
    std::array<std::int8_t, N> last_k, sign;
    std::uint8_t last_code, last_ticks;
    Shape shape;

    float slope(std::size_t a) const noexcept { return s[a] * slope_steps; }
    std::int32_t slope_units(std::size_t a) const noexcept {
        return static_cast<std::int32_t>(s[a]);
    }
};

/// What all vertices at the end of one piece have in common.
template <std::size_t N>
struct Ending {
    curve::State<N> before{};  // what predicts its symbols
    std::array<std::int32_t, N> predicted{};
    std::int32_t h{};
    Cost base{};  // of the path and of the code
    std::uint8_t code{}, way{};
};

/// One of them.
template <std::size_t N>
struct Candidate {
    Cost cost;
    std::array<std::int32_t, N> p, k;
};

}  // namespace fairlead::reduce
