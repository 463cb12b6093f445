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

struct Board : fairlead::PipelineConfig {
    static constexpr std::size_t window = 32;
};

int main() {
    static fairlead::Pipeline<Board> pipeline{{}};
    static fairlead::Decoder decoder;
    std::uint64_t digest = 14695981039346656037u;  // FNV-1a
    const auto take = [&](const fairlead::Bytes& bytes) {
        for (std::size_t i = 0; i < bytes.size; ++i) {
            digest = (digest ^ bytes.data[i]) * 1099511628211u;
            if (!decoder.push(bytes.data[i])) continue;
            for (fairlead::Decoder::Update update; decoder.next(update);) continue;
        }
        return !bytes.empty();
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
    const auto& counters = decoder.counters();
    std::printf("frames %u damaged %u digest %016llx arithmetic %s\n",
                static_cast<unsigned>(counters.frames), static_cast<unsigned>(counters.damaged),
                static_cast<unsigned long long>(digest), to_string(fairlead::check_arithmetic()));
    return counters.frames > 5 && counters.damaged == 0 ? 0 : 1;
}
