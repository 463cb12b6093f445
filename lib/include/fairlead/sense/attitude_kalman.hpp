#pragma once
// The error-state Kalman step, about 14 times a second, cut into slices so that every sample pays
// about the same.
//
// States: attitude error in the world frame (true = exp(error) estimate), horizontal velocity, gyro
// bias, gyro scale and shear. Gravity becomes visible because a body's velocity stays bounded: the
// pseudo-measurement v = 0, at the standard deviation and correlation time of velocity. The
// velocity lives in the frame that turns with the heading error, so that heading never touches the
// other states. Heading is moved by the magnetometer alone, and the magnetometer moves nothing else
// (a Schmidt update): with and without one the inclination is the same.
// Cost: a slice is about N^2/2 multiply-adds, N = 13 or 14; 11 slices a step.
#include <algorithm>

#include "fairlead/math/quat.hpp"
#include "fairlead/sense/attitude_field.hpp"
#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/attitude_state.hpp"
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
    enum Slice : std::uint8_t {
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
        const Real speed2 = squared(params.velocity_m_s);
        const Real per_lift = 1 / real(gravity_m_s2 * params.align_s);
        const Real tilt2 = 2 * speed2 * per_lift * per_lift;
        for (std::size_t i = 0; i < 2; ++i) {
            forget(p, State::tilt + i, tilt2);
            forget(p, State::velocity + i, speed2);
        }
        p(State::velocity, State::tilt + 1) = speed2 * per_lift;
        p(State::velocity + 1, State::tilt) = -speed2 * per_lift;
        if constexpr (has_field) {
            // turned to north on that level: heading error = dip * tilt_y + its own
            const Real dip = field_dip(s.field);
            const Real own = field_variance(s.field, params, real(params.align_s),
                                            s.field.horizontal * s.field.horizontal);
            forget(p, State::heading, (std::min)(dip * dip * tilt2 + own, heading_variance_max));
            p(State::heading, State::tilt + 1) = dip * tilt2;
            p(State::heading, State::velocity) = dip * speed2 * per_lift;
        }
        s.velocity_m_s = {};
        s.correction = {};
        s.slice = idle;
        s.sums = {};
    }

    /// Takes over the window's sums; the first part of the covariance's way through the window.
    static void close_window(State& s, const Params& params) noexcept {
        auto& w = s.sums;
        auto& m = s.means;
        m.time = w.time;
        m.rate = (1 / w.time) * w.turn;
        m.velocity = s.velocity_m_s;
        m.middle = s.q_wb * turn_quat(real(-0.5f) * w.turn, dot(w.turn, w.turn) / 4);
        if constexpr (has_field) close_field(s.field);

        auto& p = s.covariance;
        Column with = p.column(State::tilt + 1);
        p.shear(State::velocity, w.lift, with, with[State::tilt + 1]);
        with = p.column(State::tilt);
        p.shear(State::velocity + 1, -w.lift, with, with[State::tilt]);
        add_noise(p, params, w);
        w = {};
        s.correction = {};
        s.slice = turn_x;
    }

    /// One slice of the step; the last one corrects the state.
    static void advance(State& s, const Params& params) noexcept {
        const auto slice = s.slice;
        ++s.slice;
        switch (slice) {
            case turn_x:
            case turn_y: turn(s, slice - std::size_t{turn_x}); break;
            case turn_z:
                turn(s, 2);
                if (!resting(s)) s.slice = velocity_x;
                break;
            case bias_x:
            case bias_y:
            case bias_z: measure_bias(s, params, slice - std::size_t{bias_x}); break;
            case velocity_x: measure_velocity(s, params, 0); break;
            case velocity_y: measure_velocity(s, params, 1); break;
            case heading:  // idle without a magnetometer, so that both correct at the same sample
                if constexpr (has_field) measure_heading(s, params);
                break;
            default:
                correct(s, params);
                s.slice = idle;
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
        for (std::size_t i = State::bias; i < State::bias + 3; ++i)
            if (p(i, i) < squared(params.bias_rad_s)) p(i, i) += squared(params.bias_walk) * w.time;
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
        const Real one_by_s = 1 / (with[i] + noise2);
        const Real step = (innovation - s.correction[i]) * one_by_s;
        for (std::size_t j = 0; j < State::size; ++j) s.correction[j] += step * with[j];
        p.shrink(with, one_by_s);
    }

    static void measure_bias(State& s, const Params& params, std::size_t axis) noexcept {
        const Real rate = component(s.rest.gyro, axis), bias = component(s.bias_rad_s, axis);
        const Real noise2 = squared(params.rest_rate_rad_s) * real(params.rest_window_s);
        measure(s, State::bias + axis, rate - bias, noise2 / s.means.time);
    }

    static void measure_velocity(State& s, const Params& params, std::size_t axis) noexcept {
        const Real noise2 = resting(s)
                                ? squared(params.rest_velocity_m_s) * real(params.rest_velocity_s)
                                : squared(params.velocity_m_s) * real(params.velocity_s);
        measure(s, State::velocity + axis, -s.means.velocity[axis], noise2 / s.means.time);
    }

    static void measure_heading(State& s, const Params& params) noexcept {
        // a single reading tells as much as all of those, correlated, that might have come since
        s.field.since_s += s.means.time;
        if (s.field.mean_count == 0) return;
        const Real time = (std::min)(s.field.since_s, real(params.field_s));
        s.field.since_s = 0;
        constexpr float turning = 0.35f;  // rad/s: the field is seen from more than one side
        auto& p = s.covariance;
        auto& x = s.correction;
        const auto look = look_at_field(s.field, params, x[State::tilt], time, resting(s),
                                        dot(s.means.rate, s.means.rate) > squared(turning));
        p(State::heading, State::heading) += look.doubt;
        // the field's angle east of north is dip * tilt_y - heading
        const Column tilt = p.column(State::tilt + 1);
        Column with{};
        for (std::size_t j = 0; j < State::size; ++j)
            with[j] = look.dip * tilt[j] - p(State::heading, j);
        const Real s2 = look.dip * with[State::tilt + 1] - with[State::heading] + look.variance;
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
        s.q_wb = normalised(q * s.q_wb);
        const Real limit = real(params.bias_max_rad_s);
        // beyond the limit it is not believed, and then it is not known either
        const auto bias = [&](Real b, std::size_t i) {
            const Real found = b + x[State::bias + i], kept = std::clamp(found, -limit, limit);
            Real& variance = s.covariance(State::bias + i, State::bias + i);
            if (!approx::same(kept, found)) variance = (std::max)(variance, limit * limit);
            return kept;
        };
        s.bias_rad_s = {bias(s.bias_rad_s.x, 0), bias(s.bias_rad_s.y, 1), bias(s.bias_rad_s.z, 2)};
        const Real *scale = x.data() + State::scale, *shear = x.data() + State::shear;
        s.gyro_matrix = s.gyro_matrix +
                        BasicSym3<Real>{scale[0], shear[2], shear[1], scale[1], shear[0], scale[2]};
    }
};

}  // namespace fairlead
