#pragma once
// B-splines of order 2 to 6 (degree 1 to 5) with any knots, in memory fixed at compile time:
// evaluation with derivatives, and knot insertion. [de Boor 1972; Boehm 1980]
//
// Curve: n coefficients, n + Order knots in rising order, none more than Order times; the domain is
// [knot Order - 1, knot n]. Outside it the end polynomials go on. At a knot of multiplicity Order
// the value is the one from the right, at the end of the domain the one from the left.
// Cost: a binary search in the knots and Order (Order - 1) / 2 steps on points.
#include <array>
#include <cstddef>

#include "fairlead/base/status.hpp"
#include "fairlead/math/approx.hpp"

namespace fairlead {

namespace detail {

/// The i in [order - 1, n - 1] with knots[i] <= t < knots[i + 1], as far as there is one: the
/// interval whose polynomial is valid at t. Intervals of no length are never chosen.
template <class Real>
constexpr std::size_t knot_interval(const Real* knots, std::size_t n, std::size_t order,
                                    Real t) noexcept {
    std::size_t low = order - 1, high = n;  // knots[low] <= t < knots[high], where t is inside
    while (high - low > 1) {
        const std::size_t middle = low + (high - low) / 2;
        if (knots[middle] <= t && knots[middle] < knots[n])
            low = middle;
        else
            high = middle;
    }
    while (low + 1 < n && !(knots[low] < knots[low + 1])) ++low;
    return low;
}

/// (1 - s) a + s b: hits both ends.
template <class Real, std::size_t D>
constexpr std::array<Real, D> between(const std::array<Real, D>& a, const std::array<Real, D>& b,
                                      Real s) noexcept {
    std::array<Real, D> out{};
    for (std::size_t d = 0; d < D; ++d) out[d] = (1 - s) * a[d] + s * b[d];
    return out;
}

/// de Boor's triangle on interval i: c[j] is the coefficient i - (Order - 1) + j.
template <class Real, std::size_t Order, std::size_t D>
constexpr std::array<Real, D> de_boor(const Real* knots, std::size_t i,
                                      std::array<std::array<Real, D>, Order> c, Real t,
                                      std::size_t derivative) noexcept {
    if (derivative >= Order) return {};
    for (std::size_t r = 1; r < Order; ++r)
        for (std::size_t j = Order - 1; j >= r; --j) {
            const std::size_t left = i + 1 + j - Order;
            const Real from = knots[left], width = knots[left + Order - r] - from;
            if (r > derivative) {
                c[j] = between(c[j - 1], c[j], (t - from) / width);
                continue;
            }
            const Real s = static_cast<Real>(Order - r) / width;
            for (std::size_t d = 0; d < D; ++d) c[j][d] = s * (c[j][d] - c[j - 1][d]);
        }
    return c[Order - 1];
}

/// n coefficients: a domain of positive length, every knot finite and at most order times.
template <class Real>
constexpr Status check_knots(const Real* knots, std::size_t n, std::size_t order) noexcept {
    if (n < order) return Status::bad_argument;
    for (std::size_t i = 0; i < n + order; ++i) {
        if (!approx::is_finite(knots[i])) return Status::bad_argument;
        if (i > 0 && knots[i] < knots[i - 1]) return Status::bad_argument;
        if (i >= order && !(knots[i] > knots[i - order])) return Status::bad_argument;
    }
    return knots[order - 1] < knots[n] ? Status::ok : Status::bad_argument;
}

}  // namespace detail

template <class Real, std::size_t Order, std::size_t D, std::size_t Capacity>
class BSpline {
    static_assert(Order >= 2 && Order <= 6 && D >= 1 && Capacity >= Order);

  public:
    using Point = std::array<Real, D>;
    static constexpr std::size_t order = Order;
    static constexpr std::size_t capacity = Capacity;

    /// Takes n coefficients and n + Order knots. bad_argument: no curve, nothing is taken.
    constexpr Status set(const Real* knots, const Point* points, std::size_t n) noexcept {
        if (n > Capacity || detail::check_knots(knots, n, Order) != Status::ok)
            return Status::bad_argument;
        for (std::size_t i = 0; i < n + Order; ++i) knots_[i] = knots[i];
        for (std::size_t i = 0; i < n; ++i) points_[i] = points[i];
        size_ = n;
        return Status::ok;
    }

    constexpr std::size_t size() const noexcept { return size_; }
    constexpr Real knot(std::size_t i) const noexcept { return knots_[i]; }
    constexpr const Point& point(std::size_t i) const noexcept { return points_[i]; }
    constexpr Real begin() const noexcept { return knots_[Order - 1]; }
    constexpr Real end() const noexcept { return knots_[size_]; }

    /// The curve, or its derivative, at t.
    constexpr Point at(Real t, std::size_t derivative = 0) const noexcept {
        FAIRLEAD_ASSERT(size_ >= Order);
        const std::size_t i = detail::knot_interval(knots_.data(), size_, Order, t);
        std::array<Point, Order> c{};
        for (std::size_t j = 0; j < Order; ++j) c[j] = points_[i + 1 + j - Order];
        return detail::de_boor(knots_.data(), i, c, t, derivative);
    }

    /// One more knot at t inside the domain; the curve stays as it is. bad_argument: outside, no
    /// room, or t is a knot Order times already.
    constexpr Status insert(Real t) noexcept {
        if (size_ < Order || size_ == Capacity || !(t >= begin() && t <= end()))
            return Status::bad_argument;
        std::size_t i = detail::knot_interval(knots_.data(), size_, Order, t);
        std::size_t times = 0;
        for (std::size_t k = 0; k < size_ + Order; ++k)
            if (knots_[k] == t) ++times;
        if (times >= Order) return Status::bad_argument;
        // at the end of the domain the new knot goes behind its equals, as it does elsewhere
        while (i + 1 < size_ + Order && knots_[i + 1] <= t) ++i;
        for (std::size_t j = size_; j > i - times; --j) points_[j] = points_[j - 1];
        // from the right, so that every point is read before it is written
        for (std::size_t j = i - times; j + Order > i + 1; --j) {
            const Real from = knots_[j], to = knots_[j + Order - 1];
            points_[j] = detail::between(points_[j - 1], points_[j], (t - from) / (to - from));
        }
        for (std::size_t k = size_ + Order; k > i + 1; --k) knots_[k] = knots_[k - 1];
        knots_[i + 1] = t;
        ++size_;
        return Status::ok;
    }

  private:
    std::array<Real, Capacity + Order> knots_{};
    std::array<Point, Capacity> points_{};
    std::size_t size_{0};
};

}  // namespace fairlead
