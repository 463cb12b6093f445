// Reads frames from the standard input and says what they held. Uses the single header.
#include USER_HEADER

#include <cstdio>

int main() {
    static fairlead::Decoder decoder;
    unsigned bytes = 0, pieces = 0, events = 0;
    for (int c = std::getchar(); c != EOF; c = std::getchar(), ++bytes) {
        if (!decoder.push(static_cast<std::uint8_t>(c))) continue;
        for (fairlead::Decoder::Update update; decoder.next(update);)
            if (update.piece) ++pieces;
        for (fairlead::Event event; decoder.next_event(event);) ++events;
    }
    const auto& counters = decoder.counters();
    std::printf("bytes %u frames %u damaged %u skipped %u pieces %u events %u\n", bytes,
                static_cast<unsigned>(counters.frames), static_cast<unsigned>(counters.damaged),
                static_cast<unsigned>(counters.skipped_bytes), pieces, events);
    return counters.frames > 5 && counters.damaged == 0 && counters.skipped_bytes == 0 && pieces > 2
               ? 0
               : 1;
}
