#pragma once
// Orientation from gyro and accelerometer, with or without magnetometer: causal, float, in fixed
// memory and even work per sample.
//
// Every sample: rest detection, exact strapdown, sums over a window, one part of a Kalman step
// (attitude_kalman.hpp) that estimates tilt, heading, gyro bias, scale and shear. Time steps are
// per sample; lost samples are bridged; what is missing, clipped or stuck adds to the uncertainty
// instead of to the error. After [Laidig & Seel 2023] for the idea of a filter in an almost
// inertial frame; the rest is ours: docs/attitude.md has method, figures and limits.
// In: Samples behind an Intake. Out: q_wb, body to east-north-up. State: at most 1000 bytes.
#include <algorithm>
#include <cstdint>
#include <optional>

#include "fairlead/sense/attitude_alive.hpp"
#include "fairlead/sense/attitude_kalman.hpp"
#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/attitude_rest.hpp"
#include "fairlead/sense/attitude_state.hpp"
#include "fairlead/sense/attitude_strapdown.hpp"
#include "fairlead/sense/clip.hpp"
#include "fairlead/sense/saved.hpp"

namespace fairlead {

template <class Real = float, AttitudeMode mode = AttitudeMode::imu_mag>
class BasicAttitude {
    static_assert(mode != AttitudeMode::gyro, "include fairlead/sense/attitude_gyro.hpp");
    using Kalman = KalmanStep<Real, mode>;
    using Vector = BasicVec3<Real>;
    using Rotation = BasicQuat<Real>;
    static constexpr bool has_field = mode == AttitudeMode::imu_mag;

  public:
    using State = AttitudeState<Real, mode>;
    static constexpr std::size_t latency = 0;

    /// params must pass check(): asserted.
    explicit BasicAttitude(const AttitudeParams& params = {}) noexcept : params_{params} {
        FAIRLEAD_ASSERT(check(params));
        constexpr float longest_s = 2.0f;  // a step in ns fits 32 bits
        gap_ns_max_ = static_cast<std::int32_t>((std::min)(params.gap_s_max, longest_s) * 1e9f);
        reset();
    }

    void reset() noexcept {
        s_ = State{};
        Kalman::start(s_, params_);
    }

    /// Empty: no time has passed since the sample before, or nothing is known yet. A sample without
    /// a gyro or accelerometer reading repeats the last orientation, not marked as valid.
    std::optional<Pose> push(const Sample& sample) noexcept {
        const bool has_gyro = valid(sample, flag::gyro_valid, sample.gyro_rad_s);
        const bool has_accel = valid(sample, flag::accel_valid, sample.accel_m_s2);
        if (s_.phase == AttitudePhase::empty) {
            if (!has_gyro || !has_accel) return std::nullopt;
            begin(sample);
            return pose(sample);
        }
        // a new run: its clock has nothing to do with the one before
        const bool new_run = (sample.flags & flag::new_run) != 0;
        if (!new_run && sample.t_ns <= s_.t_ns) return std::nullopt;
        if (new_run || lapse(sample) > gap_ns_max_) {  // also where only invalid samples came
            if (has_gyro && has_accel) {
                begin(sample);
                return pose(sample);
            }
            if (new_run) s_.phase = AttitudePhase::empty;  // begins with what comes next
            return pose(sample, false);
        }
        if (!has_gyro) return pose(sample, false);  // bridged like a lost one
        step(sample, has_accel);
        return pose(sample);
    }
    static constexpr std::optional<Pose> flush() noexcept { return std::nullopt; }

    /// Optional, for vehicles: the velocity in the body frame, m/s, such as the speed of a wheel
    /// times the axis that points ahead, and its standard deviation, m/s (at least 0.01; slip and
    /// the mounting's error count: 2 % of the speed is usual). Call it before the push it belongs
    /// to, as often as there is a reading; one serves for params.drive_s. It takes the place of the
    /// bounded velocity, so that speeding up, braking and bends are not taken for tilt. Not finite:
    /// ignored.
    void drive(const Vec3& velocity_b_m_s, float sigma_m_s) noexcept {
        if (!is_finite(velocity_b_m_s) || !approx::is_finite(sigma_m_s)) return;
        constexpr float sigma_min = 0.01f;
        const auto sigma = static_cast<Real>((std::max)(sigma_m_s, sigma_min));
        auto& d = s_.drive;
        d.fresh = d.fresh || !d.known;
        d.velocity_m_s = widen(velocity_b_m_s);
        d.variance = sigma * sigma;
        d.age_s = 0;
        d.known = true;
    }

    // ---- what is known, after the last push
    Rotation orientation() const noexcept { return s_.q_wb; }
    Vector rate_rad_s() const noexcept { return s_.rate_rad_s; }
    Vector bias_rad_s() const noexcept { return s_.bias_rad_s; }
    bool resting() const noexcept { return (s_.flags & flag::rest) != 0; }

    /// Orientation dt_s from now if the rate stays: what the latency of a display asks for.
    Rotation predict(Real dt_s) const noexcept {
        const Vector r = dt_s * s_.rate_rad_s;
        return normalised(s_.q_wb * turn_quat(r, dot(r, r)));
    }
    /// Acceleration of the sensor without gravity, in the world frame.
    Vector earth_acceleration(const Sample& sample) const noexcept {
        return rotate(s_.q_wb, widen(sample.accel_m_s2)) -
               Vector{0, 0, static_cast<Real>(gravity_m_s2)};
    }
    /// The same in the body frame.
    Vector linear_acceleration(const Sample& sample) const noexcept {
        return rotate(conj(s_.q_wb), earth_acceleration(sample));
    }
    /// Standard deviations, rad. Inclination: of the whole angle between the two verticals.
    Real inclination_sigma() const noexcept {
        constexpr float both_axes = 1.41421356f / gravity_m_s2;
        return reported(tilt_variance() + motion_variance(), both_axes * params_.accel_offset_m_s2);
    }
    Real heading_sigma() const noexcept {
        static_assert(has_field, "without a magnetometer heading is only relative");
        const Real dip = field_dip(s_.field);
        const auto zero = static_cast<Real>(params_.accel_zero_m_s2 / gravity_m_s2);
        return reported(heading_variance() + dip * dip * (motion_variance() / 2 + zero * zero),
                        params_.field_offset);
    }

    // ---- what a board keeps over a power-down
    const State& state() const noexcept { return s_; }
    /// Takes over bias, scale, shear and the field's reference; the orientation is found anew.
    void restore_knowledge(const State& known) noexcept {
        s_ = known;
        s_.phase = AttitudePhase::empty;
        s_.part = Kalman::idle;
    }
    /// Takes over everything: the next sample follows the last one of that state.
    void restore_all(const State& known) noexcept { s_ = known; }

  private:
    static Vector widen(const Vec3& v) noexcept {
        return {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
    }
    static bool valid(const Sample& sample, std::uint32_t bit, const Vec3& v) noexcept {
        return (sample.flags & bit) != 0 && approx::is_finite(v.x + v.y + v.z);
    }
    Real tilt_variance() const noexcept {
        return s_.covariance(State::tilt, State::tilt) +
               s_.covariance(State::tilt + 1, State::tilt + 1);
    }
    Real heading_variance() const noexcept { return s_.covariance(State::heading, State::heading); }

    /// Motion beyond what the filter can adapt to: of the whole inclination. What is slow now
    /// counts at once, before its mean square has grown.
    Real motion_variance() const noexcept {
        const auto& v = s_.slow_velocity_m_s;
        const auto tilt = static_cast<Real>(params_.restless_tilt);
        const Real now2 = (v[0] * v[0] + v[1] * v[1]) / 2;
        return tilt * tilt * (std::max)((std::max)(s_.restless2, now2) - 1, Real{0});
    }

    /// The noise that the filter assumes is cautious; params.sigma_scale makes its report honest.
    Real reported(Real variance, float offset) const noexcept {
        const Real v = (std::max)(variance, Real{0}) + static_cast<Real>(offset * offset);
        return static_cast<Real>(params_.sigma_scale) * approx::sqrt(v);
    }

    /// Since the sample before, ns; the sample's time is later. Any two times have a difference.
    std::int64_t lapse(const Sample& sample) const noexcept {
        const auto ns =
            static_cast<std::uint64_t>(sample.t_ns) - static_cast<std::uint64_t>(s_.t_ns);
        return ns > static_cast<std::uint64_t>(INT64_MAX) ? INT64_MAX
                                                          : static_cast<std::int64_t>(ns);
    }

    /// The first sample, and the first after an outage.
    void begin(const Sample& sample) noexcept {
        const Vector gyro = widen(sample.gyro_rad_s), accel = widen(sample.accel_m_s2);
        s_.t_ns = sample.t_ns;
        s_.rate_rad_s = gyro - s_.bias_rad_s;
        s_.q_wb = levelled(s_.q_wb, rotate(s_.q_wb, accel));
        s_.velocity_m_s = {};
        s_.sums = {};
        s_.blind_s = 0;
        if constexpr (has_field) {
            s_.field.sum = {};
            s_.field.count = 0;
            if (has_reading(sample)) {
                const Vector field = rotate(s_.q_wb, widen(sample.mag_uT));
                s_.q_wb = about_up(approx::atan2(field.x, field.y)) * s_.q_wb;
            }
        }
        start_rest(s_.rest, params_, gyro, accel);
        Kalman::lose_orientation(s_);
        s_.phase = AttitudePhase::aligning;
        s_.flags = flag::settling;
    }

    void step(const Sample& sample, bool has_accel) noexcept {
        // at most gap_ns_max_: the difference fits 32 bits, whose conversion is one instruction
        const Real dt = static_cast<Real>(static_cast<std::int32_t>(sample.t_ns - s_.t_ns)) *
                        static_cast<Real>(1e-9);
        s_.t_ns = sample.t_ns;
        const bool gap = is_gap(dt);
        const bool blind = doubt_gyro(sample, dt);
        const Vector gyro = widen(sample.gyro_rad_s), read = widen(sample.accel_m_s2);
        if (thaws(s_.alive, read)) Kalman::doubt_inclination(s_);
        // frozen? until it speaks again
        if (count_repeats(s_.alive, gyro, read) && s_.rest.quiet_s <= 0 &&
            s_.alive.held * s_.period_s > static_cast<Real>(params_.held_s))
            Kalman::doubt_inclination(s_);
        const bool has_force = has_accel && !s_.alive.accel_dead && !is_zero(read);
        const bool told_clipped = has_force && accel_clipped(sample);
        const Vector accel = has_force ? read : s_.rest.accel;
        const bool rest = update_rest(s_.rest, params_, gyro, accel, dt) && !blind;

        Vector rate = gyro - s_.bias_rad_s;
        rate = rate - s_.gyro_matrix * rate;
        Vector mean = rate;
        if (gap) mean = bridge(rate, dt);
        if (blind || dt > static_cast<Real>(params_.verify_gap_s)) Kalman::doubt_inclination(s_);
        s_.rate_rad_s = rate;
        const Vector half = (dt / 2) * mean;
        const Real half2 = dot(half, half);
        const Rotation half_turn = turn_quat(half, half2);
        const Rotation middle = s_.q_wb * half_turn;
        s_.q_wb = middle * half_turn;

        // a reading is a mean over the interval before its time stamp: seen from its middle
        const BasicMat3<Real> axes = matrix_of(middle);
        if (has_force && !told_clipped && dot(read, read) < s_.accel_end2)
            add_force(axes, read, dt);
        else
            add_doubtful_force(axes, read, dt, has_force, told_clipped);
        if constexpr (has_field) add_field(axes, sample);
        auto& w = s_.sums;
        w.time += dt;
        w.turn += Real{2} * half;
        w.turn2 += 4 * half2;
        ++w.count;

        std::uint32_t flags = s_.flags & (flag::settling | flag::mag_rejected);
        if (rest && s_.still.still) flags |= flag::rest;
        if (s_.doubted) flags |= flag::settling;
        if (blind || (has_accel && (told_clipped || !has_force))) flags |= flag::clipped;
        s_.flags = static_cast<std::uint16_t>(flags);
        if (s_.phase == AttitudePhase::aligning)
            align();
        else
            filter();
    }

    /// One part; where samples are so rare that the parts outlast the window, it lasts as long.
    void filter() noexcept {
        const auto& w = s_.sums;
        const auto step_s = static_cast<Real>(params_.step_s);
        if (s_.part == Kalman::idle) {
            if (w.time + s_.period_s / 2 < step_s) return;
            Kalman::close_window(s_, params_);
            return;
        }
        if (s_.part == Kalman::turn_y) {  // not with the dearest sample
            judge_alive(s_.alive, params_, s_.bias_rad_s, s_.period_s, s_.rest.quiet_s > 0);
            judge_rest(s_.rest, params_, s_.means.time);
        }
        Kalman::advance(s_, params_);
        if (s_.part == Kalman::idle) judge();
    }

    /// Flags that change with the Kalman step, and the end of an orientation that is lost.
    void judge() noexcept {
        const auto squared = [](float x) { return static_cast<Real>(x * x); };
        constexpr float lost = 0.8f;  // rad: beyond it a linear filter is worse than a new start
        const Real limit = static_cast<Real>(params_.bias_max_rad_s);
        const Vector& b = s_.bias_rad_s;
        bool settled = tilt_variance() + motion_variance() <= squared(params_.settled_tilt) &&
                       approx::absolute(b.x) < limit && approx::absolute(b.y) < limit &&
                       approx::absolute(b.z) < limit;
        std::uint32_t flags = s_.flags & ~(flag::settling | flag::mag_rejected);
        if constexpr (has_field) {
            settled = settled && heading_variance() <= squared(params_.settled_heading);
            if (s_.field.residual2 > squared(params_.field_disturbed_uT))
                flags |= flag::mag_rejected;
        }
        if (s_.doubted && s_.force_s >= static_cast<Real>(params_.verify_s) &&
            !Kalman::force_is_off(s_, params_.force_tilt))
            s_.doubted = false;
        const bool proven = is_proven();
        settled = settled && !s_.doubted && proven;
        if (!settled) flags |= flag::settling;
        s_.flags = static_cast<std::uint16_t>(flags);
        s_.tilted_s =
            Kalman::force_is_off(s_, params_.force_lost) ? s_.tilted_s + s_.means.time : 0;
        if (contradicted()) {
            // nothing was lost or wrong: what the wrong inclination taught was wrong, too
            if (!s_.doubted && !s_.still.rested) Kalman::start(s_, params_);
            Kalman::lose_orientation(s_);
        }
        if (tilt_variance() > squared(lost) && s_.blind_s <= 0) {
            s_.phase = AttitudePhase::aligning;
            s_.velocity_m_s = {};
            s_.sums = {};
            if constexpr (has_field) {
                s_.field.sum = {};
                s_.field.count = 0;
            }
        }
    }

    /// Nothing contradicts the inclination, and after a start in motion nothing has for prove_s:
    /// a vehicle in a bend, or a drone, shows its acceleration as gravity until it changes. Asked
    /// once a Kalman step.
    bool is_proven() noexcept {
        const auto& c = s_.corrected;
        const auto most = static_cast<Real>(params_.corrected_max);
        const bool good = c[0] * c[0] + c[1] * c[1] <= most * most &&
                          !Kalman::force_is_off(s_, params_.force_tilt);
        if (s_.unproven_ms == 0) return good;
        constexpr Real ms = 1000;
        const auto step_ms = static_cast<std::uint16_t>(ms * (std::min)(s_.means.time, Real{1}));
        if (resting() || s_.unproven_ms <= step_ms)
            s_.unproven_ms = 0;
        else
            s_.unproven_ms = static_cast<std::uint16_t>(s_.unproven_ms - step_ms);
        if (!good)
            s_.unproven_ms = static_cast<std::uint16_t>(ms * static_cast<Real>(params_.prove_s));
        return good && s_.unproven_ms == 0;
    }

    /// Do the accelerometer's readings say that the inclination is wrong?
    bool contradicted() const noexcept {
        constexpr float upside_down = -2;  // m/s^2, mean vertical force
        constexpr float far_off = 1.05f;   // rad: no motion keeps the mean force there for verify_s
        const bool verified = s_.force_s >= static_cast<Real>(params_.verify_s);
        if (verified && s_.doubted && Kalman::force_is_off(s_, far_off)) return true;
        return (verified && s_.force_m_s2.z < static_cast<Real>(upside_down)) ||
               s_.tilted_s > static_cast<Real>(params_.force_lost_s);
    }

    /// Levels on the mean specific force so far, and turns to the mean field.
    void align() noexcept {
        auto& w = s_.sums;
        const Vector up{s_.velocity_m_s[0], s_.velocity_m_s[1], w.lift};
        const Rotation before = s_.q_wb;
        s_.q_wb = levelled(before, up);
        w.lift = norm(up);
        s_.velocity_m_s = {};
        if constexpr (has_field) {
            Vector& sum = s_.field.sum;
            sum = rotate(s_.q_wb * conj(before), sum);
            if (s_.field.count > 0) {
                s_.q_wb = about_up(approx::atan2(sum.x, sum.y)) * s_.q_wb;
                sum = {0, approx::sqrt(sum.x * sum.x + sum.y * sum.y), sum.z};
            }
        }
        if (w.time < static_cast<Real>(params_.align_s)) return;
        if constexpr (has_field) start_field(s_.field, params_);
        Kalman::aligned(s_, params_);
        s_.phase = AttitudePhase::running;
    }

    /// Keeps the typical period up to date; true for a step that lost samples.
    bool is_gap(Real dt) noexcept {
        if (s_.period_s <= 0) s_.period_s = dt;
        const bool gap = dt > static_cast<Real>(params_.gap_periods) * s_.period_s;
        const Real share = static_cast<Real>(dt < s_.period_s ? 0.25 : gap ? 1.0 / 256 : 1.0 / 64);
        s_.period_s += share * (dt - s_.period_s);
        return gap;
    }

    /// The mean rate over a gap, linear between its ends, and what may have happened in it.
    Vector bridge(const Vector& rate, Real dt) noexcept {
        const Vector change = rate - s_.rate_rad_s;
        const auto walk = static_cast<Real>(params_.rate_walk);
        s_.sums.doubt_angle2 += dt * dt * (dot(change, change) + walk * walk * dt) / 12;
        return static_cast<Real>(0.5) * (rate + s_.rate_rad_s);
    }

    /// A clipped or dead axis: the angle missed grows with the time it lasts.
    bool doubt_gyro(const Sample& sample, Real dt) noexcept {
        const bool clipped = is_clipped(sample, flag::gyro_clipped) ||
                             at_range_end(sample.gyro_rad_s, params_.gyro_full_scale_rad_s);
        const bool dead = s_.alive.gyro_dead;
        if (!clipped && !dead) {
            s_.blind_s = 0;
            return false;
        }
        constexpr float beyond_range = 0.2f;  // of the reading: how much a clipped one may miss
        constexpr float dead_rad_s = 1.0f;
        const auto reading = static_cast<Real>(beyond_range) * norm(widen(sample.gyro_rad_s));
        const Real missed = dead ? static_cast<Real>(dead_rad_s) : reading;
        // (missed * t)^2 grows by this much
        s_.sums.doubt_angle2 += missed * missed * dt * (2 * s_.blind_s + dt);
        s_.blind_s += dt;
        return true;
    }

    bool accel_clipped(const Sample& sample) const noexcept {
        return is_clipped(sample, flag::accel_clipped) ||
               at_range_end(sample.accel_m_s2, params_.accel_full_scale_m_s2);
    }

    void add_force(const BasicMat3<Real>& axes, const Vector& accel, Real dt) noexcept {
        const Vector force = axes * accel;
        s_.velocity_m_s[0] += dt * force.x;
        s_.velocity_m_s[1] += dt * force.y;
        s_.sums.lift += dt * force.z;
    }

    /// Not measured, or large: perhaps at the end of the range. The true force of a clipped axis is
    /// beyond the reading, by accel_beyond of it on average.
    [[gnu::noinline, gnu::cold]] void add_doubtful_force(const BasicMat3<Real>& axes,
                                                         const Vector& read, Real dt, bool measured,
                                                         bool told_clipped) noexcept {
        const Vector square{read.x * read.x, read.y * read.y, read.z * read.z};
        const Real largest2 = (std::max)(square.x, (std::max)(square.y, square.z));
        if (told_clipped || !measured) Kalman::suspend_force(s_, params_);
        // whatever clips at less than the least range is no accelerometer
        measured = measured && !(told_clipped && largest2 < static_cast<Real>(usual_end2));
        if (measured && !told_clipped &&
            (params_.accel_full_scale_m_s2 > 0 || !at_usual_end(s_.accel_end2, largest2))) {
            add_force(axes, read, dt);
            return;
        }
        // the velocity has wandered within its bound
        const auto speed = static_cast<Real>(params_.velocity_m_s);
        s_.sums.doubt_velocity2 += 2 * speed * speed * dt / static_cast<Real>(params_.velocity_s);
        if (!measured) {
            s_.sums.lift += dt * static_cast<Real>(gravity_m_s2);
            return;
        }
        constexpr Real most2 = 1e8f;  // (m/s^2)^2: what no part measures is not made larger
        constexpr Real near_it = (1 - usual_range_error) * (1 - usual_range_error);
        const Real beyond = 1 + static_cast<Real>(params_.accel_beyond);
        const auto whole = [&](Real x, Real x2) {
            return x2 < near_it * largest2 || x2 > most2 ? x : beyond * x;
        };
        add_force(axes, {whole(read.x, square.x), whole(read.y, square.y), whole(read.z, square.z)},
                  dt);
    }

    /// Of the magnetometer. Zero is not a field: a part that does not answer reads so.
    static bool has_reading(const Sample& sample) noexcept {
        return valid(sample, flag::mag_valid, sample.mag_uT) && !is_zero(sample.mag_uT);
    }

    void add_field(const BasicMat3<Real>& axes, const Sample& sample) noexcept {
        if (!has_reading(sample)) return;
        if ((sample.flags & flag::mag_clipped) != 0) return;
        s_.field.sum += axes * widen(sample.mag_uT);
        ++s_.field.count;
    }

    std::optional<Pose> pose(const Sample& sample, bool known = true) const noexcept {
        std::optional<Pose> out{std::in_place};
        out->t_ns = sample.t_ns;
        out->q_wb = {static_cast<float>(s_.q_wb.w), static_cast<float>(s_.q_wb.x),
                     static_cast<float>(s_.q_wb.y), static_cast<float>(s_.q_wb.z)};
        out->flags = s_.flags | (sample.flags & (flag::gap_before | flag::new_run)) |
                     (known ? flag::orientation_valid : flag::settling);
        return out;
    }

    AttitudeParams params_;
    std::int32_t gap_ns_max_{};
    State s_;
};

using Attitude = BasicAttitude<float, AttitudeMode::imu_mag>;
using AttitudeImu = BasicAttitude<float, AttitudeMode::imu>;

static_assert(sizeof(Attitude::State) <= 1000 && sizeof(AttitudeImu::State) <= 1000);

}  // namespace fairlead
