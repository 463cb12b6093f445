// A causal low-pass on poses. The price stands in the type: latency in records.
#include <fairlead/smooth/filter.hpp>

#include "support.hpp"

constexpr auto soft = fairlead::binomial_mask<9>();  // taps sum to 1, the centre is tap 4
using Soft = fairlead::PoseFilter<9>;                // PoseFilter<9, 8>: the newest tap, latency 0
static_assert(Soft::latency == 4);

int main() {
    Soft filter{soft};
    fairlead::Pose pose;
    while (next(pose)) {
        const auto out = filter.push(pose);  // empty for the first 4 poses
        if (out) print(*out);                // stamped with its own time, 4 records ago
    }
    while (const auto out = filter.flush()) print(*out);
}
