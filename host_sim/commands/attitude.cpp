// fairlead-sim attitude IN --out EST.csv: the orientation that the board would have computed.
#include <CLI/CLI.hpp>
#include <charconv>
#include <memory>

#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"
#include "host_sim/replay/attitude_run.hpp"
#include "host_sim/replay/attitude_settings.hpp"
#include "host_sim/replay/attitude_smooth.hpp"
#include "host_sim/replay/refused.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    InputOptions input;
    std::string out;
    std::optional<AttitudeMode> mode;
    std::vector<std::string> drop;
    double rate_error_percent{0};
    bool smooth{false};
    std::vector<std::string> set;
    Conditions conditions;
};

/// RATE[,BURST[,SEED]]
DropPlan drop_plan(const std::vector<std::string>& arguments) {
    const auto refuse = [] {
        throw BadSpec("--drop: RATE,BURST,SEED, a rate from 0 to 0.99 and a burst of 1 to 1000000");
    };
    const auto whole = [&](const std::string& text, std::uint64_t low, std::uint64_t high) {
        std::uint64_t value{};
        const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (failed != std::errc{} || end != text.data() + text.size() || value < low ||
            value > high)
            refuse();
        return value;
    };
    DropPlan plan;
    if (arguments.empty()) return plan;
    plan.rate = parse_real(arguments[0]);
    if (!(plan.rate >= 0 && plan.rate <= 0.99)) refuse();
    if (arguments.size() > 1) plan.burst = static_cast<int>(whole(arguments[1], 1, 1000000));
    if (arguments.size() > 2) plan.seed = whole(arguments[2], 0, UINT64_MAX);
    return plan;
}

void run(Options options) {
    options.conditions.drop = drop_plan(options.drop);
    options.conditions.rate_error = options.rate_error_percent / 100;
    const Recording recording = options.input.read();
    const auto mode = options.mode.value_or(all_sensors(recording));
    AttitudeParams params;
    apply_settings(params, options.set);
    const auto estimate = options.smooth
                              ? smooth_attitude(recording, mode, params)
                              : run_attitude(recording, mode, params, options.conditions);
    if (estimate.empty()) throw BadData(recording.name + ": no sample is left to estimate from");
    write_bytes(options.out, to_estimate_csv(estimate));
    options.input.judge_refused(refused_records(recording), recording.size());
}

}  // namespace

void add_attitude(CLI::App& app) {
    auto* command = app.add_subcommand("attitude", "Estimate orientation from an IMU recording");
    auto o = std::make_shared<Options>();
    o->input.add_to(*command);
    o->input.add_strict_to(*command);
    add_mode(*command, o->mode);
    command
        ->add_option("--drop", o->drop,
                     "RATE[,BURST[,SEED]]: lose this share of the samples, in runs of BURST")
        ->type_name("LIST")
        ->delimiter(',')
        ->expected(1, 3);
    command
        ->add_option("--rate-error", o->rate_error_percent,
                     "Percent by which the time stamps run fast")
        ->check(in_range(-50, 100));
    command->add_option("--every", o->conditions.every, "Keep one sample of so many")
        ->check(CLI::Range(1, 1000));
    command->add_option("--start-at", o->conditions.start_s, "Begin so many seconds in")
        ->check(in_range(0, 1e9));
    auto* smooth = command->add_flag(
        "--smooth", o->smooth,
        "Use the whole recording, forward and backward, in double: for analysis, not what a board "
        "would have known");
    for (const char* other : {"--drop", "--rate-error", "--every", "--start-at"})
        smooth->excludes(command->get_option(other));
    command
        ->add_option("--set", o->set,
                     "NAME=VALUE: a parameter of the filter, such as velocity_m_s=3 "
                     "(docs/attitude.md); SI units")
        ->type_name("NAME=VALUE");
    command->add_option("--out", o->out, "CSV to write: t_ns,qw,qx,qy,qz; sensor to east-north-up")
        ->required();
    command->callback([o] { run(*o); });
}

}  // namespace fairlead::sim
