// The pipelines whose search is narrow.
#include "host_sim/replay/replay_board.hpp"

namespace fairlead::sim {

template <Beam beam>
void run_beam(const Recording& recording, Replay& result) {
    run_board<beam, StreamEncoder>(recording, result);
}
template void run_beam<Beam::narrow>(const Recording&, Replay&);

}  // namespace fairlead::sim
