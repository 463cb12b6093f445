#pragma once
// Motions for tests: smooth curves with noise, made in double from a seed.
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "fairlead/base/types.hpp"

namespace fairlead::test {

using Eigen::Quaterniond;
using Eigen::Vector3d;

inline Vector3d to_double(const Vec3& v) { return {v.x, v.y, v.z}; }
inline Quaterniond to_double(const Quat& q) { return Quaterniond(q.w, q.x, q.y, q.z).normalized(); }
inline Vec3 to_float(const Vector3d& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}
inline Quat to_float(const Quaterniond& q) {
    return {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()),
            static_cast<float>(q.z())};
}

/// Unit quaternion of a rotation vector, and back, by way of sin and atan2.
inline Quaterniond exp_d(const Vector3d& r) {
    const double a = r.norm();
    const Vector3d v = a > 0 ? Vector3d(r * (std::sin(a / 2) / a)) : Vector3d(r / 2);
    return {std::cos(a / 2), v.x(), v.y(), v.z()};
}
inline Vector3d log_d(Quaterniond q) {
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    const double n = q.vec().norm();
    return n > 0 ? Vector3d(q.vec() * (2 * std::atan2(n, q.w()) / n)) : Vector3d(2 * q.vec());
}
inline double angle_d(const Quaterniond& a, const Quaterniond& b) {
    return log_d(a.conjugate() * b).norm();
}

struct MotionPlan {
    std::size_t n = 300;
    double step_s = 1 / 120.0;
    double size_m = 0.5;    // amplitude of each of three sines an axis
    double rate_rad_s = 2;  // typical angular rate
    double noise_m = 0.002;
    double noise_rad = 0.02;  // normal, per axis
    double jitter = 0;        // of the time step, as a part of it
};

class Motions {
  public:
    explicit Motions(std::uint32_t seed) : random_{seed} {}

    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    Vector3d normal(double sigma) {
        std::normal_distribution<double> d(0, 1);
        return sigma * Vector3d(d(random_), d(random_), d(random_));
    }
    Quaterniond rotation() {
        std::normal_distribution<double> d(0, 1);
        return Quaterniond(d(random_), d(random_), d(random_), d(random_)).normalized();
    }
    bool chance(double p) { return uniform(0, 1) < p; }

    std::vector<Pose> make(const MotionPlan& plan) {
        Vector3d p_phase[3], p_hz[3], w_phase[3], w_hz[3];
        for (int k = 0; k < 3; ++k) {
            for (int a = 0; a < 3; ++a) {
                p_phase[k][a] = uniform(0, 6.28), w_phase[k][a] = uniform(0, 6.28);
                p_hz[k][a] = uniform(0.05, 1.5), w_hz[k][a] = uniform(0.05, 1.5);
            }
        }
        std::vector<Pose> motion(plan.n);
        Quaterniond q = rotation();
        double t = 1;
        for (auto& pose : motion) {
            const double dt = plan.step_s * (1 + plan.jitter * uniform(-1, 1));
            Vector3d p = Vector3d::Zero(), w = Vector3d::Zero();
            for (int k = 0; k < 3; ++k) {
                for (int a = 0; a < 3; ++a) {
                    p[a] +=
                        plan.size_m / 3 * std::sin(6.283185307 * p_hz[k][a] * t + p_phase[k][a]);
                    w[a] +=
                        plan.rate_rad_s * std::sin(6.283185307 * w_hz[k][a] * t + w_phase[k][a]);
                }
            }
            pose.t_ns = std::llround(t * 1e9);
            pose.p_w_m = to_float(p + normal(plan.noise_m));
            pose.q_wb = to_float((q * exp_d(normal(plan.noise_rad))).normalized());
            pose.flags = flag::position_valid | flag::orientation_valid;
            t += dt;
            q = (q * exp_d(w * dt)).normalized();
        }
        return motion;
    }

  private:
    std::mt19937 random_;
};

/// The seed of this run, printed where a test fails: SCOPED_TRACE(seed_text()).
inline std::uint32_t seed() {
    static const std::uint32_t value = [] {
        const char* text = std::getenv("FAIRLEAD_SEED");
        return text ? static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10))
                    : std::random_device{}();
    }();
    return value;
}
inline std::string seed_text() { return "FAIRLEAD_SEED=" + std::to_string(seed()); }

}  // namespace fairlead::test
