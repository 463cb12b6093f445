#include "host_sim/study/baselines/ahrs/ahrs.hpp"

#include <cmath>

namespace fairlead::sim {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d wide(const Vec3& v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

Quaterniond turn(const Vector3d& r) {
    const double angle = r.norm();
    return angle > 0 ? Quaterniond(Eigen::AngleAxisd(angle, r / angle)) : Quaterniond::Identity();
}

/// Where the world's up and the field's direction in the world ought to be seen, body frame. The
/// field's reference is its own horizontal and vertical part, as Madgwick and Mahony both have it.
struct Seen {
    Vector3d up, field;
};
Seen expected(const Quaterniond& q_wb, const Vector3d& field_b) {
    const Vector3d w = q_wb * field_b;
    const Vector3d reference{0, std::hypot(w.x(), w.y()), w.z()};
    return {q_wb.conjugate() * Vector3d::UnitZ(), q_wb.conjugate() * reference};
}

/// [Madgwick, Harrison, Vaidyanathan, ICORR 2011]: a normalised gradient step against gyro drift.
class Madgwick final : public Ahrs {
  public:
    explicit Madgwick(const AhrsGain& gain) : beta_{gain.first} {}

  protected:
    Vector3d rate(const Vector3d& gyro, const Vector3d& accel, const Vector3d& field,
                  double) override {
        // The gradient of sum |seen - expected|^2 / 2 over a body rotation is a sum of cross
        // products; in quaternion form, as printed, its length is the same up to the factor 2.
        const Seen e = expected(q_wb_, field);
        Vector3d down_hill = accel.cross(e.up);
        if (field.squaredNorm() > 0) down_hill += field.cross(e.field);
        const double n = down_hill.norm();
        return n > 0 ? Vector3d(gyro + 2 * beta_ / n * down_hill) : gyro;
    }

  private:
    double beta_;
};

/// [Mahony, Hamel, Pflimlin, IEEE TAC 2008], explicit complementary filter with bias.
class Mahony final : public Ahrs {
  public:
    explicit Mahony(const AhrsGain& gain) : k_p_{gain.first}, k_i_{gain.integral} {}

  protected:
    Vector3d rate(const Vector3d& gyro, const Vector3d& accel, const Vector3d& field,
                  double dt_s) override {
        const Seen e = expected(q_wb_, field);
        Vector3d error = accel.cross(e.up);
        if (field.squaredNorm() > 0) error += field.cross(e.field);
        bias_ -= k_i_ * dt_s * error;
        return gyro - bias_ + k_p_ * error;
    }

  private:
    double k_p_, k_i_;
    Vector3d bias_{Vector3d::Zero()};
};

/// Tilt follows gravity and heading follows the field, both with one time constant; each is moved
/// apart from the other, unlike in Madgwick's and Mahony's.
class Complementary final : public Ahrs {
  public:
    explicit Complementary(const AhrsGain& gain) : tau_s_{gain.first} {}

  protected:
    Vector3d rate(const Vector3d& gyro, const Vector3d& accel, const Vector3d& field,
                  double) override {
        const Seen e = expected(q_wb_, field);
        Vector3d correction = accel.cross(e.up);
        if (field.squaredNorm() > 0) {
            const Vector3d w = q_wb_ * field;
            correction += std::atan2(w.x(), w.y()) * e.up;
        }
        return gyro + correction / tau_s_;
    }

  private:
    double tau_s_;
};

template <class Kind>
std::unique_ptr<Ahrs> make(const AhrsGain& gain) {
    return std::make_unique<Kind>(gain);
}

std::vector<AhrsGain> plain(std::initializer_list<double> gains) {
    std::vector<AhrsGain> out;
    for (const double gain : gains) out.push_back({gain, 0});
    return out;
}
std::vector<AhrsGain> with_integral(std::initializer_list<double> gains,
                                    std::initializer_list<double> integrals) {
    std::vector<AhrsGain> out;
    for (const double gain : gains)
        for (const double integral : integrals) out.push_back({gain, integral});
    return out;
}

}  // namespace

const Quaterniond& Ahrs::update(const Sample& sample, double dt_s, bool use_field) {
    const Vector3d accel = wide(sample.accel_m_s2).normalized();
    const Vector3d field = use_field ? wide(sample.mag_uT).normalized() : Vector3d(0, 0, 0);
    if (!started_) {
        started_ = true;
        q_wb_ = Quaterniond::FromTwoVectors(accel, Vector3d::UnitZ());
        const Vector3d w = q_wb_ * field;
        if (use_field) q_wb_ = turn({0, 0, std::atan2(w.x(), w.y())}) * q_wb_;
        return q_wb_;
    }
    const Vector3d rate_b = rate(wide(sample.gyro_rad_s), accel, field, dt_s);
    q_wb_ = (q_wb_ * turn(dt_s * rate_b)).normalized();
    return q_wb_;
}

const std::vector<AhrsKind>& ahrs_kinds() {
    static const std::vector<AhrsKind> kinds{
        {"Madgwick", plain({0.01, 0.02, 0.03, 0.05, 0.08, 0.12, 0.2}), make<Madgwick>},
        {"Mahony",
         with_integral({0.03, 0.06, 0.12, 0.25, 0.5, 1, 2, 4}, {0, 3e-4, 1e-3, 3e-3, 1e-2}),
         make<Mahony>},
        {"complementary", plain({0.5, 1, 2, 4, 8, 16}), make<Complementary>},
    };
    return kinds;
}

}  // namespace fairlead::sim
