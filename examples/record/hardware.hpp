#pragma once
// Bus, data-ready line and sensor of a recording, opened together and opened anew when they have
// gone: a sensor may be pulled and put back, an adapter may leave the system and return.
#include <cstdint>
#include <memory>
#include <string>

#include "port/linux/any_bus.hpp"
#include "port/linux/clock.hpp"
#include "port/linux/gpio.hpp"
#include "port/linux/imu_loop.hpp"

namespace fairlead::record {

struct Wiring {
    std::string bus{"/dev/i2c-1"};
    std::uint32_t spi_hz{1000000};
    std::string mag_bus;  // the sensor's own
    port::ImuSetup imu;
    std::string chip{"/dev/gpiochip0"};
    unsigned line{0};
};

class Hardware {
  public:
    explicit Hardware(const Wiring& wiring) : wiring_{wiring} {}

    /// False: error() says what is missing and what a user can do about it.
    bool open() {
        close();
        const port::ChipInfo* const chip = port::ImuChips::find(wiring_.imu.sensor);
        if (chip == nullptr) return fail(wiring_.imu.sensor, Status::not_supported, 0, "");
        if (!open_bus(bus_, wiring_.bus, chip->spi)) return false;
        port::AnyBus* mag = &bus_;
        if (!wiring_.mag_bus.empty()) {
            if (!open_bus(mag_bus_, wiring_.mag_bus, {})) return false;
            mag = &mag_bus_;
        }
        const Status s = ready_.open(wiring_.chip.c_str(), wiring_.line);
        if (s != Status::ok) {
            const std::string line = wiring_.chip + " line " + std::to_string(wiring_.line);
            return fail(line, s, ready_.last_errno(), remedy_for_line(s));
        }
        loop_ = port::make_imu_loop(wiring_.imu, bus_, *mag, ready_, port::MonotonicClock{});
        return loop_ != nullptr || fail(wiring_.imu.mag, Status::not_supported, 0, "");
    }
    void close() noexcept {
        loop_.reset();
        ready_.close();
        bus_.close();
        mag_bus_.close();
    }

    port::ImuLoop& loop() noexcept { return *loop_; }
    bool is_open() const noexcept { return loop_ != nullptr; }
    const port::AnyBus& bus() const noexcept { return bus_; }
    std::uint64_t edges_dropped() const noexcept { return ready_.dropped(); }
    const std::string& error() const noexcept { return error_; }

  private:
    bool open_bus(port::AnyBus& bus, const std::string& device, const port::SpiStyle& style) {
        const Status s = bus.open(device, style, wiring_.spi_hz);
        return s == Status::ok ||
               fail(device, s, bus.last_errno(), port::AnyBus::remedy(device, s));
    }
    bool fail(const std::string& what, Status status, int error, const char* remedy) {
        error_ = what + ": " + to_string(status);
        if (error != 0) error_ += ", errno " + std::to_string(error);
        if (*remedy != 0) error_ += std::string{"; "} + remedy;
        close();
        return false;
    }
    static const char* remedy_for_line(Status status) noexcept {
        switch (status) {
            case Status::not_found: return "gpiodetect lists the chips, gpioinfo their lines";
            case Status::no_permission: return "add the user to the group gpio, or run as root";
            case Status::busy: return "another program holds the line: gpioinfo names it";
            default: return "";
        }
    }

    Wiring wiring_;
    port::AnyBus bus_, mag_bus_;
    port::DataReady ready_;
    std::unique_ptr<port::ImuLoop> loop_;
    std::string error_;
};

}  // namespace fairlead::record
