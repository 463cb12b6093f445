// Everything between a raw pose and a decoded curve, for a look at what the linker would be asked.
#include "fairlead/pipeline.hpp"
#include "fairlead/wire/decoder.hpp"

using namespace fairlead;

struct Config : PipelineConfig {
    using Filter = PoseFilter<9>;
};

Bytes push(Pipeline<Config>& pipeline, const Pose& pose) { return pipeline.push(pose); }
Bytes flush(Pipeline<Config>& pipeline) { return pipeline.flush(); }
bool push_event(Pipeline<Config>& pipeline, const Event& e) { return pipeline.push_event(e); }
Bytes idle(Pipeline<Config>& pipeline) { return pipeline.idle(); }
Pipeline<Config> make() { return Pipeline<Config>{{{}, Config::Filter{binomial_mask<9>()}, {}}}; }
bool push(Decoder& decoder, std::uint8_t byte) { return decoder.push(byte); }
bool next(Decoder& decoder, Decoder::Update& update) { return decoder.next(update); }
bool next_event(Decoder& decoder, Event& event) { return decoder.next_event(event); }
