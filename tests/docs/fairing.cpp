// The frame of the example in docs/fairing.md.
#include "example_headers.inc"

void use(const fairlead::Pose& pose);

void example(const fairlead::Pose& pose) {
#include "example.inc"
}
