#pragma once
// A plan: the knots that are wanted beyond the frozen polynomial, and the polynomials between them.
#include <array>
#include <cstddef>
#include <cstdint>

#include "host_sim/study/baselines/earlier/reduce/span.hpp"

namespace fairlead::earlier {

/// Planned knots beyond the frozen polynomial, in ticks after its knot.
template <class Channel, std::size_t MaxKnots>
struct Plan {
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;

    std::size_t size{0};
    std::array<std::int32_t, MaxKnots> knot{};
    std::array<std::array<float, D>, MaxKnots> jump{};  // of the coefficient of u^(Order - 1)
    std::array<std::array<float, D>, Order> start{};    // free start: coefficients at the start
    float worst{0};           // largest error beyond the head, 1 = tolerance
    std::size_t worst_at{0};  // and the sample where it stands
    float objective{0};       // sum of squared errors of the plain fit beyond the head
    std::size_t landing{0};   // this many of the last knots bring the curve to rest
    std::size_t covers{0};    // leading samples of the window within tolerance
    std::int8_t settled{-1};  // the first jump is rounded to multiples of 2^settled last places

    void insert(std::int32_t at) noexcept {
        std::size_t i = size;
        for (; i > 0 && knot[i - 1] > at; --i) {
            knot[i] = knot[i - 1];
            jump[i] = jump[i - 1];
        }
        knot[i] = at;
        jump[i] = {};
        ++size;
    }
    void erase(std::size_t i) noexcept {
        for (; i + 1 < size; ++i) {
            knot[i] = knot[i + 1];
            jump[i] = jump[i + 1];
        }
        --size;
    }
    /// Changes of the jumps after the first that take up a change of the first: together they are a
    /// multiple of a B-spline, so that nothing changes beyond knot Order. Needs Order + 1 knots.
    using Absorption = std::array<std::array<float, D>, Order>;
    Absorption absorption(const std::array<float, D>& change) const noexcept {
        const auto weight = [this](std::size_t k) {
            float product = 1;
            for (std::size_t j = 0; j <= Order; ++j)
                if (j != k) product *= static_cast<float>(knot[k] - knot[j]);
            return product;
        };
        const float first = weight(0);
        Absorption out;
        for (std::size_t k = 1; k <= Order; ++k) {
            const float share = first / weight(k);
            for (std::size_t d = 0; d < D; ++d) out[k - 1][d] = share * change[d];
        }
        return out;
    }
    void absorb(const Absorption& changes) noexcept {
        for (std::size_t k = 1; k <= Order; ++k)
            for (std::size_t d = 0; d < D; ++d) jump[k][d] += changes[k - 1][d];
    }
    /// The first n samples left the window.
    void drop(std::size_t n) noexcept {
        covers -= n < covers ? n : covers;
        worst_at -= n < worst_at ? n : worst_at;
    }
    std::size_t knots_before(float u) const noexcept {
        std::size_t n = 0;
        while (n < size && static_cast<float>(knot[n]) < u) ++n;
        return n;
    }
};

/// Values that the signal may take after the window: weak pseudo-samples that keep a plan from
/// running away beyond its data.
template <class Channel, std::size_t Count>
struct Future {
    std::size_t size{0};
    std::array<float, Count> u{};
    std::array<std::array<float, Channel::dimension>, Count> x{};
    std::array<float, Count> weight{};
};

/// A walk along the polynomials of a plan.
template <class Channel, std::size_t MaxKnots>
struct PlanWalk {
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;

    Polynomial<D, Order> p{};
    float origin{0};      // tick that p is about
    std::size_t next{0};  // the next knot

    PlanWalk() = default;
    PlanWalk(const Polynomial<D, Order>& frozen, bool free,
             const Plan<Channel, MaxKnots>& plan) noexcept
        : p{frozen} {
        if (free) p.c = plan.start;
    }
    void pass_knot(const Plan<Channel, MaxKnots>& plan) noexcept {
        const auto knot = static_cast<float>(plan.knot[next]);
        p = p.shifted(knot - origin);
        origin = knot;
        for (std::size_t d = 0; d < D; ++d) p.c[Order - 1][d] += plan.jump[next][d];
        ++next;
        if (plan.landing == 0 || next < plan.size) return;
        for (std::size_t m = 1; m < Order; ++m) p.c[m] = {};  // it will be a stop
    }
    /// On to the polynomial at u, which must not fall: at most MaxKnots knots in all are passed.
    void to(float u, const Plan<Channel, MaxKnots>& plan) noexcept {
        while (next < plan.size && static_cast<float>(plan.knot[next]) < u) pass_knot(plan);
    }
    /// Where the present polynomial ends.
    float end(const Plan<Channel, MaxKnots>& plan) const noexcept {
        return next < plan.size ? static_cast<float>(plan.knot[next]) : 1e30f;
    }
    std::array<float, D> at(float u, const Plan<Channel, MaxKnots>& plan) noexcept {
        to(u, plan);
        return p(u - origin);
    }
};

}  // namespace fairlead::earlier
