// fairlead-sim reduce IN --out STREAM.flr: the reducer and the codec alone.
#include <CLI/CLI.hpp>
#include <memory>

#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"
#include "host_sim/replay/replay.hpp"
#include "host_sim/report/summary.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    InputOptions input;
    ReplayOptions replay;
    std::string channel{"both"}, out, trace;
    bool json{false};
};

std::string trace_csv(const Recording& recording, const Replay& result) {
    std::string csv = "index,t_ns,bytes\n";
    for (std::size_t i = 0; i < recording.size(); ++i)
        csv += std::to_string(i) + "," + std::to_string(recording.t_ns(i)) + "," +
               std::to_string(result.bytes_after_record[i]) + "\n";
    return csv;
}

void run(Options& options) {
    ReplayOptions& o = options.replay;
    o.position = options.channel != "orientation";
    o.orientation = options.channel != "position";
    const Recording recording = options.input.read();
    const bool imu = !recording.samples.empty();
    if (imu && !o.orientation) throw BadSpec("an IMU gives orientations, no positions");
    if (imu) o.position = false;
    check_search(o);
    if ((o.position && !imu && !(o.tol_pos_m > 0)) || (o.orientation && !(o.tol_rot_rad > 0)))
        throw BadSpec("reduce needs --tol-pos for positions and --tol-rot for orientations");
    const Replay result = replay(recording, o);
    write_bytes(options.out, result.stream);
    if (!options.trace.empty()) write_bytes(options.trace, trace_csv(recording, result));
    std::fputs((options.json ? summary_json(result) : summary_table(result)).c_str(), stdout);
    check_guarantee(result);
    options.input.judge_refused(result.refused, recording.size());
}

}  // namespace

void add_reduce(CLI::App& app) {
    auto* command =
        app.add_subcommand("reduce", "Reduce a recording to a stream of few bytes, unfiltered");
    auto options = std::make_shared<Options>();
    options->input.add_to(*command);
    options->input.add_strict_to(*command);
    options->input.add_events_to(*command);
    add_mode(*command, options->replay.mode);
    add_reduction(*command, options->replay, true);
    command->add_option("--channel", options->channel, "What to reduce")
        ->check(CLI::IsMember({"position", "orientation", "both"}))
        ->capture_default_str();
    command->add_option("--out", options->out, "Stream to write, .flr")->required();
    command->add_flag("--json", options->json, "Print the summary as JSON");
    command->add_option("--trace", options->trace,
                        "CSV to write: bytes of complete frames after each input record");
    command->callback([options] { run(*options); });
}

}  // namespace fairlead::sim
