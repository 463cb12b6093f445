// The frame of the example in docs/portability.md.
#include "example_headers.inc"

void report(const char*);

void start() {
#include "example.inc"
}
