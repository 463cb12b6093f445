#pragma once
// What a stream says as text, a line for each run, piece and event: the form in which the golden
// streams are kept, and in which tests/ref/stream_decoder.py answers.
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>

#include "fairlead/wire/decoder.hpp"

namespace fairlead::test {

/// As the host tools: up to 12 axes and 4 rotations.
using ListingDecoder = wire::Decoder<12, 4, wire::KindSet<curve::Smooth, curve::Cubics>>;

class Listing {
  public:
    void push(std::uint8_t byte) {
        if (decoder.push(byte)) drain();
    }
    void finish() {
        while (decoder.finish()) drain();
    }
    ListingDecoder decoder;
    std::string text;

  private:
    static std::uint32_t bits(float x) {
        std::uint32_t b;
        std::memcpy(&b, &x, sizeof b);
        return b;
    }
    template <class... Values>
    void add(const char* format, Values... values) {
        char line[200];
        std::snprintf(line, sizeof line, format, values...);
        text += line;
    }
    void add(const ListingDecoder::Piece& p) {
        if (p.cubic) {
            const curve::CubicVertex& from = p.span.start[0];
            add("cubic %u %u %" PRId64 " %" PRId64 " %u %" PRId64 " %" PRId64 " %" PRId64
                " %" PRId64 "\n",
                unsigned{p.channel}, unsigned{p.axis}, p.start, p.end, unsigned{p.code}, from.p,
                from.v, from.a, p.span.j[0]);
            return;
        }
        add("piece %u %u %" PRId64 " %" PRId64 " %u %d", unsigned{p.channel}, unsigned{p.axis},
            p.start, p.end, unsigned{p.code}, int{p.fresh && p.code != curve::code::jump});
        for (std::size_t c = 0; c < (p.rotates ? 3u : 1u); ++c)
            add(" %d %d %08x", p.v[c], p.s[c], bits(p.rise[c]));
        if (p.rotates)
            add(" %08x %08x %08x %08x", bits(p.anchor.w), bits(p.anchor.x), bits(p.anchor.y),
                bits(p.anchor.z));
        text += '\n';
    }
    void drain() {
        if (decoder.run_index() != run_) {
            run_ = decoder.run_index();
            add("run %u stream %u base %" PRId64 " sub %u\n", unsigned{decoder.run()},
                unsigned{decoder.stream_id()}, decoder.grid().base_ns, decoder.grid().sub_ns);
        }
        ListingDecoder::Piece piece;
        while (decoder.next(piece)) add(piece);
        Event event;
        while (decoder.next_event(event))
            add("event %" PRId64 " %u %u\n", event.t_ns, unsigned{event.channel},
                unsigned{event.value});
    }

    std::uint32_t run_{0};
};

}  // namespace fairlead::test
