#pragma once
// A user's own configuration as a stage: FAIRLEAD_CONFIG names a header that defines `Config`, as
// examples/firmware/config.hpp and config_imu.hpp do.
#include FAIRLEAD_CONFIG
#include "tests/target/pipeline_stage.hpp"

struct Subject : fairlead::target::PipelineStage<Config> {
    static constexpr const char* text = "the pipeline of a Config";
};
