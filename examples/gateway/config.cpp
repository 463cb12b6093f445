#include "examples/gateway/config.hpp"

#include <algorithm>
#include <set>

#include "examples/gateway/calibration_file.hpp"
#include "port/linux/any_bus.hpp"

namespace fairlead::gateway {

// Each function below names every member of its struct: a member that is added and not compared
// does not compile.
namespace {

template <class T>
bool same(const T& a, const T& b) {
    return a == b;
}
bool same(const Calibration& a, const Calibration& b) { return same_calibration(a, b); }
bool same(const port::SerialConfig& a, const port::SerialConfig& b) {
    const auto& [baud, parity, stop_bits] = a;
    return baud == b.baud && parity == b.parity && stop_bits == b.stop_bits;
}
bool same(const port::ImuSetup& a, const port::ImuSetup& b) {
    const auto& [sensor, mag, address, mag_address, watermark, accept_unknown, blob] = a;
    return sensor == b.sensor && mag == b.mag && address == b.address &&
           mag_address == b.mag_address && watermark == b.watermark &&
           accept_unknown == b.accept_unknown && blob == b.blob;
}
bool same(const ButtonConfig& a, const ButtonConfig& b) {
    const auto& [line, channel, active_low, debounce_s] = a;
    return line == b.line && channel == b.channel && active_low == b.active_low &&
           debounce_s == b.debounce_s;
}
bool same(const std::vector<ButtonConfig>& a, const std::vector<ButtonConfig>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& x, const auto& y) { return same(x, y); });
}
bool same(const port::ModbusTcpLimits& a, const port::ModbusTcpLimits& b) {
    const auto& [clients, per_host, frame_ns, first_ns, idle_ns, per_second, burst] = a;
    return clients == b.clients && per_host == b.clients_per_host && frame_ns == b.frame_ns &&
           first_ns == b.first_ns && idle_ns == b.idle_ns && per_second == b.requests_per_second &&
           burst == b.burst;
}

}  // namespace

bool operator==(const UnitConfig& a, const UnitConfig& b) {
    const auto& [id, name, source, stale_s, file, speed, loop, device, line, latency, imu, bus,
                 spi_hz, mag_bus, calibration, bias_max_rad_s, chip, line_number, buttons,
                 tolerance_m, tolerance_deg] = a;
    return id == b.id && name == b.name && source == b.source && stale_s == b.stale_s &&
           file == b.file && speed == b.speed && loop == b.loop && device == b.device &&
           same(line, b.line) && latency == b.latency && same(imu, b.imu) && bus == b.bus &&
           spi_hz == b.spi_hz && mag_bus == b.mag_bus && same(calibration, b.calibration) &&
           bias_max_rad_s == b.bias_max_rad_s && chip == b.chip && line_number == b.line_number &&
           same(buttons, b.buttons) && tolerance_m == b.tolerance_m &&
           tolerance_deg == b.tolerance_deg;
}

bool operator==(const RtuConfig& a, const RtuConfig& b) {
    const auto& [device, line, rs485, gap_ns] = a;
    return device == b.device && same(line, b.line) && rs485 == b.rs485 && gap_ns == b.gap_ns;
}

bool same_server(const Config& a, const Config& b) {
    return a.listen == b.listen && a.allow == b.allow && a.rtu == b.rtu && same(a.limits, b.limits);
}

Config default_config() {
    Config config;
    config.listen = {*port::parse_endpoint("127.0.0.1:1502")};
    config.allow = {*port::parse_network("127.0.0.0/8"), *port::parse_network("::1")};
    return config;
}

namespace {

/// What the chips' table says of a unit's buses.
template <class Add>
void check_wiring(const UnitConfig& unit, Add add) {
    const std::string who = "unit " + std::to_string(unit.id) + ": ";
    const port::ChipInfo* imu = port::ImuChips::find(unit.imu.sensor);
    const port::ChipInfo* mag = port::MagChips::find(unit.imu.mag);
    const bool spi = port::AnyBus::is_spi(unit.bus);
    if (!spi && !port::AnyBus::is_i2c(unit.bus)) add(who + "bus is /dev/i2c-N or /dev/spidevB.C");
    if (imu != nullptr && spi && imu->spi.hz_max == 0)
        add(who + unit.imu.sensor + " has no SPI: connect it by I2C");
    if (mag == nullptr) return;
    if (spi && unit.mag_bus < 0)
        add(who + "with the sensor on SPI, mag_bus names the mag's I2C bus");
    const bool inside = unit.imu.sensor == "icm20948" || unit.imu.sensor == "mpu6050";
    if (mag->behind_bypass && (spi || !inside))
        add(who + unit.imu.mag + " is reached through an MPU-9250 or ICM-20948 on I2C only");
}

}  // namespace

void check_config(const Config& config, const std::string& where,
                  std::vector<std::string>& errors) {
    const auto add = [&](const std::string& what) { errors.push_back(where + ": " + what); };
    if (config.units.empty()) add("there is no [[unit]]: nothing to serve");
    if (config.listen.empty() && !config.rtu)
        add("neither server.listen nor [rtu]: nobody could ask");
    if (config.listen.size() > port::ModbusTcpServer::listeners_max) add("too many server.listen");
    if (config.allow.size() > port::ModbusTcpServer::networks_max) add("too many server.allow");
    for (std::size_t i = 0; i < config.listen.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if (config.listen[i] == config.listen[k]) add("server.listen names an address twice");
    std::set<int> ids;
    std::set<std::string> devices;
    if (config.rtu) devices.insert(config.rtu->device);
    for (const UnitConfig& unit : config.units) {
        if (!ids.insert(unit.id).second) {
            add("two units have the id " + std::to_string(unit.id));
        }
        if (unit.source == SourceKind::serial && !devices.insert(unit.device).second) {
            add("two users of the line " + unit.device);
        }
        if (unit.source != SourceKind::sensor) continue;
        check_wiring(unit, add);
        std::vector<unsigned> lines{unit.line_number};
        for (const ButtonConfig& button : unit.buttons) lines.push_back(button.line);
        for (const unsigned line : lines) {
            const std::string name = unit.chip + " line " + std::to_string(line);
            if (!devices.insert(name).second) add("two users of " + name);
        }
    }
    for (const port::Endpoint& endpoint : config.listen) {
        if (!endpoint.is_loopback() && !config.expose) {
            add("server.listen leaves this machine: Modbus has no passwords; say server.expose = "
                "true and name the networks in server.allow");
        }
    }
}

}  // namespace fairlead::gateway
