// The frame of the example in docs/attitude.md.
#include "example_headers.inc"

template <class... Anything>
void use(const Anything&...);

#include "example.inc"
