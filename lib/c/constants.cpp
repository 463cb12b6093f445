// The constants of fairlead.h for one configuration and one machine. Each is the size of an array,
// which header.py reads from the symbol table: so it works for any core without running anything.
// Sizes are one more than the constant, for an array cannot have none.
#include "lib/c/configuration.hpp"

using namespace fairlead::c;
namespace wire = fairlead::wire;

#define FAIRLEAD_CONSTANT(name, value)                       \
    extern const char fairlead_constant_##name[(value) + 1]; \
    const char fairlead_constant_##name[(value) + 1] = {}

extern "C" {
FAIRLEAD_CONSTANT(VERSION_NUMBER, FAIRLEAD_VERSION_NUMBER);
FAIRLEAD_CONSTANT(TAKES_POSES, Kind::poses);
FAIRLEAD_CONSTANT(TAKES_SAMPLES, Kind::samples);
FAIRLEAD_CONSTANT(TAKES_VECTORS, Kind::vectors);
FAIRLEAD_CONSTANT(SENDS_POSITION, sends_position);
FAIRLEAD_CONSTANT(SENDS_ORIENTATION, sends_orientation);
FAIRLEAD_CONSTANT(COMPONENTS, Kind::components);
FAIRLEAD_CONSTANT(DELAY_RECORDS_MAX, Config::delay_records_max);
FAIRLEAD_CONSTANT(EVENTS_MAX, Config::events_max);
FAIRLEAD_CONSTANT(LIVE_PIECES, live_pieces);
FAIRLEAD_CONSTANT(DECODER_AXES, decoder_axes);
FAIRLEAD_CONSTANT(ATTITUDE_SENSORS, static_cast<int>(mode) + 1);
FAIRLEAD_CONSTANT(PIPELINE_BYTES, sizeof(PipelineCell));
FAIRLEAD_CONSTANT(DECODER_BYTES, sizeof(DecoderCell));
FAIRLEAD_CONSTANT(LIVE_BYTES, sizeof(LiveCell));
FAIRLEAD_CONSTANT(ATTITUDE_BYTES, sizeof(AttitudeCell));
FAIRLEAD_CONSTANT(SAVED_BYTES, sizeof(SavedAttitude));
FAIRLEAD_CONSTANT(PIECE_BYTES, sizeof(HeldPiece));
}
