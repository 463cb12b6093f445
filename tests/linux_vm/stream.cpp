// In the machine: kernel -> driver -> loop -> Intake -> attitude -> pipeline, for some seconds.
// usage: stream /dev/i2c-N ADDRESS /dev/gpiochipN LINE SECONDS OUT
// Writes OUT.log, the accepted samples, and OUT.stream, the bytes; says what was counted.
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "host_sim/recording/recording.hpp"
#include "port/linux/clock.hpp"
#include "port/linux/gpio.hpp"
#include "port/linux/i2c.hpp"
#include "port/linux/sampler.hpp"
#include "port/sensors/lsm6.hpp"
#include "tests/linux_vm/chain.hpp"

using namespace fairlead;
using namespace fairlead::port;

namespace {

unsigned long long u(std::uint64_t v) { return v; }

}  // namespace

int main(int argc, char** argv) {
    if (argc != 7) return 2;
    I2c bus;
    DataReady ready;
    const auto address = static_cast<std::uint8_t>(std::strtoul(argv[2], nullptr, 0));
    const auto line = static_cast<unsigned>(std::atoi(argv[4]));
    if (bus.open(argv[1]) != Status::ok || ready.open(argv[3], line) != Status::ok) {
        std::printf("stream: cannot open: errno %d, %d\n", bus.last_errno(), ready.last_errno());
        return 1;
    }
    Lsm6dso<I2c> imu{bus, address};
    Sampler<Lsm6dso<I2c>, DataReady, MonotonicClock> loop{imu, ready, {}};
    Lsm6dso<I2c>::Config config;
    config.watermark = 8;
    static_cast<void>(loop.start(config));  // a failed start is mended as any other fault
    const std::int64_t end = now_ns() + std::atoi(argv[5]) * second;
    std::vector<Sample> log;
    std::vector<std::uint8_t> bytes;
    vm::Chain chain;
    port::Batch batch;
    std::int64_t last_ns = 0, disorder = 0, longest_ns = 0;
    while (now_ns() < end) {
        static_cast<void>(loop.step(batch));
        for (std::size_t i = 0; i < batch.count; ++i) {
            const Sample& s = batch.samples[i];
            if (s.t_ns <= last_ns) ++disorder;
            if (last_ns != 0 && s.t_ns - last_ns > longest_ns) longest_ns = s.t_ns - last_ns;
            last_ns = s.t_ns;
            log.push_back(s);
            chain.push(s, bytes);
        }
    }
    chain.flush(bytes);
    const SamplerCounts& c = loop.counts();
    std::printf("stream %s samples %llu lost %llu disorder %lld refused %llu edges %llu\n", argv[2],
                u(c.samples), u(c.lost), static_cast<long long>(disorder), u(c.refused),
                u(c.edges));
    std::printf(
        "stream %s missed-edges %llu transfer-errors %llu overruns %llu resyncs %llu resets %llu "
        "restarts %llu clock-jumps %llu longest-gap-ms %.1f late-edges %u ppm %d\n",
        argv[2], u(c.missed_edges), u(c.transfer_errors), u(c.overruns), u(c.resyncs), u(c.resets),
        u(c.restarts), u(c.clock_jumps), static_cast<double>(longest_ns) * 1e-6,
        imu.timeline().set_aside(), imu.timeline().error_ppm());
    const auto text = [](const void* p, std::size_t n) {
        return std::string_view{static_cast<const char*>(p), n};
    };
    const std::string out = argv[6];
    sim::write_bytes(out + ".log", text(log.data(), log.size() * sizeof(Sample)));
    sim::write_bytes(out + ".stream", text(bytes.data(), bytes.size()));
    return 0;
}
