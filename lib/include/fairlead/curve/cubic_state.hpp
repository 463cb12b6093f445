#pragma once
// A track of cubics (cubic.hpp): what one piece does to its state, for a coder of either direction.
//
// A piece is, by its code (lengths.hpp),
//   a cubic   tells k: its control point c is the predicted one plus k;
//   a line    breaks the curve: p stays, v and a jump. It tells k: its end is a lattice value;
//   a jump    breaks the curve: p jumps to a lattice value, and holds.
// A line of one tick reaches each sample at the next tick, and jumps reach closer ones: a way on
// always exists. Behind a jump, and where a curve begins, the next piece is a line, as with the
// quadratics of state.hpp.
// After a restart the next three pieces are a run: the first tells its length, all have it, and
// their control points are told so that a reader who knows nothing can follow: c1 by itself, c2
// against c1, c3 against c2 + 0.9 (c2 - c1). Behind the third, all readers set the state from c1,
// c2, c3. A jump, the only other piece allowed in a run, ends it: it tells its value by itself.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/curve/cubic.hpp"

namespace fairlead::curve {

/// |k| of a piece that is no jump, at most.
inline constexpr std::int32_t cubic_k_max = 1 << 20;

/// State of N components that share their vertices: 1 for an axis of a vector, 3 for a rotation.
template <std::size_t N>
struct CubicState {
    std::array<CubicVertex, N> at{};
    std::array<std::int32_t, N> control{}, control_before{};  // the last two of a run
    std::array<std::int8_t, N> last_k{}, before_k{};          // of the last two cubics, to +-100
    std::array<std::int8_t, N> sign{};                        // of the last k that was not 0
    std::uint8_t last_code{code::jump};                       // a line as the cubic of its length
    std::uint8_t last_ticks{1};
    std::uint8_t phase{0};  // sub-ticks behind the whole tick; other than 0 only between jumps
    std::uint8_t run{0};    // pieces left of a run
    bool known{true};       // false: a reader has joined, `at` says nothing

    /// Is the next piece a line, because the curve began or jumped?
    constexpr bool loose() const noexcept { return run == 0 && last_code == code::jump; }

    /// A curve begins at rest on these values, |value| <= vertex_max.
    static constexpr CubicState begin(const std::array<std::int32_t, N>& value) noexcept {
        CubicState s;
        for (std::size_t c = 0; c < N; ++c) s.at[c] = at_rest(value[c]);
        return s;
    }
    /// A reader joins where a run begins.
    static constexpr CubicState join() noexcept {
        CubicState s;
        s.restart();
        s.known = false;
        return s;
    }
    /// A run begins. What predicts is forgotten; the curve goes on.
    constexpr void restart() noexcept {
        last_k = before_k = sign = {};
        last_code = code::to_end;
        last_ticks = 1;
        phase = 0;
        run = 3;
    }
};

/// Is it the same state, bit for bit?
template <std::size_t N>
constexpr bool same(const CubicState<N>& a, const CubicState<N>& b) noexcept {
    bool all = a.last_code == b.last_code && a.last_ticks == b.last_ticks && a.phase == b.phase &&
               a.run == b.run && a.known == b.known;
    for (std::size_t c = 0; c < N; ++c)
        all = all && a.at[c] == b.at[c] && a.control[c] == b.control[c] &&
              a.control_before[c] == b.control_before[c] && a.last_k[c] == b.last_k[c] &&
              a.before_k[c] == b.before_k[c] && a.sign[c] == b.sign[c];
    return all;
}

/// One piece as it is drawn: from `start` with the third derivative j; a jump holds `start`.
template <std::size_t N>
struct CubicSpan {
    std::array<CubicVertex, N> start{};
    std::array<std::int64_t, N> j{};
    bool known{true};  // false: a reader who has joined cannot draw it
};

/// How a length stands to the one before: 0 equal, 1 longer, 2 shorter.
constexpr std::size_t length_ratio(std::int32_t h, std::int32_t before) noexcept {
    return h == before ? 0u : h > before ? 1u : 2u;
}

/// Weights of travel and bend in the next control point, in 1/64, by length_ratio(). A curve whose
/// third derivative is 0 has 2 and 11/6; less is likelier because curves turn back. Fitted to
/// recordings of a tracker: the axes of positions, and rotations.
struct ControlWeights {
    std::array<std::int32_t, 3> travel, bend;
};
inline constexpr ControlWeights axis_weights{{64 + 49, 64 + 51, 64 + 58}, {84, 69, 89}};
inline constexpr ControlWeights rotation_weights{{64 + 61, 64 + 60, 64 + 63}, {66, 51, 98}};

/// The control point expected of component c of a piece of h ticks.
template <std::size_t N>
constexpr std::int32_t predicted_control(const CubicState<N>& s, std::size_t c,
                                         std::int32_t h) noexcept {
    if (s.run == 3) return 0;
    if (s.run == 2) return s.control[c];
    if (s.run == 1) {
        const std::int64_t rise = std::int64_t{s.control[c]} - s.control_before[c];
        return static_cast<std::int32_t>(s.control[c] + detail::floored(9 * rise + 5, 10));
    }
    const Ahead to = ahead(s.at[c], h);
    const std::size_t ratio = length_ratio(h, s.last_ticks);
    const ControlWeights& weights = N == 1 ? axis_weights : rotation_weights;
    const std::int64_t rise = std::int64_t{64} * to.part + weights.travel[ratio] * to.travel +
                              weights.bend[ratio] * to.bend;
    return static_cast<std::int32_t>(lattice_near(s.at[c]) +
                                     detail::floored(rise + 32 * fine, 64 * fine));
}

/// The lattice value expected at the end of a line of h ticks.
template <std::size_t N>
constexpr std::int32_t predicted_end(const CubicState<N>& s, std::size_t c,
                                     std::int32_t h) noexcept {
    const std::int64_t travel =
        detail::floored_by<2 * cubic_unit / fine>(std::int64_t{h} * s.at[c].v);
    return static_cast<std::int32_t>(lattice_near(s.at[c]) +
                                     detail::floored(travel + fine / 2, fine));
}

namespace detail {

/// A piece in a run. @return false: out of bounds.
template <std::size_t N>
constexpr bool run_piece(CubicState<N>& s, std::size_t c, std::int32_t h, std::int32_t k,
                         CubicSpan<N>& span) noexcept {
    const std::int64_t told = std::int64_t{predicted_control(s, c, h)} + k;
    if (!within(told, vertex_max)) return false;
    const auto control = static_cast<std::int32_t>(told);
    const CubicVertex from = s.at[c];
    if (s.known) {
        if (!within(told - lattice_near(from), control_max)) return false;
        span.start[c] = from;
        span.j[c] = third_derivative(from, h, control);
        s.at[c] = piece_end(from, h, span.j[c]);
    }
    if (s.run == 1) s.at[c] = behind_run(s.control_before[c], s.control[c], control, h);
    s.control_before[c] = s.control[c];
    s.control[c] = control;
    return (!s.known && s.run != 1) || inside(s.at[c]);
}

/// A cubic or a line outside a run. @return false: out of bounds.
template <std::size_t N>
constexpr bool free_piece(CubicState<N>& s, std::size_t c, bool line, std::int32_t h,
                          std::int32_t k, CubicSpan<N>& span) noexcept {
    const CubicVertex from = s.at[c];
    const std::int64_t to =
        std::int64_t{line ? predicted_end(s, c, h) : predicted_control(s, c, h)} + k;
    if (!within(to, vertex_max) || !within(to - lattice_near(from), control_max)) return false;
    const auto aim = static_cast<std::int32_t>(to);
    span.start[c] = line ? line_start(from, h, aim) : from;
    span.j[c] = line ? 0 : third_derivative(from, h, aim);
    s.at[c] = piece_end(span.start[c], h, span.j[c]);
    s.before_k[c] = line ? std::int8_t{0} : s.last_k[c];
    s.last_k[c] = line ? std::int8_t{0}
                       : static_cast<std::int8_t>(k > 100    ? 100
                                                  : k < -100 ? -100
                                                             : k);
    if (line) s.sign[c] = 0;
    if (!line && k != 0) s.sign[c] = static_cast<std::int8_t>(k > 0 ? 1 : -1);
    return inside(span.start[c]) && inside(s.at[c]);
}

template <std::size_t N>
constexpr bool jump_piece(CubicState<N>& s, const std::array<std::int32_t, N>& k,
                          CubicSpan<N>& span) noexcept {
    for (std::size_t c = 0; c < N; ++c) {
        const std::int64_t to = std::int64_t{s.run > 0 ? 0 : lattice_near(s.at[c])} + k[c];
        if (!within(k[c], jump_max) || !within(to, vertex_max)) return false;
        s.at[c] = span.start[c] = at_rest(static_cast<std::int32_t>(to));
    }
    s.last_k = s.before_k = s.sign = {};
    s.run = 0;
    s.known = true;
    return true;
}

}  // namespace detail

/// Goes on to the end of a piece. subs: its duration in sub-ticks, whole ticks but for a jump.
/// @param span is written: how the piece is drawn.
/// @return false, with the state unchanged, where the piece is not allowed there or leaves the
/// bounds of cubic.hpp. Any values are allowed in the piece. Cost: a division of 64 bits by h^3,
/// and four by constants, for each component.
template <std::size_t N>
constexpr bool step(CubicState<N>& state, const Piece<N>& piece, CubicSpan<N>& span) noexcept {
    const bool line = is_line(piece.code), jump = piece.code == code::jump;
    CubicState<N> s = state;
    CubicSpan<N> drawn;
    if (piece.subs == 0) return false;
    if (jump) {
        drawn.known = true;
        if (!detail::jump_piece(s, piece.k, drawn)) return false;
        s.last_code = code::jump;
        s.last_ticks = 1;
        s.phase = static_cast<std::uint8_t>((s.phase + piece.subs) % subs_per_tick);
        state = s;
        span = drawn;
        return true;
    }
    const std::int32_t h = piece.subs / subs_per_tick;
    if (s.phase != 0 || piece.subs % subs_per_tick != 0 || h > piece_ticks_max) return false;
    if (piece.code > code::to_end && !line) return false;
    if (!ends_frame(piece.code) && lengths[line ? piece.code - code::line : piece.code] != h)
        return false;
    if (line ? s.run > 0 : s.loose()) return false;
    if (s.run > 0 && (piece.code == code::to_end || (s.run < 3 && h != s.last_ticks))) return false;
    drawn.known = s.known;
    for (std::size_t c = 0; c < N; ++c) {
        const std::int32_t most = s.run == 3 ? vertex_max : cubic_k_max;
        if (!detail::within(piece.k[c], most)) return false;
        if (s.run > 0 ? !detail::run_piece(s, c, h, piece.k[c], drawn)
                      : !detail::free_piece(s, c, line, h, piece.k[c], drawn))
            return false;
    }
    if (s.run == 1) s.known = true;
    if (s.run > 0) --s.run;
    s.last_code = static_cast<std::uint8_t>(line ? piece.code - code::line : piece.code);
    s.last_ticks = static_cast<std::uint8_t>(h);
    state = s;
    span = drawn;
    return true;
}

/// Value of component c of a piece, in lattice steps, t ticks behind its start. Real: double on a
/// host, float on a board, which rounds to its width.
template <class Real, std::size_t N>
constexpr Real value_at(const CubicSpan<N>& span, std::size_t c, Real t) noexcept {
    const std::int32_t near_by = lattice_near(span.start[c]);
    return static_cast<Real>(near_by) +
           (part_of<Real>(span.start[c], near_by) + cubic<Real>(span.start[c], span.j[c]).rise(t));
}

}  // namespace fairlead::curve
