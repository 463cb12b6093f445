#pragma once
// Modbus RTU: one serial line on which this program is one or more of the devices.
//
// A request for us ends in silence, because its sender waits for the answer. So a frame is judged
// at once when it is a whole read request, and otherwise when the line has been silent: then its
// last eight bytes may still be a request behind noise or behind other devices' talk. Everything
// else is counted and dropped; nothing is answered that is not ours and whole.
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
    bool rs485{false};       // the driver switches the transmitter (TIOCSRS485)
    std::int64_t gap_ns{0};  // silence that ends a frame; 0: 3.5 characters and 2 ms of margin
};

class ModbusRtuServer {
  public:
    ModbusRtuServer(RegisterBank& bank, ModbusCounters& counters) noexcept
        : bank_{bank}, counters_{counters} {}

    /// A line that is not there yet, or goes away, is opened again once a second.
    Status open(const ModbusRtuConfig& config, std::int64_t now_ns) noexcept;
    bool is_open() const noexcept { return fd_ >= 0; }

    std::size_t prepare(pollfd* out, std::int64_t now_ns, std::int64_t* wake_ns) noexcept;
    void serve(const pollfd* polled, std::int64_t now_ns) noexcept;

  private:
    Status connect() noexcept;
    void judge(bool silent) noexcept;
    void answer(const std::uint8_t* adu, std::size_t size) noexcept;
    bool is_our_read(const std::uint8_t* adu) noexcept;
    bool is_ours(std::uint8_t unit) noexcept;

    RegisterBank& bank_;
    ModbusCounters& counters_;
    ModbusReply reply_{};
    ModbusRtuConfig config_{};
    int fd_{-1};  // libmodbus owns it
    std::int64_t gap_ns_{};
    std::int64_t retry_ns_{};
    std::array<std::uint8_t, modbus::rtu_adu_max> buffer_{};
    std::size_t used_{};
    bool overlong_{};
    std::int64_t last_byte_ns_{};
};

}  // namespace fairlead::port
