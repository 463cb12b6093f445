#pragma once
// Fits for a gyro, on the board, in fixed memory: bias and noise from a rest, bias over temperature
// from several rests, scale from a turn of known angle. Each says Status::not_enough_data until it
// can answer, and Status::bad_data where the data contradict the procedure.
#include "fairlead/base/status.hpp"
#include "fairlead/math/quat.hpp"
#include "fairlead/sense/calibrate_fit.hpp"

namespace fairlead {

struct GyroBias {
    Vec3 bias_rad_s{};
    float noise_rad_s{};  // standard deviation of one sample
    float random_walk{};  // rad/sqrt(s), from neighbours: the Allan deviation at 1 s
    float uncertainty{};  // quality: standard error of the bias, rad/s
};

/// Lie still for some seconds.
class GyroBiasFit {
  public:
    static constexpr float seconds_min = 2;
    static constexpr float moved_rad_s = 0.03f;  // a larger deviation is motion, not noise

    void push(const Vec3& gyro_rad_s, float dt_s) noexcept {
        if (!is_finite(gyro_rad_s)) return;
        if (moments_.count() > 0) {
            const Vec3 step = gyro_rad_s - before_;
            difference2_ += dot(step, step) / 3;
            seconds_ += dt_s;
        }
        before_ = gyro_rad_s;
        moments_.push(gyro_rad_s);
    }
    void reset() noexcept { *this = {}; }

    Result<GyroBias> result() const noexcept {
        if (seconds_ < seconds_min || moments_.count() < 20) return Status::not_enough_data;
        if (!(moments_.deviation() <= moved_rad_s)) return Status::bad_data;
        const auto steps = static_cast<float>(moments_.count() - 1);
        GyroBias out;
        out.bias_rad_s = moments_.mean();
        out.noise_rad_s = moments_.deviation();
        out.random_walk = approx::sqrt(difference2_ / 2 / steps * (seconds_ / steps));
        out.uncertainty = out.noise_rad_s / approx::sqrt(steps);
        return out;
    }

  private:
    Moments moments_{};
    Vec3 before_{};
    float difference2_{0}, seconds_{0};
};

struct GyroDrift {
    Vec3 bias_rad_s{};  // at temperature_C
    Vec3 per_K{};
    float temperature_C{};
    float residual_rad_s{};  // quality: RMS distance of the rests from the line
};

/// One bias for each of several rests at different temperatures: a line through them.
class GyroTemperatureFit {
  public:
    static constexpr float span_K_min = 5;

    void push(const Vec3& bias_rad_s, float temperature_C) noexcept {
        if (count_ == 0) origin_C_ = low_C_ = high_C_ = temperature_C;
        low_C_ = temperature_C < low_C_ ? temperature_C : low_C_;
        high_C_ = temperature_C > high_C_ ? temperature_C : high_C_;
        const float t = temperature_C - origin_C_;
        ++count_;
        t_ += t;
        tt_ += t * t;
        b_ += bias_rad_s;
        tb_ += t * bias_rad_s;
        bb_ += dot(bias_rad_s, bias_rad_s);
    }

    Result<GyroDrift> result() const noexcept {
        if (count_ < 3 || high_C_ - low_C_ < span_K_min) return Status::not_enough_data;
        const float n = static_cast<float>(count_), mean_t = t_ / n;
        const float spread = tt_ - t_ * mean_t;
        GyroDrift out;
        out.per_K = (1 / spread) * (tb_ - mean_t * b_);
        out.temperature_C = origin_C_ + mean_t;
        out.bias_rad_s = (1 / n) * b_;
        const float left2 =
            bb_ - n * dot(out.bias_rad_s, out.bias_rad_s) - spread * dot(out.per_K, out.per_K);
        out.residual_rad_s = approx::sqrt((left2 > 0 ? left2 : 0) / (3 * n));
        if (!is_finite(out.per_K) || !is_finite(out.bias_rad_s) ||
            !approx::is_finite(out.residual_rad_s) || !approx::is_finite(out.temperature_C))
            return Status::bad_data;
        return out;
    }

  private:
    std::uint32_t count_{0};
    float origin_C_{0}, low_C_{0}, high_C_{0}, t_{0}, tt_{0}, bb_{0};
    Vec3 b_{}, tb_{};
};

struct GyroScale {
    float factor{1};       // true over measured
    float off_axis_rad{};  // quality: how far the turn strayed from its axis
};

/// Turn the board about one of its axes by a known angle, from rest to rest.
class GyroTurnFit {
  public:
    static constexpr float angle_rad_min = 1.5f;
    static constexpr float off_axis_rad_max = 0.2f;
    static constexpr float factor_error_max = 0.2f;

    /// gyro: without its bias. axis: 0, 1, 2.
    void push(const Vec3& gyro_rad_s, float dt_s) noexcept {
        turned_ += dt_s * gyro_rad_s;
        // the turn as it is, in three dimensions: shows whether the axis stayed where it was
        q_ = normalised(q_ * from_rotation_vector(dt_s * gyro_rad_s));
    }
    void reset() noexcept { *this = {}; }

    Result<GyroScale> result(std::size_t axis, float angle_rad) const noexcept {
        FAIRLEAD_ASSERT(axis < 3);
        if (!is_finite(turned_)) return Status::bad_data;  // a part of the turn is missing
        const float measured = component(turned_, axis);
        if (approx::absolute(measured) < angle_rad_min) return Status::not_enough_data;
        GyroScale out;
        out.factor = angle_rad / measured;
        const Vec3 along{axis == 0 ? 1.0f : 0, axis == 1 ? 1.0f : 0, axis == 2 ? 1.0f : 0};
        const Vec3 seen = rotate(q_, along);
        const float c = dot(seen, along);
        out.off_axis_rad = approx::acos(c);
        if (!(approx::absolute(out.factor - 1) <= factor_error_max) ||
            !(out.off_axis_rad <= off_axis_rad_max))
            return Status::bad_data;
        return out;
    }

  private:
    Vec3 turned_{};
    Quat q_{};
};

}  // namespace fairlead
