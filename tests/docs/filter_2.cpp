// The frame of the second example in docs/filter.md.
#include "fairlead/smooth/adaptive.hpp"

void use(const std::optional<fairlead::Pose>& now, const fairlead::Pose& soon);

void example(const fairlead::Pose& pose) {
#include "example.inc"
    use(now, soon);
}
