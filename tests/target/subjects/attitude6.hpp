#pragma once
// Orientation from gyro and accelerometer.
#include "fairlead/sense/attitude.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text = "attitude from gyro and accelerometer, defaults";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = true;
    static constexpr bool takes_anything = true;
    using Output = fairlead::Pose;
    fairlead::AttitudeImu stage{};

    std::optional<Output> push(const fairlead::target::Record& in) { return stage.push(in.sample); }
    std::optional<Output> flush() { return stage.flush(); }
};
