// The frame of the example in docs/intake.md.
#include "fairlead/sense/intake.hpp"

void use(const fairlead::Pose& pose);
template <class Count>
void print(Count count);

void example(const fairlead::Pose& raw) {
#include "example.inc"
}
