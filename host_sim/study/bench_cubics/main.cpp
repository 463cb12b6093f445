// bench-cubics: C2 cubics on a lattice beside the best rival, the other kinds of pieces and the
// earlier search, on the tracker recordings. docs/cubics.md holds the tables.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "host_sim/study/bench_cubics/measure.hpp"

int main(int argc, char** argv) {
    namespace c2 = fairlead::sim::cubics;
    CLI::App app{"C2 cubics beside their rivals, from their bytes: the tables of docs/cubics.md"};
    app.option_defaults()->always_capture_default();
    c2::Options options;
    app.add_option("--recordings", options.recordings, "folder of .trk recordings");
    app.add_option("--folder", options.folder, "where kept results of the rivals are");
    app.add_option("--program", options.program, "fairlead-sim, for the kinds of the stream");
    app.add_option("--page", options.page, "page whose tables to replace");
    app.add_option("--plot", options.plot, "SVG to write, of the motion table");
    app.add_option("--only", options.only, "recordings with this in their names");
    app.add_option("--delays", options.delays, "records that a sample may wait")
        ->check(CLI::Range(8, 240))
        ->delimiter(',');
    app.add_option("--channels", options.channels, "position, orientation")
        ->check(CLI::IsMember({"position", "orientation"}))
        ->delimiter(',');
    app.add_option("--prices", options.prices, "of a piece, in the table of control points")
        ->check(CLI::Range(0.0, 1e4))
        ->delimiter(',');
    app.add_option("--control-points", options.control_points, "those of libsisl, as CSV");
    app.add_option("--passes", options.passes, "of training")->check(CLI::Range(1, 20));
    app.add_flag("!--no-rivals", options.rivals, "do not compare with rivals");
    app.add_flag("--verbose", options.verbose, "a line for each stream");
    auto& change = options.change;
    const auto changed = [&](const char* name, auto& value, const char* what) {
        return app
            .add_option(name, value, std::string{what} + "; otherwise as usual for the channel")
            ->always_capture_default(false);
    };
    changed("--width", change.width, "vertices kept at a record")->check(CLI::Range(1, 200));
    changed("--values", change.values, "pieces tried for a length")->check(CLI::Range(1, 64));
    changed("--look-ahead", change.look_ahead, "records known behind a frame's end")
        ->check(CLI::Range(0, 7));
    changed("--look", change.look, "ticks that a vertex sees ahead")->check(CLI::Range(1, 1000));
    changed("--restart", change.restart, "records from restart to restart, 0: none")
        ->check(CLI::Range(0, 100000));
    changed("--margin", change.margin_bits, "dearer vertices are dropped, bits")
        ->check(CLI::Range(1, 10000));
    changed("--repeats", change.repeats, "of a frame that would break, each four times as wide")
        ->check(CLI::Range(0, 3));
    changed("--commit", change.commit, "of a delay that is committed, for few control points")
        ->check(CLI::Range(0.0, 1.0));
    changed("--break", change.break_bits, "price of a break, bits")->check(CLI::Range(0, 1000));
    changed("--step", change.step, "lattice step over tolerance")->check(CLI::Range(0.01, 2.0));
    changed("--chart", change.chart_rad, "angle from its anchor where a rotation moves it, rad")
        ->check(CLI::Range(0.0, 2.2));
    changed("--control-weight", change.control_weight, "bits for a control point a step off");
    changed("--vertex-weight", change.vertex_weight, "the same, of the one at the vertex");
    std::vector<std::string> tables{"bytes", "motion", "knots"};
    std::string library_tables;
    app.add_option("--tables", library_tables,
                   "write the library's tables of axes, trained on all recordings, to this file");
    app.add_option("what", tables,
                   "bytes: over the best rival; motion: errors of velocity and "
                   "acceleration; knots: control points over libsisl")
        ->check(CLI::IsMember({"bytes", "motion", "knots"}));
    CLI11_PARSE(app, argc, argv);
    try {
        c2::Study study{options};
        if (!library_tables.empty())
            return c2::write_tables(study.costs_of_all(fairlead::sim::Channel::position),
                                    library_tables)
                       ? 0
                       : 1;
        for (const std::string& table : tables)
            table == "bytes"    ? c2::bytes_table(study)
            : table == "motion" ? c2::motion_table(study)
                                : c2::knots_table(study);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench-cubics: %s\n", error.what());
        return 1;
    }
    return 0;
}
