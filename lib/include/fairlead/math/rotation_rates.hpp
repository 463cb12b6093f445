#pragma once
// How fast a rotation turns that is told by its rotation vector: the right Jacobian of the
// exponential map [Chirikjian 2012, section 10.8.6] and its derivative.
#include "fairlead/base/types.hpp"
#include "fairlead/math/vec.hpp"

namespace fairlead {

/// Angular velocity and acceleration in the body frame, per unit of time and its square.
template <class Real>
struct RotationMotion {
    BasicVec3<Real> velocity{}, acceleration{};
};

namespace detail {

/// f(a) = sum of (-a)^k / (2 k + first)! and its derivative; full precision for 0 <= a <= 16.
template <class Real>
struct RotationSeries {
    Real value{0}, slope{0};

    constexpr RotationSeries(Real a, int first) noexcept {
        constexpr int terms = 12;
        for (int k = terms; k-- > 0;) {  // by Horner's rule, from the last term to the first
            const Real ratio = -1 / static_cast<Real>((2 * k + 1 + first) * (2 * k + 2 + first));
            slope = ratio * (value + a * slope);
            value = 1 + a * ratio * value;
        }
        for (int n = 2; n <= first; ++n) {
            value /= static_cast<Real>(n);
            slope /= static_cast<Real>(n);
        }
    }
};

}  // namespace detail

/// Of q(t) = A exp(theta(t)) with any constant A, from theta in rad and its two derivatives. Exact
/// to rounding for |theta| <= 4 rad. Beyond it: `rate` and `bend` as they are, so that nonsense
/// gives no infinities. Cost: about 150 operations.
template <class Real>
constexpr RotationMotion<Real> rotation_motion(const BasicVec3<Real>& theta,
                                               const BasicVec3<Real>& rate,
                                               const BasicVec3<Real>& bend) noexcept {
    const Real a = dot(theta, theta), a_rate = 2 * dot(theta, rate);
    if (!(a <= 16)) return {rate, bend};
    // (1 - cos |theta|) / |theta|^2 and (|theta| - sin |theta|) / |theta|^3
    const detail::RotationSeries<Real> one{a, 2}, two{a, 3};
    const BasicVec3<Real> once = cross(theta, rate), twice = cross(theta, once);
    const BasicVec3<Real> once_rate = cross(theta, bend);
    const BasicVec3<Real> twice_rate = cross(rate, once) + cross(theta, once_rate);
    return {rate - one.value * once + two.value * twice,
            bend - (one.slope * a_rate) * once - one.value * once_rate +
                (two.slope * a_rate) * twice + two.value * twice_rate};
}

}  // namespace fairlead
