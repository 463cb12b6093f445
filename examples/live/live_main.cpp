// build/fairlead-live: a page that shows a body as it moves, from a recording, a board on a serial
// line or a unit of a gateway. On this machine alone unless told otherwise, and read-only.
//   fairlead-live --replay motion.trk        then open http://127.0.0.1:8321/
// Exit codes: 0 stopped by a signal, 64 wrong flags, 66 a recording cannot be read, 69 no port.
#include <signal.h>
#include <sysexits.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <ctime>

#include "examples/gateway/source.hpp"
#include "examples/gateway/version.hpp"
#include "examples/live/modbus_unit.hpp"
#include "examples/live/page.hpp"
#include "examples/live/viewers.hpp"
#include "host_sim/recording/recording.hpp"
#include "port/linux/clock.hpp"

namespace {

using namespace fairlead;

struct Flags {
    std::string replay, serial, gateway, bind{"127.0.0.1"};
    int baud{115200}, unit{1}, port{8321};
    double speed{1};
    bool loop{};
    bool expose{};
};

void add_flags(CLI::App& app, Flags& f) {
    auto* source = app.add_option_group("source", "one of");
    source->add_option("--replay", f.replay, "a recording")->check(CLI::ExistingFile);
    source->add_option("--serial", f.serial, "a board on this serial line");
    source->add_option("--gateway", f.gateway, "a gateway, HOST:PORT");
    source->require_option(1);
    app.add_option("--baud", f.baud, "rate of the line")->capture_default_str();
    app.add_option("--unit", f.unit, "unit of the gateway")
        ->check(CLI::Range(1, 247))
        ->capture_default_str();
    app.add_option("--speed", f.speed, "of the recording, times real time")
        ->check(CLI::Range(0.01, 100.0))
        ->capture_default_str();
    app.add_flag("--loop", f.loop, "begin the recording anew when it ends");
    app.add_option("--port", f.port, "port of the page; 0: any that is free")
        ->check(CLI::Range(0, 65535))
        ->capture_default_str();
    app.add_option("--bind", f.bind, "address to listen at")->capture_default_str();
    app.add_flag("--expose", f.expose, "may listen beyond this machine");
    app.set_version_flag("--version", std::string{"fairlead-live "} + gateway::version);
}

/// HOST:PORT
bool parse_gateway(const std::string& text, live::ModbusAddress& address) {
    const auto colon = text.rfind(':');
    if (colon == std::string::npos || colon == 0) return false;
    char* end = nullptr;
    const long port = std::strtol(text.c_str() + colon + 1, &end, 10);
    if (*end != 0 || port < 1 || port > 65535) return false;
    address.host = text.substr(0, colon);
    address.port = static_cast<int>(port);
    return true;
}

std::unique_ptr<gateway::Source> make_source(const Flags& f) {
    if (!f.gateway.empty()) {
        live::ModbusAddress address;
        if (!parse_gateway(f.gateway, address))
            throw std::invalid_argument("--gateway: HOST:PORT, like 127.0.0.1:1502");
        address.unit = f.unit;
        return live::make_modbus_unit(address);
    }
    gateway::UnitConfig unit;
    unit.file = f.replay;
    unit.speed = f.speed;
    unit.loop = f.loop;
    if (!f.replay.empty()) return gateway::make_replay(unit);
    if (!port::is_baud_rate(f.baud)) throw std::invalid_argument("--baud: no usual rate");
    unit.source = gateway::SourceKind::serial;
    unit.device = f.serial;
    unit.line.baud = f.baud;
    return gateway::make_board(unit);
}

void put(std::string& out, const char* name, double value) {
    char text[64];
    std::snprintf(text, sizeof text, ",\"%s\":%.7g", name, std::isfinite(value) ? value : 0.0);
    out += text;
}

void put(std::string& out, const char* name, std::initializer_list<float> values) {
    out += std::string(",\"") + name + "\":[";
    bool first = true;
    for (const float v : values) {
        char text[32];
        std::snprintf(text, sizeof text, "%s%.7g", first ? "" : ",",
                      std::isfinite(v) ? static_cast<double>(v) : 0.0);
        out += text;
        first = false;
    }
    out += "]";
}

/// truth = matrix * (reading - offset), as one list of twelve.
void put(std::string& out, const char* name, const Affine& a) {
    const Mat3& m = a.matrix;
    put(out, name,
        {a.offset.x, a.offset.y, a.offset.z, m.x.x, m.x.y, m.x.z, m.y.x, m.y.y, m.y.z, m.z.x, m.z.y,
         m.z.z});
}

void put(std::string& out, const gateway::CalibrationState& c) {
    const Vec3& g = c.gyro_offset_rad_s;
    put(out, "sensors", c.sensors);
    put(out, "done", c.done);
    put(out, "gyro_percent", c.gyro_percent);
    put(out, "accel_faces", c.accel_faces);
    put(out, "mag_percent", c.mag_percent);
    put(out, "gyro_offset", {g.x, g.y, g.z});
    put(out, "accel", c.accel);
    put(out, "mag", c.mag);
}

/// One line of JSON; names as examples/live/page/live.js reads them.
std::string as_json(const gateway::UnitState& s, std::int64_t now_ns, int viewers) {
    std::string out = "{\"viewers\":" + std::to_string(viewers);
    put(out, "now", static_cast<double>(now_ns / port::ms) * 1e-3);
    put(out, "age", s.arrival_ns == 0 ? -1 : static_cast<double>(now_ns - s.arrival_ns) * 1e-9);
    put(out, "sequence", s.sequence);
    put(out, "q", {s.q_wb.w, s.q_wb.x, s.q_wb.y, s.q_wb.z});
    put(out, "p", {s.p_w_m.x, s.p_w_m.y, s.p_w_m.z});
    put(out, "rate", {s.rate_rad_s.x, s.rate_rad_s.y, s.rate_rad_s.z});
    put(out, "status", s.status);
    for (const auto& [name, count] : std::initializer_list<std::pair<const char*, std::uint32_t>>{
             {"publications", s.publications},
             {"samples", s.samples},
             {"faults", s.sample_faults},
             {"gaps", s.gaps},
             {"bytes", s.bytes},
             {"frames", s.frames},
             {"damaged", s.frames_damaged},
             {"breaks", s.breaks},
             {"publish_us", s.publish_us},
             {"publish_max_us", s.publish_max_us}})
        put(out, name, count);
    put(out, s.calibration);
    return out + "}";
}

/// Empties what the source hands over; the live view shows the newest state alone.
void drain(gateway::UnitFeed& feed) {
    gateway::SpanItem span;
    while (feed.spans.pop(span)) {
    }
    gateway::FeedEvent event;
    while (feed.events.pop(event)) {
    }
}

int serve(const Flags& flags, gateway::Source& source, const std::string& title) {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGTERM, SIGINT}) sigaddset(&signals, signal);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    signal(SIGPIPE, SIG_IGN);  // a viewer that has gone
    live::Viewers viewers{live::page(title)};
    const int port = viewers.open(flags.bind, flags.port);
    if (port == 0) {
        std::fprintf(stderr, "fairlead-live: %s port %d cannot be had\n", flags.bind.c_str(),
                     flags.port);
        return EX_UNAVAILABLE;
    }
    std::printf("http://%s:%d/\n", flags.bind.c_str(), port);
    std::fflush(stdout);
    const auto feed = std::make_unique<gateway::UnitFeed>();
    source.start(*feed, 1);
    constexpr timespec step{0, 40 * 1000 * 1000};  // 25 times a second
    while (sigtimedwait(&signals, nullptr, &step) < 0) {
        drain(*feed);
        feed->state.refresh();
        viewers.show(as_json(feed->state.value(), port::now_ns(), viewers.count()));
    }
    source.stop();
    return EX_OK;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Shows a body as it moves, in a browser"};
    Flags flags;
    add_flags(app, flags);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? EX_OK : EX_USAGE;
    }
    const bool here = flags.bind == "127.0.0.1" || flags.bind == "::1" || flags.bind == "localhost";
    if (!here && !flags.expose) {
        std::fputs("fairlead-live: --bind beyond this machine needs --expose\n", stderr);
        return EX_USAGE;
    }
    try {
        const auto source = make_source(flags);
        // of a file its name alone: folders are nobody's business
        return serve(
            flags, *source,
            flags.replay.empty() ? flags.serial + flags.gateway : sim::stem_of(flags.replay));
    } catch (const std::invalid_argument& error) {
        std::fprintf(stderr, "fairlead-live: %s\n", error.what());
        return EX_USAGE;
    } catch (const sim::BadData& error) {
        std::fprintf(stderr, "fairlead-live: %s\n", error.what());
        return EX_NOINPUT;
    }
}
