// Writes the golden streams: make_streams FOLDER. Run it only for a new version of the format
// (docs/stream.md, Versions); what is there must decode in every later version.
#include <cstdio>
#include <string>

#include "fairlead/wire/events.hpp"
#include "tests/unit/cubic_stream.hpp"
#include "tests/unit/random_stream.hpp"

namespace {
using namespace fairlead;
using namespace fairlead::test;

void write(const std::string& path, const ByteVector& bytes) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    if (file == nullptr || std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size() ||
        std::fclose(file) != 0)
        std::perror(path.c_str());
}
void append(ByteVector& to, const ByteVector& bytes) {
    to.insert(to.end(), bytes.begin(), bytes.end());
}

/// Frames of random curves, with events and repeated headers; lost: every 17th frame is left out.
ByteVector random_stream(const Options& options, std::uint64_t seed, int frames,
                         bool lost = false) {
    RandomStream source{options, seed};
    ByteVector bytes = source.header(true);
    wire::Header header{source.shape(), 0, 0, true};
    std::uint8_t scratch[wire::header_frame_max];
    wire::write_header(header, scratch);
    wire::EventSender<4> events;
    for (int i = 1; i <= frames; ++i) {
        const ByteVector frame = source.frame();
        if (!lost || i % 17 != 0) append(bytes, frame);
        if (i % 7 == 0) append(bytes, source.header(false));
        if (i % 4 != 0) continue;
        for (int k = 0; k < 1 + i % 3; ++k)
            events.push({options.base_ns + i * std::int64_t{7'777'777} - k * 1000,
                         static_cast<std::uint16_t>(k), static_cast<std::uint16_t>(i * 1000), 0});
        std::uint8_t out[wire::EventSender<4>::frame_max];
        const std::size_t n = events.frame(out, 0, header.digest, options.base_ns);
        append(bytes, {out, out + n});
    }
    return bytes;
}
}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: make_streams FOLDER\n");
        return 2;
    }
    const std::string folder = std::string{argv[1]} + "/";
    Options o;
    write(folder + "both.bin", random_stream(o, 1, 30));
    o.usual_ticks = 8;
    o.jumps = 0.3;
    o.size = 40;
    o.restart_every = o.restart_frames = 2;
    o.sub_ns = 1953;
    o.time_bits = 22;
    o.base_ns = 1'700'000'000'123'456'789;
    write(folder + "jumps.bin", random_stream(o, 2, 30));
    o = {};
    o.independent = true;
    o.position = false;
    write(folder + "rotation_independent.bin", random_stream(o, 3, 25));
    o = {};
    o.independent = true;
    write(folder + "both_independent_lost.bin", random_stream(o, 4, 40, true));
    o = {};
    o.orientation = false;
    o.ends = 0.4;
    o.base_ns = -5;
    write(folder + "vector_ends.bin", random_stream(o, 5, 30));
    o = {};
    o.restart_every = o.restart_frames = 3;
    o.time_bits = 6;
    o.usual_ticks = 120;
    o.size = 1;
    o.jumps = 0;
    write(folder + "lost.bin", random_stream(o, 6, 40, true));
    // two runs in one stream: the board was reset, then its clock leaped
    o = {};
    o.restart_frames = 0;
    ByteVector runs = random_stream(o, 7, 12);
    append(runs, random_stream(o, 7, 12));
    o.run = 2;
    o.base_ns = -9'000'000'000'000'000'000;
    append(runs, random_stream(o, 8, 12));
    write(folder + "runs.bin", runs);
    // C2 cubics; lost: every 17th frame is left out
    CubicStream cubics{9};
    ByteVector bytes = cubics.header();
    for (unsigned i = 1; i <= 45; ++i) {
        const ByteVector frame = cubics.frame(i % 4 == 0);
        if (i % 17 != 0) append(bytes, frame);
    }
    write(folder + "cubics.bin", bytes);
}
