#pragma once
// What frames look like from outside, and how each is chained to the one before (docs/stream.md).
//
//   data frame     size 1..247 | payload | check16 (big-endian)
//   header frame   0xF8 | size | payload | CRC-32 (little-endian)
//   event frame    0xF9 | size | payload | CRC-32 of the frame, seeded by the header's digest
//
// The check of a data frame is a CRC-16 whose start value is made of all that a reader in step
// knows: the digest of the stream's header, the time at which the frame before ended, and the
// digest of that frame's bytes. So a frame that was lost, inserted, repeated or that comes from
// another device is noticed like a damaged one, for the two bytes that a check costs anyway.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/crc32.hpp"
#include "fairlead/wire/crc.hpp"

namespace fairlead::wire {

/// The version of the stream's format. It has nothing to do with the library's version: any change
/// of bytes, tables or arithmetic that a decoder must know raises it (docs/stream.md, Versions).
inline constexpr std::uint8_t stream_version = 5;

inline constexpr std::size_t payload_max = 247;
inline constexpr std::size_t check_size = 2;
inline constexpr std::size_t data_frame_max = 1 + payload_max + check_size;
inline constexpr std::uint8_t header_head = 0xF8, event_head = 0xF9;
inline constexpr std::size_t crc_size = 4;
inline constexpr std::size_t long_frame_max = 2 + 244 + crc_size;  // header and event frames
static_assert(data_frame_max == 250 && long_frame_max == 250);

/// The size of the whole frame that would begin with this byte and the next. @return 0: none does.
constexpr std::size_t frame_size(std::uint8_t first, std::uint8_t second) noexcept {
    if (first >= 1 && first <= payload_max) return 1u + first + check_size;
    if (first == header_head || first == event_head) {
        const std::size_t size = 2u + second + crc_size;
        return second > 0 && size <= long_frame_max ? size : 0;
    }
    return 0;
}

/// The place of a frame in its stream: all that must agree between sender and reader, beside the
/// digest of the header.
struct Link {
    std::int64_t end{0};        // sub-ticks since the run's base: where the frame before ended
    std::uint32_t previous{0};  // digest of the data frame before; 0: the run's first
    std::uint8_t since{0};      // frames since the latest restart frame or the run's start
};

/// The number of frames since a restart frame, behind one more frame.
constexpr std::uint8_t since_behind(std::uint8_t since, bool restart) noexcept {
    return static_cast<std::uint8_t>(restart ? 0 : since < 255 ? since + 1 : 255);
}

/// Digest of a data frame: CRC-32 of its bytes behind those of the frames before, back to the
/// latest restart frame. So the checks of both its followers vouch for a restart frame. It begins
/// with the header's digest: in the start value alone, which is linear, another header looks to all
/// checks alike as another time may, and one in a thousand fits at one of the times that are tried.
inline std::uint32_t digest_of(const std::uint8_t* frame, std::size_t size, bool restart,
                               std::uint32_t header, const Link& before) noexcept {
    return crc32(frame, size, restart ? header : before.previous);
}

/// The start value of the CRC-16 of the frame at this place: CRC-16 over header, end and previous
/// as 4 + 8 + 4 bytes, little-endian, from 0xFFFF. header: CRC-32 of the header's fixed part.
constexpr std::uint16_t seed(std::uint32_t header, const Link& link) noexcept {
    std::uint16_t crc = 0xffff;
    for (unsigned i = 0; i < 32; i += 8) crc = crc16(static_cast<std::uint8_t>(header >> i), crc);
    const auto end = static_cast<std::uint64_t>(link.end);
    for (unsigned i = 0; i < 64; i += 8) crc = crc16(static_cast<std::uint8_t>(end >> i), crc);
    for (unsigned i = 0; i < 32; i += 8)
        crc = crc16(static_cast<std::uint8_t>(link.previous >> i), crc);
    return crc;
}

/// The start value that makes the check of this data frame right: found backwards from the check.
/// frame: `size` bytes, the check included. One pass over the bytes.
constexpr std::uint16_t seed_of(const std::uint8_t* frame, std::size_t size) noexcept {
    auto crc = static_cast<std::uint16_t>(frame[size - 2] << 8 | frame[size - 1]);
    for (std::size_t i = size - check_size; i-- > 0;) crc = crc16_before(frame[i], crc);
    return crc;
}

}  // namespace fairlead::wire
