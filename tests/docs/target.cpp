// The frame of the example in docs/target.md.
#include "example_headers.inc"

#include "example.inc"

Subject subject;
