// fairlead-sim generate SPEC --seed N --out FILE: a recording with known truth.
#include "host_sim/generate/generate.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "host_sim/commands/commands.hpp"
#include "host_sim/generate/sensor_model.hpp"
#include "host_sim/recording/event_file.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/recording/writers.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    std::string spec, out, truth, events;
    std::uint64_t seed{1};
};

void run(const Options& options) {
    const Recording recording = generate(options.spec, options.seed);
    if (!recording.events.empty() && options.events.empty())
        throw BadSpec("a SPEC with press needs --events FILE: recordings hold no discrete events");
    write_bytes(options.out, to_file(recording, options.out));
    if (!options.truth.empty()) write_bytes(options.truth, to_poses_csv(recording.truth));
    if (!options.events.empty()) write_bytes(options.events, to_events_csv(recording.events));
}

std::string footer() {
    std::string text = generate_help;
    text += "\n  models:\n";
    for (const SensorModel& model : sensor_models())
        text +=
            "    " + model.name + std::string(29 - model.name.size(), ' ') + model.summary + "\n";
    return text;
}

}  // namespace

void add_generate(CLI::App& app) {
    auto* command = app.add_subcommand("generate", "Make a recording with known truth");
    auto options = std::make_shared<Options>();
    command->add_option("SPEC", options->spec, "Motion, events and sensor model: see below")
        ->required();
    command->add_option("--seed", options->seed, "Same seed, same bytes")->capture_default_str();
    command->add_option("--out", options->out, "Recording to write: .trk .tum .imu .csv")
        ->required();
    command->add_option("--truth", options->truth, "Also write the true poses, as pose CSV");
    command->add_option("--events", options->events,
                        "CSV for the discrete events: t_ns,channel,value,gap");
    command->footer(footer());
    command->callback([options] { run(*options); });
}

}  // namespace fairlead::sim
