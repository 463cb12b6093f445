#pragma once
// What a sensor makes of the truth: noise, bias, quantisation, range. IMU figures are those of the
// parts' data sheets (noise density, sensitivity, zero-rate and zero-g tolerance as three sigma);
// tracker figures are of the size that such systems state.
#include <string>
#include <vector>

#include "host_sim/generate/motion.hpp"
#include "host_sim/generate/random.hpp"

namespace fairlead::sim {

struct TrackerModel {
    double rate_hz{};
    double position_noise_m{}, orientation_noise_rad{};  // white, one sigma per axis
    double position_step_m{}, quaternion_step{};         // quantisation; 0: none but float32
};

struct ImuModel {
    double rate_hz{};
    double gyro_noise{}, accel_noise{}, mag_noise_uT{};  // rad/s/sqrt(Hz), m/s^2/sqrt(Hz), 1 sigma
    double gyro_step_rad_s{}, accel_step_m_s2{}, mag_step_uT{};  // 16-bit counts: range 32768 steps
    double gyro_bias_rad_s{}, accel_bias_m_s2{};                 // turn-on, one sigma per axis
    double gyro_walk{};                                          // rad/s per sqrt(s)
};

struct SensorModel {
    std::string name, summary;
    bool is_imu{false};
    TrackerModel tracker{};
    ImuModel imu{};
    double rate_hz() const { return is_imu ? imu.rate_hz : tracker.rate_hz; }
};

const std::vector<SensorModel>& sensor_models();

class TrackerSensor {
  public:
    TrackerSensor(const TrackerModel& model, Random random) : model_{model}, random_{random} {}
    Pose measure(const MotionState& truth, std::int64_t t_ns);

  private:
    TrackerModel model_;
    Random random_;
    Quatd last_{};  // trackers deliver sign-continuous quaternions
};

class ImuSensor {
  public:
    ImuSensor(const ImuModel& model, double rate_hz, Random random);
    Sample measure(const MotionState& truth, std::int64_t t_ns);

  private:
    ImuModel model_;
    double rate_hz_;
    Random random_;
    Vec3d gyro_bias_{}, accel_bias_{};
};

/// The truth itself, as a pose of float32.
Pose to_pose(const MotionState& truth, std::int64_t t_ns);

}  // namespace fairlead::sim
