// What a user makes of the library, so that every compiler meets the templates with their
// arguments: a pipeline of poses with a filter, a pipeline of IMU samples, a decoder.
#include <fairlead/imu_pipeline.hpp>
#include <fairlead/pipeline.hpp>
#include <fairlead/wire/decoder.hpp>

struct Tracker : fairlead::PipelineConfig {
    using Filter = fairlead::PoseFilter<9>;
    static constexpr std::size_t window = 32;
};
struct Board : fairlead::PipelineConfig {
    static constexpr std::size_t window = 32;
};

fairlead::Pipeline<Tracker> tracker{
    {{}, Tracker::Filter{fairlead::binomial_mask<9>()}, fairlead::EncoderParams{}}};
fairlead::ImuPipeline<Board> imu{{}};
fairlead::Decoder reader;

std::size_t use(const fairlead::Pose& pose, const fairlead::Sample& sample) {
    const fairlead::Bytes wire = tracker.push(pose);
    for (std::size_t i = 0; i < wire.size; ++i)
        if (reader.push(wire.data[i]))
            for (fairlead::Decoder::Update step; reader.next(step);) continue;
    return imu.push(sample).size + imu.flush().size + tracker.flush().size;
}
