#pragma once
#include "fairlead/smooth/adaptive.hpp"
#include "tests/target/pose_stage.hpp"

using Stage = fairlead::AdaptivePoseFilter;

struct Subject : fairlead::target::PoseStage<Stage> {
    static constexpr const char* text = "AdaptivePoseFilter, its standard parameters";
    Subject() : PoseStage{Stage{}} {}
};
