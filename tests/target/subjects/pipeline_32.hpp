#pragma once
#include "examples/firmware/config.hpp"
#include "tests/target/pipeline_stage.hpp"

struct Subject : fairlead::target::PipelineStage<Config> {
    static constexpr const char* text =
        "the pipeline of examples/firmware: intake, PoseFilter<9>, both channels, delay 32";
};
