#pragma once
// A serial line (UART, USB adapter, pseudo-terminal), raw and non-blocking, for use under poll().
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"

namespace fairlead::port {

enum class Parity : char { none = 'N', even = 'E', odd = 'O' };

struct SerialConfig {
    int baud{115200};  // 9600 ... 4000000, as the system's list has it
    Parity parity{Parity::none};
    int stop_bits{1};
};

/// True for the rates that the system can set.
bool is_baud_rate(int baud) noexcept;

/// Owns the descriptor. Nobody else can open the device meanwhile (TIOCEXCL).
class SerialPort {
  public:
    SerialPort() = default;
    ~SerialPort() { close(); }
    SerialPort(SerialPort&& other) noexcept : fd_{other.fd_} { other.fd_ = -1; }
    SerialPort& operator=(SerialPort&& other) noexcept;
    SerialPort(const SerialPort&) = delete;
    SerialPort& operator=(const SerialPort&) = delete;

    /// What the line held before is discarded. errno of the failing call: last_errno().
    Status open(const char* device, const SerialConfig& config) noexcept;
    void close() noexcept;

    bool is_open() const noexcept { return fd_ >= 0; }
    int fd() const noexcept { return fd_; }
    int last_errno() const noexcept { return errno_; }

    /// What is there, at most size bytes; timeout: nothing yet; disconnected: the device is gone.
    Result<std::size_t> read(std::uint8_t* out, std::size_t size) noexcept;
    /// Takes as much as the line's buffer has room for.
    Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size) noexcept;

  private:
    int fd_{-1};
    int errno_{};
};

}  // namespace fairlead::port
