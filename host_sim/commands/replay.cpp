// fairlead-sim replay IN: the whole pipeline on a recording, a summary, and a folder of results.
#include "host_sim/replay/replay.hpp"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"
#include "host_sim/recording/writers.hpp"
#include "host_sim/replay/filter_chain.hpp"
#include "host_sim/report/report.hpp"
#include "host_sim/report/summary.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    InputOptions input;
    ReplayOptions replay;
    std::string out;
};

void write_results(const Replay& result, const std::string& folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) throw BadData(folder + ": cannot be made: " + failed.message());
    write_bytes(folder + "/filtered.tum", to_tum(result.input, progress_steps("write")));
    write_bytes(folder + "/stream.flr", result.stream);
    if (result.events.offered > 0)
        write_bytes(folder + "/events.csv", to_events_csv(result.events.decoded));
    write_bytes(folder + "/report.html", report_page(result));
    std::printf("%-24s %s\n", "report", (folder + "/report.html").c_str());
}

void run(const Options& options) {
    check_search(options.replay);
    const Recording recording = options.input.read();
    const Replay result = replay(recording, options.replay);
    std::fputs(summary_table(result).c_str(), stdout);
    if (!options.out.empty()) write_results(result, options.out);
    check_guarantee(result);
    options.input.judge_refused(result.refused, recording.size());
}

}  // namespace

void add_replay(CLI::App& app) {
    auto* command = app.add_subcommand("replay",
                                       "Run a recording through the whole pipeline: intake, "
                                       "attitude of an IMU, filter, reduce, codec");
    auto options = std::make_shared<Options>();
    options->input.add_to(*command);
    options->input.add_strict_to(*command);
    options->input.add_events_to(*command);
    command->add_option("--filter", options->replay.filter, "Filters, see below; default: none");
    add_mode(*command, options->replay.mode);
    add_reduction(*command, options->replay, false);
    command->add_option("--out", options->out,
                        "Folder for filtered.tum, stream.flr, events.csv and report.html");
    command->footer(filter_help);
    command->callback([options] { run(*options); });
}

}  // namespace fairlead::sim
