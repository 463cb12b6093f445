// Poses in, bytes out: a curve within tolerance of every record, each covered in time.
#include <fairlead/pipeline.hpp>

#include "support.hpp"

struct Board {
    using Input = fairlead::Pose;
    using Channels = fairlead::Channels<fairlead::Position, fairlead::Orientation>;
    using Filter = fairlead::PoseFilter<9>;  // its latency, 4 records, is part of the type
    static constexpr std::size_t delay_records_max = 60;
    static constexpr fairlead::Beam beam = fairlead::Beam::medium;
    static constexpr std::size_t events_max = 0;  // no buttons
};

int main() {
    fairlead::Pipeline<Board>::Params params;
    params.sample_period_ns = 8'333'333;
    params.tolerance.position_m = 0.002f;      // each axis
    params.tolerance.orientation_rad = 0.01f;  // full rotation angle
    params.filter = Board::Filter{fairlead::binomial_mask<9>()};

    fairlead::Pipeline<Board> pipeline{params};
    if (!pipeline.check()) return 1;  // check().field names the parameter that is refused
    std::size_t sent = 0, records = 0;
    fairlead::Pose pose;
    while (next(pose)) {
        sent += pipeline.push(pose).size;  // whole frames, or nothing yet: write them to the wire
        ++records;
    }
    fairlead::Bytes more;
    do sent += (more = pipeline.flush()).size;
    while (more.status != fairlead::Status::end);
    std::printf("%zu records became %zu bytes\n", records, sent);
}
