#pragma once
// Orientation from a gyro alone, relative to the start: exact strapdown, and a bias that is learned
// whenever the board rests (a Kalman filter of one state an axis). Without gravity nothing else is
// observable: the error grows with time and turning. Cost: no loop. Latency: 0.
#include <algorithm>
#include <optional>

#include "fairlead/sense/attitude.hpp"
#include "fairlead/sense/clip.hpp"

namespace fairlead {

template <class Real>
struct AttitudeState<Real, AttitudeMode::gyro> {
    static constexpr std::uint32_t saved_version = 1;

    std::int64_t t_ns{};
    BasicQuat<Real> q_wb{};
    BasicVec3<Real> bias_rad_s{};
    BasicVec3<Real> rate_rad_s{};
    Real bias_variance{};
    RestState<Real> rest{};
    bool started{};
};

template <class Real>
class BasicAttitude<Real, AttitudeMode::gyro> {
    using Vector = BasicVec3<Real>;

  public:
    using State = AttitudeState<Real, AttitudeMode::gyro>;
    static constexpr std::size_t latency = 0;

    explicit BasicAttitude(const AttitudeParams& params = {}) noexcept : params_{params} {
        reset();
    }
    void reset() noexcept {
        s_ = State{};
        s_.bias_variance = squared(params_.bias_rad_s);
    }

    /// Empty: no time has passed, or the gyro has not spoken yet.
    std::optional<Pose> push(const Sample& sample) noexcept {
        const bool usable = (sample.flags & flag::gyro_valid) != 0 && is_finite(sample.gyro_rad_s);
        const Vector gyro{static_cast<Real>(sample.gyro_rad_s.x),
                          static_cast<Real>(sample.gyro_rad_s.y),
                          static_cast<Real>(sample.gyro_rad_s.z)};
        if (!s_.started) {
            if (!usable) return std::nullopt;
            s_.started = true;
            s_.t_ns = sample.t_ns;
            s_.rate_rad_s = gyro;
            start_rest(s_.rest, params_, gyro, Vector{});
            return pose(sample, flag::orientation_valid);
        }
        if ((sample.flags & flag::new_run) != 0) return resume(sample, usable, gyro);
        if (sample.t_ns <= s_.t_ns) return std::nullopt;
        if (!usable) return pose(sample, 0);
        // a gap of any length is bridged: there is nothing better to do
        const std::uint64_t step_ns =
            static_cast<std::uint64_t>(sample.t_ns) - static_cast<std::uint64_t>(s_.t_ns);
        const auto dt = static_cast<Real>(step_ns) * static_cast<Real>(1e-9);
        s_.t_ns = sample.t_ns;
        const bool clipped = is_clipped(sample, flag::gyro_clipped) ||
                             at_range_end(sample.gyro_rad_s, params_.gyro_full_scale_rad_s);
        const bool rest = notice_rest(gyro, dt) && !clipped;
        learn_bias(rest, dt);
        const Vector rate = gyro - s_.bias_rad_s;
        const bool gap = (sample.flags & flag::gap_before) != 0;
        const Vector mean = gap ? static_cast<Real>(0.5) * (rate + s_.rate_rad_s) : rate;
        s_.rate_rad_s = rate;
        const Vector turn = dt * mean;
        s_.q_wb = normalised(s_.q_wb * turn_quat(turn, dot(turn, turn)));
        return pose(sample, flag::orientation_valid | (rest ? flag::rest : 0u) |
                                (clipped ? flag::clipped : 0u));
    }
    static constexpr std::optional<Pose> flush() noexcept { return std::nullopt; }

    BasicQuat<Real> orientation() const noexcept { return s_.q_wb; }
    Vector rate_rad_s() const noexcept { return s_.rate_rad_s; }
    Vector bias_rad_s() const noexcept { return s_.bias_rad_s; }
    BasicQuat<Real> predict(Real dt_s) const noexcept {
        const Vector r = dt_s * s_.rate_rad_s;
        return normalised(s_.q_wb * turn_quat(r, dot(r, r)));
    }

    const State& state() const noexcept { return s_; }
    void restore_all(const State& known) noexcept { s_ = known; }

  private:
    static Real squared(float x) noexcept { return static_cast<Real>(x) * static_cast<Real>(x); }

    /// A new run: its clock has nothing to do with the one before. Nothing tells how far the body
    /// turned meanwhile, so the orientation stays.
    Pose resume(const Sample& sample, bool usable, const Vector& gyro) noexcept {
        s_.t_ns = sample.t_ns;
        if (usable) s_.rate_rad_s = gyro - s_.bias_rad_s;
        start_rest(s_.rest, params_, s_.rate_rad_s + s_.bias_rad_s, Vector{});
        return pose(sample, usable ? +flag::orientation_valid : 0u);
    }
    /// One sample after a long gap is no rest, however long the gap.
    bool notice_rest(const Vector& gyro, Real dt) noexcept {
        if (dt > static_cast<Real>(params_.gap_s_max)) {
            start_rest(s_.rest, params_, gyro, Vector{});
            return false;
        }
        judge_rest(s_.rest, params_, dt);
        return update_rest(s_.rest, params_, gyro, Vector{}, dt) && believable();
    }
    /// A mean rate that contradicts the known bias is a slow turn: nothing here can tell otherwise.
    bool believable() const noexcept {
        const Vector off = s_.rest.gyro - s_.bias_rad_s;
        const auto limit = static_cast<Real>(params_.bias_max_rad_s);
        const Vector& mean = s_.rest.gyro;
        if (approx::absolute(mean.x) > limit || approx::absolute(mean.y) > limit ||
            approx::absolute(mean.z) > limit)
            return false;
        const bool known = 4 * s_.bias_variance < squared(params_.bias_rad_s);
        const Real gate2 = squared(params_.rest_gate) * 3 * s_.bias_variance;
        return !known || dot(off, off) <= gate2 + squared(params_.rest_gate_rad_s);
    }
    void learn_bias(bool rest, Real dt) noexcept {
        s_.bias_variance = (std::min)(s_.bias_variance + squared(params_.bias_walk) * dt,
                                      squared(params_.bias_rad_s));
        if (!rest) return;
        const Real noise2 =
            squared(params_.rest_rate_rad_s) * static_cast<Real>(params_.rest_window_s);
        const Real gain = s_.bias_variance / (s_.bias_variance + noise2 / dt);
        s_.bias_rad_s += gain * (s_.rest.gyro - s_.bias_rad_s);
        s_.bias_variance -= gain * s_.bias_variance;
    }
    Pose pose(const Sample& sample, std::uint32_t flags) const noexcept {
        Pose out;
        out.t_ns = sample.t_ns;
        out.q_wb = {static_cast<float>(s_.q_wb.w), static_cast<float>(s_.q_wb.x),
                    static_cast<float>(s_.q_wb.y), static_cast<float>(s_.q_wb.z)};
        out.flags = flags | (sample.flags & (flag::gap_before | flag::new_run));
        return out;
    }

    AttitudeParams params_;
    State s_;
};

using AttitudeGyro = BasicAttitude<float, AttitudeMode::gyro>;

}  // namespace fairlead
