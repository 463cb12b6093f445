// What a user makes of the library, so that every compiler meets the templates with their
// arguments: pipelines of poses with a filter, of IMU samples and of vectors, decoders.
#include <fairlead/pipeline.hpp>
#include <fairlead/wire/live.hpp>

struct Tracker {
    using Input = fairlead::Pose;
    using Channels = fairlead::Channels<fairlead::Position, fairlead::Orientation>;
    using Filter = fairlead::PoseFilter<9>;
    static constexpr std::size_t delay_records_max = 32;
    static constexpr fairlead::Beam beam = fairlead::Beam::medium;
    static constexpr std::size_t events_max = 4;
};
struct Board {
    using Input = fairlead::Imu<>;
    using Channels = fairlead::Channels<fairlead::Orientation>;
    using Filter = fairlead::NoFilter;
    static constexpr std::size_t delay_records_max = 32;
    static constexpr fairlead::Beam beam = fairlead::Beam::narrow;
    static constexpr std::size_t events_max = 0;
};
struct Arm {
    using Input = fairlead::VectorSample<4>;
    using Channels = fairlead::Channels<fairlead::Vector<4>>;
    using Filter = fairlead::NoFilter;
    static constexpr std::size_t delay_records_max = 60;
    static constexpr fairlead::Beam beam = fairlead::Beam::wide;
    static constexpr std::size_t events_max = 0;
};

fairlead::Pipeline<Tracker>::Params params() {
    fairlead::Pipeline<Tracker>::Params p;
    p.filter = Tracker::Filter{fairlead::binomial_mask<9>()};
    return p;
}

fairlead::Pipeline<Tracker> tracker{params()};
fairlead::Pipeline<Board> imu{{}};
fairlead::Pipeline<Arm> arm{{}};
fairlead::wire::LiveDecoder<> display;
fairlead::wire::Decoder<4, 0> reader;

std::size_t use(const fairlead::Pose& pose, const fairlead::Sample& sample,
                const fairlead::VectorSample<4>& joints) {
    std::size_t known = 0;
    for (const std::uint8_t byte : tracker.push(pose))
        if (display.push(byte) && display.position(pose.t_ns)) ++known;
    for (const std::uint8_t byte : arm.push(joints))
        if (reader.push(byte))
            for (fairlead::wire::CurvePiece piece; reader.next(piece);) ++known;
    return known + imu.push(sample).size + imu.flush().size + tracker.flush().size;
}
