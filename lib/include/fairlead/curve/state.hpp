#pragma once
// How a curve goes on from vertex to vertex: all that encoder and decoder must know alike.
//
// At a vertex the curve has a value v (lattice steps) and a slope s (1/960 step a tick), integers.
// A piece of h ticks adds one integer k per component:
//     v' = predicted(v, s, h) + k,          predicted: v + s h / 960, rounded
//     quadratic: s' = 2 (v' - v) / h - s    line: s' = (v' - v) / h
// After a restart the slope is not known to a reader who joins. The first piece is then `fresh`: it
// predicts v, and a cubic leads from the old slope to the slope (v' - v) / h of its chord, so that
// later pieces do not depend on what came before the restart.
// A jump moves v by k, sets s to 0, and holds for a number of sub-ticks. Jumps follow each other
// until they reach a whole tick again. The slope is lost there, so that the piece behind is always
// a straight line: a curve in fast motion finds its slope at once.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/curve/grid.hpp"
#include "fairlead/curve/lengths.hpp"

namespace fairlead::curve {

/// Bounds that a valid stream keeps; step() refuses what leaves them.
inline constexpr std::int32_t vertex_max = 1 << 30;      // |v|
inline constexpr std::int32_t slope_max = 1 << 23;       // |s|
inline constexpr std::int32_t rise_max = 32767;          // |v' - v| of a piece that is no jump
inline constexpr std::int32_t jump_max = (1 << 30) - 1;  // |v' - v| of a jump
static_assert(std::int64_t{slope_max} * piece_ticks_max + slope_unit < INT32_MAX);
static_assert(std::int64_t{vertex_max} + jump_max <= INT32_MAX);

/// What predicts the next piece, beside the last k.
struct History {
    std::uint8_t last_code{code::to_end};  // of the last piece; a line as its quadratic
    std::uint8_t last_ticks{1};
    std::uint8_t phase{0};  // sub-ticks behind the whole tick; other than 0 only between jumps
    bool fresh{true};

    /// Is the next piece a straight line, because it follows a jump?
    constexpr bool loose() const noexcept { return last_code == code::jump && !fresh; }
};

/// A state of n components, 1 to 3, as functions take it: one code for axes and rotations.
struct StateView {
    History& history;
    std::int32_t *v, *s;
    std::int8_t *last_k, *sign;
    std::size_t n;

    /// Forgets what predicts lengths and k, but not the curve: what a restart does. `again` tells
    /// whether the next piece is fresh.
    constexpr void forget(bool again) const noexcept {
        history = {};
        history.fresh = again;
        for (std::size_t c = 0; c < n; ++c) last_k[c] = sign[c] = 0;
    }
};

/// N components that share their vertices: 1 for an axis of a vector, 3 for a rotation.
template <std::size_t N>
struct State : History {
    static_assert(N >= 1 && N <= 3);
    std::array<std::int32_t, N> v{};
    std::array<std::int32_t, N> s{};
    std::array<std::int8_t, N> last_k{};  // of the last piece, limited to +-100
    std::array<std::int8_t, N> sign{};    // of the last k that was not 0; -1, or 0 or 1 for plus

    constexpr StateView view() noexcept {
        return {*this, v.data(), s.data(), last_k.data(), sign.data(), N};
    }
    constexpr void forget(bool again) noexcept { view().forget(again); }
};

/// Is it the same state, bit for bit?
template <std::size_t N>
constexpr bool same(const State<N>& a, const State<N>& b) noexcept {
    bool all = a.last_code == b.last_code && a.last_ticks == b.last_ticks && a.phase == b.phase &&
               a.fresh == b.fresh;
    for (std::size_t c = 0; c < N; ++c)
        all = all && a.v[c] == b.v[c] && a.s[c] == b.s[c] && a.last_k[c] == b.last_k[c] &&
              a.sign[c] == b.sign[c];
    return all;
}

/// One piece: its code, its duration, and what it adds to the prediction.
template <std::size_t N>
struct Piece {
    std::uint8_t code{};
    std::uint16_t subs{};  // sub-ticks; 64 times the ticks of a piece that is no jump
    std::array<std::int32_t, N> k{};
};

namespace detail {
/// floor((n + d / 2) / d) for d > 0.
constexpr std::int32_t rounded_down(std::int32_t n, std::int32_t d) noexcept {
    const std::int32_t shifted = n + d / 2;
    const std::int32_t q = shifted / d;
    return shifted % d < 0 ? q - 1 : q;
}
/// n / d rounded to nearest, halves away from 0; d > 0.
constexpr std::int32_t rounded_even_handed(std::int32_t n, std::int32_t d) noexcept {
    return (n < 0 ? n - d / 2 : n + d / 2) / d;
}
}  // namespace detail

/// What a piece of h ticks adds to v where k = 0; 1 <= h <= piece_ticks_max.
constexpr std::int32_t predicted_rise(std::int32_t s, bool fresh, std::int32_t h) noexcept {
    return fresh ? 0 : detail::rounded_down(s * h, slope_unit);
}

/// Slope at the end of a piece of h ticks whose value rose by `rise`, |rise| <= rise_max. Exact for
/// the lengths of the list.
constexpr std::int32_t slope_after(std::int32_t s, bool chord, std::int32_t rise,
                                   std::int32_t h) noexcept {
    return chord ? detail::rounded_even_handed(slope_unit * rise, h)
                 : detail::rounded_even_handed(2 * slope_unit * rise, h) - s;
}

/// Is the slope at the end that of the chord? True for lines and for fresh pieces.
constexpr bool ends_on_chord(std::uint8_t c, bool fresh) noexcept { return fresh || is_line(c); }

/// What the piece leaves for the prediction of the next one.
constexpr void remember(const StateView& state, std::uint8_t c, std::int32_t subs,
                        const std::int32_t* k) noexcept {
    const bool jumped = c == code::jump;
    for (std::size_t i = 0; i < state.n; ++i) {
        const std::int32_t last = jumped || state.history.fresh ? 0 : k[i];
        state.last_k[i] = static_cast<std::int8_t>(last > 100 ? 100 : last < -100 ? -100 : last);
        if (!jumped && k[i] != 0) state.sign[i] = static_cast<std::int8_t>(k[i] > 0 ? 1 : -1);
    }
    History& history = state.history;
    history.last_code = static_cast<std::uint8_t>(is_line(c) ? c - code::line : c);
    history.last_ticks = static_cast<std::uint8_t>(jumped ? 1 : subs / subs_per_tick);
    history.fresh = false;
    history.phase = static_cast<std::uint8_t>((history.phase + subs) % subs_per_tick);
}

/// Goes on to the end of the piece. @return false, with the state unchanged, where the piece leaves
/// the bounds above; true otherwise. Any values are allowed in k; code and duration must belong
/// together.
constexpr bool step(const StateView& state, std::uint8_t c, std::int32_t subs,
                    const std::int32_t* k) noexcept {
    const bool jumped = c == code::jump, fresh = state.history.fresh;
    const bool chord = ends_on_chord(c, fresh);
    const std::int32_t h = subs / subs_per_tick, most = jumped ? jump_max : rise_max;
    std::int32_t v[3]{}, s[3]{};
    for (std::size_t i = 0; i < state.n; ++i) {
        if (k[i] > jump_max || k[i] < -jump_max) return false;
        const std::int32_t rise = k[i] + (jumped ? 0 : predicted_rise(state.s[i], fresh, h));
        if (rise > most || rise < -most) return false;
        v[i] = state.v[i] + rise;
        if (v[i] > vertex_max || v[i] < -vertex_max) return false;
        if (!jumped) s[i] = slope_after(state.s[i], chord, rise, h);
        if (s[i] > slope_max || s[i] < -slope_max) return false;
    }
    for (std::size_t i = 0; i < state.n; ++i) {
        state.v[i] = v[i];
        state.s[i] = s[i];
    }
    remember(state, c, subs, k);
    return true;
}
template <std::size_t N>
constexpr bool step(State<N>& state, const Piece<N>& piece) noexcept {
    return step(state.view(), piece.code, piece.subs, piece.k.data());
}

/// The curve within one piece, of one component: v + c1 t + c2 t^2 + c3 t^3 lattice steps, t in
/// ticks from the start of the piece. Real: double on a host (the guarantee holds for it), float on
/// a board.
template <class Real>
struct Polynomial {
    Real c1{}, c2{}, c3{};

    constexpr Real rise(Real t) const noexcept { return t * (c1 + t * (c2 + t * c3)); }
    constexpr Real rate(Real t) const noexcept { return c1 + t * (2 * c2 + t * (3 * c3)); }
    constexpr Real bend(Real t) const noexcept { return 2 * c2 + 6 * c3 * t; }
};

/// The polynomial of a piece that starts with slope s and rises by `rise` in h ticks. Jumps are
/// constant: {}.
template <class Real>
constexpr Polynomial<Real> polynomial(std::uint8_t c, bool fresh, std::int32_t s, Real rise,
                                      std::int32_t h_ticks) noexcept {
    if (c == code::jump) return {};
    const Real h = static_cast<Real>(h_ticks);
    if (is_line(c)) return {rise / h, 0, 0};
    const Real slope = static_cast<Real>(s) / static_cast<Real>(slope_unit), ahead = slope * h;
    if (!fresh) return {slope, (rise - ahead) / (h * h), 0};
    return {slope, 2 * (rise - ahead) / (h * h), (ahead - rise) / (h * h * h)};
}

}  // namespace fairlead::curve
