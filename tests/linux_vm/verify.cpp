// On the host, after the machine: does its log replay to the same bytes, and does every sample
// equal the recording's after the chip's quantisation, holes flagged and counted?
// usage: verify RECORDING|- LOG_PREFIX clean|faults SECONDS
//        verify RECORDING|- FILE record|trajectory SECONDS     what fairlead-record, -poll wrote
//        verify RECORDING|- FILE events PRESSES
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "host_sim/recording/recording.hpp"
#include "port/sensors/lsm6.hpp"
#include "tests/linux_vm/chain.hpp"
#include "tests/linux_vm/source.hpp"

using namespace fairlead;

namespace {

struct NoBus {};
using Imu = port::Lsm6<NoBus, port::lsm6::Dso>;
int failures = 0;

void check(bool good, const char* what, double figure) {
    std::printf("%s linux_vm.%s (%g)\n", good ? "ok" : "FAIL", what, figure);
    if (!good) ++failures;
}

std::vector<Sample> read_log(const std::string& path) {
    const std::string bytes = sim::read_bytes(path);
    std::vector<Sample> log(bytes.size() / sizeof(Sample));
    std::memcpy(log.data(), bytes.data(), log.size() * sizeof(Sample));
    return log;
}

/// One count, by the data sheets.
struct Scale {
    double gyro, accel;
};
constexpr Scale lsm6{70e-3 * sim::pi / 180, 0.488e-3 * sim::g_m_s2};
constexpr Scale invensense{2000 / 32768.0 * sim::pi / 180, 16 / 32768.0 * sim::g_m_s2};

/// The model's counts of a record against the driver's value.
bool same(const Sample& s, const sim::Truth& t, const Scale& scale) {
    return sim::counts(s.gyro_rad_s, scale.gyro) == sim::counts(t.gyro_rad_s, scale.gyro) &&
           sim::counts(s.accel_m_s2, scale.accel) == sim::counts(t.accel_m_s2, scale.accel);
}

struct Match {
    std::size_t silent{0}, holes{0}, strangers{0};
    std::int64_t missing{0};
};

/// Walks log and recording side by side; a record that is not in the log is a hole.
Match match(const std::vector<Sample>& log, const vm::Source& source, const Scale& scale) {
    constexpr std::int64_t reach = 10000;
    Match m;
    std::int64_t at = 0;
    while (at < reach && !log.empty() && !same(log[0], source.at(at), scale)) ++at;
    m.strangers = at == reach ? 1 : 0;
    for (std::size_t i = 1; i < log.size(); ++i) {
        std::int64_t next = at + 1;
        while (next < at + reach && !same(log[i], source.at(next), scale)) ++next;
        if (next == at + reach) {
            ++m.strangers;
            ++at;
            continue;
        }
        if (next > at + 1) {
            ++m.holes;
            m.missing += next - at - 1;
            if (!(log[i].flags & flag::gap_before)) ++m.silent;
        }
        at = next;
    }
    return m;
}

/// Whatever ended the recorder, all complete records are there and are the motion's.
void check_recording(const std::string& motion, const std::string& path, double seconds) {
    const sim::Recording r = sim::read_recording(path, sim::Salvage::yes);
    const std::string name = path.substr(path.rfind('/') + 1);
    const Match m = match(r.samples, vm::Source{motion}, invensense);
    check(m.strangers == 0 && m.missing == 0, ("recorded-samples-are-the-motions." + name).c_str(),
          static_cast<double>(r.samples.size()));
    check(static_cast<double>(r.samples.size()) > seconds * 500, ("recorded-" + name).c_str(),
          static_cast<double>(r.samples.size()) / 500);
    bool ordered = true;
    for (std::size_t i = 1; i < r.samples.size(); ++i)
        ordered = ordered && r.samples[i].t_ns > r.samples[i - 1].t_ns;
    check(ordered, ("recorded-times-rise." + name).c_str(), 1);
}

/// Each press is one change to 1 and one back to 0, whatever bounced, at the first edge's time.
void check_events(const std::string& path, int presses) {
    const std::string text = sim::read_bytes(path);
    long long t_ns = 0, last_ns = 0;
    int channel = 0, value = 0, count = 0, at = 0;
    bool good = true;
    const char* line = text.c_str() + text.find('\n') + 1;
    for (; std::sscanf(line, "%lld,%d,%d\n%n", &t_ns, &channel, &value, &at) == 3; line += at) {
        good = good && channel == 5 && value == (count % 2 == 0 ? 1 : 0) && t_ns > last_ns;
        if (value == 0) good = good && t_ns - last_ns > 90000000 && t_ns - last_ns < 150000000;
        last_ns = t_ns;
        ++count;
    }
    check(good && count == 2 * presses, "events-of-the-button", count);
}

void check_trajectory(const std::string& path, double seconds) {
    const sim::Recording r = sim::read_recording(path);
    const double span =
        r.poses.empty() ? 0 : static_cast<double>(r.poses.back().t_ns - r.poses[0].t_ns) * 1e-9;
    check(span > seconds, "trajectory-of-the-sensor", span);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 5) return 2;
    const std::string recording = argv[1], prefix = argv[2], what = argv[3];
    if (what == "record") check_recording(recording, prefix, std::atof(argv[4]));
    if (what == "events") check_events(prefix, std::atoi(argv[4]));
    if (what == "trajectory") check_trajectory(prefix, std::atof(argv[4]));
    if (what != "clean" && what != "faults") return failures == 0 ? 0 : 1;
    const bool clean = std::string{argv[3]} == "clean";
    const double seconds = std::atof(argv[4]);
    const std::vector<Sample> log = read_log(prefix + ".log");
    const std::string stream = sim::read_bytes(prefix + ".stream");

    vm::Chain chain;
    std::vector<std::uint8_t> bytes;
    for (const Sample& s : log) chain.push(s, bytes);
    chain.flush(bytes);
    const bool equal = bytes.size() == stream.size() &&
                       std::memcmp(bytes.data(), stream.data(), bytes.size()) == 0;
    check(equal && !bytes.empty(), "log-replays-to-the-same-bytes",
          static_cast<double>(bytes.size()));

    const vm::Source source{recording};
    const Match m = match(log, source, lsm6);
    check(m.strangers == 0, "every-sample-is-the-recordings", static_cast<double>(log.size()));
    check(m.silent == 0, "no-silent-loss", static_cast<double>(m.silent));
    std::size_t disorder = 0, flagged = 0;
    std::int64_t longest = 0;
    for (std::size_t i = 1; i < log.size(); ++i) {
        const std::int64_t step = log[i].t_ns - log[i - 1].t_ns;
        if (step <= 0) ++disorder;
        if (step > longest) longest = step;
        if (log[i].flags & flag::gap_before) ++flagged;
    }
    check(disorder == 0, "times-in-order", static_cast<double>(disorder));
    const double span = log.empty() ? 0 : static_cast<double>(log.back().t_ns - log[0].t_ns) * 1e-9;
    check(span > seconds - 2, "seconds-streamed", span);
    if (clean) {
        check(m.missing == 0 && m.holes == 0, "no-sample-lost", static_cast<double>(m.missing));
        check(flagged == 0, "no-gap-flag-without-loss", static_cast<double>(flagged));
    } else {
        check(flagged >= m.holes, "holes-flagged", static_cast<double>(m.holes));
        check(longest < 100000000, "stream-goes-on-within-100-ms",
              static_cast<double>(longest) * 1e-6);
    }
    return failures == 0 ? 0 : 1;
}
