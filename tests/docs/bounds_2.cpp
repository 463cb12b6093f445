// The frame of the second example in docs/bounds.md.
#include <gtest/gtest.h>

#include "fairlead/pipeline.hpp"

#include "example_headers.inc"

using namespace fairlead::sim;

struct Config : fairlead::PipelineConfig {
    static fairlead::Pipeline<Config>::Params params();
};

void example(const std::vector<fairlead::Pose>& records) {
#include "example.inc"
}
