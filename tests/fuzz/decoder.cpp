// The reader on bytes that nobody wrote: noise, and frames whose checks are right by chance,
// because this reader's checks are narrow. Held: what it tells is in order and finite, and it does
// bounded work a byte.
#include "fairlead/wire2/decoder.hpp"

#include <cmath>

#include "tests/fuzz/input.hpp"

namespace {

using namespace fairlead;

template <unsigned CheckBits>
void run(fuzz::Input& in) {
    using Kinds = wire2::KindSet<curve::Smooth>;
    wire2::Decoder<3, 1, Kinds, CheckBits> decoder;
    wire2::CurvePiece piece;
    Event event;
    const auto drain = [&] {
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
                const auto q = wire2::rotation_at(piece, end / 2);
                FUZZ_EXPECT(std::abs(dot(q, q) - 1) < 1e-3);
            }
        }
        while (decoder.next_event(event)) FUZZ_EXPECT(++told < 100'000);
    };
    while (!in.empty())
        if (decoder.push(in.byte())) drain();
    for (int calls = 0; decoder.finish(); ++calls) {
        FUZZ_EXPECT(calls < 100'000);
        drain();
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input in{data, size};
    switch (in.byte() % 3) {
        case 0: run<16>(in); break;
        case 1: run<4>(in); break;
        default: run<1>(in); break;
    }
    return 0;
}
