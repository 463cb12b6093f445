#pragma once
// Rest that is rest. A board that turns slowly and steadily is as quiet as one that lies still, and
// its rate would be learned as a bias. What tells them apart: at rest gravity and the magnetic
// field keep their directions in the body; in a turn they move.
//
// While the board is quiet, both are compared with what they were when the rest began (the anchor).
// If either has moved, it is no rest, and the bias of the anchor is restored. A rate that
// contradicts the known bias is accepted as a new bias once gravity (for its horizontal part) and
// the field (for its vertical part) would have moved visibly, had it been a turn. Without a
// magnetometer the vertical part of a new bias is accepted only at the first rest. Cost: about 80
// multiplications a Kalman step at rest.
#include <algorithm>

#include "fairlead/math/quat.hpp"
#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/attitude_state.hpp"

namespace fairlead {

/// Bias and its variance as the filter knows them now.
template <class Real>
struct KnownBias {
    BasicVec3<Real> bias{}, variance{};
};

namespace detail {

inline constexpr float still_settle_s = 0.5f;  // from the anchor on, until means have settled

template <class Real>
constexpr BasicVec3<Real> squares(const BasicVec3<Real>& v) noexcept {
    return {v.x * v.x, v.y * v.y, v.z * v.z};
}

/// Is this mean rate the one since the anchor?
template <class Real>
inline bool is_steady(const StillState<Real>& s, const AttitudeParams& p,
                      const BasicVec3<Real>& gyro) noexcept {
    const Real since_s = (std::max)(s.held_s - static_cast<Real>(still_settle_s), Real{1e-3f});
    const BasicVec3<Real> newly = gyro - s.bias - (1 / since_s) * s.turned;
    return dot(newly, newly) <= static_cast<Real>(p.rest_gate_rad_s * p.rest_gate_rad_s);
}

/// May this mean rate be a bias?
template <class Real>
inline bool bias_is_believable(StillState<Real>& s, const AttitudeParams& p,
                               const KnownBias<Real>& known, const BasicVec3<Real>& gyro) noexcept {
    const auto squared = [](float x) { return static_cast<Real>(x * x); };
    const auto limit = static_cast<Real>(p.bias_max_rad_s);
    if (approx::absolute(gyro.x) > limit || approx::absolute(gyro.y) > limit ||
        approx::absolute(gyro.z) > limit)
        return false;
    const Real force2 = dot(s.accel, s.accel);
    if (!(force2 > 0)) return false;
    const BasicVec3<Real> up = (1 / approx::sqrt(force2)) * s.accel;
    const BasicVec3<Real> rate = gyro - known.bias;
    const BasicVec3<Real> up2 = squares(up);
    const Real vertical = dot(rate, up), vertical2 = vertical * vertical;
    const Real horizontal2 = (std::max)(dot(rate, rate) - vertical2, Real{0});
    const Real variance_up = dot(up2, known.variance);
    const Real variance_sum = known.variance.x + known.variance.y + known.variance.z;
    const Real floor2 = squared(p.rest_gate_rad_s), gate2 = squared(p.rest_gate);

    // what has been so since the anchor proves nothing of a turn that begins now
    const bool steady = is_steady(s, p, gyro);
    // would a turn have shown? half as much again as counts as moved
    constexpr Real seen2 = static_cast<Real>(2.25);
    const Real turned_up = dot(s.turned_now, up);
    const Real turned_flat2 =
        (std::max)(dot(s.turned_now, s.turned_now) - turned_up * turned_up, Real{0});
    const bool flat_seen = steady && turned_flat2 >= seen2 * squared(p.rest_tilt);
    const bool flat_ok =
        flat_seen ||
        horizontal2 <= gate2 * (std::max)(variance_sum - variance_up, Real{0}) + floor2;
    const Real along = dot(s.field, up);
    const Real across2 = (std::max)(dot(s.field, s.field) - along * along, Real{0});
    const bool up_seen = steady && s.has_field &&
                         turned_up * turned_up * across2 >= seen2 * squared(p.rest_field_uT);
    const bool agrees = vertical2 <= gate2 * variance_up + floor2;
    bool up_ok = up_seen || agrees;
    // confirmed: by the field, or by a rest that agrees with what was known before it
    if (flat_ok && (up_seen || (agrees && !s.guessed))) s.rested = true;
    if (!up_ok && !s.rested) {
        // the first rest: nothing is known yet; the larger the rate, the longer it must last
        constexpr float per_rad_s = 11.5f;  // 0.2 s for each deg/s
        up_ok = s.held_s >= static_cast<Real>(per_rad_s) * approx::absolute(vertical);
        s.guessed = s.guessed || up_ok;
    }
    // a vertical part that contradicts what is known, and that nothing proves, is left out
    s.unproven = up_ok ? BasicVec3<Real>{} : vertical * up;
    return flat_ok && (up_ok || s.rested);
}

}  // namespace detail

/// Once a Kalman step. field: the mean over it in the body, or null where there was none. True when
/// what was learned since the anchor must be undone: bias and variance of the state.
template <class Real>
inline bool judge_still(StillState<Real>& s, const AttitudeParams& p, const RestState<Real>& rest,
                        const KnownBias<Real>& known, const BasicVec3<Real>* field,
                        Real time) noexcept {
    constexpr Real settle_s = detail::still_settle_s, renew_s = 20, doubt_s = 15;
    const auto squared = [](float x) { return static_cast<Real>(x * x); };
    if (rest.quiet_s < static_cast<Real>(p.rest_s)) {
        const bool rested = s.rested;
        s = {};
        s.rested = rested;
        return false;
    }
    if (s.held_s <= 0 || s.held_s > renew_s) {
        const bool rested = s.rested, suspected = s.moved, still = s.still,
                   guessed = s.guessed && s.held_s > 0;
        s = {};
        s.guessed = guessed;
        s.rested = rested;
        s.suspected = suspected;
        s.still = still;
        s.accel = rest.accel;
        s.bias = known.bias;
        s.variance = (std::max)(known.variance.x, (std::max)(known.variance.y, known.variance.z));
    }
    const bool settled = s.held_s >= settle_s;
    s.held_s = settled ? s.held_s + time : (std::min)(s.held_s + time, settle_s);
    const Real share = (std::min)(time / settle_s, Real{1});
    if (settled) s.turned += time * (rest.gyro - s.bias);
    s.turned_now += share * (s.turned - s.turned_now);
    if (field != nullptr) {
        if (!s.has_field) s.field_now = *field;
        s.field_now += share * (*field - s.field_now);
        if (!settled || !s.has_field) s.field = s.field_now;
        s.has_field = true;
    }
    if (s.moved) return false;
    const BasicVec3<Real> swung = rest.accel - s.accel, drawn = s.field_now - s.field;
    s.moved = dot(swung, swung) > squared(p.rest_tilt) * dot(s.accel, s.accel) ||
              (s.has_field && dot(drawn, drawn) > squared(p.rest_field_uT));
    if (s.moved) {
        // was it the turn that the bias of the anchor foretold? then that bias was right
        const BasicVec3<Real> foretold_a = cross(s.accel, s.turned_now),
                              foretold_m = cross(s.field, s.turned_now);
        const BasicVec3<Real> left_a = swung - foretold_a, left_m = drawn - foretold_m;
        const Real a2 = 1 / (squared(p.rest_tilt) * dot(s.accel, s.accel)),
                   m2 = 1 / squared(p.rest_field_uT);
        const Real moved2 = a2 * dot(swung, swung) + m2 * dot(drawn, drawn);
        const Real left2 = a2 * dot(left_a, left_a) + m2 * dot(left_m, left_m);
        // and where nothing was known before: a steady rate under which the field turned has shown
        // nothing. One that begins now came after a rest.
        const bool unknown = s.variance > squared(p.rest_gate_rad_s);
        const bool turned_all_along = s.has_field && dot(drawn, drawn) > squared(p.rest_field_uT) &&
                                      detail::is_steady(s, p, rest.gyro);
        const bool undo = s.still && ((unknown && turned_all_along) || 2 * left2 < moved2);
        s.still = false;
        return undo;
    }
    s.still =
        (!s.suspected || s.held_s > doubt_s) && detail::bias_is_believable(s, p, known, rest.gyro);
    return false;
}

}  // namespace fairlead
