#pragma once
// --objective knots: the earlier search for few knots, behind the same intake and filter. Its
// stream has a format of its own (version 3), which earlier::CurveStore reads.
#include "host_sim/replay/replay.hpp"

namespace fairlead::sim::earlier {

void run(const Recording& recording, Replay& result);
void judge_stream(Replay& result);

}  // namespace fairlead::sim::earlier
