#pragma once
// Coming to rest: three or four knots whose jumps cancel every derivative of the curve.
//
// A cubic with a little noise in its derivatives leaves the tolerance after about one window; an
// exactly constant polynomial holds for as long as the rest lasts and costs nothing more. The jumps
// are the exact solution of a small Vandermonde system: Order - 1 knots bring the derivatives to
// zero, one more chooses the value, too.
#include <array>
#include <cstddef>
#include <cstdint>

#include "host_sim/study/baselines/earlier/reduce/plan.hpp"

namespace fairlead::earlier {

template <class Channel, std::size_t MaxKnots>
struct Landing {
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    static constexpr std::size_t candidates = 20;  // places of the knots, per prefix and count
    using KnotPlan = Plan<Channel, MaxKnots>;
    using Vector = std::array<float, D>;

    /// Are the newest `n` samples of `count` at rest? Then `mid` is the middle of their range.
    template <class Samples>
    static bool at_rest(const Samples& s, std::size_t count, std::size_t n,
                        const typename Channel::Judge& judge, Vector& mid) noexcept {
        if (count < n) return false;
        Vector low = judge.coordinates(s[count - 1].value), high = low;
        for (std::size_t i = count - n; i < count; ++i) {
            const Vector x = judge.coordinates(s[i].value);
            for (std::size_t d = 0; d < D; ++d) {
                low[d] = x[d] < low[d] ? x[d] : low[d];
                high[d] = x[d] > high[d] ? x[d] : high[d];
            }
        }
        for (std::size_t d = 0; d < D; ++d) {
            if ((high[d] - low[d]) * judge.per_limit[d] > 1.2f) return false;
            mid[d] = (high[d] + low[d]) / 2;
        }
        return true;
    }

    /// Keeps the first `prefix` knots of the plan and lands with `count` more between `from` and
    /// `until` ticks, at the places that `candidate` names. @return whether the knots fit in.
    static bool plan(const KnotPlan& old, const Polynomial<D, Order>& frozen, bool free,
                     std::size_t prefix, std::size_t count, std::size_t candidate,
                     std::int32_t first, float until, const Vector& mid, KnotPlan& out) noexcept {
        static constexpr float offset[] = {0, 0.2f, 0.4f, 0.6f};
        static constexpr float spread[] = {0.95f, 0.7f, 0.5f, 0.3f, 0.15f};
        const float off = offset[candidate / 5], wide = spread[candidate % 5];
        const std::int32_t after = prefix ? old.knot[prefix - 1] : first;
        const float room = until - static_cast<float>(after);
        if (off + wide > 1 || prefix + count > MaxKnots) return false;
        out = old;
        out.size = prefix + count;
        for (std::size_t k = 0; k < count; ++k) {
            const float share = off + wide * static_cast<float>(k) / static_cast<float>(count - 1);
            out.knot[prefix + k] = after + 1 + static_cast<std::int32_t>(room * share * 0.98f);
            const std::size_t at = prefix + k;
            if (at > 0 && out.knot[at] <= out.knot[at - 1]) return false;
        }
        if (static_cast<float>(out.knot[out.size - 1]) >= until) return false;
        cancel(old, frozen, free, prefix, count, mid, out);
        return true;
    }

  private:
    static void cancel(const KnotPlan& old, const Polynomial<D, Order>& frozen, bool free,
                       std::size_t prefix, std::size_t count, const Vector& mid,
                       KnotPlan& out) noexcept {
        Polynomial<D, Order> p = frozen;
        if (free) p.c = old.start;
        float origin = 0;
        const auto walk = [&](std::int32_t to) {
            p = p.shifted(static_cast<float>(to) - origin);
            origin = static_cast<float>(to);
        };
        for (std::size_t q = 0; q < prefix; ++q) {
            walk(old.knot[q]);
            for (std::size_t d = 0; d < D; ++d) p.c[Order - 1][d] += old.jump[q][d];
        }
        walk(out.knot[prefix]);
        // in s = (u - first) / length: sum J_k (s - s_k)^(Order-1) + p(s) = constant, power by
        // power
        const float length = static_cast<float>(out.knot[out.size - 1] - out.knot[prefix]);
        std::array<float, Order> place{};
        for (std::size_t k = 0; k < count; ++k)
            place[k] = static_cast<float>(out.knot[prefix + k] - out.knot[prefix]) / length;
        for (std::size_t d = 0; d < D; ++d) {
            std::array<std::array<float, Order + 1>, Order> m{};
            float binomial = 1, power = 1;  // C(Order-1, r)
            std::array<float, Order> scaled{};
            for (std::size_t j = 0; j < Order; ++j, power *= length) scaled[j] = p.c[j][d] * power;
            for (std::size_t r = 0; r < count; ++r) {  // coefficient of s^(Order-1-r)
                for (std::size_t k = 0; k < count; ++k) {
                    float z = binomial;
                    for (std::size_t j = 0; j < r; ++j) z *= -place[k];
                    m[r][k] = z;
                }
                const std::size_t j = Order - 1 - r;
                m[r][count] = -(scaled[j] - (j == 0 ? mid[d] : 0));
                binomial = binomial * static_cast<float>(Order - 1 - r) / static_cast<float>(r + 1);
            }
            eliminate(m, count);
            float cube = 1;
            for (std::size_t j = 1; j < Order; ++j) cube *= length;
            for (std::size_t k = 0; k < count; ++k)
                out.jump[prefix + k][d] = m[k][count] / m[k][k] / cube;
        }
    }

    static void eliminate(std::array<std::array<float, Order + 1>, Order>& m,
                          std::size_t n) noexcept {
        for (std::size_t a = 0; a < n; ++a) {
            std::size_t pivot = a;
            for (std::size_t b = a + 1; b < n; ++b)
                if (approx::absolute(m[b][a]) > approx::absolute(m[pivot][a])) pivot = b;
            const auto row = m[a];
            m[a] = m[pivot];
            m[pivot] = row;
            for (std::size_t b = 0; b < n; ++b) {
                if (b == a) continue;
                const float f = m[b][a] / m[a][a];
                for (std::size_t k = a; k <= n; ++k) m[b][k] -= f * m[a][k];
            }
        }
    }
};

}  // namespace fairlead::earlier
