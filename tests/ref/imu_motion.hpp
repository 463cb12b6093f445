#pragma once
// An inertial sensor on a hand with known truth: rests, then turns and shakes; what it reads at any
// rate, with the errors of a real part. In double, by many small exact turns.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "fairlead/base/types.hpp"
#include "host_sim/generate/random.hpp"
#include "tests/ref/rotation.hpp"

namespace ref {

using fairlead::Quat;
using fairlead::Sample;
using fairlead::Vec3;

struct World {
    double rate_hz{1e3 / 3.5};
    double horizontal_uT{18}, up_uT{-42};  // magnetic north is the world's north
    V bias{0.004, -0.006, 0.003};
    double gyro_noise{0.002}, accel_noise{0.02}, mag_noise{0.3};  // of a sample, standard deviation
    double gyro_step{0}, accel_step{0}, mag_step{0};              // of the counts; 0: none
    double scale_x{0};
    V accel_bias{}, mag_bias_uT{};
    double speed{1};     // of the turns: 1 is up to 2.6 rad/s
    double still_s{10};  // at rest at first
    double jitter{0};    // of the time steps, a share of them
    int mag_every{1};    // one magnetometer reading in so many samples
    std::uint64_t seed{1};
};

class ImuMotion {
  public:
    explicit ImuMotion(const World& world) : w_{world}, random_{world.seed} {}

    Sample next() {
        const double dt = (1 + w_.jitter * (2 * random_.uniform() - 1)) / w_.rate_hz;
        advance(dt);
        Sample s;
        s.t_ns = std::llround(t_ * 1e9);
        s.flags = fairlead::flag::gyro_valid | fairlead::flag::accel_valid;
        mean_rate_[0] *= 1 + w_.scale_x;
        s.gyro_rad_s = read(mean_rate_ + w_.bias, w_.gyro_noise, w_.gyro_step);
        s.accel_m_s2 = read(mean_force_ + w_.accel_bias, w_.accel_noise, w_.accel_step);
        if (n_++ % w_.mag_every == 0) {
            s.flags |= fairlead::flag::mag_valid;
            s.mag_uT = read(mean_field_ + w_.mag_bias_uT, w_.mag_noise, w_.mag_step);
        }
        return s;
    }
    const Q& truth() const { return truth_; }
    double time() const { return t_; }
    V to_body(const V& v) const {
        const Q q = mul(mul(inverse(truth_), {0, v[0], v[1], v[2]}), truth_);
        return {q[1], q[2], q[3]};
    }

  private:
    /// What the sensors show are means over the interval.
    void advance(double dt) {
        const int parts = std::max(8, static_cast<int>(dt / 4e-4));
        mean_rate_ = mean_force_ = mean_field_ = {};
        for (int i = 0; i < parts; ++i) {
            const double t = t_ + (i + 0.5) * dt / parts;
            const V half = (dt / parts / 2) * rate_at(t);
            truth_ = unit(mul(truth_, from_vector(half)));
            mean_rate_ = mean_rate_ + (1.0 / parts) * rate_at(t);
            const V a = accel_at(t);
            mean_force_ = mean_force_ + (1.0 / parts) * to_body({a[0], a[1], 9.81 + a[2]});
            mean_field_ = mean_field_ + (1.0 / parts) * to_body({0, w_.horizontal_uT, w_.up_uT});
            truth_ = unit(mul(truth_, from_vector(half)));
        }
        t_ += dt;
    }
    V rate_at(double t) const {
        if (t < w_.still_s) return {};
        const double u = w_.speed * (t - w_.still_s);
        return w_.speed *
               V{1.5 * std::sin(1.1 * u), 1.2 * std::sin(0.7 * u + 1), 1.8 * std::sin(0.5 * u)};
    }
    V accel_at(double t) const {
        if (t < w_.still_s) return {};
        const double u = t - w_.still_s;  // a velocity of at most 0.7 m/s
        return {2.0 * std::cos(4 * u), 1.5 * std::sin(5 * u), std::sin(3 * u)};
    }
    Vec3 read(const V& v, double sigma, double step) {
        const auto one = [&](double x) {
            const double y = x + sigma * random_.normal();
            return static_cast<float>(step > 0 ? std::round(y / step) * step : y);
        };
        const float x = one(v[0]), y = one(v[1]), z = one(v[2]);
        return {x, y, z};
    }

    World w_;
    fairlead::sim::Random random_;
    Q truth_{unit({0.8, 0.3, -0.4, 0.2})};
    V mean_rate_{}, mean_force_{}, mean_field_{};
    double t_{0};
    int n_{0};
};

struct AttitudeErrors {
    double total_deg{}, heading_deg{}, inclination_deg{};
};

inline AttitudeErrors attitude_errors(const Q& estimate, const Q& truth) {
    constexpr double deg = 0.017453292519943295;
    const Q e = unit(mul(estimate, inverse(truth)));
    const double w = std::abs(e[0]);
    return {2 * std::acos(std::min(1.0, w)) / deg, 2 * std::atan2(std::abs(e[3]), w) / deg,
            2 * std::acos(std::min(1.0, std::hypot(e[0], e[3]))) / deg};
}
inline AttitudeErrors attitude_errors(const Quat& q, const Q& truth) {
    return attitude_errors(of(q), truth);
}

}  // namespace ref
