// A program of somebody who uses the library: motion in, frames out, and read back. Prints a digest
// of the frames, which is the same however the library came here. USER_HEADER names the header
// under test.
#ifdef USER_HEADER
#include USER_HEADER
#else
#include <fairlead/base/arithmetic.hpp>
#include <fairlead/pipeline.hpp>
#include <fairlead/wire/decoder.hpp>
#endif

#include <cstdio>

struct Board {
    using Input = fairlead::Pose;
    using Channels = fairlead::Channels<fairlead::Position, fairlead::Orientation>;
    using Filter = fairlead::NoFilter;
    static constexpr std::size_t delay_records_max = 32;
    static constexpr fairlead::Beam beam = fairlead::Beam::narrow;
    static constexpr std::size_t events_max = 0;
};

fairlead::Pipeline<Board>::Params params() {
    fairlead::Pipeline<Board>::Params p;
    p.sample_period_ns = 10'000'000;
    return p;
}

int main() {
    static fairlead::Pipeline<Board> pipeline{params()};
    static fairlead::wire::Decoder<3, 1> decoder;
    std::uint64_t digest = 14695981039346656037u;  // FNV-1a
    std::uint64_t sent = 0;
    const auto take = [&](const fairlead::Bytes& bytes) {
        sent += bytes.size;
        for (const std::uint8_t byte : bytes) {
            digest = (digest ^ byte) * 1099511628211u;
            if (!decoder.push(byte)) continue;
            for (fairlead::wire::CurvePiece piece; decoder.next(piece);) continue;
        }
        return bytes.status != fairlead::Status::end;
    };
    fairlead::Pose pose;
    pose.flags = fairlead::flag::position_valid | fairlead::flag::orientation_valid;
    for (int i = 0; i < 600; ++i) {
        const float t = 0.01f * static_cast<float>(i);
        pose.t_ns = i * std::int64_t{10000000};
        pose.p_w_m = {0.3f * fairlead::approx::sin(3 * t), 0.1f * t, 1};
        pose.q_wb = fairlead::from_rotation_vector<float>({0, fairlead::approx::sin(t), 0.2f * t});
        take(pipeline.push(pose));
    }
    for (int i = 0; i < 200 && take(pipeline.flush()); ++i) continue;
    for (int i = 0; i < 200 && decoder.finish(); ++i) continue;
    const auto& counters = decoder.frame_counters();
    const bool whole = counters.good_bytes == sent && counters.losses == 0;
    std::printf("frames %u damaged %u digest %016llx arithmetic %s\n",
                static_cast<unsigned>(counters.frames), static_cast<unsigned>(counters.losses),
                static_cast<unsigned long long>(digest), to_string(fairlead::check_arithmetic()));
    return counters.frames > 5 && whole ? 0 : 1;
}
