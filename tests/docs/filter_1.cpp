// The frame of the first example in docs/filter.md.
#include "example_headers.inc"

void print(const fairlead::Pose& pose);

void example(const fairlead::Pose& pose) {
#include "example.inc"
}
