// The frame of the example in docs/strain.md.
#include "example_headers.inc"

void use(const fairlead::Pose& pose);

fairlead::Status example(const fairlead::Pose& pose) {
#include "example.inc"
    return fairlead::Status::ok;
}
