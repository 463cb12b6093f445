#pragma once
// The same for a bare IMU: orientation from gyro and accelerometer, at 100 samples a second.
//
//     make bounds CONFIG=examples/firmware/config_imu.hpp CORE=m4f
#include "fairlead/imu_pipeline.hpp"

struct Config : fairlead::PipelineConfig {
    using Filter = fairlead::PoseFilter<5>;    // centred: 2 samples late
    static constexpr std::size_t window = 32;  // samples that the reducer can hold

    using Whole = fairlead::ImuPipeline<Config, fairlead::AttitudeMode::imu>;
    static Whole::Params params() {
        Whole::Params p{{}, {}, {}, {{}, Filter{fairlead::binomial_mask<5>()}, {}}};
        p.calibration.gyro.offset = {0.01f, -0.02f, 0.005f};  // rad/s, found on this board
        p.motion.encoder.tol_orientation_rad = 0.0087266f;    // 0.5 deg
        p.motion.encoder.tick_ns = 5000000;                   // below the smallest spacing
        p.motion.encoder.delay_max = 30;                      // samples: 0.3 s
        return p;
    }
};
