#pragma once
// What the firmware runs: one 6-DOF tracker at 120 records a second. An integrator copies this
// file, changes it, and asks what it costs:
//
//     make bounds CONFIG=examples/firmware/config.hpp CORE=m4f BUDGET=400000
#include "fairlead/pipeline.hpp"

struct Config : fairlead::PipelineConfig {
    using Filter = fairlead::PoseFilter<9>;    // centred: 4 records late
    static constexpr std::size_t window = 32;  // records that a reducer can hold
    static constexpr std::size_t events = 0;   // a tracker without buttons

    static fairlead::Pipeline<Config>::Params params() {
        fairlead::EncoderParams encoder;
        encoder.tol_position_m = {0.002f, 0.002f, 0.002f};
        encoder.tol_orientation_rad = 0.0087266f;  // 0.5 deg
        encoder.tick_ns = 4000000;                 // below the smallest spacing of records
        encoder.delay_max = 30;                    // records: 0.25 s
        return {{}, Filter{fairlead::binomial_mask<9>()}, encoder};
    }
};
