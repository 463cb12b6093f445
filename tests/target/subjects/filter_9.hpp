#pragma once
#include "fairlead/smooth/filter.hpp"
#include "tests/target/pose_stage.hpp"

using Stage = fairlead::PoseFilter<9, 4>;

struct Subject : fairlead::target::PoseStage<Stage> {
    static constexpr const char* text = "PoseFilter<9, 4>, binomial mask";
    Subject() : PoseStage{Stage{fairlead::binomial_mask<9>()}} {}
};
