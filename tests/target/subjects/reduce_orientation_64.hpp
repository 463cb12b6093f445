#pragma once
#include "tests/target/reduce_stage.hpp"

struct Subject : fairlead::target::OrientationReduceStage<64> {
    static constexpr const char* text = "Reducer<OrientationChannel, 64>, 0.5 deg";
};
