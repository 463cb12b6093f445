// The frame of the example in docs/reducer.md.
#include "fairlead/wire/encoder.hpp"

void send(const fairlead::Bytes& frames);

void example(const fairlead::Pose& pose) {
#include "example.inc"
    send(frames);
}
