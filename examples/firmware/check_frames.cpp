// Reads the bytes that the firmware sent, as a host on the other end of the UART would, and
// compares the decoded curves with the motion that the tracker saw.   usage: check_frames FILE
#include <cstdio>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "examples/firmware/config.hpp"
#include "examples/firmware/motion.hpp"
#include "fairlead/wire/live.hpp"

namespace {

using Reader = fairlead::wire::LiveDecoder<2048>;  // pieces of the whole ten seconds

struct Worst {
    float m{0}, rad{0};
    bool covered{true};
};

/// Over the tracker's records.
Worst worst_error(const Reader& reader) {
    Worst worst;
    for (std::int64_t n = 0; n < motion::records; ++n) {
        const fairlead::Pose truth = motion::at(n * motion::step_ns);
        const auto p = reader.position(truth.t_ns);
        const auto q = reader.orientation(truth.t_ns);
        worst.covered = worst.covered && p && q;
        if (!p || !q) continue;
        const float m = norm(p->p_w_m - truth.p_w_m);
        const float rad = rotation_angle(q->q_wb, truth.q_wb);
        worst.m = m > worst.m ? m : worst.m;
        worst.rad = rad > worst.rad ? rad : worst.rad;
    }
    return worst;
}

}  // namespace

int main(int argc, char** argv) {
    std::ifstream file{argc > 1 ? argv[1] : "", std::ios::binary};
    const std::string bytes{std::istreambuf_iterator<char>{file}, {}};
    const auto reader = std::make_unique<Reader>();
    for (const char byte : bytes) reader->push(static_cast<std::uint8_t>(byte));
    while (reader->finish()) continue;
    const auto& seen = reader->decoder().frame_counters();
    const Worst worst = worst_error(*reader);
    const std::size_t lost = bytes.size() - static_cast<std::size_t>(seen.good_bytes);
    std::printf("%zu bytes, %zu not understood, %u frames; worst error %.2f mm, %.3f deg\n",
                bytes.size(), lost, seen.frames, static_cast<double>(worst.m) * 1e3,
                static_cast<double>(worst.rad) * 57.29578);
    // sqrt(3) tolerances per axis, and what the filter itself takes off a motion of this speed
    const auto tolerance = Config::params().tolerance;
    const float limit_m = 1.8f * tolerance.position_m[0];
    const float limit_rad = 1.2f * tolerance.orientation_rad;
    const bool fine = lost == 0 && worst.covered && worst.m < limit_m && worst.rad < limit_rad;
    std::puts(fine ? "ok the frames tell the motion" : "FAIL the frames do not tell the motion");
    return fine ? 0 : 1;
}
