// bench-cubics: C2 cubics on a lattice beside the best rival, positions of the tracker recordings.
// Each half of the recordings is coded with tables that were trained on the other half. Every
// stream is decoded from its bytes, by a reader in step and by readers that join, and compared with
// the samples in double. docs/cubics.md holds the tables.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <future>

#include "host_sim/study/bench_cubics/stream.hpp"
#include "host_sim/study/bench_peers/byte_rivals.hpp"

namespace {

using namespace fairlead::sim;
namespace c2 = fairlead::sim::cubics;

struct Options {
    std::string recordings{"../shared/recordings/tracker120"};
    std::string folder{"build/peers"};
    std::vector<std::int32_t> delays{60, 120, 240};
    std::string tables;  // file to write
    int passes{4};
    bool rivals{true}, verbose{};
    c2::StreamParams stream;
};

using Half = std::vector<const Cell*>;

c2::Costs trained(const Half& half, const Options& options) {
    c2::StreamParams params = options.stream;
    params.delay = 120;
    c2::Costs costs = c2::train({});
    for (int pass = 0; pass < options.passes; ++pass) {
        c2::Counts counts;
        for (const Cell* cell : half) c2::run(cell->track, cell->tolerance, params, costs, counts);
        costs = c2::train(counts);
    }
    return costs;
}

struct Sum {
    double log_ratio{}, log_velocity{}, worst{}, error{}, seam{};
    std::size_t cells{}, samples{}, pieces{}, breaks{}, bytes{};
};

std::vector<c2::Result> results(const Half& half, const c2::Costs& costs, const Options& options,
                                std::int32_t delay) {
    c2::StreamParams params = options.stream;
    params.delay = delay;
    std::vector<c2::Result> all;
    for (const Cell* cell : half) {
        c2::Counts counts;
        all.push_back(c2::run(cell->track, cell->tolerance, params, costs, counts));
    }
    return all;
}

/// Bytes of the best rival.
double rival_bytes(const Cell& cell, std::int32_t delay, Cache& cache) {
    std::size_t least = SIZE_MAX;
    for (const Tried& t : best_of_each(byte_rivals(cell, static_cast<std::size_t>(delay), cache)))
        least = std::min(least, t.bytes);
    return static_cast<double>(least);
}

bool score(const Half& half, const std::vector<c2::Result>& results, const Options& options,
           Cache& cache, std::int32_t delay, std::array<Sum, 2>& sums) {
    for (std::size_t i = 0; i < half.size(); ++i) {
        const Cell& cell = *half[i];
        const c2::Result& r = results[i];
        if (!r.fault.empty() || r.error > 1) {
            std::fprintf(stderr, "%s, delay %d: %s, error %.6f of the tolerance\n",
                         cell.label().c_str(), delay, r.fault.c_str(), r.error);
            return false;
        }
        const auto bytes = static_cast<double>(r.bytes);
        const double ratio = options.rivals ? bytes / rival_bytes(cell, delay, cache) : 1;
        if (options.verbose)
            std::fprintf(stderr, "%s, delay %d: %zu bytes, %.3f of the best rival, %zu breaks\n",
                         cell.label().c_str(), delay, r.bytes, ratio, r.breaks);
        Sum& sum = sums[cell.coarse ? 1 : 0];
        sum.log_ratio += std::log(ratio);
        sum.log_velocity += std::log(r.velocity);
        sum.worst = std::max(sum.worst, ratio);
        sum.error = std::max(sum.error, r.error);
        sum.seam = std::max(sum.seam, r.seam);
        ++sum.cells;
        sum.samples += cell.track.size();
        sum.pieces += r.pieces;
        sum.breaks += r.breaks;
        sum.bytes += r.bytes;
    }
    return true;
}

void print(std::int32_t delay, const std::array<Sum, 2>& sums) {
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const Sum& s = sums[i];
        const auto cells = static_cast<double>(s.cells), samples = static_cast<double>(s.samples);
        std::printf("| %d | %s | %.3f | %.3f | %zu | %.2f | %zu | %.2f | %.4f | %.5f | %.0e |\n",
                    delay, i == 0 ? "1 mm" : "5 mm", std::exp(s.log_ratio / cells), s.worst,
                    s.bytes, static_cast<double>(s.pieces) / samples * 40, s.breaks,
                    1e4 * static_cast<double>(s.breaks) / samples, std::exp(s.log_velocity / cells),
                    s.error, s.seam);
    }
    std::fflush(stdout);
}

int measure(const Options& options) {
    std::vector<Cell> cells;
    for_each_cell(options.recordings, options.folder + "/cut", "", [&](const Cell& cell) {
        if (cell.track.channel == Channel::position && !cell.generated) cells.push_back(cell);
    });
    if (cells.empty()) return 0;
    if (!options.tables.empty()) {
        Half all;
        for (const Cell& cell : cells) all.push_back(&cell);
        return c2::write_tables(trained(all, options), options.tables) ? 0 : 1;
    }
    // two cells a recording, fine and coarse; recordings take turns
    std::array<Half, 2> half;
    for (std::size_t i = 0; i < cells.size(); ++i) half[i / 2 % 2].push_back(&cells[i]);
    // the halves at the same time
    std::array<c2::Costs, 2> costs;
    auto other = std::async(std::launch::async, [&] { return trained(half[0], options); });
    costs[0] = trained(half[1], options);
    costs[1] = other.get();
    Cache cache{options.folder + "/rivals.cache"};
    std::printf(
        "| delay | tolerance | bytes over best rival | worst | bytes | pieces a second and axis | "
        "breaks "
        "| a 10,000 records | velocity rms, m/s | largest error | seam |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::int32_t delay : options.delays) {
        std::array<Sum, 2> sums;
        auto second = std::async(std::launch::async,
                                 [&] { return results(half[1], costs[1], options, delay); });
        const std::array<std::vector<c2::Result>, 2> found{
            results(half[0], costs[0], options, delay), second.get()};
        for (std::size_t h = 0; h < 2; ++h)
            if (!score(half[h], found[h], options, cache, delay, sums)) return 1;
        print(delay, sums);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"C2 cubics beside the best rival, from their bytes. docs/cubics.md"};
    app.option_defaults()->always_capture_default();
    Options options;
    app.add_option("--recordings", options.recordings, "folder of .trk recordings");
    app.add_option("--folder", options.folder, "where kept results of the rivals are");
    app.add_option("--delays", options.delays, "records that a sample may wait")
        ->check(CLI::Range(8, 240))
        ->delimiter(',');
    app.add_option("--tables", options.tables,
                   "write the library's tables, trained on all recordings, to this file");
    app.add_option("--passes", options.passes, "of training")->check(CLI::Range(1, 20));
    app.add_option("--width", options.stream.search.width, "vertices kept at a record")
        ->check(CLI::Range(1, 200));
    app.add_option("--look-ahead", options.stream.look_ahead, "records known behind a frame's end")
        ->check(CLI::Range(0, 7));
    app.add_option("--look", options.stream.search.look, "ticks that a vertex sees ahead")
        ->check(CLI::Range(1, 1000));
    app.add_option("--break", options.stream.search.break_bits, "price of a break, bits")
        ->check(CLI::Range(0, 1000));
    app.add_flag("!--no-rivals", options.rivals, "do not compare with rivals");
    app.add_flag("--verbose", options.verbose, "a line for each stream");
    CLI11_PARSE(app, argc, argv);
    try {
        return measure(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench-cubics: %s\n", error.what());
        return 1;
    }
}
