#pragma once
// The header frame: what a stream is. It stands at the start of a run, is repeated at an interval,
// and may be kept by a reader: the digest of its fixed part enters the check of every data frame,
// so a header of another stream, run or device never decodes anything.
//
//   0xF8 | size | fixed part | end | flags 1 | CRC-32 of all before
//   fixed part  version 1, stream id 2, run 2, base_ns 8, sub_ns v, time bits 1 (bit 7: independent
//               frames), usual ticks of a frame v, number of channels 1, then for each channel
//               type and kind 1, axes 1 (bit 7: a step for each axis), tolerance over step 2,
//               steps: mantissa less 256 1, exponent 1
//   end         v, zigzag
// Numbers are little-endian; v: 7 bits a byte, bit 7 says that more follow (docs/stream.md).
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/crc32.hpp"
#include "fairlead/wire2/check.hpp"

namespace fairlead::wire2 {

inline constexpr std::size_t channels_max = 4, axes_max = 8;

/// A step of the lattice: mantissa * 2^exponent, in the channel's unit; mantissa 256 to 511.
struct Step {
    std::uint16_t mantissa{0};
    std::int8_t exponent{0};
};
constexpr bool operator==(const Step& a, const Step& b) noexcept {
    return a.mantissa == b.mantissa && a.exponent == b.exponent;
}

enum class ChannelType : std::uint8_t { none = 0, vector = 1, orientation = 2 };

/// One channel of a stream.
struct ChannelShape {
    ChannelType type{ChannelType::none};
    std::uint8_t kind{0};               // of its pieces: 1 C1 quadratic, 2 C1 quadratic with lines
    std::uint8_t axes{0};               // 3 for an orientation
    std::uint16_t tolerance{0};         // over the step, in 1/32768, rounded up
    std::array<Step, axes_max> step{};  // vectors: a step for each axis; orientation: the first

    constexpr std::size_t steps() const noexcept {
        if (type == ChannelType::orientation) return 1;
        for (std::size_t i = 1; i < axes; ++i)
            if (!(step[i] == step[0])) return axes;
        return 1;
    }
};

/// What the head of a frame needs to know of its stream.
struct FrameTiming {
    std::uint32_t sub_ns{0};       // a sub-tick; a tick has 64
    std::uint8_t time_bits{0};     // low bits of the time, in ticks, that a restart carries
    bool independent{false};       // each frame decodes alone
    std::uint16_t usual_ticks{0};  // of a frame
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

/// Bytes of a header frame with so many channels and steps at most.
constexpr std::size_t header_size_max(std::size_t channels, std::size_t steps) noexcept {
    return 2 + (16 + 5 + 3) + 4 * channels + 2 * steps + (10 + 1) + crc_size;
}
inline constexpr std::size_t header_frame_max =
    header_size_max(channels_max, channels_max* axes_max);
static_assert(header_frame_max <= long_frame_max);

namespace detail {
/// Little-endian numbers in order, to memory or from it.
struct ByteWriter {
    static constexpr bool writes = true;
    std::uint8_t* data;
    std::size_t size{0}, capacity;
    template <class Unsigned>
    constexpr void number(Unsigned& v, std::size_t bytes) noexcept {
        auto wide = static_cast<std::uint64_t>(v);
        for (; bytes > 0 && size < capacity; --bytes, wide >>= 8)
            data[size++] = static_cast<std::uint8_t>(wide);
    }
    template <class Unsigned>
    constexpr void varying(Unsigned& v) noexcept {
        auto wide = static_cast<std::uint64_t>(v);
        for (bool more = true; more && size < capacity; wide >>= 7) {
            more = wide >> 7 != 0;
            data[size++] = static_cast<std::uint8_t>((wide & 0x7fu) | (more ? 0x80u : 0u));
        }
    }
    constexpr bool ok() const noexcept { return true; }
};
struct ByteReader {
    static constexpr bool writes = false;
    const std::uint8_t* data;
    std::size_t size{0}, capacity;
    bool good{true};
    template <class Unsigned>
    constexpr void number(Unsigned& v, std::size_t bytes) noexcept {
        std::uint64_t wide = 0;
        good = good && bytes <= capacity - size;
        for (std::size_t i = 0; good && i < bytes; ++i)
            wide |= std::uint64_t{data[size++]} << (8 * i);
        v = static_cast<Unsigned>(wide);
    }
    template <class Unsigned>
    constexpr void varying(Unsigned& v) noexcept {
        std::uint64_t wide = 0;
        bool more = true;
        for (unsigned shift = 0; more && good && shift < 70; shift += 7) {
            std::uint8_t byte = 0;
            number(byte, 1);
            more = (byte & 0x80u) != 0;
            if (shift < 64) wide |= std::uint64_t{byte & 0x7fu} << shift;
        }
        v = static_cast<Unsigned>(wide);
        good = good && !more && v == wide;
    }
    constexpr bool ok() const noexcept { return good; }
};

template <class Io>
constexpr void code_channel(Io& io, ChannelShape& c) noexcept {
    auto type = static_cast<std::uint8_t>(static_cast<unsigned>(c.type) << 4 | (c.kind & 15u));
    io.number(type, 1);
    c.type = static_cast<ChannelType>(type >> 4);
    c.kind = type & 15u;
    std::size_t steps = Io::writes ? c.steps() : 0;
    auto axes = static_cast<std::uint8_t>(c.axes | (steps > 1 ? 0x80u : 0u));
    io.number(axes, 1);
    c.axes = axes & 0x7fu;
    if (!Io::writes) steps = (axes & 0x80u) != 0 ? c.axes : 1;
    io.number(c.tolerance, 2);
    for (std::size_t i = 0; i < steps && i < axes_max; ++i) {
        auto mantissa = static_cast<std::uint8_t>(c.step[i].mantissa - 256u);
        io.number(mantissa, 1);
        c.step[i].mantissa = static_cast<std::uint16_t>(256u + mantissa);
        auto exponent = static_cast<std::uint8_t>(c.step[i].exponent);
        io.number(exponent, 1);
        c.step[i].exponent = static_cast<std::int8_t>(exponent);
    }
    if (!Io::writes && steps == 1) c.step.fill(c.step[0]);
}

/// The fixed part behind its version.
template <class Io>
constexpr void code_shape(Io& io, StreamShape& s) noexcept {
    io.number(s.stream_id, 2);
    io.number(s.run, 2);
    auto base = static_cast<std::uint64_t>(s.base_ns);
    io.number(base, 8);
    s.base_ns = static_cast<std::int64_t>(base);
    io.varying(s.timing.sub_ns);
    auto bits = static_cast<std::uint8_t>(s.timing.time_bits | (s.timing.independent ? 0x80u : 0u));
    io.number(bits, 1);
    s.timing.time_bits = bits & 0x7fu;
    s.timing.independent = (bits & 0x80u) != 0;
    io.varying(s.timing.usual_ticks);
    io.number(s.channels, 1);
    for (std::size_t i = 0; i < s.channels && i < channels_max; ++i) code_channel(io, s.channel[i]);
}
}  // namespace detail

/// Can a decoder follow such a stream? What a channel's step must hold is checked by its decoder.
constexpr bool sane(const StreamShape& s) noexcept {
    bool good = s.timing.sub_ns > 0 && s.timing.time_bits >= 8 && s.timing.time_bits <= 40 &&
                s.timing.usual_ticks > 0 && s.channels > 0 && s.channels <= channels_max;
    for (std::size_t i = 0; good && i < s.channels; ++i) {
        const ChannelShape& c = s.channel[i];
        good = c.type == ChannelType::orientation
                   ? c.axes == 3
                   : c.type == ChannelType::vector && c.axes > 0 && c.axes <= axes_max;
        good = good && c.kind > 0;
    }
    return good;
}

/// Writes the header frame to `out`, header_frame_max bytes, and sets its digest. @return its size.
inline std::size_t write_header(Header& header, std::uint8_t* out) noexcept {
    detail::ByteWriter io{out + 2, 0, header_frame_max - 2};
    std::uint8_t version = stream_version;
    io.number(version, 1);
    detail::code_shape(io, header.shape);
    header.digest = crc32(out + 2, io.size);
    const auto bits = static_cast<std::uint64_t>(header.end);
    std::uint64_t end = bits >> 63 ? ~(bits << 1) : bits << 1;
    io.varying(end);
    std::uint8_t flags = header.starts ? 1 : 0;
    io.number(flags, 1);
    out[0] = header_head;
    out[1] = static_cast<std::uint8_t>(io.size);
    std::uint32_t crc = crc32(out, 2 + io.size);
    io.number(crc, crc_size);
    return 2 + io.size;
}

/// What a header frame turns out to be.
enum class HeaderFault : std::uint8_t {
    none,
    damaged,          // the CRC-32 is wrong, or it is no header frame
    unknown_version,  // a good frame of another version of the format
    bad_content,      // a good frame that tells nonsense
};

/// Reads a header frame of `size` bytes.
inline HeaderFault read_header(const std::uint8_t* frame, std::size_t size,
                               Header& header) noexcept {
    if (size < 3 + crc_size || frame[0] != header_head || frame_size(frame[0], frame[1]) != size)
        return HeaderFault::damaged;
    const std::size_t sealed = size - crc_size;
    detail::ByteReader crc_io{frame + sealed, 0, crc_size};
    std::uint32_t crc = 0;
    crc_io.number(crc, crc_size);
    if (crc != crc32(frame, sealed)) return HeaderFault::damaged;
    if (frame[2] != stream_version) return HeaderFault::unknown_version;
    header = {};
    detail::ByteReader io{frame + 3, 0, sealed - 3};
    detail::code_shape(io, header.shape);
    if (!io.ok() || !sane(header.shape)) return HeaderFault::bad_content;
    header.digest = crc32(frame + 2, 1 + io.size);
    std::uint64_t end = 0;
    io.varying(end);
    header.end = static_cast<std::int64_t>(end & 1u ? ~(end >> 1) : end >> 1);
    std::uint8_t flags = 0;
    io.number(flags, 1);
    header.starts = (flags & 1u) != 0;
    return io.ok() && io.size == io.capacity ? HeaderFault::none : HeaderFault::bad_content;
}

}  // namespace fairlead::wire2
