#pragma once
// Frames of numbers, and what they cost: adaptive Rice codes, one state per context, all states
// begun anew at every restart, so that a reader can join there. The means at which states begin are
// the stream's own averages, told once in its header: a courtesy to every rival alike.
#include <cstdint>
#include <string>
#include <vector>

namespace fairlead::sim {

constexpr std::size_t contexts_max = 16;
constexpr std::size_t frame_overhead = 3;  // bytes: one of header, two of CRC-16

struct Symbol {
    std::uint32_t value{};
    std::uint8_t context{};
    std::uint8_t plain_bits{};  // not 0: so many bits as they are, no code
};

struct Frame {
    std::size_t sent_at{};  // record whose arrival made these bytes leave
    std::size_t end{};      // records below this one can be decoded now
    bool restart{};
    std::vector<Symbol> symbols;
};

constexpr std::uint32_t fold(long v) {  // 0 -1 1 -2 2 ... -> 0 1 2 3 4 ...
    return v < 0 ? static_cast<std::uint32_t>(-2 * v - 1) : static_cast<std::uint32_t>(2 * v);
}
constexpr long unfold(std::uint32_t u) {
    return (u & 1u) != 0 ? -static_cast<long>(u / 2) - 1 : static_cast<long>(u / 2);
}

/// Bytes of the whole stream, frame overhead and header included. A state halves its memory when
/// it has seen `memory` numbers.
std::size_t coded_size(const std::vector<Frame>& frames, unsigned memory);

/// The bits themselves, frame by frame without overhead, and back; `shape` tells the contexts.
std::vector<std::string> write_frames(const std::vector<Frame>& frames, unsigned memory);
std::vector<Frame> read_frames(const std::vector<std::string>& bytes, std::vector<Frame> shape,
                               unsigned memory);

}  // namespace fairlead::sim
