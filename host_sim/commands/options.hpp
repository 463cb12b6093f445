#pragma once
// Options that several subcommands share.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>
#include <string>

#include "host_sim/recording/event_file.hpp"
#include "host_sim/recording/plausible.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/recording/writers.hpp"
#include "host_sim/replay/replay.hpp"

namespace fairlead::sim {

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

/// IN, and what a user can say about it: --columns, --units and their like; --events.
struct InputOptions {
    std::string path, events;
    bool salvage{false}, strict{false};
    ReadOptions reading;

    void add_to(CLI::App& command, const std::string& name = "IN") {
        command
            .add_option(name, path,
                        "Recording: .imu, .trk, or text: CSV with a header, EuRoC, TUM, KITTI")
            ->required()
            ->check(CLI::ExistingFile);
        command.add_flag("--salvage", salvage,
                         "Use the complete records before the damage of a bad file");
        command.add_option("--columns", reading.columns,
                           "Of text: what the columns are, for example t_ns,gx,gy,gz,ax,ay,az; - "
                           "for one that is not used");
        command.add_option(
            "--units", reading.units,
            "Of text: units of columns, for example t=us,gyro=deg/s,accel=g,mag=gauss");
        command.add_option("--sensors", reading.sensors,
                           "Of .imu version 1: the sensors that exist, for example gyro,accel");
        command.add_option("--rate", reading.rate_hz, "Of records without times: records a second")
            ->check(in_range(0.01, 1e6));
        command
            .add_option("--times", reading.times,
                        "Of records without times: a file with one time a line")
            ->check(CLI::ExistingFile);
        command
            .add_option("--with", reading.with,
                        "Files of the other sensors of the same device, merged by time")
            ->check(CLI::ExistingFile);
    }

    /// --strict: of commands whose intake judges the records.
    void add_strict_to(CLI::App& command) {
        command.add_flag("--strict", strict,
                         "Exit with 1 where more than 1 % of the records are refused");
    }

    void add_events_to(CLI::App& command) {
        command
            .add_option("--events", events,
                        "CSV of discrete events beside the recording: t_ns,channel,value")
            ->check(CLI::ExistingFile);
    }

    ReadOptions read_options() const {
        ReadOptions options = reading;
        options.salvage = salvage ? Salvage::yes : Salvage::no;
        return options;
    }

    /// The recording; what the reader took, and what is odd, on stderr.
    enum class Doubts { to_stderr, elsewhere };
    Recording read(Doubts place = Doubts::to_stderr) const {
        ReadOptions how = read_options();
        how.progress = progress_steps("read", "bytes");
        Recording recording = read_recording(path, how);
        how.progress = {};
        if (!recording.damage.empty())
            std::fprintf(stderr, "fairlead-sim: %s; %zu records before it are used\n",
                         recording.damage.c_str(), recording.size());
        for (const std::string& note : recording.notes)
            std::fprintf(stderr, "fairlead-sim: %s: note: %s\n", path.c_str(), note.c_str());
        const auto odd = place == Doubts::to_stderr
                             ? doubts(recording, progress_steps("check", "checks"))
                             : std::vector<std::string>{};
        for (const std::string& doubt : odd)
            std::fprintf(stderr, "fairlead-sim: %s: doubtful: %s\n", path.c_str(), doubt.c_str());
        if (!events.empty()) recording.events = read_events(events);
        return recording;
    }

    /// The last line of a run that refused more than 1 % of the records; --strict: exit code 1.
    void judge_refused(std::size_t refused, std::size_t records) const {
        if (100 * refused <= records) return;
        char text[160];
        std::snprintf(text, sizeof text, "%zu of %zu records (%.1f %%) were refused by the intake",
                      refused, records,
                      100 * static_cast<double>(refused) / static_cast<double>(records));
        if (strict) throw BadData(path + ": " + text);
        std::fflush(stdout);
        std::fprintf(stderr, "fairlead-sim: %s: %s\n", path.c_str(), text);
    }
};

/// --beam, --objective, --continuity: how the search works and what it keeps small.
inline void add_search(CLI::App& command, ReplayOptions& options) {
    const auto beam = [&options](const std::string& width) {
        options.beam = width == "narrow" || width == "small" ? Beam::narrow
                       : width == "wide" || width == "large" ? Beam::wide
                                                             : Beam::medium;
    };
    auto* width =
        command
            .add_option_function<std::string>(
                "--beam", beam,
                "Width of the search: more work finds fewer bytes, never another guarantee")
            ->check(CLI::IsMember({"narrow", "medium", "wide"}))
            ->default_str("medium");
    command
        .add_option_function<std::string>("--slice", beam,
                                          "Earlier name of --beam: small, medium or large")
        ->check(CLI::IsMember({"small", "medium", "large"}))
        ->excludes(width);
    command
        .add_option_function<std::string>(
            "--objective",
            [&options](const std::string& name) {
                options.objective = name == "knots" ? Objective::knots : Objective::bytes;
            },
            "What is kept small. knots: few control points by the earlier search; its stream is of "
            "an earlier format (decode --earlier)")
        ->check(CLI::IsMember({"bytes", "knots"}))
        ->default_str("bytes");
    command
        .add_option(
            "--continuity", options.continuity,
            "1: the velocity is continuous; 2: the acceleration of positions too, while "
            "orientations stay at 1 (with --objective knots both have it); 0: corners are allowed, "
            "and a smooth curve is one too")
        ->check(CLI::Range(0, 2));
}

/// The stream counts in ns: a shorter interval is none.
inline bool has_restarts(const ReplayOptions& options) { return options.restart_s >= 1e-9; }

/// What --objective and --continuity mean together.
inline void check_search(const ReplayOptions& options) {
    if (options.continuity == 2 && options.objective == Objective::bytes) {
        if (!options.position)
            throw BadSpec(
                "--continuity 2 with --objective bytes concerns positions: an orientation has a "
                "continuous velocity; --objective knots gives it a continuous acceleration");
        if (!has_restarts(options))
            throw BadSpec(
                "--continuity 2 needs restarts: a frame of such a curve needs the one before it, "
                "so --independent and --restart 0 are not for it");
    }
    if (options.objective == Objective::knots && !has_restarts(options))
        throw BadSpec("--independent and --restart 0 need --objective bytes");
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
    add_search(command, options);
    command
        .add_option("--max-delay,--delay", options.delay_max,
                    "Most records from a sample to the bytes that cover it")
        ->check(CLI::Range(delay_least, delay_most))
        ->capture_default_str();
    command
        .add_option("--restart", options.restart_s,
                    "Seconds between the points at which a reader can join; 0: as --independent")
        ->check(in_range(0, 1e6))
        ->capture_default_str();
    command.add_flag_callback(
        "--independent", [&options] { options.restart_s = 0; },
        "Each frame can be decoded alone: a lost frame costs its own time only");
    command.add_option("--stream-id", options.stream_id, "Tells streams on one line apart")
        ->check(CLI::Range(0u, 65535u))
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
    if (result.overflows > 0)
        throw BadData(result.name + ": " + std::to_string(result.overflows) +
                      " frames did not fit, or failed their check");
    if (result.events.wrong > 0 || result.events.late > 0)
        throw BadData(result.name + ": " + std::to_string(result.events.wrong) +
                      " events are wrong or missing, " + std::to_string(result.events.late) +
                      " came late");
}

}  // namespace fairlead::sim
