// Reads frames from the standard input and says what they held. Uses the single header.
#include USER_HEADER

#include <cstdio>

int main() {
    static fairlead::wire::Decoder<3, 1> decoder;
    unsigned bytes = 0, pieces = 0, events = 0;
    const auto take = [&] {
        for (fairlead::wire::CurvePiece piece; decoder.next(piece);) ++pieces;
        for (fairlead::Event event; decoder.next_event(event);) ++events;
    };
    for (int c = std::getchar(); c != EOF; c = std::getchar(), ++bytes)
        if (decoder.push(static_cast<std::uint8_t>(c))) take();
    while (decoder.finish()) take();
    const auto& counters = decoder.frame_counters();
    const auto skipped = bytes - static_cast<unsigned>(counters.good_bytes);
    std::printf("bytes %u frames %u damaged %u skipped %u pieces %u events %u\n", bytes,
                static_cast<unsigned>(counters.frames), static_cast<unsigned>(counters.losses),
                skipped, pieces, events);
    return counters.frames > 5 && counters.losses == 0 && skipped == 0 && pieces > 2 ? 0 : 1;
}
