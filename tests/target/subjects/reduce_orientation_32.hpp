#pragma once
#include "tests/target/reduce_stage.hpp"

struct Subject : fairlead::target::OrientationReduceStage<32> {
    static constexpr const char* text = "Reducer<OrientationChannel, 32>, 0.5 deg";
};
