// Bytes of C2 cubics over those of the best rival.
#include <cmath>
#include <cstdio>

#include "host_sim/study/bench_cubics/measure.hpp"
#include "host_sim/study/bench_cubics/motion.hpp"
#include "host_sim/study/bench_peers/byte_rivals.hpp"

namespace fairlead::sim::cubics {
namespace {

struct Sum {
    double log_ratio{}, log_velocity{}, worst{}, error{}, seam{};
    std::size_t cells{}, samples{}, pieces{}, breaks{}, bytes{};

    void add(const Cell& cell, const Result& r, double ratio) {
        log_ratio += std::log(ratio);
        log_velocity += std::log(motion_errors(cell.track, r.decoded).velocity.rms);
        worst = std::max(worst, ratio);
        error = std::max(error, r.error);
        seam = std::max(seam, r.seam);
        ++cells;
        samples += cell.track.size();
        pieces += r.pieces;
        breaks += r.breaks;
        bytes += r.bytes;
    }
    double ratio() const { return std::exp(log_ratio / static_cast<double>(cells)); }
};

/// Bytes of the best rival.
double rival_bytes(const Cell& cell, std::int32_t delay, Cache& cache) {
    std::size_t least = SIZE_MAX;
    for (const Tried& t : best_of_each(byte_rivals(cell, static_cast<std::size_t>(delay), cache)))
        least = std::min(least, t.bytes);
    return static_cast<double>(least);
}

std::string row(Channel channel, std::int32_t delay, bool coarse, const Sum& s) {
    const auto cells = static_cast<double>(s.cells), samples = static_cast<double>(s.samples);
    const bool position = channel == Channel::position;
    const double tracks = position ? 3 : 1, unit = position ? 1 : 180 / std::acos(-1);
    return text("| %d | %s | %.3f | %.3f | %zu | %.2f | %zu | %.2f | %.4g %s | %.5f | %.0e |\n",
                delay, tolerance_name(channel, coarse).c_str(), s.ratio(), s.worst, s.bytes,
                static_cast<double>(s.pieces) / samples * 120 / tracks, s.breaks,
                1e4 * static_cast<double>(s.breaks) / samples,
                unit * std::exp(s.log_velocity / cells), position ? "m/s" : "deg/s", s.error,
                s.seam);
}

}  // namespace

void bytes_table(Study& study) {
    const Options& options = study.options();
    Cache cache{options.folder + "/rivals.cache"};
    const std::string head =
        "| delay | tolerance | bytes over best rival | worst | bytes | pieces a second "
        "and track | breaks | a 10,000 records | velocity error, rms | largest error | seam |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n";
    for (const Channel channel : {Channel::position, Channel::orientation}) {
        if (!options.has(channel)) continue;
        std::string out = head;
        const Halves& halves = study.halves(channel);
        if (halves.cells().empty()) return;
        for (const std::int32_t delay : options.delays) {
            const std::vector<Result>& found = study.results(channel, delay);
            std::array<Sum, 2> sums;
            for (std::size_t i = 0; i < found.size(); ++i) {
                const Cell& cell = halves.cells()[i];
                check(cell, found[i], delay);
                const auto bytes = static_cast<double>(found[i].bytes);
                const double ratio = options.rivals ? bytes / rival_bytes(cell, delay, cache) : 1;
                if (options.verbose)
                    std::fprintf(
                        stderr, "%s, delay %d: %zu bytes, %.3f of the best rival, %zu breaks\n",
                        cell.label().c_str(), delay, found[i].bytes, ratio, found[i].breaks);
                sums[cell.coarse ? 1 : 0].add(cell, found[i], ratio);
            }
            for (const bool coarse : {false, true})
                out += row(channel, delay, coarse, sums[coarse ? 1 : 0]);
            std::fprintf(stderr, "%s, delay %d: %.3f of the best rival\n", to_string(channel),
                         delay, std::sqrt(sums[0].ratio() * sums[1].ratio()));
        }
        publish(options, std::string{"bytes "} + to_string(channel), out);
    }
}

}  // namespace fairlead::sim::cubics
