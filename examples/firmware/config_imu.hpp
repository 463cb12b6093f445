#pragma once
// The same for a bare IMU: orientation from gyro and accelerometer, at 100 samples a second.
//
//     make bounds CONFIG=examples/firmware/config_imu.hpp CORE=m4f
#include "fairlead/pipeline.hpp"

struct Config {
    using Input = fairlead::Imu<fairlead::AttitudeMode::imu>;  // gyro and accelerometer
    using Channels = fairlead::Channels<fairlead::Orientation>;
    using Filter = fairlead::PoseFilter<5>;               // centred: 2 samples late
    static constexpr std::size_t delay_records_max = 32;  // samples: 0.32 s
    static constexpr fairlead::Beam beam = fairlead::Beam::narrow;
    static constexpr std::size_t events_max = 0;  // a board without buttons

    using Pipeline = fairlead::Pipeline<Config>;
    static Pipeline::Params params() {
        Pipeline::Params p;
        p.sample_period_ns = 10'000'000;           // 100 samples a second
        p.tolerance.orientation_rad = 0.0087266f;  // 0.5 deg
        p.filter = Filter{fairlead::binomial_mask<5>()};
        p.calibration.gyro.offset = {0.01f, -0.02f, 0.005f};  // rad/s, found on this board
        return p;
    }
};
