// The configuration file: TOML into Config, section by section.
#include <algorithm>
#include <filesystem>
#include <string_view>

#include "examples/gateway/calibration_file.hpp"
#include "examples/gateway/config.hpp"
#include "examples/gateway/config_section.hpp"
#include "examples/gateway/text_file.hpp"

namespace fairlead::gateway {
namespace {

constexpr std::size_t buttons_max = 16;
constexpr double deg_per_rad = 57.295779513082323;

bool same_mounting(const Quat& a, const Quat& b) noexcept {
    return a.w == b.w && a.x == b.x && a.y == b.y && a.z == b.z;
}

void read_line(Section& section, port::SerialConfig& line) {
    section.integer("baud", line.baud, 9600, 4000000);
    if (const toml::node* node = section.find("baud"); node != nullptr) {
        if (!port::is_baud_rate(line.baud))
            section.fail(node->source(), "baud", "is no usual rate");
    }
    section.integer("stop_bits", line.stop_bits, 1, 2);
    std::string parity;
    section.text("parity", parity);
    if (parity == "none")
        line.parity = port::Parity::none;
    else if (parity == "even")
        line.parity = port::Parity::even;
    else if (parity == "odd")
        line.parity = port::Parity::odd;
    else if (!parity.empty())
        section.fail(section.find("parity")->source(), "parity", "must be none, even or odd");
}

void read_server(Section& section, Config& config) {
    section.list("listen", config.listen, port::parse_endpoint,
                 "must be like \"127.0.0.1:1502\" or \"[::1]:1502\"");
    section.list("allow", config.allow, port::parse_network,
                 "must be like \"192.168.1.0/24\" or \"fd00::/8\"");
    section.truth("expose", config.expose);
    auto& limits = config.limits;
    section.integer("clients", limits.clients, 1, port::ModbusTcpServer::slots_max);
    section.integer("clients_per_host", limits.clients_per_host, 1,
                    port::ModbusTcpServer::slots_max);
    section.integer("requests_per_second", limits.requests_per_second, 0, 1000000);
    section.integer("burst", limits.burst, 1, 10000);
    section.seconds("frame_s", limits.frame_ns, 0.05, 60);
    section.seconds("first_request_s", limits.first_ns, 0.1, 3600);
    section.seconds("idle_s", limits.idle_ns, 1, 86400);
    section.finish();
}

void read_rtu(Section& section, Config& config) {
    RtuConfig rtu;
    section.require("device");
    section.text("device", rtu.device);
    read_line(section, rtu.line);
    section.truth("rs485", rtu.rs485);
    section.seconds("gap_s", rtu.gap_ns, 0.0005, 1);
    section.finish();
    config.rtu = rtu;
}

/// The name of a chip that the table knows.
template <class Chips>
void read_chip(Section& section, const char* key, std::string& out) {
    section.text(key, out);
    if (out.empty() || Chips::find(out) != nullptr) return;
    std::string expected = "must be one of";
    for (const port::ChipInfo& chip : Chips::infos) expected += std::string{" "} + chip.name;
    section.fail(section.find(key)->source(), key, expected);
}

void read_buttons(Section& unit_section, UnitConfig& unit) {
    const toml::node* node = unit_section.find("buttons");
    if (node == nullptr) return;
    const toml::array* items = node->as_array();
    if (items == nullptr || items->size() > buttons_max) {
        return unit_section.fail(node->source(), "buttons",
                                 "must be a list of at most " + std::to_string(buttons_max));
    }
    for (const toml::node& item : *items) {
        if (!item.is_table()) {
            unit_section.fail(item.source(), "buttons", "must hold tables like { line = 22 }");
            continue;
        }
        Section section = unit_section.inner(*item.as_table(), "buttons.");
        ButtonConfig button;
        button.channel = static_cast<int>(unit.buttons.size());
        section.require("line");
        section.integer("line", button.line, 0, 1023);
        section.integer("channel", button.channel, 0, 65535);
        section.truth("active_low", button.active_low);
        section.real("debounce_s", button.debounce_s, 0, 1);
        section.finish();
        unit.buttons.push_back(button);
    }
}

/// An I2C bus by its number, or any bus by its device: "/dev/i2c-1", "/dev/spidev0.0".
void read_bus(Section& section, UnitConfig& unit) {
    const toml::node* node = section.find("bus");
    if (node != nullptr && node->is_integer()) {
        int number = 0;
        section.integer("bus", number, 0, 1023);
        unit.bus = "/dev/i2c-" + std::to_string(number);
    } else if (node != nullptr) {
        section.value("bus", unit.bus, "must be a number or a device like \"/dev/spidev0.0\"");
    }
    section.integer("spi_hz", unit.spi_hz, 10000, 50000000);
    section.integer("mag_bus", unit.mag_bus, 0, 1023);
}

void read_calibration_keys(Section& section, UnitConfig& unit,
                           const std::filesystem::path& folder) {
    std::string file, mounting;
    section.text("calibration", file);
    if (!file.empty())
        read_calibration((folder / file).string(), unit.calibration, section.errors());
    section.text("mounting", mounting);
    if (!mounting.empty()) {
        if (!same_mounting(unit.calibration.q_bs, Quat{})) {
            section.fail(section.find("mounting")->source(), "mounting",
                         "stands in the calibration file already");
        } else if (!parse_mounting(mounting, unit.calibration.q_bs)) {
            section.fail(section.find("mounting")->source(), "mounting",
                         "must name three axes of a right-handed set, like \"x y z\" or "
                         "\"-y x z\"");
        }
    }
    double limit_deg_s = unit.bias_max_rad_s * deg_per_rad;
    section.real("bias_max_deg_s", limit_deg_s, 0.01, 100);
    unit.bias_max_rad_s = limit_deg_s / deg_per_rad;
}

/// The configuration file that some chips need before they measure.
void read_blob(Section& section, UnitConfig& unit, const std::filesystem::path& folder) {
    const port::ChipInfo* chip = port::ImuChips::find(unit.imu.sensor);
    std::string file, why;
    section.text("blob", file);
    if (chip == nullptr) return;
    if (file.empty()) {
        if (chip->needs_blob) {
            section.fail(section.source(), "blob",
                         "is missing: this chip measures nothing without its maker's file");
        }
        return;
    }
    file = (folder / file).string();
    if (!chip->needs_blob)
        section.fail(section.find("blob")->source(), "blob", "is of no use to this chip");
    else if (!read_small_file(file, port::bmi::blob_max, unit.imu.blob, why))
        section.errors().push_back(file + ": " + why);
    else if (unit.imu.blob.empty() || unit.imu.blob.size() % 2 != 0)
        section.errors().push_back(file + ": is no configuration file of this chip");
}

void read_sensor(Section& section, UnitConfig& unit, const std::filesystem::path& folder) {
    section.require("line");
    read_chip<port::ImuChips>(section, "sensor", unit.imu.sensor);
    read_chip<port::MagChips>(section, "mag", unit.imu.mag);
    read_bus(section, unit);
    section.integer("address", unit.imu.address, 0x08, 0x77);
    section.integer("mag_address", unit.imu.mag_address, 0x08, 0x77);
    section.truth("accept_unknown", unit.imu.accept_unknown);
    read_blob(section, unit, folder);
    section.text("chip", unit.chip);
    section.integer("line", unit.line_number, 0, 1023);
    section.integer("watermark", unit.imu.watermark, 0, 32);
    read_buttons(section, unit);
}

void read_unit(Section& section, Config& config, const std::filesystem::path& folder) {
    UnitConfig unit;
    section.require("id");
    section.require("source");
    section.integer("id", unit.id, 1, 247);
    unit.name = "unit " + std::to_string(unit.id);
    section.text("name", unit.name);
    section.real("stale_s", unit.stale_s, 0.01, 3600);
    std::string source;
    section.text("source", source);
    if (source == "replay") {
        section.require("file");
        section.text("file", unit.file);
        if (!unit.file.empty()) unit.file = (folder / unit.file).string();
        section.real("speed", unit.speed, 0.01, 1000);
        section.truth("loop", unit.loop);
    } else if (source == "serial") {
        unit.source = SourceKind::serial;
        section.require("device");
        section.text("device", unit.device);
        read_line(section, unit.line);
        section.integer("latency", unit.latency, 0, 250);
    } else if (source == "sensor") {
        unit.source = SourceKind::sensor;
        read_sensor(section, unit, folder);
        read_calibration_keys(section, unit, folder);
    } else if (!source.empty()) {
        section.fail(section.find("source")->source(), "source",
                     "must be replay, serial or sensor");
    }
    if (source == "replay" || source == "sensor") {
        section.real("tolerance_m", unit.tolerance_m, 1e-6, 10);
        section.real("tolerance_deg", unit.tolerance_deg, 0.007, 28.6);
    }
    section.finish();
    config.units.push_back(unit);
}

void read_root(const toml::table& root, const std::string& path, ConfigResult& out) {
    const std::filesystem::path folder = std::filesystem::path{path}.parent_path();
    Section top{root, "", path, out.errors};
    std::string level;
    top.text("log", level);
    constexpr std::array<std::string_view, 4> levels{"error", "warning", "info", "debug"};
    const auto found = std::find(levels.begin(), levels.end(), level);
    if (found != levels.end()) {
        out.config.log_level = static_cast<Level>(found - levels.begin());
    } else if (!level.empty()) {
        top.fail(top.find("log")->source(), "log", "must be error, warning, info or debug");
    }
    const auto table_named = [&](const char* key) -> const toml::table* {
        const toml::node* node = top.find(key);
        if (node == nullptr) return nullptr;
        if (!node->is_table())
            top.fail(node->source(), key, "must be a table: [" + std::string{key} + "]");
        return node->as_table();
    };
    if (const toml::table* server = table_named("server")) {
        Section section{*server, "server.", path, out.errors};
        read_server(section, out.config);
    }
    if (const toml::table* rtu = table_named("rtu")) {
        Section section{*rtu, "rtu.", path, out.errors};
        read_rtu(section, out.config);
    }
    if (const toml::node* units = top.find("unit")) {
        if (!units->is_array_of_tables()) {
            top.fail(units->source(), "unit", "must be written as [[unit]]");
        } else {
            for (const toml::node& node : *units->as_array()) {
                Section section{*node.as_table(), "unit.", path, out.errors};
                read_unit(section, out.config, folder);
            }
        }
    }
    top.finish();
}

}  // namespace

ConfigResult parse_config(const std::string& text, const std::string& path) {
    ConfigResult out{default_config(), {}};
    bool read = false;
    parse_toml(text, path, out.errors, [&](const toml::table& root) {
        read_root(root, path, out);
        read = true;
    });
    if (read) check_config(out.config, path, out.errors);
    return out;
}

ConfigResult read_config(const std::string& path) {
    std::string text, why;
    if (!read_small_file(path, toml_size_max, text, why))
        return {default_config(), {path + ": " + why}};
    return parse_config(text, path);
}

}  // namespace fairlead::gateway
