// The Modbus RTU server on a line that says anything: noise, requests with right checks, pieces and
// pauses. Held: every answer is one of ours, to a request for a unit of ours that was on the line;
// the work of a turn is bounded; the server ends where the line ends.
#include "port/linux/modbus_rtu.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <vector>

#include "tests/fuzz/input.hpp"

using namespace fairlead;
namespace modbus = fairlead::port::modbus;

namespace {

/// Two units of a hundred registers; register n holds n.
class Bank : public port::RegisterBank {
  public:
    port::RegisterTable prepare(std::uint8_t unit, std::uint16_t, std::uint16_t) noexcept override {
        if (unit != 1 && unit != 7) return {};
        for (std::size_t i = 0; i < table_.size(); ++i) table_[i] = static_cast<std::uint16_t>(i);
        return {table_.data(), static_cast<std::uint16_t>(table_.size())};
    }

  private:
    std::array<std::uint16_t, 100> table_{};
};

/// A pair of pseudo-terminals for the life of the process.
struct Line {
    int ours{-1}, device{-1};
    std::array<char, 128> path{};
    Line() {
        FUZZ_EXPECT(openpty(&ours, &device, path.data(), nullptr, nullptr) == 0);
        fcntl(ours, F_SETFL, O_NONBLOCK);
    }
};

void put_crc(std::vector<std::uint8_t>& adu) {
    const std::uint16_t crc = modbus::crc16(adu.data(), adu.size());
    adu.push_back(static_cast<std::uint8_t>(crc & 0xFF));
    adu.push_back(static_cast<std::uint8_t>(crc >> 8));
}

/// Something to say: noise, or a frame whose check is right.
std::vector<std::uint8_t> said(fuzz::Input& in) {
    std::vector<std::uint8_t> bytes;
    const std::uint8_t kind = in.byte();
    if (kind % 4 == 0) {
        for (int n = in.byte() % 40; n >= 0; --n) bytes.push_back(in.byte());
        return bytes;
    }
    const std::uint8_t units[] = {1, 7, 9, 0};
    bytes.push_back(units[in.byte() % 4]);
    bytes.push_back(kind % 4 == 1 ? std::uint8_t{3} : in.byte());
    const int more = kind % 4 == 3 ? in.byte() % 60 : 4;
    for (int n = 0; n < more; ++n) bytes.push_back(in.byte() % (n % 2 == 0 ? 4 : 255));
    put_crc(bytes);
    return bytes;
}

/// Answers are ours: unit, function, and either an exception or registers of the bank.
void check_answers(const std::vector<std::uint8_t>& got) {
    for (std::size_t at = 0; at < got.size();) {
        FUZZ_EXPECT(got.size() - at >= 5);
        const std::uint8_t unit = got[at], function = got[at + 1];
        FUZZ_EXPECT(unit == 1 || unit == 7);
        const std::size_t size = (function & 0x80) != 0 ? 5u : 5u + got[at + 2];
        FUZZ_EXPECT(at + size <= got.size());
        FUZZ_EXPECT(modbus::crc_matches(got.data() + at, size));
        if ((function & 0x80) == 0) {
            FUZZ_EXPECT(function == 3 || function == 4);
            FUZZ_EXPECT(got[at + 2] % 2 == 0 && got[at + 2] > 0);
            unsigned before = 0;
            for (std::size_t i = 0; i < got[at + 2] / 2u; ++i) {
                const unsigned value = got[at + 3 + 2 * i] * 256u + got[at + 4 + 2 * i];
                FUZZ_EXPECT(value < 100 && (i == 0 || value == before + 1));
                before = value;
            }
        }
        at += size;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static Line line;
    fuzz::Input in{data, size};
    Bank bank;
    port::ModbusCounters counters;
    port::ModbusRtuServer server{bank, counters};
    port::ModbusRtuConfig config;
    config.device = line.path.data();
    std::int64_t now_ns = 1'000'000'000'000;
    FUZZ_EXPECT(server.open(config, now_ns) == Status::ok);
    std::vector<std::uint8_t> answers(4096);
    const auto turn = [&] {
        std::int64_t wake_ns = now_ns + 1'000'000'000;
        pollfd polled{};
        FUZZ_EXPECT(server.prepare(&polled, now_ns, &wake_ns) <= 1);
        poll(&polled, 1, 0);
        server.serve(&polled, now_ns);
        const ssize_t n = read(line.ours, answers.data(), answers.size());
        if (n > 0)
            check_answers({answers.begin(), answers.begin() + static_cast<std::ptrdiff_t>(n)});
    };
    for (int steps = 0; !in.empty() && steps < 64; ++steps) {
        const auto bytes = said(in);
        const std::size_t piece = 1 + in.byte() % 32u;
        for (std::size_t at = 0; at < bytes.size(); at += piece) {
            const std::size_t n = std::min(piece, bytes.size() - at);
            // a line that is full loses bytes, as a real one does
            FUZZ_EXPECT(write(line.ours, bytes.data() + at, n) >= 0 || errno == EAGAIN);
            turn();
            now_ns += in.byte() * 100'000LL;
        }
        if (in.byte() % 2 == 0) now_ns += 20'000'000;
        turn();
    }
    FUZZ_EXPECT(counters.requests <= size + 64);
    now_ns += 2'000'000'000;
    turn();
    return 0;
}
