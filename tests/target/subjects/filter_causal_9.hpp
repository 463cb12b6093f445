#pragma once
#include "fairlead/smooth/filter.hpp"
#include "tests/target/pose_stage.hpp"

using Stage = fairlead::PoseFilter<9, 8>;

struct Subject : fairlead::target::PoseStage<Stage> {
    static constexpr const char* text = "PoseFilter<9, 8>, causal Savitzky-Golay mask, latency 0";
    Subject() : PoseStage{Stage{fairlead::causal_savitzky_golay_mask<9, 1>()}} {}
};
