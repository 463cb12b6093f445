#pragma once
// One chip select of an SPI controller through /dev/spidevB.C: the Wire of port/sensors/spi.hpp.
//
// An exchange is one SPI_IOC_MESSAGE: the select stays low from the address to the last byte. No
// heap, no retries; last_errno() keeps the kernel's number of the last failure.
// Source: linux/spi/spidev.h, Documentation/spi/spidev.rst.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"
#include "port/linux/i2c.hpp"

namespace fairlead::port {

/// The three system calls underneath, so that tests can stand in for the kernel.
using SpiSystem = I2cSystem;

class Spidev {
  public:
    static constexpr std::size_t buffer_default = 4096;  // spidev's own limit a message

    Spidev() noexcept : Spidev{SpiSystem::kernel()} {}
    explicit Spidev(SpiSystem& system) noexcept : system_{&system} {}
    Spidev(const Spidev&) = delete;
    Spidev& operator=(const Spidev&) = delete;
    ~Spidev() { close(); }

    /// Mode 3 (clock idles high), which every chip of the table takes; 8 bits a word.
    /// bad_argument: hz is 0. not_supported: the controller refuses the mode.
    Status open(const char* path, std::uint32_t hz) noexcept;
    void close() noexcept;
    bool is_open() const noexcept { return fd_ >= 0; }
    int last_errno() const noexcept { return errno_; }

    Status exchange(const std::uint8_t* out, std::size_t out_size, std::uint8_t* in,
                    std::size_t in_size) noexcept;
    /// What spidev's parameter bufsiz allows; 4096 where the kernel does not tell.
    std::size_t read_max() const noexcept { return read_max_; }
    void pause_us(std::uint32_t microseconds) noexcept;

  private:
    Status call(unsigned long request, const void* argument) noexcept;

    SpiSystem* system_;
    int fd_{-1};
    int errno_{0};
    std::uint32_t hz_{0};
    std::size_t read_max_{buffer_default};
};

}  // namespace fairlead::port
