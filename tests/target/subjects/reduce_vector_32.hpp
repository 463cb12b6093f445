#pragma once
#include "tests/target/reduce_stage.hpp"

struct Subject : fairlead::target::VectorReduceStage<32> {
    static constexpr const char* text = "Reducer<VectorChannel<3>, 32>, 2 mm";
};
