// fairlead-sim experiment NAME|all [--out DIR]: the papers' experiments, rerun.
#include "host_sim/study/experiments/experiment.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "host_sim/commands/commands.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/study/experiments/plot.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    std::string name{"all"}, out{"build/experiments"};
};

void run(const Options& options) {
    make_folder(options.out);
    Progress progress{"experiments", experiments().size(), "experiments"};
    std::size_t done = 0;
    for (const auto& experiment : experiments()) {
        progress.show(done++);
        if (options.name != "all" && options.name != experiment.name) continue;
        const std::string text = experiment.run(options.out);
        write_bytes(options.out + "/" + experiment.name + ".md", text);
        std::printf("%s\n", text.c_str());
    }
}

}  // namespace

void add_experiment(CLI::App& app) {
    auto* command =
        app.add_subcommand("experiment", "Rerun the papers' experiments: a table and plots each");
    auto options = std::make_shared<Options>();
    std::vector<std::string> names{"all"};
    std::string text = "all, or one of";
    for (const auto& experiment : experiments()) {
        names.emplace_back(experiment.name);
        text += std::string("\n  ") + experiment.name + ": " + experiment.what;
    }
    command->add_option("NAME", options->name, text)->required()->check(CLI::IsMember(names));
    command->add_option("--out", options->out, "Folder for tables and plots")
        ->capture_default_str();
    command->callback([options] { run(*options); });
}

}  // namespace fairlead::sim
