#pragma once
#include "fairlead/smooth/cascade.hpp"
#include "tests/target/pose_stage.hpp"

using Stage = fairlead::Cascade<fairlead::PoseFilter<5>, 4>;

struct Subject : fairlead::target::PoseStage<Stage> {
    static constexpr const char* text = "Cascade<PoseFilter<5>, 4>, smoothing mask, lambda 1";
    Subject() : PoseStage{Stage{fairlead::PoseFilter<5>{fairlead::smoothing_mask(1)}}} {}
};
