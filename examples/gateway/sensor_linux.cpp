// A sensor's hardware on Linux: i2c-dev or spidev, and libgpiod.
#include <vector>

#include "examples/gateway/sensor.hpp"
#include "port/linux/any_bus.hpp"
#include "port/linux/button.hpp"
#include "port/linux/gpio.hpp"

namespace fairlead::gateway {
namespace {

class LinuxHardware final : public SensorHardware {
  public:
    Opened open(const UnitConfig& unit) override {
        close();
        const port::ChipInfo* const imu = port::ImuChips::find(unit.imu.sensor);
        if (imu == nullptr) return {Status::not_supported, "sensor"};
        const auto hz = static_cast<std::uint32_t>(unit.spi_hz);
        if (const Status s = bus_.open(unit.bus, imu->spi, hz); s != Status::ok)
            return {s, "bus", port::AnyBus::remedy(unit.bus, s)};
        port::AnyBus* mag = &bus_;
        if (unit.mag_bus >= 0) {
            const std::string device = "/dev/i2c-" + std::to_string(unit.mag_bus);
            if (const Status s = mag_bus_.open(device, {}, 0); s != Status::ok)
                return {s, "mag_bus", port::AnyBus::remedy(device, s)};
            mag = &mag_bus_;
        }
        if (const Status s = ready_.open(unit.chip.c_str(), unit.line_number); s != Status::ok)
            return {s, "data-ready line"};
        buttons_.reserve(unit.buttons.size());  // contacts keep pointers to their lines
        for (const ButtonConfig& button : unit.buttons) {
            port::GpioEdges& edges = buttons_.emplace_back();
            const Status s = edges.open(unit.chip.c_str(), button.line, port::EdgeKind::both);
            if (s != Status::ok) return {s, "button line"};
            contacts_.emplace_back(
                edges, static_cast<std::uint16_t>(button.channel),
                port::Debounce{static_cast<std::int64_t>(button.debounce_s * 1e9),
                               button.active_low});
        }
        loop_ = port::make_imu_loop(unit.imu, bus_, *mag, ready_, port::MonotonicClock{});
        return {loop_ ? Status::ok : Status::not_supported, "sensor"};
    }
    void close() noexcept override {
        loop_.reset();
        contacts_.clear();
        buttons_.clear();
        ready_.close();
        bus_.close();
        mag_bus_.close();
    }
    port::ImuLoop& loop() noexcept override { return *loop_; }
    std::size_t events(std::int64_t now_ns, std::array<Event, events_max>& out) noexcept override {
        std::size_t n = 0;
        for (auto& contact : contacts_) {
            contact.step(now_ns, [&](const Event& event) {
                if (n < out.size()) out[n++] = event;
            });
        }
        return n;
    }

  private:
    port::AnyBus bus_, mag_bus_;
    port::DataReady ready_;
    std::vector<port::GpioEdges> buttons_;
    std::vector<port::Contact<port::GpioEdges>> contacts_;
    std::unique_ptr<port::ImuLoop> loop_;
};

}  // namespace

std::unique_ptr<SensorHardware> make_linux_hardware() { return std::make_unique<LinuxHardware>(); }

}  // namespace fairlead::gateway
