// fairlead-sim info FILE: what a recording, or a stream, holds.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iterator>
#include <memory>
#include <set>

#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"
#include "host_sim/recording/evidence.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/replay/curve_store.hpp"

namespace fairlead::sim {
namespace {

std::size_t count_flag(const std::vector<Pose>& poses, std::uint32_t mask) {
    std::size_t n = 0;
    for (const Pose& pose : poses) n += (pose.flags & mask) == mask ? 1 : 0;
    return n;
}

/// a - b in seconds, for any two times.
double apart_s(std::int64_t a, std::int64_t b) {
    return (static_cast<double>(a / 1000000000) - static_cast<double>(b / 1000000000)) +
           static_cast<double>(a % 1000000000 - b % 1000000000) * 1e-9;
}

void print_times(const Recording& recording) {
    const std::size_t n = recording.size();
    const double seconds = apart_s(recording.t_ns(n - 1), recording.t_ns(0));
    std::size_t gaps = 0, backward = 0;
    double longest_s = 0;
    for (std::size_t i = 1; i < n; ++i) {
        const double step_s = apart_s(recording.t_ns(i), recording.t_ns(i - 1));
        if (step_s <= 0) ++backward;
        if (step_s > 1.5 * recording.period_s) ++gaps;
        if (step_s > longest_s) longest_s = step_s;
    }
    std::printf("records          %zu\n", n);
    std::printf("duration         %.3f s\n", seconds);
    std::printf("nominal rate     %.3f Hz\n",
                recording.period_s > 0 ? 1 / recording.period_s : 0.0);
    std::printf("longest step     %.3f ms\n", longest_s * 1e3);
    std::printf("missing records  %zu place%s in time, %zu backward or repeated\n", gaps,
                gaps == 1 ? "" : "s", backward);
}

/// What the sensors of an IMU hold, and the size of what they read.
void print_sensors(const Recording& recording) {
    struct Sensor {
        const char* name;
        std::uint32_t valid;
        Vec3 Sample::*values;
        const char* unit;
    };
    constexpr Sensor sensors[] = {{"gyroscope", flag::gyro_valid, &Sample::gyro_rad_s, "rad/s"},
                                  {"accelerometer", flag::accel_valid, &Sample::accel_m_s2, "m/s2"},
                                  {"magnetometer", flag::mag_valid, &Sample::mag_uT, "uT"}};
    std::printf("holds            IMU samples\n");
    Progress progress{"sizes", std::size(sensors), "sensors"};
    for (const Sensor& sensor : sensors) {
        progress.show(static_cast<std::size_t>(&sensor - sensors));
        Numbers x, y, z;
        for (const Sample& s : recording.samples) {
            if ((s.flags & sensor.valid) == 0) continue;
            const Vec3& v = s.*sensor.values;
            x.push_back(static_cast<double>(v.x));
            y.push_back(static_cast<double>(v.y));
            z.push_back(static_cast<double>(v.z));
        }
        if (x.empty())
            std::printf("%-16s none\n", sensor.name);
        else
            std::printf("%-16s in %zu records, median length %.4g %s\n", sensor.name, x.size(),
                        median_length(x, y, z), sensor.unit);
    }
    std::size_t warm = 0;
    for (const Sample& s : recording.samples)
        if ((s.flags & flag::temperature_valid) != 0) ++warm;
    if (warm > 0) std::printf("temperature      in %zu records\n", warm);
    if (!recording.events.empty()) std::printf("events           %zu\n", recording.events.size());
}

void print_channel(std::size_t number, const StoredChannel& channel) {
    char name[48];
    std::snprintf(name, sizeof name, "channel %zu, %s", number,
                  channel.rotates ? "rotation" : "vector");
    std::printf("%-20s %zu ax%s, tolerance %.4g%s", name,
                channel.rotates ? 3 : channel.tracks.size(),
                !channel.rotates && channel.tracks.size() == 1 ? "is" : "es", channel.tolerance,
                channel.rotates ? " rad" : "");
    std::printf("; %s", channel.order == 4 ? "C2 cubics" : "C1 quadratics");
    if (channel.empty()) return void(std::printf("; no curve\n"));
    std::printf("\n%20s %zu curves, %zu pieces, %zu breaks, from %.3f s to %.3f s\n", "",
                channel.curves(), channel.pieces(), channel.breaks(),
                static_cast<double>(channel.begin_ns()) * 1e-9,
                static_cast<double>(channel.end_ns()) * 1e-9);
}

void print_run(const CurveRun& run, bool several) {
    if (run.channels.empty()) return;
    if (several) std::printf("run %-16u number %u as the board counts\n", run.index, run.number);
    std::printf("tick                 %.6g ms\n", static_cast<double>(run.tick_ns) * 1e-6);
    for (std::size_t c = 0; c < run.channels.size(); ++c) print_channel(c, run.channels[c]);
}

void print_events(const CurveStore& store) {
    const auto& counters = store.event_counters();
    if (counters.frames == 0) return;
    std::set<std::uint16_t> channels;
    for (const Event& event : store.events()) channels.insert(event.channel);
    std::printf("events               %u on %zu channel%s, in %u frames; %u missing\n",
                counters.events, channels.size(), channels.size() == 1 ? "" : "s", counters.frames,
                counters.lost);
}

void print_stream(const InputOptions& input) {
    const std::string bytes = read_bytes(input.path);
    CurveStore store;
    store.push(bytes);
    store.finish();
    const std::string damage = store.damage();
    if (!damage.empty() && (!input.salvage || store.empty()))
        throw BadData(input.path + ": " + damage);
    const StreamBytes by_kind = stream_bytes(bytes);
    std::printf("format               reduced stream, version %d\n", by_kind.version.value_or(0));
    std::printf("stream id            %u\n", store.stream_id());
    std::printf("bytes                %zu", bytes.size());
    if (by_kind.whole)
        std::printf(": %zu of data, %zu of headers, %zu of events", by_kind.data, by_kind.headers,
                    by_kind.events);
    std::printf("\nframes               %u\n", store.frame_counters().frames);
    if (store.runs().size() > 1)
        std::printf("runs                 %zu: the clock of the board has started anew\n",
                    store.runs().size());
    for (const CurveRun& run : store.runs()) print_run(run, store.runs().size() > 1);
    print_events(store);
    if (!damage.empty()) std::printf("damage               %s\n", damage.c_str());
}

bool is_stream(const std::string& path) {
    return path.size() > 4 && path.compare(path.size() - 4, 4, ".flr") == 0;
}

void run(const InputOptions& input) {
    if (is_stream(input.path)) return print_stream(input);
    const Recording recording = input.read(InputOptions::Doubts::elsewhere);
    std::printf("name             %s\n", recording.name.c_str());
    std::printf("format           %s%s\n", to_string(recording.format),
                recording.format != Format::imu ? ""
                : recording.version2            ? ", version 2"
                                                : ", version 1");
    if (!recording.columns.empty()) std::printf("columns          %s\n", recording.columns.c_str());
    print_times(recording);
    if (!recording.samples.empty()) print_sensors(recording);
    const auto& poses = recording.samples.empty() ? recording.poses : recording.truth;
    if (!poses.empty()) {
        std::printf("%-16s position in %zu, orientation in %zu, both in %zu\n",
                    recording.samples.empty() ? "holds" : "reference",
                    count_flag(poses, flag::position_valid),
                    count_flag(poses, flag::orientation_valid),
                    count_flag(poses, flag::position_valid | flag::orientation_valid));
    }
    if (!recording.moving.empty()) {
        std::size_t moving = 0;
        for (const auto m : recording.moving) moving += m;
        std::printf("movement phase   %zu records\n", moving);
    }
    for (const std::string& doubt : doubts(recording, progress_steps("check", "checks")))
        std::printf("doubtful         %s\n", doubt.c_str());
}

}  // namespace

void add_info(CLI::App& app) {
    auto* command = app.add_subcommand("info", "Say what a recording or a stream (.flr) holds");
    auto input = std::make_shared<InputOptions>();
    input->add_to(*command, "FILE");
    command->callback([input] { run(*input); });
}

}  // namespace fairlead::sim
