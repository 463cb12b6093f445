// bench-peers: our reducer beside its rivals, control points and bytes, in one go. What is measured
// and how: docs/peers.md. Results of the rivals are kept; only our own are made anew.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "host_sim/bench_peers/knot_rivals.hpp"

namespace {

using namespace fairlead::sim;

struct Options {
    std::string recordings{"../shared/recordings/tracker120"};
    std::string folder{"build/peers"};
    std::string only;
};

int run(const Options& options) {
    Cache cache{options.folder + "/rivals.cache"};
    std::printf("name,channel,tolerance,samples,method,control_points,error_over_tolerance\n");
    for_each_cell(options.recordings, options.folder + "/cut", options.only, [&](const Cell& cell) {
        for (const KnotResult& r : knot_rivals(cell, cache)) {
            std::printf("%s,%s,%s,%zu,%s,%zu,%.4f\n", cell.track.name.c_str(),
                        to_string(cell.track.channel),
                        tolerance_name(cell.track.channel, cell.coarse).c_str(), cell.track.size(),
                        r.method.c_str(), r.control_points, r.error);
            std::fflush(stdout);
        }
    });
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Our reducer and codec beside their rivals. Method and figures: docs/peers.md"};
    app.option_defaults()->always_capture_default();
    Options options;
    app.add_option("--recordings", options.recordings, "folder of .trk recordings");
    app.add_option("--folder", options.folder, "where cut recordings and kept results go");
    app.add_option("--only", options.only, "only recordings whose name contains this");
    CLI11_PARSE(app, argc, argv);
    try {
        return run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench-peers: %s\n", error.what());
        return 1;
    }
}
