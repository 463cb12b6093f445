// Everything between a raw pose and a decoded curve, for a look at what the linker would be asked.
#include "fairlead/pipeline.hpp"
#include "fairlead/wire/decoder.hpp"

using namespace fairlead;

struct Board {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, Orientation>;
    using Filter = PoseFilter<9>;
    static constexpr std::size_t delay_records_max = 120;
    static constexpr Beam beam = Beam::medium;
    static constexpr std::size_t events_max = 6;
};
using Pipe = Pipeline<Board>;
using Reader = wire::Decoder<>;

Bytes push(Pipe& pipeline, const Pose& pose) { return pipeline.push(pose); }
Bytes flush(Pipe& pipeline) { return pipeline.flush(); }
bool push_event(Pipe& pipeline, const Event& e) { return pipeline.push_event(e); }
Bytes idle(Pipe& pipeline) { return pipeline.idle(); }
void reset(Pipe& pipeline) { pipeline.reset(); }
Pipe make() {
    Pipe::Params params;
    params.filter = Board::Filter{binomial_mask<9>()};
    return Pipe{params};
}
bool push(Reader& decoder, std::uint8_t byte) { return decoder.push(byte); }
bool finish(Reader& decoder) { return decoder.finish(); }
bool next(Reader& decoder, wire::CurvePiece& piece) { return decoder.next(piece); }
bool next_event(Reader& decoder, Event& event) { return decoder.next_event(event); }
Quat rotation(const wire::CurvePiece& piece, float ticks) {
    return wire::rotation_at(piece, ticks);
}
