// fairlead-sim faults IN SPEC --seed N --out FILE: a recording, or any file, spoiled on purpose.
#include "host_sim/generate/faults.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>

#include "host_sim/commands/commands.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/recording/writers.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    std::string in, spec, out;
    std::uint64_t seed{1};
};

ReadOptions with_progress() {
    ReadOptions how;
    how.progress = progress_steps("read", "bytes");
    return how;
}

void run(const Options& options) {
    const auto items = parse_spec(options.spec);
    std::string bytes;
    if (std::all_of(items.begin(), items.end(), is_byte_fault)) {
        bytes = read_bytes(options.in);
    } else {
        Recording recording = read_recording(options.in, with_progress());
        for (std::size_t i = 0; i < items.size(); ++i)
            if (!is_byte_fault(items[i])) spoil_records(recording, items[i], options.seed + i);
        bytes = to_file(recording, options.out, progress_steps("write"));
        if (const std::string lost = left_out(recording, options.out); !lost.empty())
            std::fprintf(stderr, "fairlead-sim: %s: left out: %s\n", options.out.c_str(),
                         lost.c_str());
    }
    for (std::size_t i = 0; i < items.size(); ++i)
        if (is_byte_fault(items[i])) spoil_bytes(bytes, items[i], options.seed + i);
    write_bytes(options.out, bytes);
}

}  // namespace

void add_faults(CLI::App& app) {
    auto* command = app.add_subcommand("faults", "Spoil a recording, or any file, on purpose");
    auto options = std::make_shared<Options>();
    command->add_option("IN", options->in, "Recording, or any file for faults of bytes")
        ->required()
        ->check(CLI::ExistingFile);
    command->add_option("SPEC", options->spec, "What to spoil: see below")->required();
    command->add_option("--seed", options->seed, "Same seed, same places")->capture_default_str();
    command->add_option("--out", options->out, "File to write")->required();
    command->footer(faults_help);
    command->callback([options] { run(*options); });
}

}  // namespace fairlead::sim
