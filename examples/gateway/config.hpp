#pragma once
// What the gateway is told to do: one TOML file (examples/gateway/gateway.toml shows every key), or
// nothing but a recording to replay. Every mistake is reported with its line before anything
// starts.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "examples/gateway/feed.hpp"
#include "examples/gateway/log.hpp"
#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/calibrate.hpp"
#include "port/linux/imu_loop.hpp"
#include "port/linux/modbus_rtu.hpp"
#include "port/linux/modbus_tcp.hpp"
#include "port/linux/serial.hpp"

namespace fairlead::gateway {

struct RtuConfig {
    std::string device;
    port::SerialConfig line{19200, port::Parity::even, 1};
    bool rs485{};
    std::int64_t gap_ns{port::ModbusRtuConfig{}.gap_ns};  // silence that ends a frame
};

/// A contact on a GPIO line as a discrete channel.
struct ButtonConfig {
    unsigned line{};
    int channel{};
    bool active_low{};
    double debounce_s{0.02};
};

struct UnitConfig {
    int id{1};
    std::string name;
    SourceKind source{SourceKind::replay};
    double stale_s{2};

    std::string file;  // replay
    double speed{1};   // times real time
    bool loop{};

    std::string device;  // serial line
    port::SerialConfig line{};
    int latency{3};  // records from the end of a frame to its leaving the board

    port::ImuSetup imu;             // sensor on this machine
    std::string bus{"/dev/i2c-1"};  // or "/dev/spidev0.0"
    int spi_hz{1000000};
    int mag_bus{-1};  // I2C bus of the magnetometer; the sensor's own
    Calibration calibration{};
    double bias_max_rad_s{AttitudeParams{}.bias_max_rad_s};
    std::string chip{"/dev/gpiochip0"};
    unsigned line_number{};  // of the data-ready line
    std::vector<ButtonConfig> buttons;

    // replay, sensor: what the reducer keeps
    double tolerance_m{0.001};
    double tolerance_deg{0.25};
};

struct Config {
    std::vector<port::Endpoint> listen;
    std::vector<port::Network> allow;
    bool expose{};
    port::ModbusTcpLimits limits{};
    std::optional<RtuConfig> rtu;
    std::vector<UnitConfig> units;
    Level log_level{Level::info};
};

/// Two units with equal settings need no restart when the configuration is read again.
bool operator==(const UnitConfig& a, const UnitConfig& b);
bool operator==(const RtuConfig& a, const RtuConfig& b);
/// The same of everything that the server is opened with.
bool same_server(const Config& a, const Config& b);

/// Loopback only, no units.
Config default_config();

struct ConfigResult {
    Config config;
    std::vector<std::string> errors;  // "file:line: what is wrong"
};
ConfigResult read_config(const std::string& path);
ConfigResult parse_config(const std::string& text, const std::string& path);

/// What no single value shows: two units with one id, an open door that nobody asked for.
void check_config(const Config& config, const std::string& where, std::vector<std::string>& errors);

}  // namespace fairlead::gateway
