// fairlead-sim decode STREAM.flr --at IN --out OUT.csv: the curve at the times of a recording; and
// the stream's discrete events, --events EVENTS.csv.
#include <CLI/CLI.hpp>
#include <memory>

#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"
#include "host_sim/curve_store.hpp"
#include "host_sim/recording/event_file.hpp"
#include "host_sim/recording/writers.hpp"
#include "host_sim/spec.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    std::string stream, at, out, events;
    bool salvage{false};
};

void write_curve(const CurveStore& store, const Options& options) {
    const Recording times =
        read_recording(options.at, options.salvage ? Salvage::yes : Salvage::no);
    std::vector<Pose> poses;
    for (std::size_t i = 0; i < times.size(); ++i) poses.push_back(store.at(times.t_ns(i)));
    write_bytes(options.out, to_poses_csv(poses));
}

void run(const Options& options) {
    if (options.out.empty() && options.events.empty())
        throw BadSpec("decode needs --at and --out for the curve, or --events for the events");
    CurveStore store;
    store.push(read_bytes(options.stream));
    store.finish();
    if (!options.out.empty()) write_curve(store, options);
    if (!options.events.empty()) write_bytes(options.events, to_events_csv(store.events()));
    const std::string damage = store.damage();
    if (damage.empty()) return;
    // what could be decoded is written all the same: decoding went on at the next good frame
    if (!options.salvage || store.empty()) throw BadData(options.stream + ": " + damage);
    std::fprintf(stderr, "fairlead-sim: %s: %s\n", options.stream.c_str(), damage.c_str());
}

}  // namespace

void add_decode(CLI::App& app) {
    auto* command = app.add_subcommand(
        "decode", "Evaluate a stream at the times of a recording; empty fields: no curve there");
    auto options = std::make_shared<Options>();
    command->add_option("STREAM", options->stream, "Stream, .flr")
        ->required()
        ->check(CLI::ExistingFile);
    auto* at = command->add_option("--at", options->at, "Recording whose times are wanted")
                   ->check(CLI::ExistingFile);
    auto* out = command->add_option("--out", options->out, "Pose CSV to write")->needs(at);
    at->needs(out);
    command->add_option("--events", options->events,
                        "CSV to write: the discrete events, t_ns,channel,value,gap");
    command->add_flag("--salvage", options->salvage,
                      "A damaged stream is no error: what is good of it is decoded");
    command->callback([options] { run(*options); });
}

}  // namespace fairlead::sim
