// The frame of the second example in docs/bounds.md.
#include <gtest/gtest.h>

#include "examples/firmware/config.hpp"

#include "example_headers.inc"

using namespace fairlead::sim;

void example(const std::vector<fairlead::Pose>& records) {
#include "example.inc"
}
