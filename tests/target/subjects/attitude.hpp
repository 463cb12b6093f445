#pragma once
#include "fairlead/sense/attitude.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text =
        "BasicAttitude<float>: gyro, accelerometer and magnetometer";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = true;
    static constexpr bool takes_anything = false;
    using Output = fairlead::Pose;
    fairlead::BasicAttitude<float, fairlead::AttitudeMode::imu_mag> stage{};

    std::optional<Output> push(const fairlead::target::Record& in) { return stage.push(in.sample); }
    std::optional<Output> flush() { return std::nullopt; }
};
