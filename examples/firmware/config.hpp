#pragma once
// What the firmware runs: one 6-DOF tracker at 120 records a second. An integrator copies this
// file, changes it, and asks what it costs:
//
//     make bounds CONFIG=examples/firmware/config.hpp CORE=m4f BUDGET=400000
#include "fairlead/pipeline.hpp"

struct Config {
    using Input = fairlead::Pose;
    using Channels = fairlead::Channels<fairlead::Position, fairlead::Orientation>;
    using Filter = fairlead::PoseFilter<9>;               // centred: 4 records late
    static constexpr std::size_t delay_records_max = 32;  // records: 0.27 s
    static constexpr fairlead::Beam beam = fairlead::Beam::narrow;
    static constexpr std::size_t events_max = 0;  // a tracker without buttons

    using Pipeline = fairlead::Pipeline<Config>;
    static Pipeline::Params params() {
        Pipeline::Params p;
        p.sample_period_ns = 8'333'333;            // 120 records a second
        p.tolerance.position_m = 0.002f;           // each axis
        p.tolerance.orientation_rad = 0.0087266f;  // 0.5 deg
        p.filter = Filter{fairlead::binomial_mask<9>()};
        return p;
    }
};
