#pragma once
// The magnetic field as a heading: a slowly learned reference of its horizontal and vertical part,
// and a variance that grows with the distance from that reference. No gate: nothing can lock out.
//
// The heading's noise is that of the field over the measured horizontal part, so that a field that
// stands on end says nothing. While the reference is young, what contradicts it casts doubt on the
// heading that was taken with it. A field that is new, yet steady in motion, becomes the reference.
// Cost: two square roots, one arcus tangent a Kalman step.
#include <algorithm>

#include "fairlead/math/vec.hpp"
#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/attitude_state.hpp"

namespace fairlead {

template <class Real>
using MagField = FieldState<Real, AttitudeMode::imu_mag>;

template <class Real>
struct FieldLook {
    Real east{};      // angle of the measured field, east of north, rad
    Real variance{};  // of that angle, all but the tilt's part
    Real dip{};       // vertical over horizontal part: what a tilt error does to the heading
    Real doubt{};     // variance to add to the heading that was believed so far
};

template <class Real>
inline void close_field(MagField<Real>& f) noexcept {
    f.mean_count = f.count;
    if (f.count > 0) f.mean = (1 / static_cast<Real>(f.count)) * f.sum;
    f.sum = {};
    f.count = 0;
}

/// The first look: whatever the field is, it is the reference.
template <class Real>
inline void start_field(MagField<Real>& f, const AttitudeParams& p) noexcept {
    close_field(f);
    f.horizontal = approx::sqrt(f.mean.x * f.mean.x + f.mean.y * f.mean.y);
    f.up = f.mean.z;
    f.next_horizontal = f.horizontal;
    f.next_up = f.up;
    f.residual2 = f.next_residual2 = f.steady_s = f.since_s = 0;
    f.weight_s = static_cast<Real>(p.align_s);
}

template <class Real>
inline Real field_dip(const MagField<Real>& f) noexcept {
    return f.up / (std::max)(f.horizontal, Real{1});
}

/// Variance of a heading taken over `time` from a field of the given horizontal part.
template <class Real>
inline Real field_variance(const MagField<Real>& f, const AttitudeParams& p, Real time,
                           Real horizontal2) noexcept {
    const auto squared = [](float x) { return static_cast<Real>(x * x); };
    const auto correlated_s = static_cast<Real>(p.field_s);
    // what contradicts a young reference is not noise
    const Real disturbance2 =
        f.residual2 * f.weight_s / (f.weight_s + static_cast<Real>(p.field_young_s));
    const Real noise2 =
        squared(p.field_uT) + disturbance2 + squared(p.field_start_uT) * correlated_s / f.weight_s;
    return noise2 * correlated_s / (time * (std::max)(horizontal2, Real{1}));
}

namespace detail {

/// A second reference follows the field at once. Where it explains the field much better for long
/// enough, and the board turns meanwhile, it takes over; true then.
template <class Real>
inline bool field_changed(MagField<Real>& f, const AttitudeParams& p, Real horizontal, Real up,
                          Real time, bool turning) noexcept {
    constexpr Real much_better = 4;
    const auto follow_s = static_cast<Real>(p.field_next_s);
    const auto clear_uT = static_cast<Real>(p.field_disturbed_uT);
    const Real share = time / (follow_s + time);
    const Real off_h = horizontal - f.next_horizontal, off_u = up - f.next_up;
    f.next_horizontal += share * off_h;
    f.next_up += share * off_u;
    f.next_residual2 += share * (off_h * off_h + off_u * off_u - f.next_residual2);
    const bool better =
        f.residual2 > clear_uT * clear_uT && much_better * f.next_residual2 < f.residual2;
    if (!better)
        f.steady_s = 0;
    else if (turning)
        f.steady_s += time;
    return f.steady_s >= static_cast<Real>(p.field_change_s);
}

}  // namespace detail

/// Judges the closed window's mean field, mean_count > 0, and lets the reference follow it.
/// tilt_x: the pending tilt correction about east. time: since the look before.
template <class Real>
inline FieldLook<Real> look_at_field(MagField<Real>& f, const AttitudeParams& p, Real tilt_x,
                                     Real time, bool rest, bool turning) noexcept {
    const Real north = f.mean.y - tilt_x * f.mean.z, up = f.mean.z + tilt_x * f.mean.y;
    const Real horizontal2 = f.mean.x * f.mean.x + north * north;
    const Real horizontal = approx::sqrt(horizontal2);
    const Real off_h = f.horizontal - horizontal, off_u = f.up - up;
    const Real share = time / (static_cast<Real>(p.field_residual_s) + time);
    f.residual2 += share * (off_h * off_h + off_u * off_u - f.residual2);

    FieldLook<Real> look;
    look.east = approx::atan2(f.mean.x, f.mean.y);
    look.variance = field_variance(f, p, time, horizontal2);
    look.dip = field_dip(f);
    const Real reference2 = (std::max)(f.horizontal * f.horizontal, Real{1});
    // a mean over n = weight / field_s looks moves by 1/n of each new one, and so may the heading.
    // Where the field agrees with itself better than with a young reference, more so: the heading
    // may have been taken from a disturbance.
    const Real itself2 = 2 * f.next_residual2;
    const Real against2 = (std::max)(f.residual2 - itself2, Real{0});
    const Real doubt2 =
        f.residual2 + against2 * static_cast<Real>(p.field_young_doubt_s) / f.weight_s;
    look.doubt =
        doubt2 * time * static_cast<Real>(p.field_s) / (f.weight_s * f.weight_s * reference2);

    const Real seen_s = rest ? time * static_cast<Real>(p.field_rest) : time;
    f.weight_s = (std::min)(static_cast<Real>(p.field_memory_s), f.weight_s + seen_s);
    const Real follow = (std::min)(Real{1}, seen_s / f.weight_s);
    f.horizontal -= follow * off_h;
    f.up -= follow * off_u;

    if (detail::field_changed(f, p, horizontal, up, time, turning)) {
        look.doubt += f.residual2 / reference2;  // how far the new field may point elsewhere
        f.horizontal = f.next_horizontal;
        f.up = f.next_up;
        f.residual2 = f.next_residual2;
        f.weight_s = f.steady_s;
        f.steady_s = 0;
    }
    return look;
}

}  // namespace fairlead
