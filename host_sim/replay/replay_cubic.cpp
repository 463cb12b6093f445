// The pipelines whose positions are C2 cubics; orientations stay C1.
#include "host_sim/replay/replay_board.hpp"

namespace fairlead::sim {
namespace {

template <Beam beam>
void run_width(const Recording& recording, Replay& result) {
    if (!result.options.orientation)
        return run_poses<Channels<Position>, beam, StreamEncoder, curve::Cubics>(recording, result);
    run_poses<Channels<Position, Orientation>, beam, StreamEncoder, curve::Cubics>(recording,
                                                                                   result);
}

}  // namespace

void run_cubics(const Recording& recording, Replay& result) {
    switch (result.options.beam) {
        case Beam::narrow: return run_width<Beam::narrow>(recording, result);
        case Beam::wide: return run_width<Beam::wide>(recording, result);
        case Beam::medium:
        default: break;
    }
    run_width<Beam::medium>(recording, result);
}

}  // namespace fairlead::sim
