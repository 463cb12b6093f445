// fairlead-sim score IN EST.csv: how far an orientation estimate is from a recording's reference.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>

#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"
#include "host_sim/replay/attitude_run.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    InputOptions input;
    std::string estimate;
    bool json{false};
    Align align{Align::none};
};

void run(const Options& o) {
    const Recording recording = o.input.read();
    const auto estimate = parse_estimate_csv(read_bytes(o.estimate), o.estimate);
    const Score s = score(recording, aligned(recording, estimate, o.align));
    if (s.count == 0)
        throw BadData(o.estimate + ": no time stamp of it has a valid reference in the movement");
    const char* format = o.json ? "{\"recording\": \"%s\", \"samples\": %zu, \"not_finite\": %zu, "
                                  "\"total_deg\": %.6f, \"heading_deg\": %.6f, "
                                  "\"inclination_deg\": %.6f}\n"
                                : "recording    %s\nsamples      %zu\nnot finite   %zu\n"
                                  "total        %.3f deg\nheading      %.3f deg\n"
                                  "inclination  %.3f deg\n";
    std::printf(format, recording.name.c_str(), s.count, s.not_finite, s.total_deg, s.heading_deg,
                s.inclination_deg);
}

}  // namespace

void add_score(CLI::App& app) {
    auto* command =
        app.add_subcommand("score", "Compare an orientation estimate with the reference");
    auto o = std::make_shared<Options>();
    o->input.add_to(*command);
    command->add_option("EST", o->estimate, "CSV: t_ns,qw,qx,qy,qz, times as in the recording")
        ->required()
        ->check(CLI::ExistingFile);
    const std::map<std::string, Align> ways{
        {"none", Align::none}, {"heading", Align::heading}, {"rotation", Align::rotation}};
    command
        ->add_option(
            "--align", o->align,
            "Remove a constant offset first: of heading (a reference that is level but not "
            "north-aligned), or any rotation between the two worlds")
        ->transform(CLI::CheckedTransformer(ways, CLI::ignore_case).description(""))
        ->type_name("none|heading|rotation");
    command->add_flag("--json", o->json, "One JSON object instead of text");
    command->callback([o] { run(*o); });
}

}  // namespace fairlead::sim
