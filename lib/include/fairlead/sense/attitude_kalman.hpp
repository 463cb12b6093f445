#pragma once
// The error-state Kalman step, about 12 times a second, cut into parts so that every sample pays
// about the same.
//
// States: attitude error in the world frame (true = exp(error) estimate), horizontal velocity, gyro
// bias, gyro scale and shear. Gravity becomes visible because a body's velocity stays bounded: the
// pseudo-measurement v = 0, at the standard deviation and correlation time of velocity. The
// velocity lives in the frame that turns with the heading error, so that heading never touches the
// other states. Heading is moved by the magnetometer alone, and the magnetometer moves nothing else
// (a Schmidt update): with and without one the inclination is the same.
// Cost: a part is about N^2/2 multiply-adds, N = 13 or 14; 11 parts a step.
#include <algorithm>

#include "fairlead/math/quat.hpp"
#include "fairlead/sense/attitude_field.hpp"
#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/attitude_state.hpp"
#include "fairlead/sense/attitude_still.hpp"
#include "fairlead/sense/attitude_strapdown.hpp"

namespace fairlead {

inline constexpr float gravity_m_s2 = 9.81f;  // where a nominal value is enough

template <class Real, AttitudeMode mode>
class KalmanStep {
    using State = AttitudeState<Real, mode>;
    using Params = AttitudeParams;
    using Column = typename Covariance<Real, State::size>::Column;
    static constexpr bool has_field = mode == AttitudeMode::imu_mag;

  public:
    enum Part : std::uint8_t {
        idle,
        turn_x,
        turn_y,
        turn_z,
        bias_x,
        bias_y,
        bias_z,
        velocity_x,
        velocity_y,
        heading,
        apply
    };

    /// What is not known of the gyro at switch-on.
    static void start(State& s, const Params& params) noexcept {
        s.bias_rad_s = {};
        s.gyro_matrix = {};
        auto& p = s.covariance;
        p = {};
        for (std::size_t i = 0; i < 3; ++i) {
            p(State::bias + i, State::bias + i) = squared(params.bias_rad_s);
            for (std::size_t j = 0; j < i; ++j)
                p(State::scale + i, State::scale + j) = squared(params.clock_error);
            p(State::scale + i, State::scale + i) =
                squared(params.clock_error) + squared(params.scale_error);
            p(State::shear + i, State::shear + i) = squared(params.misalignment);
        }
    }

    /// The mean force is taken anew: what came before says nothing about what is now.
    static void doubt_inclination(State& s) noexcept {
        s.force_m_s2 = {};
        s.force_s = s.tilted_s = 0;
        s.doubted = true;
    }

    /// A reading was clipped, or is missing: the half of a motion that fits into the range would
    /// speak alone. The mean force is taken anew once all have been whole for force_s - verify_s.
    [[gnu::noinline, gnu::cold]] static void suspend_force(State& s,
                                                           const Params& params) noexcept {
        s.force_m_s2 = {0, 0, real(gravity_m_s2)};
        s.force_s = real((std::min)(params.verify_s - params.force_s, 0.0f));
        s.tilted_s = 0;
    }

    /// Before levelling: nothing is known, which is what a report shall say.
    static void lose_orientation(State& s) noexcept {
        constexpr Real tilt_variance = 1;  // 57 degrees
        forget(s.covariance, State::tilt, tilt_variance);
        forget(s.covariance, State::tilt + 1, tilt_variance);
        if constexpr (has_field) forget(s.covariance, State::heading, heading_variance_max);
    }

    /// After levelling on the mean force over align_s: off by the change of velocity in that time.
    static void aligned(State& s, const Params& params) noexcept {
        auto& p = s.covariance;
        // the mean force over align_s is off by the change of velocity in it, sqrt(2) speed / time;
        // capped, so that a large velocity_m_s does not make every levelling a lost orientation
        constexpr float tilt_max = 0.4f, root_2 = 1.41421356f;
        const Real speed = real(params.velocity_m_s), speed2 = speed * speed;
        const Real tilt1 =
            (std::min)(real(root_2) * speed / real(gravity_m_s2 * params.align_s), real(tilt_max));
        const Real tilt2 = tilt1 * tilt1, both = tilt1 * speed / real(root_2);
        for (std::size_t i = 0; i < 2; ++i) {
            forget(p, State::tilt + i, tilt2);
            forget(p, State::velocity + i, speed2);
        }
        p(State::velocity, State::tilt + 1) = both;
        p(State::velocity + 1, State::tilt) = -both;
        if constexpr (has_field) {
            // turned to north on that level: heading error = dip * tilt_y + its own
            const Real dip = field_dip(s.field);
            const Real own = field_variance(s.field, params, real(params.align_s),
                                            s.field.horizontal * s.field.horizontal);
            const Real whole = dip * dip * tilt2 + own;
            forget(p, State::heading, (std::min)(whole, heading_variance_max));
            // where the variance is capped, so are its covariances: the matrix stays positive
            const Real kept =
                whole > heading_variance_max ? dip * heading_variance_max / whole : dip;
            p(State::heading, State::tilt + 1) = kept * tilt2;
            p(State::heading, State::velocity) = kept * both;
        }
        s.velocity_m_s = s.velocity_from_m_s = {};
        s.correction = {};
        s.part = idle;
        s.sums = {};
        s.drive.fresh = true;
        doubt_inclination(s);
        s.doubted = false;
        s.cruise_m_s = s.slow_velocity_m_s = s.corrected = {};
        constexpr float ms = 1000;
        s.unproven_ms = static_cast<std::uint16_t>(ms * params.prove_s);
    }

    /// Takes over the window's sums; the first part of the covariance's way through the window.
    static void close_window(State& s, const Params& params) noexcept {
        auto& w = s.sums;
        auto& m = s.means;
        m.time = w.time;
        m.rate = (1 / w.time) * w.turn;
        watch_force(s, params);
        take_drive(s, params);
        s.velocity_from_m_s = s.velocity_m_s;
        stop_cruise(s, params);
        m.middle = s.q_wb * turn_quat(real(-0.5f) * w.turn, dot(w.turn, w.turn) / 4);
        if constexpr (has_field) close_field(s.field);
        auto& p = s.covariance;
        Column with = p.column(State::tilt + 1);
        p.shear(State::velocity, w.lift, with, with[State::tilt + 1]);
        with = p.column(State::tilt);
        p.shear(State::velocity + 1, -w.lift, with, with[State::tilt]);
        add_noise(p, params, w);
        const Real walk2 = (squared(params.bias_walk) + s.trend.drift2) * w.time;
        for (std::size_t i = State::bias; i < State::bias + 3; ++i)
            if (p(i, i) < squared(params.bias_rad_s)) p(i, i) += walk2;
        s.trend.variance = bias_variance(p);
        w = {};
        s.correction = {};
        s.part = turn_x;
    }

    /// Is the mean force farther from the vertical than `angle`?
    static bool force_is_off(const State& s, float angle) noexcept {
        const auto& f = s.force_m_s2;
        const Real across2 = f.x * f.x + f.y * f.y, slope = real(angle * (1 + angle * angle / 3));
        return !(f.z > 0) || across2 > slope * slope * f.z * f.z;
    }

    /// One part of the step; the last one corrects the state.
    static void advance(State& s, const Params& params) noexcept {
        const auto part = s.part;
        ++s.part;
        switch (part) {
            case turn_x:
                watch_rest(s, params);
                turn(s, 0);
                break;
            case turn_y: turn(s, 1); break;
            case turn_z:
                turn(s, 2);
                if (!resting(s)) s.part = velocity_x;
                break;
            case bias_x:
            case bias_y:
            case bias_z:  // a motion that has begun since is no bias
                if (resting(s)) measure_bias(s, params, part - std::size_t{bias_x});
                break;
            case velocity_x: measure_velocity(s, params, 0); break;
            case velocity_y: measure_velocity(s, params, 1); break;
            case heading:  // idle without a magnetometer, so that both correct at the same sample
                if constexpr (has_field) measure_heading(s, params);
                follow_cruise(s, params);
                break;
            default:
                correct(s, params);
                s.part = idle;
                break;
        }
    }

  private:
    // beyond 100 degrees a heading is as unknown as it can be
    static constexpr Real heading_variance_max = static_cast<Real>(3);

    static constexpr Real real(float x) noexcept { return static_cast<Real>(x); }
    static constexpr Real squared(float x) noexcept {
        return static_cast<Real>(x) * static_cast<Real>(x);
    }
    static bool resting(const State& s) noexcept { return (s.flags & flag::rest) != 0; }
    /// Field and force are seen from more than one side.
    static bool is_turning(const State& s) noexcept {
        constexpr float turning = 0.35f;  // rad/s
        return dot(s.means.rate, s.means.rate) > squared(turning);
    }

    static void forget(Covariance<Real, State::size>& p, std::size_t i, Real variance) noexcept {
        for (std::size_t j = 0; j < State::size; ++j) p(i, j) = 0;
        p(i, i) = variance;
    }

    static void add_noise(Covariance<Real, State::size>& p, const Params& params,
                          const WindowSums<Real>& w) noexcept {
        const Real speed = approx::sqrt(w.turn2 * static_cast<Real>(w.count)) / w.time;
        const Real angle2 =
            (squared(params.gyro_noise) + squared(params.gyro_scale_noise) * speed) * w.time +
            w.doubt_angle2;
        const Real velocity2 = squared(params.accel_noise) * w.time + w.doubt_velocity2;
        for (std::size_t i = 0; i < 2; ++i) {
            p(State::tilt + i, State::tilt + i) += angle2;
            p(State::velocity + i, State::velocity + i) += velocity2;
        }
        if constexpr (has_field) {
            Real& h = p(State::heading, State::heading);
            h = (std::max)(h, (std::min)(h + angle2, heading_variance_max));
        }
    }

    static Real bias_variance(const Covariance<Real, State::size>& p) noexcept {
        return p(State::bias, State::bias) + p(State::bias + 1, State::bias + 1) +
               p(State::bias + 2, State::bias + 2);
    }

    /// Of the tilt, over corrected_s, once it is known: what lasts draws it one way.
    static void sum_corrections(State& s, const Params& params) noexcept {
        const auto& p = s.covariance;
        if (p(State::tilt, State::tilt) + p(State::tilt + 1, State::tilt + 1) >
            squared(params.settled_tilt)) {
            s.corrected = {};
            return;
        }
        const Real kept = 1 - (std::min)(s.means.time / real(params.corrected_s), Real{1});
        for (std::size_t i = 0; i < 2; ++i)
            s.corrected[i] = kept * s.corrected[i] + s.correction[State::tilt + i];
    }

    /// Corrections of a bias that only wanders are white. Where they keep their sign it drifts.
    static void follow_bias(State& s, const Params& params) noexcept {
        auto& t = s.trend;
        // a body that keeps its attitude shows an acceleration that lasts as such a drift
        if (!resting(s) && !is_turning(s) && s.restless2 > squared(params.cruise_m_s)) {
            t.drift2 = 0;
            return;
        }
        const Real* x = s.correction.data() + State::bias;
        const auto memory_s = real(params.bias_trend_s);
        const Real time = s.means.time, share = time / (memory_s + time);
        t.mean += share * (BasicVec3<Real>{x[0], x[1], x[2]} - t.mean);
        const Real told2 = (std::max)(t.variance - bias_variance(s.covariance), Real{0});
        t.white2 += share * (told2 - t.white2);
        // a low-passed white sequence keeps share / 2 of its variance
        const Real excess2 =
            dot(t.mean, t.mean) - squared(params.bias_trend_sigma) * share / 2 * t.white2;
        t.drift2 = (std::clamp)(excess2 * memory_s / (time * time), Real{0},
                                squared(params.bias_trend_max));
    }

    /// The speed input in the world. Its first reading after a pause is the velocity.
    static void take_drive(State& s, const Params& params) noexcept {
        auto& d = s.drive;
        if (!d.known) return;
        d.age_s += s.means.time;
        if (d.age_s > real(params.drive_s)) {
            d.known = false;
            return;
        }
        const BasicVec3<Real> v = rotate(s.q_wb, d.velocity_m_s);
        s.cruise_m_s = {v.x, v.y};
        s.restless2 = 0;  // the speed is known: no motion is taken for tilt
        if (d.fresh) {
            d.fresh = false;
            s.velocity_m_s = s.cruise_m_s;
            forget(s.covariance, State::velocity, d.variance);
            forget(s.covariance, State::velocity + 1, d.variance);
        }
    }

    /// It has come to a stop: what its velocity was tells nothing of the tilt.
    static void stop_cruise(State& s, const Params& params) noexcept {
        constexpr Real cruising2 = 1;  // (m/s)^2
        const auto& v = s.cruise_m_s;
        if (!resting(s) || v[0] * v[0] + v[1] * v[1] < cruising2) return;
        s.cruise_m_s = s.velocity_m_s = s.velocity_from_m_s = {};
        for (std::size_t i = 0; i < 2; ++i)
            forget(s.covariance, State::velocity + i, squared(params.rest_velocity_m_s));
    }

    /// A vehicle, and a runner, keeps its velocity for long, seen from its own heading: what lasts
    /// while it turns is expected, and taken neither for tilt nor for bias. Not before the
    /// inclination is proven, and not while a bias drifts: that looks alike.
    static void follow_cruise(State& s, const Params& params) noexcept {
        if (s.drive.known) return;
        auto& v = s.cruise_m_s;
        const auto& q = s.means.middle;
        const auto& r = s.means.rate;
        // the part of the turn about the vertical
        Real turned = 2 * ((q.x * q.z - q.w * q.y) * r.x + (q.y * q.z + q.w * q.x) * r.y -
                           (q.x * q.x + q.y * q.y) * r.z) +
                      r.z;
        turned *= s.means.time;
        if constexpr (has_field) turned += s.correction[State::heading];
        const Real turned2 = turned * turned;
        // whatever spins so fast about the vertical does not cruise
        if (resting(s) || s.unproven_ms > 0 || s.trend.drift2 > 0 || turned2 > 1) {
            v = {};
            return;
        }
        const Real c = 1 - turned2 / 2, d = turned * (1 - turned2 * real(1.0f / 6));
        const Real share = s.means.time / (real(params.cruise_s) + s.means.time), kept = 1 - share;
        // while the mean force contradicts the inclination, so does the velocity
        const Real believed =
            force_is_off(s, params.force_tilt)
                ? 0
                : share * s.restless2 / (s.restless2 + squared(params.cruise_m_s));
        v = {kept * (c * v[0] - d * v[1]) + believed * s.velocity_from_m_s[0],
             kept * (d * v[0] + c * v[1]) + believed * s.velocity_from_m_s[1]};
    }

    /// The mean specific force: whatever the motion, it points up in the end. Not while force_s is
    /// negative: see suspend_force.
    static void watch_force(State& s, const Params& params) noexcept {
        const auto& w = s.sums;
        if (s.force_s < 0) {
            s.force_s += w.time;
            return;
        }
        const Real share = w.time / ((std::min)(s.force_s, real(params.force_s)) + w.time);
        const BasicVec3<Real> force =
            (1 / w.time) * BasicVec3<Real>{s.velocity_m_s[0] - s.velocity_from_m_s[0],
                                           s.velocity_m_s[1] - s.velocity_from_m_s[1], w.lift};
        s.force_m_s2 += share * (force - s.force_m_s2);
        s.force_s += w.time;
    }

    /// A quiet board: at rest, or in a slow turn? What a turn taught is undone.
    static void watch_rest(State& s, const Params& params) noexcept {
        auto& p = s.covariance;
        const KnownBias<Real> known{
            s.bias_rad_s,
            {p(State::bias, State::bias), p(State::bias + 1, State::bias + 1),
             p(State::bias + 2, State::bias + 2)}};
        BasicVec3<Real> field{};
        const BasicVec3<Real>* seen = nullptr;
        if constexpr (has_field)
            if (s.field.mean_count > 0) {
                field = rotate(conj(s.means.middle), s.field.mean);
                seen = &field;
            }
        if (!judge_still(s.still, params, s.rest, known, seen, s.means.time)) return;
        s.bias_rad_s = s.still.bias;
        for (std::size_t i = 0; i < 3; ++i) forget(p, State::bias + i, s.still.variance);
    }

    /// The errors of body axis j turn the world: error -= R_j (db_j + dC_j rate).
    static void turn(State& s, std::size_t j) noexcept {
        auto& p = s.covariance;
        const std::size_t next = j == 2 ? 0 : j + 1, last = 3 - j - next;
        const std::size_t b = State::bias + j, c = State::scale + j;
        const std::size_t d = State::shear + last, e = State::shear + next;
        const Real r_own = component(s.means.rate, j), r_next = component(s.means.rate, next),
                   r_last = component(s.means.rate, last);
        Column with = p.column(b);
        p.add_column(c, r_own, with);
        p.add_column(d, r_next, with);
        p.add_column(e, r_last, with);
        const Real variance = with[b] + r_own * with[c] + r_next * with[d] + r_last * with[e];
        const BasicMat3<Real> axes = matrix_of(s.means.middle);
        const Real t = -s.means.time;
        p.shear(State::tilt, t * component(axes.x, j), with, variance);
        p.shear(State::tilt + 1, t * component(axes.y, j), with, variance);
        if constexpr (has_field) p.shear(State::heading, t * component(axes.z, j), with, variance);
    }

    /// State i was measured: `innovation` beyond its value, with variance noise2.
    static void measure(State& s, std::size_t i, Real innovation, Real noise2) noexcept {
        auto& p = s.covariance;
        const Column with = p.column(i);
        const Real one_by_s = 1 / (with[i] + (std::max)(noise2, p.noise_least * with[i]));
        const Real step = (innovation - s.correction[i]) * one_by_s;
        for (std::size_t j = 0; j < State::size; ++j) s.correction[j] += step * with[j];
        p.shrink(with, one_by_s);
    }

    static void measure_bias(State& s, const Params& params, std::size_t axis) noexcept {
        const Real rate = component(s.rest.gyro, axis) - component(s.still.unproven, axis),
                   bias = component(s.bias_rad_s, axis);
        const Real noise2 = squared(params.rest_rate_rad_s) * real(params.rest_window_s);
        measure(s, State::bias + axis, rate - bias, noise2 / s.means.time);
    }

    static void measure_velocity(State& s, const Params& params, std::size_t axis) noexcept {
        if (s.drive.known) {
            measure(s, State::velocity + axis, s.cruise_m_s[axis] - s.velocity_from_m_s[axis],
                    s.drive.variance);
            return;
        }
        const Real usual2 = notice_motion(s, params, axis);
        const Real noise2 =
            resting(s) ? squared(params.rest_velocity_m_s) * real(params.rest_velocity_s) : usual2;
        const Real expected = resting(s) ? 0 : s.cruise_m_s[axis];
        measure(s, State::velocity + axis, expected - s.velocity_from_m_s[axis],
                noise2 / s.means.time);
    }

    /// Variance of a velocity of mean 0, times its correlation time, in the motion of late.
    static Real notice_motion(State& s, const Params& params, std::size_t axis) noexcept {
        const Real time = s.means.time;
        Real& slow = s.slow_velocity_m_s[axis];
        slow += time / (real(params.restless_s) + time) * (s.velocity_from_m_s[axis] - slow);
        s.restless2 += time / (real(params.restless_memory_s) + time) * (slow * slow - s.restless2);
        // what shakes like a runner moves like one. Before the first rest the bias is not known,
        // and such motion would be taken for it: it counts at once, and twice
        const Real shake =
            s.still.rested ? 0
                           : (std::min)(Real{1}, s.rest.accel_noise2 / squared(params.shake_m_s2));
        const auto& now = s.slow_velocity_m_s;
        const Real moves2 =
            (std::max)(s.restless2, shake / 4 * (now[0] * now[0] + now[1] * now[1]));
        const Real usual = squared(params.velocity_m_s) * real(params.velocity_s);
        const Real seen = real(2 * params.restless_gain * params.restless_s) * moves2 *
                          (1 + real(params.restless_knee) * moves2);
        return (std::clamp)((1 + shake) * seen, usual,
                            (1 + shake) * real(params.restless_max) * usual);
    }

    static void measure_heading(State& s, const Params& params) noexcept {
        // a single reading tells as much as all of those, correlated, that might have come since
        s.field.since_s += s.means.time;
        if (s.field.mean_count == 0) return;
        const Real time = (std::min)(s.field.since_s, real(params.field_s));
        s.field.since_s = 0;
        auto& p = s.covariance;
        auto& x = s.correction;
        const auto look =
            look_at_field(s.field, params, x[State::tilt], time, resting(s), is_turning(s));
        p(State::heading, State::heading) += look.doubt;
        // the field's angle east of north is dip * tilt_y - heading
        const Column tilt = p.column(State::tilt + 1);
        Column with{};
        for (std::size_t j = 0; j < State::size; ++j)
            with[j] = look.dip * tilt[j] - p(State::heading, j);
        const Real seen2 = look.dip * with[State::tilt + 1] - with[State::heading];
        const Real s2 = seen2 + (std::max)(look.variance, p.noise_least * seen2);
        const Real gain = with[State::heading] / s2;
        x[State::heading] -= gain * (look.east + look.dip * x[State::tilt + 1] - x[State::heading]);
        for (std::size_t j = 0; j < State::heading; ++j) p(State::heading, j) -= gain * with[j];
        p(State::heading, State::heading) -= gain * with[State::heading];
    }

    /// Moves the state, and what the running window has gathered with the state as it was.
    static void correct(State& s, const Params& params) noexcept {
        const auto& x = s.correction;
        const BasicVec3<Real> turn{x[State::tilt], x[State::tilt + 1], 0};
        auto& v = s.velocity_m_s;
        // what the window has gathered of force stays as it was
        const Real east = v[0] - s.velocity_from_m_s[0], north = v[1] - s.velocity_from_m_s[1];
        v[0] += x[State::velocity] + s.sums.lift * turn.y;
        v[1] += x[State::velocity + 1] - s.sums.lift * turn.x;
        BasicQuat<Real> q = turn_quat(turn, dot(turn, turn));
        if constexpr (has_field) {
            const BasicQuat<Real> about = about_up(x[State::heading]);
            const BasicVec3<Real> turned = rotate(about, BasicVec3<Real>{v[0], v[1], 0});
            v = {turned.x, turned.y};
            q = about * q;
            s.field.sum = rotate(q, s.field.sum);
        }
        s.velocity_from_m_s = {v[0] - east, v[1] - north};
        s.q_wb = normalised(q * s.q_wb);
        sum_corrections(s, params);
        follow_bias(s, params);
        const Real limit = real(params.bias_max_rad_s);
        // beyond the limit it is not believed, and then it is not known either
        const auto bias = [&](Real b, std::size_t i) {
            const Real found = b + x[State::bias + i], kept = (std::clamp)(found, -limit, limit);
            Real& variance = s.covariance(State::bias + i, State::bias + i);
            if (!approx::same(kept, found)) variance = (std::max)(variance, limit * limit);
            return kept;
        };
        s.bias_rad_s = {bias(s.bias_rad_s.x, 0), bias(s.bias_rad_s.y, 1), bias(s.bias_rad_s.z, 2)};
        // so wrong a bias has turned the orientation further than a linear step can mend
        constexpr float far_off = 0.05f;  // rad/s
        const Real* found = x.data() + State::bias;
        if (found[0] * found[0] + found[1] * found[1] + found[2] * found[2] > squared(far_off))
            lose_orientation(s);
        const Real *scale = x.data() + State::scale, *shear = x.data() + State::shear;
        s.gyro_matrix = s.gyro_matrix +
                        BasicSym3<Real>{scale[0], shear[2], shear[1], scale[1], shear[0], scale[2]};
    }
};

}  // namespace fairlead
