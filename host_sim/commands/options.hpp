#pragma once
// Options that several subcommands share.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>
#include <string>

#include "host_sim/event_file.hpp"
#include "host_sim/replay.hpp"
#include "host_sim/spec.hpp"
#include "host_sim/stream.hpp"
#include "host_sim/writers.hpp"

namespace fairlead::sim {

/// IN and --salvage, --events.
struct InputOptions {
    std::string path, events;
    bool salvage{false};

    void add_to(CLI::App& command, const std::string& name = "IN") {
        command.add_option(name, path, "Recording: .imu, .trk, EuRoC IMU CSV, pose CSV or TUM")
            ->required()
            ->check(CLI::ExistingFile);
        command.add_flag("--salvage", salvage,
                         "Use the complete records before the damage of a bad file");
    }

    void add_events_to(CLI::App& command) {
        command
            .add_option("--events", events,
                        "CSV of discrete events beside the recording: t_ns,channel,value")
            ->check(CLI::ExistingFile);
    }

    Recording read() const {
        Recording recording = read_recording(path, salvage ? Salvage::yes : Salvage::no);
        if (!recording.damage.empty())
            std::fprintf(stderr, "fairlead-sim: %s; %zu records before it are used\n",
                         recording.damage.c_str(), recording.size());
        if (!recording.note.empty())
            std::fprintf(stderr, "fairlead-sim: %s: %s\n", path.c_str(), recording.note.c_str());
        recording.events = read_events(events);
        return recording;
    }
};

/// Like CLI::Range, but NaN is outside.
inline CLI::Validator in_range(double low, double high) {
    const auto check = [low, high](const std::string& text) -> std::string {
        double value{};
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return {};
        char why[96];
        std::snprintf(why, sizeof why, "must be a number from %g to %g", low, high);
        return why;
    };
    return CLI::Validator(check, "NUMBER");
}

/// What the reducer and its frames are given. Without defaults the tolerances start at 0: not
/// given.
inline void add_reduction(CLI::App& command, ReplayOptions& options, bool must_be_given) {
    if (must_be_given) options.tol_pos_m = options.tol_rot_rad = 0;
    auto* position =
        command.add_option("--tol-pos", options.tol_pos_m, "Tolerance of each position axis, m")
            ->check(CLI::Range(1e-9, 1e6));
    auto* rotation =
        command
            .add_option("--tol-rot", options.tol_rot_rad, "Tolerance of the rotation angle, rad")
            ->check(in_range(1e-5, 3));
    if (!must_be_given) {
        position->capture_default_str();
        rotation->capture_default_str();
    }
    command
        .add_option("--max-delay", options.delay_max,
                    "Most records from a sample to the bytes that cover it")
        ->check(CLI::Range(2u, delay_most))
        ->capture_default_str();
    command
        .add_option_function<std::string>(
            "--slice",
            [&options](const std::string& size) {
                options.slice = size == "small"   ? slice_small
                                : size == "large" ? slice_large
                                                  : slice_medium;
            },
            "Work per record: more finds fewer knots, never another guarantee")
        ->check(CLI::IsMember({"small", "medium", "large"}))
        ->default_str("medium");
    command
        .add_option("--open", options.goal,
                    "Records that a frame leaves open where it can; 0: a third of --max-delay")
        ->check(CLI::Range(0u, delay_most))
        ->capture_default_str();
    command
        .add_option("--restart", options.restart_s,
                    "Seconds between the points at which a reader can join")
        ->check(in_range(0.01, 1e6))
        ->capture_default_str();
}

/// --mode: which of an IMU's sensors the orientation is made of. Empty: all it has.
inline void add_mode(CLI::App& command, std::optional<AttitudeMode>& mode) {
    command
        .add_option_function<std::string>(
            "--mode",
            [&mode](const std::string& name) {
                mode = name == "3d"   ? AttitudeMode::gyro
                       : name == "6d" ? AttitudeMode::imu
                                      : AttitudeMode::imu_mag;
            },
            "Of an IMU, 3d: gyro; 6d: and accelerometer; 9d: and magnetometer; default: all it has")
        ->transform(CLI::IsMember({"3d", "6d", "9d"}, CLI::ignore_case));
}

/// The reduction promises a bound; should it ever not hold, that is an error.
inline void check_guarantee(const Replay& result) {
    for (const ChannelResult* channel : {&result.position, &result.orientation})
        if (channel->violations > 0 || channel->changed > 0)
            throw BadData(result.name + ": " + std::to_string(channel->violations) +
                          " samples outside tolerance, " + std::to_string(channel->changed) +
                          " changed after they were covered");
    if (result.events.wrong > 0 || result.events.late > 0)
        throw BadData(result.name + ": " + std::to_string(result.events.wrong) +
                      " events are wrong or missing, " + std::to_string(result.events.late) +
                      " came late");
}

}  // namespace fairlead::sim
