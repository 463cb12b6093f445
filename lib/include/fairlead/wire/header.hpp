#pragma once
// The header frame: what a stream is. It stands at the start of a run, is repeated at an interval,
// and may be kept by a reader: the digest of its fixed part enters the check of every data frame,
// so a header of another stream, run or device never decodes anything.
//
//   0xF8 | size | fixed part | end | CRC-32 of all before
//   fixed part  version 1, stream id v, run v, base_ns z, sub_ns v,
//               form 1: bits 0-4 time bits less 1, 5-6 channels less 1, 7 independent frames,
//               usual ticks of a frame 1, usual frames from restart to restart 1,
//               then for each channel
//               form 1: bits 0-2 axes less 1, 3 a step for each axis, 4-6 kind, 7 orientation,
//               tolerance over step, less the usual one, z,
//               steps: mantissa less 256 1, exponent 1, origin: z for each axis
//   end         v: 2 zigzag(end of the latest data frame) + 1 where the run begins behind
// v: 7 bits a byte, the lowest first, bit 7 says that more follow; z: v of a signed number, zigzag
// (docs/stream.md).
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/crc32.hpp"
#include "fairlead/curve/scale.hpp"
#include "fairlead/wire/check.hpp"

namespace fairlead::wire {

inline constexpr std::size_t channels_max = 4, axes_max = 8;
/// An origin takes at most 4 bytes.
inline constexpr std::int32_t origin_max = (1 << 27) - 1;
static_assert(origin_max >= curve::value_steps_max);

enum class ChannelType : std::uint8_t { none = 0, vector = 1, orientation = 2 };

/// One channel of a stream.
struct ChannelShape {
    ChannelType type{ChannelType::none};
    std::uint8_t kind{0};                       // of its pieces: curve/lengths.hpp
    std::uint8_t axes{0};                       // 3 for an orientation
    std::uint16_t tolerance{0};                 // over the step, in 1/32768, rounded up
    std::array<curve::Scale, axes_max> step{};  // of each axis; orientation: all three alike
    /// What absolute values are told against, in lattice steps; |o| <= origin_max. Of an
    /// orientation: its place on the grid, 4 n + index of the largest component, n, n.
    std::array<std::int32_t, axes_max> origin{};

    constexpr bool own_steps() const noexcept {
        bool own = false;
        for (std::size_t i = 1; i < axes; ++i)
            own = own || step[i].m != step[0].m || step[i].e != step[0].e;
        return own;
    }
};

/// What the head of a frame needs to know of its stream.
struct FrameTiming {
    std::uint32_t sub_ns{0};      // a sub-tick; a tick has 64
    std::uint8_t time_bits{8};    // low bits of the time, in ticks, that a restart carries: 5 to 32
    bool independent{false};      // each frame decodes alone
    std::uint8_t usual_ticks{0};  // of a frame
    std::uint8_t restart_frames{0};  // usually from a restart frame to the next; 0: none is usual
};

/// What a stream is: the fixed part of its header frame.
struct StreamShape {
    std::uint16_t stream_id{0}, run{0};
    std::int64_t base_ns{0};  // time of sub-tick 0
    FrameTiming timing{};
    std::uint8_t channels{0};
    std::array<ChannelShape, channels_max> channel{};
};

/// A header frame: the shape, and where the stream is.
struct Header {
    StreamShape shape{};
    std::uint32_t digest{0};  // CRC-32 of the fixed part
    std::int64_t end{0};      // sub-ticks: end of the latest data frame
    bool starts{false};       // the run begins behind this header frame
};

/// Tolerance over step, in 1/32768, of the lattices that encoders choose (curve/scale.hpp): it is
/// told against these.
inline constexpr std::int32_t vector_tolerance_usual = 27'307, rotation_tolerance_usual = 36'409;

/// Bytes of a header frame with so many channels and steps at most.
constexpr std::size_t header_size_max(std::size_t channels, std::size_t steps) noexcept {
    return 2 + (1 + 3 + 3 + 10 + 5 + 3) + 4 * channels + (2 + 4) * steps + 10 + crc_size;
}
inline constexpr std::size_t header_frame_max =
    header_size_max(channels_max, channels_max* axes_max);
static_assert(header_frame_max <= long_frame_max);

namespace detail {
/// Signed numbers as unsigned ones, small for small sizes: 0 -1 1 -2 2 ...
constexpr std::uint64_t folded(std::int64_t v) noexcept {
    const auto bits = static_cast<std::uint64_t>(v);
    return bits >> 63 ? ~(bits << 1) : bits << 1;
}
constexpr std::int64_t unfolded(std::uint64_t v) noexcept {
    return static_cast<std::int64_t>(v & 1u ? ~(v >> 1) : v >> 1);
}

/// Little-endian numbers in order, to memory or from it: each call gives what now stands there.
struct ByteWriter {
    static constexpr bool writes = true;
    std::uint8_t* data;
    std::size_t size{0}, capacity;
    constexpr std::uint32_t number(std::uint32_t v, std::size_t bytes) noexcept {
        for (std::uint32_t rest = v; bytes > 0 && size < capacity; --bytes, rest >>= 8)
            data[size++] = static_cast<std::uint8_t>(rest);
        return v;
    }
    constexpr std::uint64_t varying(std::uint64_t v) noexcept {
        std::uint64_t rest = v;
        for (; rest >> 7 != 0; rest >>= 7)
            number(static_cast<std::uint32_t>(rest & 0x7fu) | 0x80u, 1);
        number(static_cast<std::uint32_t>(rest), 1);
        return v;
    }
    constexpr std::int64_t zigzag(std::int64_t v) noexcept {
        varying(folded(v));
        return v;
    }
    static constexpr std::int64_t within(std::int64_t v, std::int64_t, std::int64_t) noexcept {
        return v;
    }
};
struct ByteReader {
    static constexpr bool writes = false;
    const std::uint8_t* data;
    std::size_t size{0}, capacity;
    bool good{true};
    constexpr std::uint32_t number(std::uint32_t, std::size_t bytes) noexcept {
        std::uint32_t v = 0;
        for (std::size_t i = 0; i < bytes; ++i, ++size) {
            good = good && size < capacity;
            if (good) v |= std::uint32_t{data[size]} << (8 * i);
        }
        return v;
    }
    constexpr std::uint64_t varying(std::uint64_t) noexcept {
        std::uint64_t v = 0;
        std::uint32_t byte = 0x80;
        for (unsigned shift = 0; (byte & 0x80u) != 0; shift += 7) {
            byte = number(0, 1);
            v |= std::uint64_t{byte & 0x7fu} << shift;
            if (shift < 63) continue;
            good = good && byte <= 1;
            break;
        }
        return v;
    }
    constexpr std::int64_t zigzag(std::int64_t) noexcept { return unfolded(varying(0)); }
    /// The number, where it is between `least` and `most`; else the header is nonsense.
    constexpr std::int64_t within(std::int64_t v, std::int64_t least, std::int64_t most) noexcept {
        const bool inside = v >= least && v <= most;
        good = good && inside;
        return inside ? v : least;
    }
};

template <class Io>
constexpr void code_channel(Io& io, ChannelShape& c) noexcept {
    const bool own = Io::writes && c.own_steps();
    const std::uint32_t turns = c.type == ChannelType::orientation;
    const std::uint32_t form =
        io.number((c.axes - 1u) | (own ? 8u : 0u) | std::uint32_t{c.kind} << 4 | turns << 7, 1);
    c.type = form >> 7 ? ChannelType::orientation : ChannelType::vector;
    c.axes = static_cast<std::uint8_t>((form & 7u) + 1u);
    c.kind = static_cast<std::uint8_t>(form >> 4 & 7u);
    const std::int64_t usual = form >> 7 != 0 ? rotation_tolerance_usual : vector_tolerance_usual;
    const std::int64_t above = io.within(io.zigzag(c.tolerance - usual), -usual, 0xffff - usual);
    c.tolerance = static_cast<std::uint16_t>(usual + above);
    for (std::size_t i = 0; i < c.axes; ++i) {
        if (i > 0 && (form & 8u) == 0) {
            c.step[i] = c.step[0];
            continue;
        }
        c.step[i].m = static_cast<std::uint16_t>(256u + io.number(c.step[i].m - 256u, 1));
        const std::uint32_t e = io.number(static_cast<std::uint8_t>(c.step[i].e), 1);
        c.step[i].e = static_cast<std::int8_t>(e);
    }
    for (std::size_t i = 0; i < c.axes; ++i)
        c.origin[i] =
            static_cast<std::int32_t>(io.within(io.zigzag(c.origin[i]), -origin_max, origin_max));
}

/// A number of 16 bits in 1 to 3 bytes.
template <class Io>
constexpr std::uint16_t code_short_number(Io& io, std::uint16_t v) noexcept {
    const std::uint64_t told = io.varying(v);
    return static_cast<std::uint16_t>(
        io.within(static_cast<std::int64_t>(told >> 17 ? 0x10000u : told), 0, 0xffff));
}

/// The fixed part behind its version.
template <class Io>
constexpr void code_shape(Io& io, StreamShape& s) noexcept {
    s.stream_id = code_short_number(io, s.stream_id);
    s.run = code_short_number(io, s.run);
    s.base_ns = io.zigzag(s.base_ns);
    const std::uint64_t sub = io.varying(s.timing.sub_ns);
    s.timing.sub_ns = sub >> 32 ? 0 : static_cast<std::uint32_t>(sub);
    const std::uint32_t form = io.number(
        (s.timing.time_bits - 1u) | (s.channels - 1u) << 5 | (s.timing.independent ? 0x80u : 0u),
        1);
    s.timing.time_bits = static_cast<std::uint8_t>((form & 31u) + 1u);
    s.channels = static_cast<std::uint8_t>((form >> 5 & 3u) + 1u);
    s.timing.independent = form >> 7 != 0;
    s.timing.usual_ticks = static_cast<std::uint8_t>(io.number(s.timing.usual_ticks, 1));
    s.timing.restart_frames = static_cast<std::uint8_t>(io.number(s.timing.restart_frames, 1));
    for (std::size_t i = 0; i < s.channels; ++i) code_channel(io, s.channel[i]);
}

/// Where the stream is, and whether its run begins there.
template <class Io>
constexpr void code_place(Io& io, std::int64_t& end, bool& starts) noexcept {
    const std::uint64_t told = io.varying(folded(end) << 1 | (starts ? 1u : 0u));
    starts = (told & 1u) != 0;
    end = unfolded(told >> 1);
}
}  // namespace detail

/// Can a decoder follow such a stream? What a channel's step must hold is checked by its decoder.
constexpr bool sane(const StreamShape& s) noexcept {
    bool good = s.timing.sub_ns > 0 && s.timing.time_bits >= 5 && s.timing.usual_ticks > 0;
    for (std::size_t i = 0; i < s.channels; ++i) {
        const ChannelShape& c = s.channel[i];
        good = good && c.kind > 0 && (c.type == ChannelType::vector || c.axes == 3);
    }
    return good;
}

/// Writes the header frames of a stream; keeps the fixed part as its bytes. SizeMax: bytes of a
/// header frame at most.
template <std::size_t SizeMax>
class HeaderWriter {
  public:
    /// The stream, or its next run, whose headers are written from now on.
    void begin(StreamShape& shape) noexcept {
        detail::ByteWriter io{fixed_.data(), 0, fixed_.size()};
        io.number(stream_version, 1);
        detail::code_shape(io, shape);
        size_ = static_cast<std::uint8_t>(io.size);
        digest_ = crc32(fixed_.data(), size_);
    }
    /// CRC-32 of the fixed part.
    std::uint32_t digest() const noexcept { return digest_; }
    /// Writes a header frame to `out`, SizeMax bytes. end: of the latest data frame, in sub-ticks;
    /// starts: the run begins behind it. @return its size.
    std::size_t write(std::int64_t end, bool starts, std::uint8_t* out) const noexcept {
        for (std::size_t i = 0; i < size_; ++i) out[2 + i] = fixed_[i];
        detail::ByteWriter io{out + 2, size_, SizeMax - 2};
        detail::code_place(io, end, starts);
        out[0] = header_head;
        out[1] = static_cast<std::uint8_t>(io.size);
        io.number(crc32(out, 2 + io.size), crc_size);
        return 2 + io.size;
    }

  private:
    std::uint32_t digest_{0};
    std::uint8_t size_{0};
    std::array<std::uint8_t, SizeMax - 3 - crc_size> fixed_{};
};

/// What a header frame turns out to be.
enum class HeaderFault : std::uint8_t {
    none,
    damaged,          // the CRC-32 is wrong, or it is no header frame
    unknown_version,  // a good frame of another version of the format
    bad_content,      // a good frame that tells nonsense
};

/// Reads a header frame of `size` bytes into a new Header.
inline HeaderFault read_header(const std::uint8_t* frame, std::size_t size,
                               Header& header) noexcept {
    if (size < 3 + crc_size || frame[0] != header_head || frame_size(frame[0], frame[1]) != size)
        return HeaderFault::damaged;
    const std::size_t sealed = size - crc_size;
    detail::ByteReader crc{frame + sealed, 0, crc_size};
    if (crc.number(0, crc_size) != crc32(frame, sealed)) return HeaderFault::damaged;
    if (frame[2] != stream_version) return HeaderFault::unknown_version;
    detail::ByteReader io{frame + 3, 0, sealed - 3};
    detail::code_shape(io, header.shape);
    if (!io.good) return HeaderFault::bad_content;
    header.digest = crc32(frame + 2, 1 + io.size);
    detail::code_place(io, header.end, header.starts);
    return io.good && io.size == io.capacity && sane(header.shape) ? HeaderFault::none
                                                                   : HeaderFault::bad_content;
}

}  // namespace fairlead::wire
