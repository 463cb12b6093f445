#include "examples/gateway/config.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string_view>
#include <tuple>

#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>

namespace fairlead::gateway {
namespace {

using Errors = std::vector<std::string>;

constexpr std::size_t buttons_max = 16;

/// One table of the file: gives typed values within bounds, and names what nobody asked for.
class Section {
  public:
    Section(const toml::table& table, std::string name, const std::string& path, Errors& errors)
        : table_{table}, name_{std::move(name)}, path_{path}, errors_{errors} {}

    template <class T>
    void value(const char* key, T& out, const char* expected) {
        const toml::node* node = find(key);
        if (node == nullptr) return;
        if (const auto got = node->value_exact<T>()) {
            out = *got;
        } else {
            fail(node->source(), key, expected);
        }
    }
    void text(const char* key, std::string& out) { value(key, out, "must be text in quotes"); }
    void truth(const char* key, bool& out) { value(key, out, "must be true or false"); }
    template <class Int>
    void integer(const char* key, Int& out, std::int64_t min, std::int64_t max) {
        const toml::node* node = find(key);
        if (node == nullptr) return;
        const auto got = node->value_exact<std::int64_t>();
        if (got && *got >= min && *got <= max) {
            out = static_cast<Int>(*got);
        } else {
            fail(node->source(), key,
                 "must be a whole number from " + std::to_string(min) + " to " +
                     std::to_string(max));
        }
    }
    void real(const char* key, double& out, double min, double max) {
        const toml::node* node = find(key);
        if (node == nullptr) return;
        const auto got = node->value<double>();
        if (got && *got >= min && *got <= max) {
            out = *got;
        } else {
            fail(node->source(), key,
                 "must be a number from " + short_number(min) + " to " + short_number(max));
        }
    }
    /// Seconds in the file, nanoseconds in the program.
    void seconds(const char* key, std::int64_t& out, double min, double max) {
        double s = static_cast<double>(out) * 1e-9;
        real(key, s, min, max);
        out = static_cast<std::int64_t>(s * 1e9);
    }
    template <class T, class Parse>
    void list(const char* key, std::vector<T>& out, Parse parse, const char* expected) {
        const toml::node* node = find(key);
        if (node == nullptr) return;
        const toml::array* items = node->as_array();
        if (items == nullptr) return fail(node->source(), key, "must be a list in brackets");
        out.clear();
        for (const toml::node& item : *items) {
            const auto word = item.value_exact<std::string>();
            const auto parsed = word ? parse(*word) : std::nullopt;
            if (parsed) {
                out.push_back(*parsed);
            } else {
                fail(item.source(), key, expected);
            }
        }
    }
    const toml::node* find(const char* key) {
        known_.insert(key);
        return table_.get(key);
    }
    bool has(const char* key) const { return table_.contains(key); }
    void require(const char* key) {
        if (!has(key)) fail(table_.source(), key, "is missing");
    }
    void fail(const toml::source_region& at, const std::string& key, const std::string& what) {
        errors_.push_back(path_ + ":" + std::to_string(at.begin.line) + ": " + name_ + key + " " +
                          what);
    }
    const toml::source_region& source() const { return table_.source(); }
    Section inner(const toml::table& table, const std::string& name) const {
        return {table, name_ + name, path_, errors_};
    }

    /// Call last: a misspelt key must not be silently ignored.
    void finish() {
        for (const auto& [key, node] : table_) {
            if (known_.count(std::string{key.str()}) == 0) {
                fail(key.source(), std::string{key.str()}, "is not known here");
            }
        }
    }

  private:
    static std::string short_number(double v) {
        std::string s = std::to_string(v);
        s.erase(s.find_last_not_of('0') + 1);
        if (s.back() == '.') s.pop_back();
        return s;
    }

    const toml::table& table_;
    std::string name_;
    const std::string& path_;
    Errors& errors_;
    std::set<std::string> known_;
};

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
    section.finish();
    config.rtu = rtu;
}

template <std::size_t N>
void read_name(Section& section, const char* key, const std::array<const char*, N>& names,
               std::string& out) {
    section.text(key, out);
    if (out.empty() || std::find(names.begin(), names.end(), out) != names.end()) return;
    std::string expected = "must be one of";
    for (const char* name : names) expected += std::string{" "} + name;
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

void read_sensor(Section& section, UnitConfig& unit) {
    section.require("line");
    read_name(section, "sensor", port::imu_names, unit.imu.sensor);
    read_name(section, "mag", port::mag_names, unit.imu.mag);
    section.integer("bus", unit.bus, 0, 1023);
    section.integer("address", unit.imu.address, 0x08, 0x77);
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
    } else if (source == "sensor") {
        unit.source = SourceKind::sensor;
        read_sensor(section, unit);
    } else if (!source.empty()) {
        section.fail(section.find("source")->source(), "source",
                     "must be replay, serial or sensor");
    }
    if (source == "replay" || source == "sensor") {
        section.real("tolerance_m", unit.tolerance_m, 1e-6, 10);
        section.real("tolerance_deg", unit.tolerance_deg, 1e-3, 45);
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

bool operator==(const UnitConfig& a, const UnitConfig& b) {
    const auto key = [](const UnitConfig& u) {
        return std::tie(u.id, u.name, u.source, u.stale_s, u.file, u.speed, u.loop, u.device,
                        u.line.baud, u.line.parity, u.line.stop_bits, u.tolerance_m,
                        u.tolerance_deg);
    };
    const auto sensor = [](const UnitConfig& u) {
        return std::tie(u.imu.sensor, u.imu.mag, u.imu.address, u.imu.watermark, u.bus, u.chip,
                        u.line_number);
    };
    const auto same_button = [](const ButtonConfig& x, const ButtonConfig& y) {
        return std::tie(x.line, x.channel, x.active_low, x.debounce_s) ==
               std::tie(y.line, y.channel, y.active_low, y.debounce_s);
    };
    return key(a) == key(b) && sensor(a) == sensor(b) &&
           std::equal(a.buttons.begin(), a.buttons.end(), b.buttons.begin(), b.buttons.end(),
                      same_button);
}

bool same_server(const Config& a, const Config& b) {
    const auto limits = [](const port::ModbusTcpLimits& l) {
        return std::tie(l.clients, l.clients_per_host, l.frame_ns, l.first_ns, l.idle_ns,
                        l.requests_per_second, l.burst);
    };
    const auto rtu = [](const RtuConfig& r) {
        return std::tie(r.device, r.line.baud, r.line.parity, r.line.stop_bits, r.rs485);
    };
    const bool same_rtu = a.rtu.has_value() == b.rtu.has_value() &&
                          (!a.rtu.has_value() || rtu(*a.rtu) == rtu(*b.rtu));
    return a.listen == b.listen && a.allow == b.allow && same_rtu &&
           limits(a.limits) == limits(b.limits);
}

Config default_config() {
    Config config;
    config.listen = {*port::parse_endpoint("127.0.0.1:1502")};
    config.allow = {*port::parse_network("127.0.0.0/8"), *port::parse_network("::1")};
    return config;
}

ConfigResult parse_config(const std::string& text, const std::string& path) {
    ConfigResult out{default_config(), {}};
    try {
        read_root(toml::parse(text, path), path, out);
    } catch (const toml::parse_error& error) {
        out.errors.push_back(path + ":" + std::to_string(error.source().begin.line) + ": " +
                             std::string{error.description()});
        return out;
    }
    check_config(out.config, path, out.errors);
    return out;
}

ConfigResult read_config(const std::string& path) {
    std::ifstream in{path, std::ios::binary};
    const std::string text{std::istreambuf_iterator<char>{in}, {}};
    if (!in.is_open() || in.bad()) return {default_config(), {path + ": cannot be read"}};
    return parse_config(text, path);
}

void check_config(const Config& config, const std::string& where, Errors& errors) {
    const auto add = [&](const std::string& what) { errors.push_back(where + ": " + what); };
    if (config.units.empty()) add("there is no [[unit]]: nothing to serve");
    if (config.listen.empty() && !config.rtu)
        add("neither server.listen nor [rtu]: nobody could ask");
    if (config.listen.size() > port::ModbusTcpServer::listeners_max) add("too many server.listen");
    if (config.allow.size() > port::ModbusTcpServer::networks_max) add("too many server.allow");
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
