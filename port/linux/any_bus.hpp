#pragma once
// A bus that a user names by its device: /dev/i2c-N or /dev/spidevB.C. One driver instance then
// serves both, at the cost of a branch per transaction.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "port/linux/i2c.hpp"
#include "port/linux/spidev.hpp"
#include "port/sensors/spi.hpp"

namespace fairlead::port {

class AnyBus {
  public:
    /// `style` is the chip's (chips.hpp). SPI runs at `hz`, at most what the chip takes.
    /// not_supported: SPI for a chip without it. bad_argument: neither kind of device.
    Status open(const std::string& device, const SpiStyle& style, std::uint32_t hz) noexcept {
        close();
        if (is_spi(device)) {
            if (style.hz_max == 0) return Status::not_supported;
            const Status s = wire_.open(device.c_str(), hz < style.hz_max ? hz : style.hz_max);
            if (s == Status::ok) spi_.emplace(wire_, style);
            return s;
        }
        return is_i2c(device) ? i2c_.open(device.c_str()) : Status::bad_argument;
    }
    void close() noexcept {
        spi_.reset();
        wire_.close();
        i2c_.close();
    }
    static bool is_spi(const std::string& device) noexcept {
        return device.rfind("/dev/spidev", 0) == 0;
    }
    static bool is_i2c(const std::string& device) noexcept {
        return device.rfind("/dev/i2c-", 0) == 0;
    }
    /// What a user can do about a failed open(), or an empty text.
    static const char* remedy(const std::string& device, Status status) noexcept {
        const bool spi = is_spi(device);
        switch (status) {
            case Status::not_found:
                return spi ? "enable spidev: modprobe spidev, and dtparam=spi=on on a Raspberry Pi"
                           : "enable i2c-dev: modprobe i2c-dev, and dtparam=i2c_arm=on on a "
                             "Raspberry Pi; i2cdetect -l lists the buses";
            case Status::no_permission:
                return spi ? "add the user to the group spi, or run as root"
                           : "add the user to the group i2c, or run as root";
            case Status::not_supported: return "this chip has no SPI: connect it by I2C";
            case Status::bad_argument: return "a bus is /dev/i2c-N or /dev/spidevB.C";
            default: return "";
        }
    }
    int last_errno() const noexcept { return spi_ ? wire_.last_errno() : i2c_.last_errno(); }

    // The Bus of port/sensors.
    Status transfer(const Transfer* list, std::size_t count) noexcept {
        return spi_ ? spi_->transfer(list, count) : i2c_.transfer(list, count);
    }
    std::size_t read_max() const noexcept { return spi_ ? spi_->read_max() : i2c_.read_max(); }
    void pause_us(std::uint32_t microseconds) noexcept { i2c_.pause_us(microseconds); }

  private:
    I2c i2c_;
    Spidev wire_;
    std::optional<SpiBus<Spidev>> spi_;
};

}  // namespace fairlead::port
