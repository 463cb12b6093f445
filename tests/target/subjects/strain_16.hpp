#pragma once
#include "fairlead/smooth/strain.hpp"
#include "tests/target/pose_stage.hpp"

using Stage = fairlead::StrainSmoother<16>;

struct Subject : fairlead::target::PoseStage<Stage> {
    static constexpr const char* text =
        "StrainSmoother<16>, 24 Hz cut-off at 120 Hz, 1 step a push";
    Subject() : PoseStage{Stage{*fairlead::StrainParams::from_cutoff(24, 1.0f / 120, 1)}} {}
};
