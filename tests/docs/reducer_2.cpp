// The pipeline of the example in docs/reducer.md.
#include "fairlead/pipeline.hpp"

struct Board {
    using Input = fairlead::Pose;
    using Channels = fairlead::Channels<fairlead::Position, fairlead::Orientation>;
    using Filter = fairlead::NoFilter;
    static constexpr std::size_t delay_records_max = 120;
    static constexpr fairlead::Beam beam = fairlead::Beam::medium;
    static constexpr std::size_t events_max = 0;
};

void send(const fairlead::Bytes& frames);

void example(const fairlead::Pose& pose) {
#include "example.inc"
    send(frames);
}
