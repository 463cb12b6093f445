// fairlead-record: any supported inertial sensor, beside it a magnetometer, into a file or a row of
// files.
//   fairlead-record --bus 1 --sensor lsm6dso --chip /dev/gpiochip0 --line 17 motion.imu
// A sensor that is pulled while it records is looked for until it is back; the hole is in the data
// as gap_before. Exit codes: 0 stopped by time or signal, 64 wrong usage, 69 no bus, line or sensor
// at the start, 74 the file.
#include <sysexits.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "examples/record/hardware.hpp"
#include "examples/record/rotation.hpp"
#include "examples/record/writer.hpp"
#include "host_sim/recording/imu2.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::port;

volatile std::sig_atomic_t ended = 0;
void end(int) { ended = 1; }

constexpr std::int64_t silence_ns = 5 * second;  // then bus, line and sensor are opened anew
constexpr std::int64_t reopen_ns = 500 * ms;

struct Options {
    record::Wiring wiring;
    record::Rotation rotation;
    std::string out, blob_file;
    double seconds{0};
    bool list{};
};

void say(const Probe& p, const std::string& bus) {
    std::fprintf(stderr, "%s address 0x%02x register 0x%02x: %s", bus.c_str(), p.address, p.reg,
                 to_string(p.status));
    if (p.status == Status::ok || p.status == Status::unexpected_id)
        std::fprintf(stderr, ", read 0x%02x (%s), expected 0x%02x", p.got, p.part, p.expected);
    if (p.status == Status::no_acknowledge)
        std::fprintf(stderr,
                     "; nobody answers there: i2cdetect -y N shows who does, see --address");
    if (p.status == Status::unexpected_id)
        std::fprintf(stderr, "; another chip: see --sensor, --list, --accept-unknown");
    std::fprintf(stderr, "\n");
}

/// Sums over every time that the hardware was opened.
struct Totals {
    SamplerCounts before{};
    SamplerCounts now{};
    std::uint64_t samples() const noexcept { return before.samples + now.samples; }
    void close() noexcept {
        before.samples += now.samples;
        before.lost += now.lost;
        before.missed_edges += now.missed_edges;
        before.transfer_errors += now.transfer_errors;
        before.overruns += now.overruns;
        before.resets += now.resets;
        now = {};
    }
};

const bool on_terminal = isatty(STDERR_FILENO) != 0;

/// One line, on a terminal rewritten in place: how far, how fast, how much, what went wrong.
void live(const Options& o, const Totals& t, double seconds, double rate_hz,
          std::uint64_t edges_dropped, unsigned files) {
    const auto sum = [](std::uint64_t a, std::uint64_t b) {
        return static_cast<unsigned long long>(a + b);
    };
    const SamplerCounts &a = t.before, &b = t.now;
    std::fprintf(stderr, on_terminal ? "\r%8.1f" : "%8.1f", seconds);
    if (o.seconds > 0) std::fprintf(stderr, " of %.1f", o.seconds);
    std::fprintf(stderr, " s");
    if (seconds < o.seconds) std::fprintf(stderr, ", %.0f s left", std::ceil(o.seconds - seconds));
    std::fprintf(stderr,
                 "  %9llu samples  %7.1f Hz  lost %llu  missed edges %llu  bus errors %llu  "
                 "overruns %llu  resets %llu  edges dropped %llu ",
                 sum(a.samples, b.samples), rate_hz, sum(a.lost, b.lost),
                 sum(a.missed_edges, b.missed_edges), sum(a.transfer_errors, b.transfer_errors),
                 sum(a.overruns, b.overruns), sum(a.resets, b.resets), sum(edges_dropped, 0));
    if (files > 1) std::fprintf(stderr, " file %u ", files);
}

/// The files of a recording, one after another.
class Files {
  public:
    Files(const Options& o, const std::string& part, double period_s)
        : options_{o}, part_{part}, period_s_{period_s} {}
    bool open_next(std::int64_t now_ns) {
        begun_ns_ = now_ns;
        const std::uint32_t fields = sim::imu_field::gyro | sim::imu_field::accel |
                                     sim::imu_field::temperature |
                                     (options_.wiring.imu.mag.empty() ? 0 : sim::imu_field::mag);
        return writer_.open(record::file_name(options_.out, ++number_), part_, period_s_, fields);
    }
    bool append(const Batch& batch, std::int64_t now_ns) {
        const double seconds = static_cast<double>(now_ns - begun_ns_) * 1e-9;
        if (batch.count > 0 && options_.rotation.is_due(seconds, writer_.bytes()))
            if (!writer_.close() || !open_next(now_ns)) return false;
        const Sample* const first = batch.samples.data();
        return writer_.append({first, first + batch.count});
    }
    bool sync() { return writer_.sync(); }
    bool close() { return writer_.close(); }
    unsigned number() const noexcept { return number_; }
    const std::string& error() const noexcept { return writer_.error(); }

  private:
    const Options& options_;
    record::Writer writer_;
    std::string part_;
    double period_s_;
    std::int64_t begun_ns_{};
    unsigned number_{0};
};

/// Open, and the sensor runs. False: told why.
bool start(record::Hardware& hardware, const Options& o, bool quiet) {
    if (!hardware.open()) {
        if (!quiet) std::fprintf(stderr, "%s\n", hardware.error().c_str());
        return false;
    }
    ImuLoop& loop = hardware.loop();
    const Probe probe = loop.probe();
    if (!quiet || probe.status == Status::ok) say(probe, o.wiring.bus);
    if (probe.status != Status::ok) return false;
    const Status s = loop.start();
    if (s == Status::ok) return true;
    if (!quiet) {
        std::fprintf(stderr, "%s does not start: %s, errno %d\n", probe.part, to_string(s),
                     hardware.bus().last_errno());
        if (!o.wiring.imu.mag.empty()) say(loop.probe_mag(), o.wiring.imu.mag);
    }
    return false;
}

int run(const Options& o) {
    record::Hardware hardware{o.wiring};
    if (!start(hardware, o, false)) return EX_UNAVAILABLE;
    const double period_s = static_cast<double>(hardware.loop().period_ns()) * 1e-9;
    Files files{o, hardware.loop().probe().part, period_s};
    const std::int64_t begun = now_ns();
    bool good = files.open_next(begun);
    std::int64_t next_line = begun + second, heard = begun;
    std::uint64_t told = 0;
    Totals totals;
    Batch batch;
    while (good && ended == 0) {
        const std::int64_t now = now_ns();
        const double passed = static_cast<double>(now - begun) * 1e-9;
        if (o.seconds > 0 && passed >= o.seconds) break;
        if (hardware.is_open()) {
            static_cast<void>(hardware.loop().step(batch));  // what went wrong is in the counts
            totals.now = hardware.loop().counts();
            if (batch.count > 0) heard = now;
            good = files.append(batch, now);
        } else {
            sleep_until(now + reopen_ns);
            if (start(hardware, o, true)) heard = now_ns();
        }
        if (now - heard > silence_ns && hardware.is_open()) {
            std::fprintf(stderr, "\nthe sensor is silent: looking for it until it is back\n");
            totals.close();
            hardware.close();
        }
        if (now < next_line) continue;
        good = files.sync() && good;
        const double since = static_cast<double>(now - next_line + second) * 1e-9;
        if (on_terminal)
            live(o, totals, passed, static_cast<double>(totals.samples() - told) / since,
                 hardware.edges_dropped(), files.number());
        told = totals.samples();
        next_line = now + second;
    }
    good = files.close() && good;
    const double passed = static_cast<double>(now_ns() - begun) * 1e-9;
    live(o, totals, passed, static_cast<double>(totals.samples()) / passed,
         hardware.edges_dropped(), files.number());
    std::fprintf(stderr, "\n%s%s\n", good ? o.out.c_str() : "", files.error().c_str());
    return good ? EX_OK : EX_IOERR;
}

template <class Chips>
std::vector<std::string> names() {
    std::vector<std::string> out;
    for (const ChipInfo& info : Chips::infos) out.emplace_back(info.name);
    return out;
}

template <class Chips>
void list(const char* kind) {
    std::printf("%s\n", kind);
    for (const ChipInfo& info : Chips::infos) {
        std::printf("  %-10s %s; I2C 0x%02x", info.name, info.parts, info.addresses[0]);
        if (info.addresses[1] != 0) std::printf(" or 0x%02x", info.addresses[1]);
        if (info.spi.hz_max > 0) std::printf("; SPI up to %u kHz", info.spi.hz_max / 1000);
        if (info.needs_blob) std::printf("; needs --blob");
        std::printf("\n");
    }
}

void add_options(CLI::App& app, Options& o) {
    record::Wiring& w = o.wiring;
    app.add_option("out", o.out, "file to write, .imu or .csv; must not exist");
    app.add_option("--bus", w.bus, "I2C bus N, or its device, or /dev/spidevB.C")
        ->transform([](const std::string& text) {
            const bool number = !text.empty() && text.find_first_not_of("0123456789") == text.npos;
            return number ? "/dev/i2c-" + text : text;
        })
        ->capture_default_str();
    app.add_option("--spi-hz", w.spi_hz, "clock of an SPI bus")
        ->capture_default_str()
        ->check(CLI::Range(10000, 50000000));
    app.add_option("--sensor", w.imu.sensor, "the chip; --list tells them all")
        ->capture_default_str()
        ->check(CLI::IsMember(names<ImuChips>()));
    app.add_option("--address", w.imu.address, "I2C address; default: the part's own");
    app.add_option("--mag", w.imu.mag, "a magnetometer beside it; --list tells them all")
        ->check(CLI::IsMember(names<MagChips>()));
    app.add_option("--mag-address", w.imu.mag_address, "its I2C address; default: the part's own");
    app.add_option("--mag-bus", w.mag_bus, "its I2C device; default: the sensor's bus");
    app.add_option("--blob", o.blob_file, "configuration file of the maker, for a BMI270");
    app.add_option("--chip", w.chip, "GPIO chip of the data-ready line")->capture_default_str();
    app.add_option("--line", w.line, "its line: times come from its edges");
    app.add_option("--watermark", w.imu.watermark, "samples per interrupt; 0: each one, no FIFO")
        ->capture_default_str()
        ->check(CLI::Range(0, 32));
    app.add_option("--seconds", o.seconds, "stop after so long; default: Ctrl-C");
    app.add_option("--rotate-seconds", o.rotation.seconds, "go on in the next file after so long")
        ->check(CLI::Range(1.0, 1e9));
    app.add_option("--rotate-mb", o.rotation.megabytes, "go on in the next file at this size")
        ->check(CLI::Range(0.001, 1e6));
    app.add_flag("--accept-unknown", w.imu.accept_unknown, "take a part with an unknown identity");
    app.add_flag("--list", o.list, "list the chips and exit");
}

/// What no single option shows. Empty: nothing is wrong.
std::string wrong_in(const CLI::App& app, Options& o) {
    if (o.out.empty()) return "out is required: the file to write";
    if (app.count("--line") == 0) return "--line is required: times come from its edges";
    const ChipInfo* const chip = ImuChips::find(o.wiring.imu.sensor);
    if (chip->needs_blob && o.blob_file.empty())
        return "--blob is required: this chip measures nothing without its maker's file";
    if (AnyBus::is_spi(o.wiring.bus) && !o.wiring.imu.mag.empty() && o.wiring.mag_bus.empty())
        return "--mag-bus is required: the sensor is on SPI, the magnetometer on I2C";
    if (o.blob_file.empty()) return "";
    std::ifstream in{o.blob_file, std::ios::binary};
    o.wiring.imu.blob.assign(std::istreambuf_iterator<char>{in}, {});
    const std::size_t size = o.wiring.imu.blob.size();
    if (!in.is_open() || size == 0 || size > bmi::blob_max || size % 2 != 0)
        return o.blob_file + " is no configuration file of this chip";
    return "";
}

}  // namespace

int main(int argc, char** argv) {
    Options o;
    CLI::App app{"Records an inertial sensor on I2C or SPI to .imu or .csv.", "fairlead-record"};
    add_options(app, o);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? EX_OK : EX_USAGE;
    }
    if (o.list) {
        list<ImuChips>("--sensor");
        list<MagChips>("--mag");
        return EX_OK;
    }
    if (const std::string wrong = wrong_in(app, o); !wrong.empty()) {
        std::fprintf(stderr, "%s\nRun with --help for more information.\n", wrong.c_str());
        return EX_USAGE;
    }
    std::signal(SIGINT, end);
    std::signal(SIGTERM, end);
    std::signal(SIGPIPE, SIG_IGN);
    return run(o);
}
