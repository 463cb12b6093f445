#pragma once
// Five joint angles and two buttons, for the test of the C interface; attitude alone from a gyro.
#include "fairlead/pipeline.hpp"

struct Config {
    using Input = fairlead::VectorSample<5>;
    using Channels = fairlead::Channels<fairlead::Vector<5>>;
    using Filter = fairlead::NoFilter;
    static constexpr std::size_t delay_records_max = 60;
    static constexpr fairlead::Beam beam = fairlead::Beam::narrow;
    static constexpr std::size_t events_max = 2;
    static constexpr fairlead::AttitudeMode attitude_mode = fairlead::AttitudeMode::gyro;

    static fairlead::Pipeline<Config>::Params params() {
        fairlead::Pipeline<Config>::Params p;
        p.sample_period_ns = 10'000'000;
        p.tolerance.value = {0.001f};
        return p;
    }
};
