#pragma once
#include "tests/target/reduce_stage.hpp"

struct Subject : fairlead::target::VectorReduceStage<64> {
    static constexpr const char* text = "Reducer<VectorChannel<3>, 64>, 2 mm";
};
