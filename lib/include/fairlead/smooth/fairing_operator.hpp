#pragma once
// The fairing operators rho_2 and rho_3 of [Lee & Shin 1996, eq. (16), (18)], for one sample.
//
// Each replaces a sample by the value at which the second or third difference of a stencil around
// it vanishes. Orientations use the half-angle steps w_i = log(q_i^-1 q_{i+1}) in place of
// p_{i+1} - p_i. Deviations from the print, all derived anew:
//   - the middle sample of rho_2 is the geodesic midpoint (the printed product is not one);
//   - steps are written forwards, which is the print's log(q_{i+1}^-1 q_i) with the sign turned;
//   - rho_3 also exists mirrored in time: its stencil leans to one side, and rounds that alternate
//     do not shift the motion.
// Stable damping: below 3/4 for positions, below 1/2 for orientations (there rho_3 moves 1.5 times
// as far, because the step behind the sample contains the sample itself).
//
// Cost of one orientation sample, damped: rho_2 two logs and two exps, rho_3 three and two.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/types.hpp"
#include "fairlead/math/quat.hpp"

namespace fairlead {

/// Where a sample stands in its segment and how its stencil leans.
struct FairingPlace {
    std::size_t before{};  // samples before it in its segment; more than 3 count as 3
    std::size_t after{};   // samples after it
    bool mirrored{};       // rho_3 leans backwards
};

namespace detail {

template <class Real>
struct FairPosition {
    using Value = BasicVec3<Real>;
    using Scalar = Real;
    static constexpr std::uint32_t valid = flag::position_valid;
    static constexpr std::uint32_t gap = flag::gap_before | flag::position_gap;
    template <class P>
    static constexpr auto& of(P& pose) noexcept {
        return pose.p_w_m;
    }
    static constexpr Value step(const Value& from, const Value& to) noexcept { return to - from; }
    static constexpr Value moved(const Value& from, const Value& by) noexcept { return from + by; }
    static Real distance(const Value& a, const Value& b) noexcept { return norm(b - a); }

    /// Third difference zero, solved for the middle sample; `lean` is the side with two neighbours.
    template <class At>
    static constexpr Value third(const At& at, int lean) noexcept {
        return at(lean) + Real{1} / Real{3} * (at(-lean) - at(2 * lean));
    }
};

template <class Real>
struct FairOrientation {
    using Value = BasicQuat<Real>;
    using Scalar = Real;
    static constexpr std::uint32_t valid = flag::orientation_valid;
    static constexpr std::uint32_t gap = flag::gap_before | flag::orientation_gap;
    template <class P>
    static constexpr auto& of(P& pose) noexcept {
        return pose.q_wb;
    }
    static BasicVec3<Real> step(const Value& from, const Value& to) noexcept {
        return log(conj(from) * to);
    }
    static Value moved(const Value& from, const BasicVec3<Real>& by) noexcept {
        return normalised(from * exp(by));
    }
    static Real distance(const Value& a, const Value& b) noexcept { return rotation_angle(a, b); }

    template <class At>
    static Value third(const At& at, int lean) noexcept {
        return moved(at(lean),
                     Real{1} / Real{2} * (step(at(0), at(-lean)) - step(at(lean), at(2 * lean))));
    }
};

/// rho_m of one sample. at(j) is the j-th neighbour, j in -3 ... 3, inside the segment.
/// Segments shorter than m + 1 samples have no m-th difference and stay as they are.
template <class Channel, int Order, class At>
inline typename Channel::Value fairing_target(const At& at, const FairingPlace& place) noexcept {
    static_assert(Order == 2 || Order == 3);
    using Real = typename Channel::Scalar;
    if (place.before + place.after < Order) return at(0);
    if (place.before == 0 || place.after == 0) {
        const int in = place.before == 0 ? 1 : -1;  // towards the inside of the segment
        const auto first = Channel::step(at(in), at(2 * in));
        if constexpr (Order == 2) return Channel::moved(at(in), -first);
        return Channel::moved(at(in), Channel::step(at(2 * in), at(3 * in)) - Real{2} * first);
    }
    if constexpr (Order == 2) {
        return Channel::moved(at(-1), Real{1} / Real{2} * Channel::step(at(-1), at(1)));
    } else if (place.mirrored) {
        return Channel::third(at, place.before == 1 ? 1 : -1);
    } else {
        return Channel::third(at, place.after == 1 ? -1 : 1);
    }
}

/// One damped round for one sample [eq. (17)]: the way from at(0) to its target, by `damping`.
template <class Channel, int Order, class At>
inline typename Channel::Value faired(const At& at, const FairingPlace& place,
                                      typename Channel::Scalar damping) noexcept {
    const auto target = fairing_target<Channel, Order>(at, place);
    return Channel::moved(at(0), damping * Channel::step(at(0), target));
}

/// A bound on distances, as compared in floating point: what passes keeps the bound when measured
/// exactly, too. Infinity: no bound, and nothing is measured.
template <class Channel>
class FairingBound {
    using Real = typename Channel::Scalar;
    using Value = typename Channel::Value;

  public:
    constexpr explicit FairingBound(Real bound) noexcept
        : limit_{bound - bound * relative_margin - absolute_margin},
          active_{approx::is_finite(bound)} {}
    bool kept(const Value& raw, const Value& value) const noexcept {
        return !active_ || Channel::distance(raw, value) <= limit_;
    }

  private:
    // rounding of a distance near 1 m and of an angle, held by tests/unit/test_fairing.cpp
    static constexpr Real relative_margin = static_cast<Real>(1e-6);
    static constexpr Real absolute_margin = static_cast<Real>(5e-7);
    Real limit_;
    bool active_;
};

}  // namespace detail

/// E_2 or E_3 of n values [eq. (12)]: the sum of squared differences of that order; orientations
/// count in rotation vectors (full angles).
template <class Channel, int Order, class At>
inline typename Channel::Scalar fairing_energy(const At& at, std::size_t n) noexcept {
    using Real = typename Channel::Scalar;
    const auto step = [&](std::size_t i) { return Channel::step(at(i), at(i + 1)); };
    Real sum = 0;
    for (std::size_t i = 0; i + Order < n; ++i) {
        auto d = step(i + 1) - step(i);
        if constexpr (Order == 3) d = (step(i + 2) - step(i + 1)) - d;
        sum += dot(d, d);
    }
    return Channel::valid == flag::orientation_valid ? 4 * sum : sum;
}

}  // namespace fairlead
