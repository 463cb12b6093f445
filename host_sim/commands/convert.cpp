// fairlead-sim convert IN OUT: a recording in another format; nothing is dropped without a word.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    InputOptions input;
    std::string out, events_out;
    int imu_version{0};
};

bool ends_with(const std::string& text, const std::string& end) {
    return text.size() >= end.size() &&
           text.compare(text.size() - end.size(), end.size(), end) == 0;
}

void run(const Options& o) {
    const Recording recording = o.input.read();
    const bool imu = ends_with(o.out, ".imu") && !recording.samples.empty();
    if (o.imu_version != 0 && !imu) throw BadSpec("--imu-version is for an IMU's .imu");
    write_bytes(o.out, imu ? to_imu(recording, o.imu_version)
                           : to_file(recording, o.out, progress_steps("write")));
    std::string lost = left_out(recording, o.out);
    if (!o.events_out.empty()) {
        write_bytes(o.events_out, to_events_csv(recording.events));
        if (!ends_with(o.out, ".tum")) lost.clear();
    }
    std::printf("%zu records in %s\n", recording.size(), o.out.c_str());
    if (!lost.empty())
        std::fprintf(stderr, "fairlead-sim: %s: left out: %s\n", o.out.c_str(), lost.c_str());
}

}  // namespace

void add_convert(CLI::App& app) {
    auto* command = app.add_subcommand("convert", "Write a recording in another format");
    auto o = std::make_shared<Options>();
    o->input.add_to(*command);
    o->input.add_events_to(*command);
    command
        ->add_option("OUT,--out", o->out, "File to write: .imu .trk .tum .csv; also as --out OUT")
        ->required();
    command
        ->add_option("--imu-version", o->imu_version,
                     "Version of .imu; default: 1 where it can hold the recording, else 2")
        ->check(CLI::IsMember({1, 2}));
    command->add_option("--events-out", o->events_out,
                        "CSV to write: the discrete events, t_ns,channel,value,gap");
    command->callback([o] { run(*o); });
}

}  // namespace fairlead::sim
