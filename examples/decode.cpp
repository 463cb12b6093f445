// Bytes in, curve out: the far end of the wire keeps the newest piece and evaluates it.
#include <fairlead/pipeline.hpp>
#include <fairlead/reduce/evaluate.hpp>
#include <fairlead/wire/decoder.hpp>

#include "support.hpp"

/// The position at the end of what is final so far.
void print_end(const fairlead::Decoder& decoder) {
    const auto& link = decoder.position();
    const std::int64_t t_ns =
        link.curve.span.t0_ns + std::int64_t{link.cover_ticks} * decoder.tick_ns();
    const auto p = value_at(link.curve, link.scale, decoder.tick_ns(), t_ns);
    std::printf("%.3f s  %.4f %.4f %.4f m\n", static_cast<double>(t_ns) * 1e-9,
                static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
}

int main() {
    fairlead::Pipeline<fairlead::PipelineConfig> board{{}};
    fairlead::Decoder reader;
    fairlead::Pose pose;
    while (next(pose)) {
        const fairlead::Bytes wire = board.push(pose);
        for (std::size_t i = 0; i < wire.size; ++i) {
            if (!reader.push(wire.data[i])) continue;  // true: a frame is complete and good
            fairlead::Decoder::Update step;
            while (reader.next(step)) {
            }
            print_end(reader);
        }
    }
}
