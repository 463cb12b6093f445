#pragma once
// What a Modbus request says, decided on its bytes alone: framing, lengths, function, range.
//
// Source: MODBUS Application Protocol V1.1b3 (sections 4, 6, 7), Messaging on TCP/IP V1.0b (3.1.3),
// over Serial Line V1.02 (2.5.1). Pure functions, no I/O; bound: one pass over at most 260 bytes.
#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace fairlead::port::modbus {

constexpr std::size_t mbap_size = 7;      // transaction 2, protocol 2, length 2, unit 1
constexpr std::size_t tcp_adu_max = 260;  // MBAP + 253 bytes of PDU
constexpr std::size_t rtu_adu_max = 256;  // unit + PDU + CRC
constexpr std::size_t read_pdu_size = 5;  // function, address, quantity
constexpr std::uint16_t quantity_max = 125;

enum class Exception : std::uint8_t {
    none = 0x00,
    illegal_function = 0x01,
    illegal_address = 0x02,
    illegal_value = 0x03,
    target_failed = 0x0B,  // a gateway's answer for a unit that it does not serve
};

constexpr std::uint16_t word_at(const std::uint8_t* bytes) noexcept {
    return static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]);
}

enum class Framing : std::uint8_t { incomplete, complete, broken };

struct TcpFrame {
    Framing state{Framing::incomplete};
    std::size_t size{};  // of the whole ADU, when complete
};

/// Looks for one ADU at the start of a TCP stream. Broken: no later byte can make sense.
constexpr TcpFrame find_tcp_frame(const std::uint8_t* bytes, std::size_t size) noexcept {
    if (size >= 4 && word_at(bytes + 2) != 0) return {Framing::broken, 0};
    if (size < 6) return {};
    const std::size_t length = word_at(bytes + 4);  // unit and PDU
    if (length < 2 || length > tcp_adu_max - 6) return {Framing::broken, 0};
    if (size < mbap_size + 1) return {};
    // 0 and 128..255 are no request's functions, so the answer could not be told from another's
    if (bytes[mbap_size] == 0 || bytes[mbap_size] >= 0x80) return {Framing::broken, 0};
    if (size < length + 6) return {};
    return {Framing::complete, length + 6};
}

struct ReadRequest {
    Exception exception{Exception::none};
    std::uint16_t address{};
    std::uint16_t quantity{};
};

/// A PDU on a read-only table that functions 3 and 4 serve alike. The range is the caller's to
/// check.
constexpr ReadRequest parse_pdu(const std::uint8_t* pdu, std::size_t size) noexcept {
    if (size < 1 || (pdu[0] != 0x03 && pdu[0] != 0x04)) return {Exception::illegal_function, 0, 0};
    if (size != read_pdu_size) return {Exception::illegal_value, 0, 0};
    const std::uint16_t quantity = word_at(pdu + 3);
    if (quantity == 0 || quantity > quantity_max) return {Exception::illegal_value, 0, 0};
    return {Exception::none, word_at(pdu + 1), quantity};
}

/// CRC-16 of the serial line: polynomial 0xA001 reflected, initial value 0xFFFF.
constexpr std::uint16_t crc16(const std::uint8_t* bytes, std::size_t size) noexcept {
    std::uint32_t crc = 0xFFFF;
    for (std::size_t i = 0; i < size; ++i) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? crc >> 1 ^ 0xA001u : crc >> 1;
    }
    return static_cast<std::uint16_t>(crc);
}

/// True when the last two bytes are the CRC of those before them (low byte first).
constexpr bool crc_matches(const std::uint8_t* adu, std::size_t size) noexcept {
    if (size < 4) return false;
    const std::uint16_t crc = crc16(adu, size - 2);
    return adu[size - 2] == (crc & 0xFF) && adu[size - 1] == crc >> 8;
}

/// The sizes that a frame of a serial line can have, by its first bytes. 0: not known, either for
/// ever or until more bytes are there (`open`).
struct RtuSizes {
    std::size_t request{};
    std::size_t response{};
    bool open{};  // further bytes will tell more
};

/// Functions of MODBUS Application Protocol V1.1b3, sections 6.1 to 6.18. Others have no known
/// size.
constexpr RtuSizes rtu_sizes(const std::uint8_t* bytes, std::size_t size) noexcept {
    if (size < 2) return {0, 0, true};
    const auto counted = [&](std::size_t at, std::size_t around) -> std::size_t {
        return size > at ? around + bytes[at] : 0;
    };
    if (bytes[1] >= 0x80) return {0, 5, false};
    switch (bytes[1]) {
        case 0x01:
        case 0x02:
        case 0x03:
        case 0x04: return {8, counted(2, 5), size < 3};
        case 0x05:
        case 0x06:
        case 0x08: return {8, 8, false};
        case 0x07: return {4, 5, false};
        case 0x0B: return {4, 8, false};
        case 0x0C:
        case 0x11: return {4, counted(2, 5), size < 3};
        case 0x0F:
        case 0x10: return {counted(6, 9), 8, size < 7};
        case 0x14:
        case 0x15: return {counted(2, 5), counted(2, 5), size < 3};
        case 0x16: return {10, 10, false};
        case 0x17: return {counted(10, 13), counted(2, 5), size < 11};
        case 0x18: return {6, size > 3 ? 6u + word_at(bytes + 2) : 0u, size < 4};
        default: return {};
    }
}

struct RtuFrame {
    Framing state{Framing::incomplete};
    std::size_t size{};      // of the whole frame, when complete
    bool is_request{false};  // ... and it has a request's size
};

/// Looks for one frame at the start of the bytes: complete where the CRC is right at a size that
/// its function can have, broken where no further byte can make it so. Call for every byte that is
/// added, since a frame ends as soon as it is complete.
constexpr RtuFrame find_rtu_frame(const std::uint8_t* bytes, std::size_t size) noexcept {
    const RtuSizes sizes = rtu_sizes(bytes, size);
    bool open = sizes.open;
    for (const std::size_t wanted : {sizes.request, sizes.response}) {
        if (wanted == 0 || wanted > rtu_adu_max) continue;
        if (size < wanted)
            open = true;
        else if (crc_matches(bytes, wanted))
            return {Framing::complete, wanted, wanted == sizes.request};
    }
    return {open ? Framing::incomplete : Framing::broken, 0, false};
}

}  // namespace fairlead::port::modbus
