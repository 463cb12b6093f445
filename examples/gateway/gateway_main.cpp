// build/fairlead-gateway: motion on Modbus. docs/gateway.md tells what it does and what it
// promises.
//
// Exit codes: 0 stopped by a signal, 64 wrong flags, 66 a recording cannot be read, 69 an address
// or a line cannot be had, 71 the system refuses, 78 the configuration is wrong.
#include <poll.h>
#include <sys/signalfd.h>
#include <sysexits.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <optional>

#include "examples/gateway/config.hpp"
#include "examples/gateway/notify.hpp"
#include "examples/gateway/reloader.hpp"
#include "examples/gateway/service.hpp"
#include "examples/gateway/version.hpp"
#include "port/linux/clock.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::gateway;

struct Flags {
    std::string config;
    bool check{};
    std::string replay;
    std::vector<std::string> serial;
    int baud{115200};
    double speed{1};
    bool loop{};
    std::vector<std::string> listen;
    bool expose{};
    std::string log;
};

void add_flags(CLI::App& app, Flags& flags) {
    app.add_option("-c,--config", flags.config, "configuration file (TOML)");
    app.add_flag("--check", flags.check,
                 "read the configuration, say what is wrong, serve nothing");
    app.add_option("--replay", flags.replay, "serve this recording as unit 1");
    app.add_option("--serial", flags.serial, "serve boards on these lines as units 1, 2, ...");
    app.add_option("--baud", flags.baud, "rate of the lines given by --serial");
    app.add_option("--speed", flags.speed, "of --replay, times real time");
    app.add_flag("--loop", flags.loop, "begin --replay anew when it ends");
    app.add_option("--listen", flags.listen, "instead of server.listen, like 127.0.0.1:1502");
    app.add_flag("--expose", flags.expose, "may listen beyond this machine");
    app.add_option("--log", flags.log, "error, warning, info or debug");
    app.set_version_flag("--version", std::string{"fairlead-gateway "} + version);
}

/// The file, then the flags on top of it.
ConfigResult configured(const Flags& flags) {
    ConfigResult out =
        flags.config.empty() ? ConfigResult{default_config(), {}} : read_config(flags.config);
    Config& config = out.config;
    if (!flags.replay.empty() || !flags.serial.empty()) config.units.clear();
    if (!flags.replay.empty()) {
        UnitConfig unit;
        unit.name = "replay";
        unit.file = flags.replay;
        unit.speed = flags.speed;
        unit.loop = flags.loop;
        config.units.push_back(unit);
        if (unit.speed < 0.01 || unit.speed > 1000)
            out.errors.push_back("--speed: from 0.01 to 1000");
    }
    for (const std::string& device : flags.serial) {
        UnitConfig unit;
        unit.id = static_cast<int>(config.units.size()) + 1;
        unit.name = device;
        unit.source = SourceKind::serial;
        unit.device = device;
        unit.line.baud = flags.baud;
        config.units.push_back(unit);
        if (!port::is_baud_rate(flags.baud)) out.errors.push_back("--baud: no usual rate");
    }
    if (!flags.listen.empty()) config.listen.clear();
    for (const std::string& text : flags.listen) {
        const auto endpoint = port::parse_endpoint(text);
        if (endpoint)
            config.listen.push_back(*endpoint);
        else
            out.errors.push_back("--listen " + text +
                                 ": must be like 127.0.0.1:1502 or [::1]:1502");
    }
    config.expose = config.expose || flags.expose;
    if (!flags.log.empty()) {
        constexpr std::array<const char*, 4> levels{"error", "warning", "info", "debug"};
        const auto found = std::find(levels.begin(), levels.end(), flags.log);
        if (found == levels.end())
            out.errors.push_back("--log: error, warning, info or debug");
        else
            config.log_level = static_cast<Level>(found - levels.begin());
    }
    const bool changed = !flags.replay.empty() || !flags.serial.empty() || !flags.listen.empty();
    if (flags.config.empty() || (changed && out.errors.empty())) {
        check_config(config, flags.config.empty() ? "flags" : flags.config, out.errors);
    }
    return out;
}

void tell(const ConfigResult& result) {
    for (const std::string& error : result.errors) std::fprintf(stderr, "%s\n", error.c_str());
}

void log_ready(const Service& service, const Config& config, const char* event) {
    for (const std::uint16_t port : service.ports())
        LogLine{Level::info, event}.add("port", port).add("units", config.units.size());
    if (service.ports().empty()) LogLine{Level::info, event}.add("units", config.units.size());
}

/// What a reload has come to, in the serving thread: what is wrong in the new configuration leaves
/// the old one running.
void take_over(Reloader& reloader, Service& service) {
    auto loaded = reloader.take();
    if (!loaded) return;
    Service::Change change;
    if (!loaded->plan) {
        LogLine{Level::error, "reload refused"}.add("why", loaded->error);
    } else {
        try {
            change = service.commit(std::move(*loaded->plan));
            LogLine::set_threshold(loaded->config.log_level);
            log_ready(service, loaded->config, "reloaded");
        } catch (const StartError& error) {
            LogLine{Level::error, "reload failed, going on as before"}.add("why", error.text);
        }
    }
    reloader.finish(std::move(change), service.running_units());
    notify("READY=1");
}

/// Signals by a descriptor: none of them interrupts anything.
int open_signals() {
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, signal);
    sigprocmask(SIG_BLOCK, &signals, nullptr);
    std::signal(SIGPIPE, SIG_IGN);  // of a log or a client that is gone
    return signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
}

void run(int signal_fd, Service& service, Reloader& reloader) {
    const std::int64_t watchdog_ns = watchdog_period_ns();
    const std::int64_t beat_ns = watchdog_ns > 0 ? watchdog_ns / 3 : port::second;
    notify("READY=1");
    for (;;) {
        service.serve({signal_fd, reloader.fd()}, port::now_ns() + beat_ns);
        if (watchdog_ns > 0 && service.is_alive(port::now_ns())) notify("WATCHDOG=1");
        take_over(reloader, service);
        signalfd_siginfo signal{};
        if (read(signal_fd, &signal, sizeof signal) != sizeof signal) continue;
        if (signal.ssi_signo != SIGHUP) return;
        notify_reloading(port::now_ns());
        reloader.begin(service.running_units());
    }
}

int serve(const Flags& flags, const Config& config) {
    LogLine::set_threshold(config.log_level);
    const int signal_fd = open_signals();
    if (signal_fd < 0) return EX_OSERR;
    std::optional<LogWriter> log{std::in_place};
    Service service{port::now_ns()};
    try {
        service.apply(config);
        log_ready(service, config, "ready");
        Reloader reloader{[&flags] { return configured(flags); }};
        run(signal_fd, service, reloader);
        notify("STOPPING=1");
        LogLine{Level::info, "stopped"}.add("requests", service.counters().requests);
        if (reloader.is_busy()) {  // it may read for minutes, and nothing needs what it reads
            log.reset();
            _exit(EX_OK);
        }
    } catch (const StartError& error) {
        LogLine{Level::error, "cannot start"}.add("why", error.text);
        return error.code;
    } catch (const std::exception& error) {
        LogLine{Level::error, "cannot start"}.add("why", error.what());
        return EX_OSERR;
    }
    return EX_OK;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{
        "Serves motion on Modbus TCP and RTU, from recordings and from boards on serial lines"};
    Flags flags;
    add_flags(app, flags);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? EX_OK : EX_USAGE;
    }
    if (flags.config.empty() && flags.replay.empty() && flags.serial.empty()) {
        std::fputs(
            "fairlead-gateway: nothing to serve: --config FILE, --replay FILE or --serial LINE\n",
            stderr);
        return EX_USAGE;
    }
    const ConfigResult result = configured(flags);
    if (!result.errors.empty()) {
        tell(result);
        return EX_CONFIG;
    }
    if (flags.check) {
        std::printf("%s: ok, %zu units\n", flags.config.empty() ? "flags" : flags.config.c_str(),
                    result.config.units.size());
        return EX_OK;
    }
    return serve(flags, result.config);
}
