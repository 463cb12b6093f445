// fairlead-sim filter IN --filter SPEC --out OUT.csv: intake and filter alone.
#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "fairlead/sense/intake.hpp"
#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/recording/writers.hpp"
#include "host_sim/replay/attitude_run.hpp"
#include "host_sim/replay/filter_chain.hpp"
#include "host_sim/replay/refused.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    InputOptions input;
    std::optional<AttitudeMode> mode;
    std::string filter, out;
};

/// The recording's own, or what the attitude filter makes of an IMU.
std::vector<Pose> poses_to_filter(const Recording& recording, const Options& options) {
    if (recording.samples.empty()) return recording.poses;
    return run_attitude(recording, options.mode.value_or(all_sensors(recording)));
}

void run(const Options& options) {
    const Recording recording = options.input.read();
    const auto chain =
        std::make_unique<FilterChain>(parse_filters(options.filter, recording.period_s));
    Intake<Pose> intake{intake_params(recording)};
    std::vector<Pose> filtered;
    const std::vector<Pose> poses = poses_to_filter(recording, options);
    Progress progress{"filter", poses.size()};
    for (const Pose& raw : poses) {
        progress.show(static_cast<std::size_t>(&raw - poses.data()));
        const auto pose = intake.push(raw);
        if (!pose) continue;
        if (const auto out = chain->push(*pose)) filtered.push_back(*out);
    }
    while (const auto out = chain->flush()) filtered.push_back(*out);
    write_bytes(options.out, to_poses_csv(filtered, progress_steps("write")));
    for (std::size_t i = 0; i < fault_kinds; ++i) {
        const auto kind = static_cast<Fault>(i);
        if (const auto n = intake.faults()[kind])
            std::printf("%-24s %llu\n", to_string(kind), static_cast<unsigned long long>(n));
    }
    options.input.judge_refused(refused_records(recording), recording.size());
}

}  // namespace

void add_filter(CLI::App& app) {
    auto* command = app.add_subcommand(
        "filter", "Filter a recording, of an IMU its orientation, and nothing else");
    auto options = std::make_shared<Options>();
    options->input.add_to(*command);
    options->input.add_strict_to(*command);
    add_mode(*command, options->mode);
    command->add_option("--filter", options->filter, "Filters, see below")->required();
    command->add_option("--out", options->out, "Pose CSV to write")->required();
    command->footer(filter_help);
    command->callback([options] { run(*options); });
}

}  // namespace fairlead::sim
