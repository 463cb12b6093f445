// fairlead-record: any supported inertial sensor, beside it a magnetometer, into a file.
//   fairlead-record --bus 1 --sensor lsm6dso --chip /dev/gpiochip0 --line 17 motion.imu
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <optional>

#include "examples/record/writer.hpp"
#include "port/linux/clock.hpp"
#include "port/linux/gpio.hpp"
#include "port/linux/i2c.hpp"
#include "port/linux/sampler.hpp"
#include "port/sensors/ak09916.hpp"
#include "port/sensors/icm426xx.hpp"
#include "port/sensors/lis3mdl.hpp"
#include "port/sensors/lsm6.hpp"
#include "port/sensors/mpu6xxx.hpp"

namespace {

using namespace fairlead;
using namespace fairlead::port;

volatile std::sig_atomic_t ended = 0;
void end(int) { ended = 1; }

struct Options {
    int bus{1};
    std::string sensor{"lsm6dso"}, mag, chip{"/dev/gpiochip0"}, out;
    int address{-1};
    unsigned line{0};
    unsigned watermark{8};
    double seconds{0};
    bool accept_unknown{false};
};

void say(const Probe& p) {
    std::fprintf(stderr, "address 0x%02x register 0x%02x: %s", p.address, p.reg,
                 to_string(p.status));
    if (p.status == Status::ok || p.status == Status::unexpected_id)
        std::fprintf(stderr, ", read 0x%02x (%s), expected 0x%02x", p.got, p.part, p.expected);
    std::fprintf(stderr, "\n");
}

/// One line, rewritten in place: how fast, how much, what went wrong.
void live(const SamplerCounts& c, double seconds, double rate_hz, std::uint64_t dropped) {
    std::fprintf(
        stderr,
        "\r%8.1f s  %9llu samples  %7.1f Hz  lost %llu  missed edges %llu  bus errors %llu  "
        "overruns %llu  resets %llu  edges dropped %llu ",
        seconds, static_cast<unsigned long long>(c.samples), rate_hz,
        static_cast<unsigned long long>(c.lost), static_cast<unsigned long long>(c.missed_edges),
        static_cast<unsigned long long>(c.transfer_errors),
        static_cast<unsigned long long>(c.overruns), static_cast<unsigned long long>(c.resets),
        static_cast<unsigned long long>(dropped));
}

/// A magnetometer is asked beside the IMU; its value goes with the newest sample.
class Magnetometer {
  public:
    Status start(I2c& bus, const std::string& kind) {
        if (kind == "lis3mdl") return lis3mdl_.emplace(bus).start({});
        if (kind == "ak09916") return ak09916_.emplace(bus).start({});
        return Status::ok;
    }
    void add_to(Sample& sample) {
        if (lis3mdl_) add(*lis3mdl_, sample);
        if (ak09916_) add(*ak09916_, sample);
    }

  private:
    template <class Driver>
    static void add(Driver& driver, Sample& sample) {
        const auto ready = driver.data_ready();
        if (!ready || !*ready) return;
        const auto field = driver.read(sample.t_ns);
        if (!field) return;
        sample.mag_uT = field->mag_uT;
        sample.flags |= field->flags & (flag::mag_valid | flag::clipped | flag::mag_clipped);
    }
    std::optional<Lis3mdl<I2c>> lis3mdl_;
    std::optional<Ak09916<I2c>> ak09916_;
};

template <class Driver>
int run(const Options& o, I2c& bus, DataReady& ready) {
    const auto address =
        static_cast<std::uint8_t>(o.address < 0 ? Driver::default_address : o.address);
    Driver imu{bus, address, o.accept_unknown ? UnknownId::accept : UnknownId::refuse};
    const Probe probe = imu.probe();
    say(probe);
    if (probe.status != Status::ok) return 1;
    typename Driver::Config config;
    config.watermark = static_cast<std::uint8_t>(o.watermark);
    Sampler<Driver, DataReady, MonotonicClock> loop{imu, ready, {}};
    Magnetometer mag;
    if (const Status s = loop.start(config); s != Status::ok) {
        std::fprintf(stderr, "%s: %s, errno %d\n", probe.part, to_string(s), bus.last_errno());
        return 1;
    }
    if (const Status s = mag.start(bus, o.mag); s != Status::ok) {
        std::fprintf(stderr, "%s: %s, errno %d\n", o.mag.c_str(), to_string(s), bus.last_errno());
        return 1;
    }
    record::Writer writer;
    const double period_s = static_cast<double>(imu.period_ns()) * 1e-9;
    bool good = writer.open(o.out, probe.part, period_s);
    const std::int64_t start = now_ns();
    std::int64_t next_line = start + second;
    std::uint64_t told = 0;
    port::Batch batch;
    while (good && !ended) {
        const std::int64_t now = now_ns();
        const double passed = static_cast<double>(now - start) * 1e-9;
        if (o.seconds > 0 && passed >= o.seconds) break;
        static_cast<void>(loop.step(batch));  // what went wrong is in the counts
        if (batch.count > 0) mag.add_to(batch.samples[batch.count - 1]);
        const Sample* const first = batch.samples.data();
        good = writer.append({first, first + batch.count});
        if (now < next_line) continue;
        good = writer.sync() && good;
        const double since = static_cast<double>(now - next_line + second) * 1e-9;
        live(loop.counts(), passed, static_cast<double>(loop.counts().samples - told) / since,
             ready.dropped());
        told = loop.counts().samples;
        next_line = now + second;
    }
    good = writer.close() && good;
    live(loop.counts(), static_cast<double>(now_ns() - start) * 1e-9, 1 / period_s,
         ready.dropped());
    std::fprintf(stderr, "\n%s%s\n", good ? o.out.c_str() : "", writer.error().c_str());
    return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    Options o;
    CLI::App app{"Records an inertial sensor on I2C to .imu or EuRoC .csv.", "fairlead-record"};
    app.add_option("out", o.out, "file to write, .imu or .csv; must not exist")->required();
    app.add_option("--bus", o.bus, "I2C bus: /dev/i2c-N")->capture_default_str();
    app.add_option("--sensor", o.sensor, "icm42688, lsm6dso, lsm6dsv or mpu6050 (and relatives)")
        ->capture_default_str()
        ->check(CLI::IsMember({"icm42688", "lsm6dso", "lsm6dsv", "mpu6050"}));
    app.add_option("--address", o.address, "I2C address; default: the part's own");
    app.add_option("--mag", o.mag, "a magnetometer beside it: lis3mdl or ak09916")
        ->check(CLI::IsMember({"lis3mdl", "ak09916"}));
    app.add_option("--chip", o.chip, "GPIO chip of the data-ready line")->capture_default_str();
    app.add_option("--line", o.line, "its line: times come from its edges")->required();
    app.add_option("--watermark", o.watermark, "samples per interrupt; 0: each one, no FIFO")
        ->capture_default_str()
        ->check(CLI::Range(0, 32));
    app.add_option("--seconds", o.seconds, "stop after so long; default: Ctrl-C");
    app.add_flag("--accept-unknown", o.accept_unknown, "take a part with an unknown identity");
    CLI11_PARSE(app, argc, argv);
    std::signal(SIGINT, end);
    std::signal(SIGTERM, end);

    I2c bus;
    if (const Status s = bus.open(o.bus); s != Status::ok) {
        std::fprintf(stderr, "/dev/i2c-%d: %s, errno %d\n", o.bus, to_string(s), bus.last_errno());
        return 1;
    }
    DataReady ready;
    if (const Status s = ready.open(o.chip.c_str(), o.line); s != Status::ok) {
        std::fprintf(stderr, "%s line %u: %s, errno %d\n", o.chip.c_str(), o.line, to_string(s),
                     ready.last_errno());
        return 1;
    }
    if (o.sensor == "icm42688") return run<Icm426xx<I2c>>(o, bus, ready);
    if (o.sensor == "lsm6dsv") return run<Lsm6dsv<I2c>>(o, bus, ready);
    if (o.sensor == "mpu6050") return run<Mpu6xxx<I2c>>(o, bus, ready);
    return run<Lsm6dso<I2c>>(o, bus, ready);
}
