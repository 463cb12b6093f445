// Prints what a stream says, a line for each run, piece and event, as tests/ref/stream_decoder.py
// does: the two must agree to the last digit.
//
//   list_stream FILE
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <vector>

#include "fairlead/wire2/decoder.hpp"

namespace {
using namespace fairlead;

// as the host tools: up to 24 axes and 4 rotations
using Decoder = wire2::Decoder<12, 4, wire2::KindSet<curve::Smooth>>;

std::uint32_t bits(float x) {
    std::uint32_t b;
    std::memcpy(&b, &x, sizeof b);
    return b;
}

void print(const wire2::CurvePiece& p) {
    std::printf("piece %u %u %" PRId64 " %" PRId64 " %u %d ", unsigned{p.channel}, unsigned{p.axis},
                p.start, p.end, unsigned{p.code}, p.fresh && p.code != curve::code::jump);
    for (std::size_t c = 0; c < (p.rotates ? 3u : 1u); ++c)
        std::printf("%s%d %d %08x", c > 0 ? " " : "", p.v[c], p.s[c], bits(p.rise[c]));
    if (p.rotates)
        std::printf(" %08x %08x %08x %08x", bits(p.anchor.w), bits(p.anchor.x), bits(p.anchor.y),
                    bits(p.anchor.z));
    std::printf("\n");
}

class Lister {
  public:
    void drain() {
        if (decoder.run_index() != run_) {
            run_ = decoder.run_index();
            std::printf("run %u stream %u base %" PRId64 " sub %u\n", unsigned{decoder.run()},
                        unsigned{decoder.stream_id()}, decoder.grid().base_ns,
                        decoder.grid().sub_ns);
        }
        wire2::CurvePiece piece;
        while (decoder.next(piece)) print(piece);
        Event event;
        while (decoder.next_event(event))
            std::printf("event %" PRId64 " %u %u\n", event.t_ns, unsigned{event.channel},
                        unsigned{event.value});
    }
    Decoder decoder;

  private:
    std::uint32_t run_{0};
};
}  // namespace

int main(int argc, char** argv) {
    std::FILE* file = argc == 2 ? std::fopen(argv[1], "rb") : nullptr;
    if (file == nullptr) {
        std::fprintf(stderr, "usage: list_stream FILE\n");
        return 2;
    }
    static Lister lister;
    for (int byte; (byte = std::fgetc(file)) != EOF;)
        if (lister.decoder.push(static_cast<std::uint8_t>(byte))) lister.drain();
    std::fclose(file);
    while (lister.decoder.finish()) lister.drain();
    if (lister.decoder.refused() == Decoder::Refused::version) {
        std::fprintf(stderr, "%s: the stream has another version of the format than %u\n", argv[1],
                     unsigned{wire2::stream_version});
        return 1;
    }
    return 0;
}
