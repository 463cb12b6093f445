// fairlead-sim attitude IN --out EST.csv: the orientation that the board would have computed.
#include <CLI/CLI.hpp>
#include <memory>

#include "host_sim/attitude_run.hpp"
#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    InputOptions input;
    std::string out;
    std::optional<AttitudeMode> mode;
    std::vector<double> drop;
    double rate_error_percent{0};
    Conditions conditions;
};

void run(Options options) {
    if (!options.drop.empty()) {
        DropPlan& drop = options.conditions.drop;
        drop.rate = options.drop[0];
        if (options.drop.size() > 1) drop.burst = static_cast<int>(options.drop[1]);
        if (options.drop.size() > 2) drop.seed = static_cast<std::uint64_t>(options.drop[2]);
        if (drop.rate < 0 || drop.rate >= 1 || drop.burst < 1)
            throw std::invalid_argument("--drop: a rate in [0, 1) and a burst of at least 1");
    }
    options.conditions.rate_error = options.rate_error_percent / 100;
    const Recording recording = options.input.read();
    const auto estimate = run_attitude(recording, options.mode.value_or(all_sensors(recording)),
                                       AttitudeParams{}, options.conditions);
    write_bytes(options.out, to_estimate_csv(estimate));
}

}  // namespace

void add_attitude(CLI::App& app) {
    auto* command = app.add_subcommand("attitude", "Estimate orientation from an IMU recording");
    auto o = std::make_shared<Options>();
    o->input.add_to(*command);
    add_mode(*command, o->mode);
    command
        ->add_option("--drop", o->drop, "RATE,BURST,SEED: lose this share of the samples, in runs")
        ->delimiter(',')
        ->expected(1, 3);
    command->add_option("--rate-error", o->rate_error_percent,
                        "Percent by which the time stamps run fast");
    command->add_option("--every", o->conditions.every, "Keep one sample of so many")
        ->check(CLI::Range(1, 1000));
    command->add_option("--start-at", o->conditions.start_s, "Begin so many seconds in");
    command->add_option("--out", o->out, "CSV to write: t_ns,qw,qx,qy,qz; sensor to east-north-up")
        ->required();
    command->callback([o] { run(*o); });
}

}  // namespace fairlead::sim
