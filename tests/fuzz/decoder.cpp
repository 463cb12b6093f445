// The reader on bytes that nobody wrote: noise; frames whose checks are right by chance, because
// this reader's checks are narrow; and payloads of the fuzzer's with right sizes and checks. Held:
// what it tells is in order and finite, and it does bounded work a byte.
#include "fairlead/wire/decoder.hpp"

#include <cmath>

#include "tests/fuzz/input.hpp"
#include "tests/unit/header_frame.hpp"

namespace {

using namespace fairlead;
using Kinds = wire::KindSet<curve::Smooth, curve::Cubics>;

template <unsigned Bits>
struct Checks : wire::Everything {
    static constexpr unsigned check_bits = Bits;
};

template <class Decoder>
void drain(Decoder& decoder) {
    typename Decoder::Piece piece;
    Event event;
    int told = 0;
    while (decoder.next(piece)) {
        FUZZ_EXPECT(++told < 100'000);
        FUZZ_EXPECT(piece.start <= piece.end);
        FUZZ_EXPECT(piece.channel < 4 && piece.axis < 3);
        const double end = piece.ticks();
        for (std::size_t c = 0; c < (piece.rotates ? 3u : 1u); ++c)
            for (const double at : {0.0, end / 2, end}) {
                FUZZ_EXPECT(std::isfinite(piece.steps_at(at, c)));
                FUZZ_EXPECT(std::isfinite(piece.rate_at(at, c)));
            }
        if (piece.rotates) {
            const auto q = wire::rotation_at(piece, end / 2);
            FUZZ_EXPECT(std::abs(dot(q, q) - 1) < 1e-3);
        }
    }
    while (decoder.next_event(event)) FUZZ_EXPECT(++told < 100'000);
}
template <class Decoder>
void finish(Decoder& decoder) {
    for (int calls = 0; decoder.finish(); ++calls) {
        FUZZ_EXPECT(calls < 100'000);
        drain(decoder);
    }
}

template <unsigned CheckBits>
void noise(fuzz::Input& in) {
    wire::Decoder<3, 1, Kinds, Checks<CheckBits>> decoder;
    while (!in.empty())
        if (decoder.push(in.byte())) drain(decoder);
    finish(decoder);
}

/// A header of a shape that the input chooses.
wire::Header header_of(fuzz::Input& in) {
    wire::Header header;
    wire::StreamShape& s = header.shape;
    const unsigned form = in.byte();
    s.base_ns = in.byte() * std::int64_t{1} << 55;
    s.timing.sub_ns = 1u + (std::uint32_t{in.byte()} << 20);
    s.timing.time_bits = static_cast<std::uint8_t>(5 + form % 28);
    s.timing.independent = (form & 32u) != 0;
    s.timing.usual_ticks = static_cast<std::uint8_t>(in.byte() | 1);
    s.timing.restart_frames = form % 4;
    for (const bool rotates : {false, true}) {
        if ((form & (rotates ? 64u : 128u)) != 0 && s.channels + rotates > 0) continue;
        wire::ChannelShape& c = s.channel[s.channels++];
        c.type = rotates ? wire::ChannelType::orientation : wire::ChannelType::vector;
        const bool cubic = !rotates && (form & 16u) != 0 && !s.timing.independent;
        c.kind = cubic ? curve::Cubics::id : curve::Smooth::id;
        c.axes = 3;
        c.step.fill(
            curve::Scale::of_step(rotates ? 1e-4f * static_cast<float>(1 + in.byte()) : 0.01f));
    }
    header.starts = true;
    return header;
}
/// Payloads as they come, with the sizes and checks that an encoder would give them.
void framed(fuzz::Input& in) {
    wire::Decoder<3, 1, Kinds> decoder;
    wire::Header header = header_of(in);
    std::uint8_t bytes[wire::long_frame_max];
    const auto push = [&](std::size_t size) {
        bool told = false;
        for (std::size_t i = 0; i < size; ++i)
            if (decoder.push(bytes[i])) told = true, drain(decoder);
        return told;
    };
    push(wire::write_header(header, bytes));
    wire::Link link;
    while (!in.empty()) {
        const std::size_t size = 1 + in.byte() % 60u;
        bytes[0] = static_cast<std::uint8_t>(size);
        for (std::size_t i = 1; i <= size; ++i) bytes[i] = in.byte();
        append_crc16(bytes, 1 + size, wire::seed(header.digest, link));
        code::RangeDecoder io{bytes + 1, size};
        wire::FrameHead head;
        if (!wire::code_head(io, head, header.shape.timing, link.end, link.since)) continue;
        const std::uint32_t digest =
            wire::digest_of(bytes, size + 3, head.restart, header.digest, link);
        if (push(size + 3)) link = {head.end, digest, wire::since_behind(link.since, head.restart)};
        if (!decoder.in_step()) break;
    }
    finish(decoder);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in{data, size};
    switch (in.byte() % 4) {
        case 0: noise<16>(in); break;
        case 1: noise<4>(in); break;
        case 2: noise<1>(in); break;
        default: framed(in); break;
    }
    return 0;
}
