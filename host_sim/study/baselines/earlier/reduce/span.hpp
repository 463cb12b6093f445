#pragma once
// One knot interval's worth of a spline, and the arithmetic that both ends of the wire share.
//
// A curve is a chain of polynomials. At a simple knot value and all derivatives but the highest
// carry over, so that a new span needs one time and one vector: the jump of the highest derivative.
// Its coefficients are kept in fixed point (unit: a power of two near the tolerance, time in
// ticks), so that the state of a curve is a handful of exact integers that a restart point can
// carry and a late joiner continues bit for bit. Carrying the state over a knot rounds to half a
// last place: 2^-9 of a unit.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/convert.hpp"
#include "fairlead/base/each.hpp"
#include "fairlead/math/approx.hpp"

namespace fairlead::earlier {

/// Binary places of the Taylor coefficient of power m: each power of a tick gets six more.
constexpr int fraction_bits(std::size_t m) noexcept { return 8 + 6 * static_cast<int>(m); }

/// What a rounding may cost at the end of the interval that it is made for: 2^-3 of a unit.
inline constexpr int rounding_places = 3;
/// By how many places less is rounded away where that is too much.
inline constexpr std::array<std::uint8_t, 4> finer_places{0, 3, 6, 10};

/// 2^e as a float, |e| <= 126.
constexpr float power_of_two(int e) noexcept {
    int n = e < 0 ? -e : e;
    if (n > 126) n = 126;
    float p = 1;
    for (; n >= 30; n -= 30) p *= 1073741824.0f;
    p *= static_cast<float>(std::uint32_t{1} << n);
    return e < 0 ? 1 / p : p;
}

/// Nearest integer to y, halves away from zero, clamped to +-2^30. NaN gives 0.
constexpr std::int32_t to_integer(float y) noexcept {
    constexpr float limit = 1073741824.0f;
    if (approx::is_nan(y)) return 0;
    if (y > limit) return 1 << 30;
    if (y < -limit) return -(1 << 30);
    return static_cast<std::int32_t>(y < 0 ? y - 0.5f : y + 0.5f);
}

/// a + b, clamped to +-2^30 like every coefficient.
constexpr std::int32_t clamped_sum(std::int64_t a, std::int64_t b) noexcept {
    constexpr std::int64_t limit = 1 << 30;
    const std::int64_t sum = a + b;
    return static_cast<std::int32_t>(sum > limit ? limit : (sum < -limit ? -limit : sum));
}

/// The polynomial of one knot interval, D components, Order coefficients each.
/// value(t) = sum_m c[m] 2^-fraction_bits(m) u^m units, u = (t - t0_ns) / tick_ns.
template <std::size_t D, std::size_t Order>
struct Span {
    static constexpr std::size_t dimension = D;
    static constexpr std::size_t order = Order;

    std::int64_t t0_ns{};  // the knot at which it takes over
    std::array<std::array<std::int32_t, D>, Order> c{};
};

/// The same polynomial in float, for evaluation.
template <std::size_t D, std::size_t Order>
struct Polynomial {
    std::array<std::array<float, D>, Order> c{};

    Polynomial() = default;
    explicit Polynomial(const Span<D, Order>& span) noexcept {
        for (std::size_t m = 0; m < Order; ++m)
            for (std::size_t d = 0; d < D; ++d)
                c[m][d] = static_cast<float>(span.c[m][d]) * power_of_two(-fraction_bits(m));
    }

    /// Value at u ticks after the knot.
    FAIRLEAD_INLINE std::array<float, D> operator()(float u) const noexcept {
        std::array<float, D> y = c[Order - 1];
        each<Order - 1>([&](std::size_t m) FAIRLEAD_INLINE {
            each<D>([&](std::size_t d) FAIRLEAD_INLINE { y[d] = y[d] * u + c[Order - 2 - m][d]; });
        });
        return y;
    }

    /// A few of its components.
    template <std::size_t W>
    Polynomial<W, Order> components(std::size_t from) const noexcept {
        Polynomial<W, Order> out;
        each<Order>([&](std::size_t m) FAIRLEAD_INLINE {
            each<W>([&](std::size_t d) FAIRLEAD_INLINE { out.c[m][d] = c[m][from + d]; });
        });
        return out;
    }

    /// Would a span's integers hold it?
    bool representable() const noexcept {
        bool held = true;
        each<Order>([&](std::size_t m) FAIRLEAD_INLINE {
            const float most = power_of_two(30 - fraction_bits(m));
            each<D>([&](std::size_t d)
                        FAIRLEAD_INLINE { held = held && approx::absolute(c[m][d]) < most; });
        });
        return held;
    }

    /// k-th derivative at u, per tick^k.
    std::array<float, D> derivative(float u, std::size_t k) const noexcept {
        std::array<float, D> y{};
        for (std::size_t d = 0; d < D; ++d) {
            float sum = 0;
            for (std::size_t m = Order; m-- > k;) {
                float falling = 1;  // m! / (m - k)!
                for (std::size_t j = 0; j < k; ++j) falling *= static_cast<float>(m - j);
                sum = sum * u + falling * c[m][d];
            }
            y[d] = sum;
        }
        return y;
    }

    /// The Taylor coefficients about u: the same polynomial seen from a later knot.
    Polynomial shifted(float u) const noexcept {
        Polynomial out = *this;
        each<Order - 1>([&](std::size_t m) FAIRLEAD_INLINE {  // repeated synthetic division
            each<Order - 1>([&](std::size_t i) FAIRLEAD_INLINE {
                const std::size_t j = Order - 2 - i;
                if (j < m) return;
                each<D>([&](std::size_t d) FAIRLEAD_INLINE { out.c[j][d] += u * out.c[j + 1][d]; });
            });
        });
        return out;
    }
};

/// Ticks from the knot to t, as both ends of the wire compute them.
inline float ticks_between(std::int64_t t0_ns, std::int64_t t_ns, std::uint32_t tick_ns) noexcept {
    return to_float(t_ns - t0_ns) / static_cast<float>(tick_ns);
}

/// The state of the curve at a later knot, before its jump: C^(Order-2) to the last place.
template <std::size_t D, std::size_t Order>
inline Span<D, Order> carried(const Span<D, Order>& from, std::uint32_t ticks,
                              std::uint32_t tick_ns) noexcept {
    Span<D, Order> to;
    to.t0_ns = from.t0_ns + static_cast<std::int64_t>(ticks) * tick_ns;
    Polynomial<D, Order> p{from};
    for (auto& value : p.c[0]) value = 0;  // the step is added to the integer value
    p = p.shifted(static_cast<float>(ticks));
    for (std::size_t m = 0; m < Order; ++m)
        for (std::size_t d = 0; d < D; ++d) {
            const std::int32_t rounded = to_integer(p.c[m][d] * power_of_two(fraction_bits(m)));
            to.c[m][d] = clamped_sum(rounded, m == 0 ? from.c[0][d] : 0);
        }
    return to;
}

}  // namespace fairlead::earlier
