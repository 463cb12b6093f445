#pragma once
// Modbus RTU: one serial line on which this program is one or more of the devices.
//
// The specification ends a frame by a silence of 3.5 characters. No USB adapter keeps such times:
// it delivers bytes in pieces that are 1 to 16 ms apart, so silence alone cannot tell a piece from
// a frame. Here a frame ends at once when its CRC is right at a length that its function can have;
// the silence (gap_ns) only ends what has no such length. In that case, and behind noise, the last
// eight bytes before the silence may still be a request, because its sender waits for the answer.
//
// A request whose pieces come further apart than the gap is answered as well, as long as nothing
// stands between the pieces and it is complete within a second. Frames for other units, their
// answers, and the echo of our own answers are recognised by their lengths and left alone: a
// request inside another unit's frame is never answered. Everything else is counted and dropped.
// Source: MODBUS over Serial Line V1.02, section 2.5.1. Bound: 256 bytes a turn, two CRCs a byte.
#include <poll.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"
#include "port/linux/modbus.hpp"
#include "port/linux/modbus_adu.hpp"
#include "port/linux/serial.hpp"

namespace fairlead::port {

struct ModbusRtuConfig {
    const char* device{""};  // must outlive the server
    SerialConfig line{19200, Parity::even, 1};
    bool rs485{false};                // the driver switches the transmitter (TIOCSRS485)
    std::int64_t gap_ns{16'000'000};  // pause that the pieces of a frame may have, at least 0
};

class ModbusRtuServer {
  public:
    ModbusRtuServer(RegisterBank& bank, ModbusCounters& counters) noexcept
        : bank_{bank}, counters_{counters} {}

    /// A line that is not there yet, or goes away, is opened again once a second. bad_argument: no
    /// usual baud rate, or a negative gap.
    Status open(const ModbusRtuConfig& config, std::int64_t now_ns) noexcept;
    bool is_open() const noexcept { return fd_ >= 0; }
    /// The silence that ends a frame: the gap, 3.5 characters, and what a kernel may add.
    std::int64_t silence_ns() const noexcept { return silence_ns_; }

    std::size_t prepare(pollfd* out, std::int64_t now_ns, std::int64_t* wake_ns) noexcept;
    void serve(const pollfd* polled, std::int64_t now_ns) noexcept;

  private:
    static constexpr std::size_t request_size = 1 + modbus::read_pdu_size + 2;

    Status connect() noexcept;
    void clear() noexcept;
    void take(std::uint8_t byte) noexcept;
    void take_frame(const modbus::RtuFrame& frame) noexcept;
    void silence() noexcept;
    bool join_late() noexcept;
    void keep_late() noexcept;
    void expect_answer(const std::uint8_t* adu, std::size_t size) noexcept;
    bool is_our_read(const std::uint8_t* adu) noexcept;
    bool is_ours(std::uint8_t unit) noexcept;

    RegisterBank& bank_;
    ModbusCounters& counters_;
    ModbusReply reply_{};
    ModbusRtuConfig config_{};
    int fd_{-1};  // libmodbus owns it
    std::int64_t silence_ns_{};
    std::int64_t retry_ns_{};
    std::array<std::uint8_t, modbus::rtu_adu_max> buffer_{};  // since the last frame or silence
    std::size_t used_{};
    std::int64_t since_ns_{};                        // of its first byte
    bool lost_{};                                    // where a frame begins is not known
    std::array<std::uint8_t, request_size> late_{};  // a request's first pieces, before the silence
    std::size_t late_used_{};
    std::int64_t late_since_ns_{};
    std::array<std::uint8_t, modbus::rtu_adu_max>
        request_{};  // the newest that waits for an answer
    std::size_t request_used_{};
    std::int64_t now_ns_{};
    std::int64_t last_byte_ns_{};
};

}  // namespace fairlead::port
