// Poses in, bytes out: few knots, every sample within tolerance, each covered in time.
#include <fairlead/pipeline.hpp>

#include "support.hpp"

struct Board : fairlead::PipelineConfig {
    using Filter = fairlead::PoseFilter<9>;
    static constexpr std::size_t window = 64;  // records that may wait for their knots
};

int main() {
    fairlead::EncoderParams limits;
    limits.tol_position_m = {0.002f, 0.002f, 0.002f};  // per axis
    limits.tol_orientation_rad = 0.01f;                // full rotation angle
    limits.delay_max = 60;                             // records; at most the window

    fairlead::Pipeline<Board> pipeline{{{}, Board::Filter{fairlead::binomial_mask<9>()}, limits}};
    std::size_t sent = 0, records = 0;
    fairlead::Pose pose;
    while (next(pose)) {
        sent += pipeline.push(pose).size;  // whole frames, or nothing yet: write them to the wire
        ++records;
    }
    while (const std::size_t more = pipeline.flush().size) sent += more;
    std::printf("%zu records became %zu bytes\n", records, sent);
}
