#pragma once
// B-spline curves of orientations with local control, by the cumulative basis [Kim, Kim & Shin,
// SIGGRAPH 95]:
//   q(t) = q_0 prod_{j>0} exp( b_j(t) log(q_{j-1}^-1 q_j) ),   b_j = sum of the basis from j on.
// Order 4 (cubic) is C2 at simple knots; in general order k with simple knots is C(k-2). Turning
// all control orientations, from the left or the right, turns the curve. Control orientations on
// one turn at the knots' Greville abscissae give that turn at constant rate. Control orientation i
// moves the curve on [knot i, knot i + Order] only.
// Neighbouring control orientations are joined the short way round, so they lie closer than pi.
// Cost: Order - 1 logs and exps, besides the basis.
#include <array>
#include <cstddef>

#include "fairlead/base/status.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/math/bspline.hpp"
#include "fairlead/math/quat.hpp"

namespace fairlead {

/// An orientation with its angular rate and acceleration, both in the body frame.
template <class Real>
struct Turning {
    BasicQuat<Real> q{};
    BasicVec3<Real> rate{};          // rad/s, for knots in s
    BasicVec3<Real> acceleration{};  // rad/s^2
};

template <class Real, std::size_t Order, std::size_t Capacity>
class OrientationSpline {
    static_assert(Order >= 2 && Order <= 6 && Capacity >= Order);

  public:
    static constexpr std::size_t order = Order;

    /// Takes n control orientations (unit) and n + Order knots; bad_argument: no curve.
    constexpr Status set(const Real* knots, const BasicQuat<Real>* controls,
                         std::size_t n) noexcept {
        if (n > Capacity || detail::check_knots(knots, n, Order) != Status::ok)
            return Status::bad_argument;
        for (std::size_t i = 0; i < n + Order; ++i) knots_[i] = knots[i];
        for (std::size_t i = 0; i < n; ++i) controls_[i] = controls[i];
        size_ = n;
        return Status::ok;
    }

    constexpr std::size_t size() const noexcept { return size_; }
    constexpr Real begin() const noexcept { return knots_[Order - 1]; }
    constexpr Real end() const noexcept { return knots_[size_]; }

    Turning<Real> at(Real t) const noexcept {
        FAIRLEAD_ASSERT(size_ >= Order);
        const std::size_t i = detail::knot_interval(knots_.data(), size_, Order, t);
        // on this interval b_j is the spline of coefficients 0 ... 0 1 ... 1, the first 1 at j
        std::array<std::array<Real, Order - 1>, Order> unit{};
        for (std::size_t j = 1; j < Order; ++j)
            for (std::size_t d = 0; d < j; ++d) unit[j][d] = 1;
        const auto b = detail::de_boor(knots_.data(), i, unit, t, 0);
        const auto b1 = detail::de_boor(knots_.data(), i, unit, t, 1);
        const auto b2 = detail::de_boor(knots_.data(), i, unit, t, 2);

        const std::size_t first = i + 1 - Order;
        Turning<Real> out{controls_[first], {}, {}};
        for (std::size_t j = 0; j + 1 < Order; ++j) {
            const BasicVec3<Real> half = log(conj(controls_[first + j]) * controls_[first + j + 1]);
            const BasicQuat<Real> turn = exp(b[j] * half), back = conj(turn);
            const BasicVec3<Real> full = Real{2} * half;
            out.q = out.q * turn;
            out.rate = rotate(back, out.rate) + b1[j] * full;
            out.acceleration =
                rotate(back, out.acceleration) + (b1[j] * cross(out.rate, full) + b2[j] * full);
        }
        return out;
    }

  private:
    std::array<Real, Capacity + Order> knots_{};
    std::array<BasicQuat<Real>, Capacity> controls_{};
    std::size_t size_{0};
};

}  // namespace fairlead
