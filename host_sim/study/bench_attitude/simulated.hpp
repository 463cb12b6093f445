#pragma once
// What a sensor would have said of a motion: an .imu recording with an exact reference.
//
// Errors of each chip by its data sheet: white noise, turn-on bias and its wander, scale,
// misalignment, quantisation. Gyro and accelerometer readings are means over the interval before
// their time stamp, the magnetometer's are taken at it. Field: 20 uT north, 43 uT down.
#include <optional>
#include <string>
#include <vector>

#include "host_sim/recording/recording.hpp"
#include "host_sim/study/bench_attitude/motions.hpp"

namespace fairlead::sim {

struct Drift {
    double from_s{}, to_s{}, from_deg_s{}, to_deg_s{};
};
struct Jump {
    double at_s{}, by_deg_s{};
};
/// The board is turned over about a horizontal axis while something fails.
struct TurnOver {
    enum class Failure { gap, saturation, frozen_gyro, frozen_all };
    double at_s{}, seconds{0.8}, angle_deg{180};
    Failure failure{};
};

struct SimPlan {
    std::string name;
    MotionPlan motion;
    std::uint64_t seed{1};
    std::string chip{"bmi160"};  // bmi160, icm42688, lsm6dso, mpu6050
    double rate_hz{100};
    double mag_rate_hz{0};             // 0: with every sample
    std::optional<double> bias_deg_s;  // of every axis; else drawn from the chip's figure
    std::optional<Drift> drift;        // of every axis, random signs
    std::optional<Jump> jump;
    std::optional<TurnOver> turn_over;
    double hard_iron_uT{0};      // left in the magnetometer, random direction
    double cut_s{0};             // the recording begins so late, in motion
    double vibration_m_s2{0.5};  // alias of it, white, while moving
    double score_from_s{15};     // from the start of what is left
};

struct Simulated {
    Recording recording;
    std::vector<float> speed_m_s;  // one per sample, or empty
    Vec3 forward{};
};

Simulated simulate(const SimPlan& plan);

}  // namespace fairlead::sim
