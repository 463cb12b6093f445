#pragma once
// How a curve whose second derivative is continuous goes on from vertex to vertex.
//
// One component. At a vertex the curve has a value p, a velocity v and an acceleration a; a piece
// of h ticks is a cubic with the third derivative j:
//     x(t) = p + v t + a t^2 / 2 + j t^3 / 6,  0 <= t <= h.
// A piece tells one lattice value c, its control point: the one that a uniform B-spline with knots
// h ticks apart has, whose last piece this is. Its blossom gives c = x(h, 2h, 3h) (Ramshaw 1989,
// Blossoms are polar forms, section 3), so that
//     c = p + 2 h v + 11/6 h^2 a + h^3 j.
// Where three pieces in a row have the same length, the state behind them is a function of their
// three control points alone:
//     p = (c1 + 4 c2 + c3) / 6,  v = (c3 - c1) / (2 h),  a = (c1 - 2 c2 + c3) / h^2.
// A restart uses this: it tells three control points, and a reader that knew nothing before knows
// the state then. So no error lives longer than a restart.
//
// All numbers are integers in units that make every step exact: p in 1/6, v in 1/2, a and j in
// 1/1 of 1/960^3 of a lattice step (and tick, tick^2, tick^3). The only rounding is that of j to
// its unit; the next vertex lies on the cubic with the rounded j, to the bit. The curve is C2
// without any rest, and its control points are off the lattice by h^3 / (2 * 960^3) steps at most
// (7e-5 at 48 ticks). At a restart the state behind its three pieces is set to the formula above.
// That moves it by four times this at most: 2.5e-4 steps in p at 48 ticks.
//
// Floats in a fixed order would serve as well, but then each vertex leaves a rest, and a reader
// must not fuse operations. On a Cortex-M4F the integers cost nothing that is felt: a vertex comes
// about ten times a second, and between vertices a search uses floats.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/curve/lengths.hpp"
#include "fairlead/curve/scale.hpp"
#include "fairlead/curve/state.hpp"

namespace fairlead::curve {

/// Steps of the third derivative in one lattice step a tick^3; 1/h^3 is whole for each listed h.
inline constexpr std::int64_t cubic_unit = std::int64_t{slope_unit} * slope_unit * slope_unit;

/// Bounds of a valid curve, so that no step can overflow.
inline constexpr std::int64_t cubic_velocity_max = 1 << 13;      // steps a tick
inline constexpr std::int64_t cubic_acceleration_max = 1 << 11;  // steps a tick^2
inline constexpr std::int32_t control_max = 1 << 17;             // |c - p|, steps

/// State of one component at a vertex.
struct CubicVertex {
    std::int64_t p{};  // value, 1/(6 cubic_unit) step
    std::int64_t v{};  // velocity, 1/(2 cubic_unit) step a tick
    std::int64_t a{};  // acceleration, 1/cubic_unit step a tick^2
};

constexpr bool operator==(const CubicVertex& x, const CubicVertex& y) noexcept {
    return x.p == y.p && x.v == y.v && x.a == y.a;
}
constexpr bool operator!=(const CubicVertex& x, const CubicVertex& y) noexcept { return !(x == y); }

namespace detail {
/// floor(n / d), d > 0.
constexpr std::int64_t floored(std::int64_t n, std::int64_t d) noexcept {
    const std::int64_t q = n / d;
    return n % d < 0 ? q - 1 : q;
}
/// The same for the units of this file, which are a power of 2 times a small number: by the 32-bit
/// divisions that a Cortex-M has. A division of 64 bits takes ten times as many instructions.
template <std::int64_t D>
constexpr std::int64_t floored_by(std::int64_t n) noexcept {
    constexpr int twos = [] {
        int k = 0;
        while ((D >> k) % 2 == 0) ++k;
        return k;
    }();
    static_assert(D > 0 && (D >> twos) < (1 << 16), "the odd part is a digit of 16 bits");
    constexpr auto odd = static_cast<std::uint32_t>(D >> twos);
    const std::int64_t m = n >> twos;
    const auto size = static_cast<std::uint64_t>(m < 0 ? ~m : m);
    const auto high = static_cast<std::uint32_t>(size >> 32);
    const auto low = static_cast<std::uint32_t>(size);
    const std::uint32_t middle = (high % odd) << 16 | low >> 16;
    const std::uint32_t last = (middle % odd) << 16 | (low & 0xffffu);
    const std::uint64_t q =
        (std::uint64_t{high / odd} << 32) + (std::uint64_t{middle / odd} << 16) + last / odd;
    return m < 0 ? ~static_cast<std::int64_t>(q) : static_cast<std::int64_t>(q);
}
/// n / d rounded to nearest, halves away from 0; d > 0, |n| <= 2^63 - 1 - d / 2.
constexpr std::int64_t nearest(std::int64_t n, std::int64_t d) noexcept {
    return (n < 0 ? n - d / 2 : n + d / 2) / d;
}
constexpr bool within(std::int64_t x, std::int64_t most) noexcept {
    return x <= most && x >= -most;
}
}  // namespace detail

/// The curve at rest on a lattice value, |value| <= vertex_max.
constexpr CubicVertex at_rest(std::int32_t value) noexcept {
    return {6 * cubic_unit * value, 0, 0};
}

/// The lattice value nearest to p; halves go up.
constexpr std::int32_t lattice_near(const CubicVertex& at) noexcept {
    return static_cast<std::int32_t>(detail::floored_by<6 * cubic_unit>(at.p + 3 * cubic_unit));
}

/// Is the state within the bounds of a valid curve?
constexpr bool inside(const CubicVertex& at) noexcept {
    return detail::within(at.p, 6 * cubic_unit * vertex_max) &&
           detail::within(at.v, 2 * cubic_unit * cubic_velocity_max) &&
           detail::within(at.a, cubic_unit * cubic_acceleration_max);
}

/// The state behind three pieces of h ticks whose control points are c1, c2, c3. h is a length of
/// the list, |c| <= vertex_max. Exact; may lie outside the bounds.
constexpr CubicVertex behind_run(std::int32_t c1, std::int32_t c2, std::int32_t c3,
                                 std::int32_t h) noexcept {
    const std::int64_t a = c1, b = c2, c = c3, unit = cubic_unit / h;
    return {cubic_unit * (a + 4 * b + c), unit * (c - a), unit / h * (a - 2 * b + c)};
}

/// Third derivative of the piece of h ticks, 1 <= h <= piece_ticks_max, from a state inside() its
/// bounds to the control point c. |c - p| <= control_max + 1. Unit 1/cubic_unit.
constexpr std::int64_t third_derivative(const CubicVertex& at, std::int32_t h,
                                        std::int32_t c) noexcept {
    const std::int64_t h1 = h, h2 = h1 * h1;
    const std::int64_t rest = 6 * cubic_unit * c - at.p - 6 * h1 * at.v - 11 * h2 * at.a;
    return detail::nearest(rest, 6 * h2 * h1);
}

/// The end of a piece of h ticks with the third derivative j. Exact.
constexpr CubicVertex piece_end(const CubicVertex& at, std::int32_t h, std::int64_t j) noexcept {
    const std::int64_t h1 = h, h2 = h1 * h1;
    return {at.p + 3 * h1 * at.v + 3 * h2 * at.a + h2 * h1 * j, at.v + 2 * h1 * at.a + h2 * j,
            at.a + h1 * j};
}

/// The state at the start of a straight line of h ticks to a lattice value: where the curve
/// breaks. p stays, a is 0. |value - p| <= control_max + 1.
constexpr CubicVertex line_start(const CubicVertex& at, std::int32_t h,
                                 std::int32_t value) noexcept {
    return {at.p, detail::nearest(6 * cubic_unit * value - at.p, std::int64_t{3} * h), 0};
}

/// The cubic of a piece in steps and ticks, against p. Real: double on a host, float on a board.
template <class Real>
constexpr Polynomial<Real> cubic(const CubicVertex& at, std::int64_t j) noexcept {
    constexpr Real unit = Real{1} / static_cast<Real>(cubic_unit);
    return {static_cast<Real>(at.v) * (unit / 2), static_cast<Real>(at.a) * (unit / 2),
            static_cast<Real>(j) * (unit / 6)};
}

/// p against a lattice value, in steps.
template <class Real>
constexpr Real part_of(const CubicVertex& at, std::int32_t value) noexcept {
    constexpr Real unit = Real{1} / static_cast<Real>(6 * cubic_unit);
    return static_cast<Real>(at.p - 6 * cubic_unit * value) * unit;
}

/// What a length and a state say of the next control point: in 1/1024 steps against the lattice
/// value nearest to p, rounded down.
struct Ahead {
    std::int32_t part;    // p
    std::int64_t travel;  // h v
    std::int64_t bend;    // h^2 a
};
constexpr Ahead ahead(const CubicVertex& at, std::int32_t h) noexcept {
    const std::int64_t h1 = h;
    return {static_cast<std::int32_t>(detail::floored_by<6 * cubic_unit / fine>(
                at.p - 6 * cubic_unit * lattice_near(at))),
            detail::floored_by<2 * cubic_unit / fine>(h1 * at.v),
            detail::floored_by<cubic_unit / fine>(h1 * h1 * at.a)};
}

}  // namespace fairlead::curve
