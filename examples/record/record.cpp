// fairlead-record: any supported inertial sensor, beside it a magnetometer, into a file.
//   fairlead-record --bus 1 --sensor lsm6dso --chip /dev/gpiochip0 --line 17 motion.imu
// Exit codes: 0 stopped by time or signal, 64 wrong usage, 69 no bus, line or sensor, 74 the file.
#include <sysexits.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>

#include "examples/record/writer.hpp"
#include "host_sim/recording/imu2.hpp"
#include "port/linux/clock.hpp"
#include "port/linux/gpio.hpp"
#include "port/linux/i2c.hpp"
#include "port/linux/imu_loop.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::port;

volatile std::sig_atomic_t ended = 0;
void end(int) { ended = 1; }

struct Options {
    int bus{1};
    ImuSetup imu;
    std::string chip{"/dev/gpiochip0"}, out;
    unsigned line{0};
    double seconds{0};
};

void say(const Probe& p) {
    std::fprintf(stderr, "address 0x%02x register 0x%02x: %s", p.address, p.reg,
                 to_string(p.status));
    if (p.status == Status::ok || p.status == Status::unexpected_id)
        std::fprintf(stderr, ", read 0x%02x (%s), expected 0x%02x", p.got, p.part, p.expected);
    std::fprintf(stderr, "\n");
}

/// One line, rewritten in place: how far, how fast, how much, what went wrong.
void live(const Options& o, const SamplerCounts& c, double seconds, double rate_hz,
          std::uint64_t dropped) {
    const auto u = [](std::uint64_t v) { return static_cast<unsigned long long>(v); };
    std::fprintf(stderr, "\r%8.1f", seconds);
    if (o.seconds > 0) std::fprintf(stderr, " of %.1f", o.seconds);
    std::fprintf(stderr,
                 " s  %9llu samples  %7.1f Hz  lost %llu  missed edges %llu  bus errors %llu  "
                 "overruns %llu  resets %llu  edges dropped %llu ",
                 u(c.samples), rate_hz, u(c.lost), u(c.missed_edges), u(c.transfer_errors),
                 u(c.overruns), u(c.resets), u(dropped));
}

int run(const Options& o, ImuLoop& loop, const DataReady& ready, const I2c& bus) {
    const Probe probe = loop.probe();
    say(probe);
    if (probe.status != Status::ok) return EX_UNAVAILABLE;
    if (const Status s = loop.start(); s != Status::ok) {
        std::fprintf(stderr, "%s%s%s: %s, errno %d\n", probe.part, o.imu.mag.empty() ? "" : " or ",
                     o.imu.mag.c_str(), to_string(s), bus.last_errno());
        return EX_UNAVAILABLE;
    }
    record::Writer writer;
    const double period_s = static_cast<double>(loop.period_ns()) * 1e-9;
    const std::uint32_t fields = sim::imu_field::gyro | sim::imu_field::accel |
                                 sim::imu_field::temperature |
                                 (o.imu.mag.empty() ? 0 : sim::imu_field::mag);
    bool good = writer.open(o.out, probe.part, period_s, fields);
    const std::int64_t start = now_ns();
    std::int64_t next_line = start + second;
    std::uint64_t told = 0;
    port::Batch batch;
    while (good && !ended) {
        const std::int64_t now = now_ns();
        const double passed = static_cast<double>(now - start) * 1e-9;
        if (o.seconds > 0 && passed >= o.seconds) break;
        static_cast<void>(loop.step(batch));  // what went wrong is in the counts
        const Sample* const first = batch.samples.data();
        good = writer.append({first, first + batch.count});
        if (now < next_line) continue;
        good = writer.sync() && good;
        const double since = static_cast<double>(now - next_line + second) * 1e-9;
        live(o, loop.counts(), passed, static_cast<double>(loop.counts().samples - told) / since,
             ready.dropped());
        told = loop.counts().samples;
        next_line = now + second;
    }
    good = writer.close() && good;
    const double passed = static_cast<double>(now_ns() - start) * 1e-9;
    live(o, loop.counts(), passed, static_cast<double>(loop.counts().samples) / passed,
         ready.dropped());
    std::fprintf(stderr, "\n%s%s\n", good ? o.out.c_str() : "", writer.error().c_str());
    return good ? EX_OK : EX_IOERR;
}

}  // namespace

int main(int argc, char** argv) {
    Options o;
    CLI::App app{"Records an inertial sensor on I2C to .imu or .csv.", "fairlead-record"};
    app.add_option("out", o.out, "file to write, .imu or .csv; must not exist")->required();
    app.add_option("--bus", o.bus, "I2C bus: /dev/i2c-N")->capture_default_str();
    app.add_option("--sensor", o.imu.sensor,
                   "icm42688, lsm6dso, lsm6dsv or mpu6050 (and relatives)")
        ->capture_default_str()
        ->check(CLI::IsMember(std::vector<std::string>(imu_names.begin(), imu_names.end())));
    app.add_option("--address", o.imu.address, "I2C address; default: the part's own");
    app.add_option("--mag", o.imu.mag, "a magnetometer beside it: lis3mdl or ak09916")
        ->check(CLI::IsMember(std::vector<std::string>(mag_names.begin(), mag_names.end())));
    app.add_option("--chip", o.chip, "GPIO chip of the data-ready line")->capture_default_str();
    app.add_option("--line", o.line, "its line: times come from its edges")->required();
    app.add_option("--watermark", o.imu.watermark, "samples per interrupt; 0: each one, no FIFO")
        ->capture_default_str()
        ->check(CLI::Range(0, 32));
    app.add_option("--seconds", o.seconds, "stop after so long; default: Ctrl-C");
    app.add_flag("--accept-unknown", o.imu.accept_unknown, "take a part with an unknown identity");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? EX_OK : EX_USAGE;
    }
    std::signal(SIGINT, end);
    std::signal(SIGTERM, end);

    I2c bus;
    if (const Status s = bus.open(o.bus); s != Status::ok) {
        std::fprintf(stderr, "/dev/i2c-%d: %s, errno %d\n", o.bus, to_string(s), bus.last_errno());
        return EX_UNAVAILABLE;
    }
    DataReady ready;
    if (const Status s = ready.open(o.chip.c_str(), o.line); s != Status::ok) {
        std::fprintf(stderr, "%s line %u: %s, errno %d\n", o.chip.c_str(), o.line, to_string(s),
                     ready.last_errno());
        return EX_UNAVAILABLE;
    }
    const auto loop = make_imu_loop(o.imu, bus, ready, MonotonicClock{});
    return run(o, *loop, ready, bus);
}
