#pragma once
// A sensor on this machine as a source: sampling loop -> attitude -> pipeline, and contacts on GPIO
// lines as events beside it. The hardware is behind an interface, so that tests can put models
// there.
#include <array>
#include <cstdint>
#include <memory>

#include "examples/gateway/source.hpp"
#include "port/linux/imu_loop.hpp"

namespace fairlead::gateway {

class SensorHardware {
  public:
    static constexpr std::size_t events_max = 64;  // that one turn can give

    SensorHardware() = default;
    virtual ~SensorHardware() = default;
    SensorHardware(const SensorHardware&) = delete;
    SensorHardware& operator=(const SensorHardware&) = delete;

    /// Bus and lines. Where something is missing: why, with its name.
    struct Opened {
        Status status{Status::ok};
        const char* what{""};
        const char* remedy{""};  // what a user can do about it
    };
    virtual Opened open(const UnitConfig& unit) = 0;
    virtual void close() noexcept = 0;
    virtual port::ImuLoop& loop() noexcept = 0;
    /// Changes of contacts since the last call; never waits.
    virtual std::size_t events(std::int64_t now_ns,
                               std::array<Event, events_max>& out) noexcept = 0;
};

std::unique_ptr<SensorHardware> make_linux_hardware();
std::unique_ptr<Source> make_sensor(const UnitConfig& unit,
                                    std::unique_ptr<SensorHardware> hardware);

}  // namespace fairlead::gateway
