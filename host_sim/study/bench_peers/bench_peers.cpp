// bench-peers: our reducer beside its rivals, control points and bytes, in one go. What is measured
// and how: docs/peers.md. Results of the rivals are kept; only our own are made anew.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>

#include "host_sim/study/baselines/knots/certificate.hpp"
#include "host_sim/study/bench_peers/report.hpp"
#include "host_sim/study/bench_peers/rotations.hpp"
#include "host_sim/study/bench_peers/six_dof.hpp"

namespace {

using namespace fairlead::sim;

struct Options {
    std::string recordings{"../shared/recordings/tracker120"};
    std::string folder{"build/peers"};
    std::string program{"build/fairlead-sim"};
    std::string reduce_arguments;
    std::string only;
    std::string page, control_points_csv, sweep_csv;  // empty: not written
    bool rivals_only{};
};

/// Every setting that was tried, summed up over the cells of one table: the committed sweep.
class SweepSummary {
  public:
    void add(const Cell& cell, std::size_t bound, const std::vector<Tried>& all) {
        if (cell.generated) return;
        const std::size_t column = (cell.track.channel == Channel::position ? 0u : 2u) +
                                   (cell.coarse ? 1u : 0u) + 4 * bound;
        for (const Tried& tried : all) {
            auto& sum = rows_[tried.rival + ',' + tried.setting].at(column);
            ++sum.count;
            if (tried.within) ++sum.within;
            sum.log += std::log(static_cast<double>(tried.bytes));
        }
    }
    std::string csv() const {
        std::string out = "rival,setting";
        for (const char* bound : {"60", "120", "240", "none"})
            for (const char* cell : {"1 mm", "5 mm", "0.25 deg", "1 deg"})
                out += std::string{","} + cell + " delay " + bound;
        out += '\n';
        for (const auto& [key, sums] : rows_) {
            out += key;
            for (const Sum& s : sums) {
                char text[32] = ",broken";
                if (s.count == s.within && s.count > 0)
                    std::snprintf(text, sizeof text, ",%.0f",
                                  std::exp(s.log / static_cast<double>(s.count)));
                out += text;
            }
            out += '\n';
        }
        return out;
    }

  private:
    struct Sum {
        double log{};
        std::size_t count{}, within{};
    };
    std::map<std::string, std::array<Sum, 4 * bound_count>> rows_;
};

CellResult measure(const Cell& cell, const Options& options, Cache& cache, SweepSummary& sweeps) {
    CellResult result;
    result.name = cell.track.name;
    result.channel = cell.track.channel;
    result.coarse = cell.coarse;
    result.generated = cell.generated;
    result.samples = cell.track.size();
    result.seconds = cell.track.period_s * static_cast<double>(cell.track.size());
    result.knots = knot_rivals(cell, cache);
    if (cell.track.channel == Channel::position)
        result.least = 4 + knots_needed(cell.track, cell.tolerance).size();
    for (std::size_t bound = 0; bound < bound_count; ++bound) {
        const std::size_t delay = bound < delays.size() ? delays[bound] : no_delay_bound;
        const auto all = byte_rivals(cell, delay, cache);
        result.bytes[bound] = best_of_each(all);
        sweeps.add(cell, bound, all);
    }
    const Program program{options.program, options.folder, options.reduce_arguments};
    for (std::size_t s = 0; s < settings.size() && !options.rivals_only; ++s)
        for (std::size_t d = 0; d < delays.size(); ++d)
            result.ours[s][d] = program.reduce(cell, delays[d], settings[s]);
    return result;
}

std::string control_points_csv(const std::vector<CellResult>& results) {
    std::string out = "name,channel,tolerance,samples,method,control_points,error_over_tolerance\n";
    for (const CellResult& c : results) {
        for (const KnotResult& k : c.knots) {
            char line[256];
            std::snprintf(line, sizeof line, "%s,%s,%s,%zu,%s,%zu,%.4f\n", c.name.c_str(),
                          to_string(c.channel), tolerance_name(c.channel, c.coarse).c_str(),
                          c.samples, k.method.c_str(), k.control_points, k.error);
            out += line;
        }
    }
    return out;
}

void run(const Options& options) {
    Cache cache{options.folder + "/rivals.cache"};
    SweepSummary sweeps;
    std::vector<CellResult> results;
    std::vector<RotationResult> turned;
    SixDof six_dof{Program{options.program, options.folder, options.reduce_arguments}};
    for_each_cell(options.recordings, options.folder + "/cut", options.only, [&](const Cell& cell) {
        std::fprintf(stderr, "%s\n", cell.label().c_str());
        results.push_back(measure(cell, options, cache, sweeps));
        if (!options.rivals_only) six_dof.add(cell, results.back());
        if (cell.track.channel == Channel::position || cell.generated || options.rivals_only)
            return;
        const Program program{options.program, options.folder, options.reduce_arguments};
        if (const auto result = in_other_frames(cell, program)) turned.push_back(*result);
    });
    const std::string tables =
        to_markdown(results) + to_markdown(six_dof.results()) + to_markdown(turned);
    std::printf("%s", tables.c_str());
    write_bytes(options.folder + "/peers.json", to_json(results));
    if (!options.page.empty())
        write_bytes(options.page, with_tables(read_bytes(options.page), tables));
    if (!options.control_points_csv.empty())
        write_bytes(options.control_points_csv, control_points_csv(results));
    if (!options.sweep_csv.empty()) write_bytes(options.sweep_csv, sweeps.csv());
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Our reducer and codec beside their rivals. Method and figures: docs/peers.md"};
    app.option_defaults()->always_capture_default();
    Options options;
    app.add_option("--recordings", options.recordings, "folder of .trk recordings");
    app.add_option("--folder", options.folder, "where cut recordings and kept results go");
    app.add_option("--program", options.program, "fairlead-sim");
    app.add_option("--reduce-arguments", options.reduce_arguments, "more of them for its reduce");
    app.add_option("--only", options.only, "only recordings whose name contains this");
    app.add_option("--page", options.page, "page whose tables to replace");
    app.add_option("--control-points", options.control_points_csv, "CSV to write");
    app.add_option("--sweep", options.sweep_csv, "CSV to write");
    app.add_flag("--rivals-only", options.rivals_only, "do not run our own");
    CLI11_PARSE(app, argc, argv);
    try {
        run(options);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench-peers: %s\n", error.what());
        return 1;
    }
}
