// fairlead-sim: the library on recordings, on the host. Exit codes: 0 ok, 1 bad data, 2 usage.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "fairlead/version.hpp"
#include "host_sim/commands/commands.hpp"

namespace {

constexpr const char* version = "fairlead-sim " FAIRLEAD_VERSION;
constexpr int exit_ok = 0, exit_bad_data = 1, exit_usage = 2;

void add_commands(CLI::App& app) {  // one line each
    fairlead::sim::add_replay(app);
    fairlead::sim::add_reduce(app);
    fairlead::sim::add_decode(app);
    fairlead::sim::add_filter(app);
    fairlead::sim::add_attitude(app);
    fairlead::sim::add_score(app);
    fairlead::sim::add_allan(app);
    fairlead::sim::add_compare(app);
    fairlead::sim::add_experiment(app);
    fairlead::sim::add_generate(app);
    fairlead::sim::add_faults(app);
    fairlead::sim::add_convert(app);
    fairlead::sim::add_info(app);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{
        "Replays, filters and reduces recordings with the code that runs on the board.\n"
        "Exit codes: 0 ok, 1 bad data, 2 usage."};
    app.name("fairlead-sim");
    app.set_version_flag("--version", version);
    app.require_subcommand(1);
    app.option_defaults()->always_capture_default();
    add_commands(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? exit_ok : exit_usage;
    } catch (const std::invalid_argument& error) {
        std::fprintf(stderr, "fairlead-sim: %s\n", error.what());
        return exit_usage;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "fairlead-sim: %s\n", error.what());
        return exit_bad_data;
    }
    return exit_ok;
}
