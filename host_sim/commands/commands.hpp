#pragma once
// The subcommands of fairlead-sim, one file each: add_<name> in <name>.cpp, listed in sim.cpp.
namespace CLI {
class App;
}

namespace fairlead::sim {

void add_allan(CLI::App& app);
void add_attitude(CLI::App& app);
void add_compare(CLI::App& app);
void add_convert(CLI::App& app);
void add_decode(CLI::App& app);
void add_experiment(CLI::App& app);
void add_faults(CLI::App& app);
void add_filter(CLI::App& app);
void add_generate(CLI::App& app);
void add_info(CLI::App& app);
void add_reduce(CLI::App& app);
void add_replay(CLI::App& app);
void add_score(CLI::App& app);

}  // namespace fairlead::sim
