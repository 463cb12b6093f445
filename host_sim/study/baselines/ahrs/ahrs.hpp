#pragma once
// The three orientation filters that everybody knows, written plainly in double, as yardsticks: the
// gains chosen by sweep. They get true time steps and start level and north on their first
// sample, which is more than their usual implementations do.
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "fairlead/base/types.hpp"

namespace fairlead::sim {

class Ahrs {
  public:
    virtual ~Ahrs() = default;
    /// Body to east-north-up after one more sample, dt_s after the last.
    const Eigen::Quaterniond& update(const Sample& sample, double dt_s, bool use_field);

  protected:
    /// Corrected angular rate, body frame: gyro plus what gravity and field ask for.
    virtual Eigen::Vector3d rate(const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel,
                                 const Eigen::Vector3d& field, double dt_s) = 0;
    Eigen::Quaterniond q_wb_{Eigen::Quaterniond::Identity()};

  private:
    bool started_{false};
};

struct AhrsGain {
    double first{}, integral{};
};
struct AhrsKind {
    std::string name;
    std::vector<AhrsGain> gains;  // to sweep
    std::unique_ptr<Ahrs> (*make)(const AhrsGain& gain);
};

/// Madgwick 2010 (gain beta, rad/s), Mahony 2008 (k_p, 1/s, and k_i, 1/s^2), complementary filter
/// (time constant, s).
const std::vector<AhrsKind>& ahrs_kinds();

}  // namespace fairlead::sim
