// Bytes in, curve out: the far end of the wire keeps the newest pieces and evaluates them.
#include <fairlead/pipeline.hpp>
#include <fairlead/wire/live.hpp>

#include "support.hpp"

struct Board {
    using Input = fairlead::Pose;
    using Channels = fairlead::Channels<fairlead::Position, fairlead::Orientation>;
    using Filter = fairlead::NoFilter;
    static constexpr std::size_t delay_records_max = 120;
    static constexpr fairlead::Beam beam = fairlead::Beam::medium;
    static constexpr std::size_t events_max = 0;
};

/// The position at the end of what is final so far.
void print_end(const fairlead::wire::LiveDecoder<>& reader) {
    const auto t_ns = reader.position_until_ns();
    const auto motion = t_ns ? reader.position(*t_ns) : std::nullopt;
    if (!motion) return;
    const auto d = [](float x) { return static_cast<double>(x); };
    const fairlead::Vec3 &p = motion->p_w_m, &v = motion->velocity_m_s;
    std::printf("%.3f s  %.4f %.4f %.4f m  %.3f %.3f %.3f m/s\n", static_cast<double>(*t_ns) * 1e-9,
                d(p.x), d(p.y), d(p.z), d(v.x), d(v.y), d(v.z));
}

int main() {
    fairlead::Pipeline<Board>::Params params;
    params.sample_period_ns = 8'333'333;
    fairlead::Pipeline<Board> board{params};
    fairlead::wire::LiveDecoder<> reader;
    fairlead::Pose pose;
    while (next(pose)) {
        for (const std::uint8_t byte : board.push(pose))
            if (reader.push(byte)) print_end(reader);  // a frame is complete and good
    }
}
