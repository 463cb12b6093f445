// Modbus requests as bytes: framing over TCP, the PDU, the CRC of the serial line. Held against a
// second reading of the specification, written here without the first.
#include "port/linux/modbus_adu.hpp"

#include <algorithm>
#include <vector>

#include "tests/fuzz/input.hpp"

using namespace fairlead;
namespace modbus = fairlead::port::modbus;

namespace {

std::uint16_t crc_by_table(const std::uint8_t* bytes, std::size_t size) {
    static const std::vector<std::uint16_t> table = [] {
        std::vector<std::uint16_t> t(256);
        for (unsigned i = 0; i < 256; ++i) {
            unsigned c = i;
            for (int k = 0; k < 8; ++k) c = c % 2 ? c / 2 ^ 0xA001u : c / 2;
            t[i] = static_cast<std::uint16_t>(c);
        }
        return t;
    }();
    unsigned crc = 0xFFFF;
    for (std::size_t i = 0; i < size; ++i) crc = crc >> 8 ^ table[(crc ^ bytes[i]) & 0xFF];
    return static_cast<std::uint16_t>(crc);
}

void stream(const std::uint8_t* data, std::size_t size) {
    const modbus::TcpFrame whole = modbus::find_tcp_frame(data, size);
    // the answer may not change its mind as bytes arrive, and must not wait for more than it needs
    for (std::size_t n = 0; n <= std::min<std::size_t>(size, modbus::tcp_adu_max + 4); ++n) {
        const modbus::TcpFrame part = modbus::find_tcp_frame(data, n);
        switch (part.state) {
            case modbus::Framing::broken:
                FUZZ_EXPECT(whole.state == modbus::Framing::broken);
                return;
            case modbus::Framing::complete:
                FUZZ_EXPECT(part.size == n && whole.size == n);
                FUZZ_EXPECT(n >= 8 && n <= modbus::tcp_adu_max);
                FUZZ_EXPECT(data[2] == 0 && data[3] == 0);
                FUZZ_EXPECT(n == 6u + data[4] * 256u + data[5]);
                return;
            case modbus::Framing::incomplete: break;
        }
    }
    FUZZ_EXPECT(size <= modbus::tcp_adu_max);
}

void pdu(const std::uint8_t* data, std::size_t size) {
    const modbus::ReadRequest r = modbus::parse_pdu(data, size);
    const bool known = size > 0 && (data[0] == 3 || data[0] == 4);
    FUZZ_EXPECT((r.exception == modbus::Exception::illegal_function) == !known);
    if (r.exception != modbus::Exception::none) return;
    FUZZ_EXPECT(size == 5 && r.quantity >= 1 && r.quantity <= 125);
    FUZZ_EXPECT(r.address == data[1] * 256 + data[2] && r.quantity == data[3] * 256 + data[4]);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size > 600) return 0;
    stream(data, size);
    pdu(data, size);
    FUZZ_EXPECT(modbus::crc16(data, size) == crc_by_table(data, size));
    if (size >= 4) {
        std::vector<std::uint8_t> adu{data, data + size};
        const std::uint16_t crc = crc_by_table(data, size - 2);
        adu[size - 2] = static_cast<std::uint8_t>(crc & 0xFF);
        adu[size - 1] = static_cast<std::uint8_t>(crc >> 8);
        FUZZ_EXPECT(modbus::crc_matches(adu.data(), size));
        adu[data[0] % size] ^= static_cast<std::uint8_t>(1 + data[1] % 255);
        FUZZ_EXPECT(!modbus::crc_matches(adu.data(), size));
    }
    return 0;
}
