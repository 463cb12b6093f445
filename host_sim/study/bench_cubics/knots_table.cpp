// Control points of C2 cubics whose search counts pieces instead of bits, over those of libsisl.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>
#include <stdexcept>

#include "host_sim/recording/writers.hpp"
#include "host_sim/study/bench_cubics/measure.hpp"

namespace fairlead::sim::cubics {
namespace {

/// libsisl's control points by the label of a cell: what bench-peers keeps.
std::map<std::string, double> yardstick(const std::string& path) {
    std::istringstream lines{read_bytes(path)};
    std::string line;
    std::map<std::string, double> points;
    while (std::getline(lines, line)) {
        std::istringstream fields{line};
        std::array<std::string, 6> f;
        for (auto& field : f) std::getline(fields, field, ',');
        if (f[4] == "libsisl") points[f[0] + ' ' + f[1] + ' ' + f[2]] = std::stod(f[5]);
    }
    if (points.empty()) throw std::runtime_error(path + " has no control points of libsisl");
    return points;
}

struct Sum {
    double log_ratio{}, worst{};
    std::size_t cells{}, points{}, bytes{}, breaks{};
    double ratio() const {
        return std::exp(log_ratio / static_cast<double>(std::max<std::size_t>(cells, 1)));
    }
};

}  // namespace

void knots_table(Study& study) {
    const Options& options = study.options();
    const auto points = yardstick(options.control_points);
    const std::string head =
        "| delay | price of a piece | tolerance | control points over libsisl | worst | "
        "both | control points | bytes | breaks |\n|---|---|---|---|---|---|---|---|---|\n";
    for (const Channel channel : {Channel::position, Channel::orientation}) {
        if (!options.has(channel)) continue;
        std::string out = head;
        for (const std::int32_t delay : options.delays) {
            if (delay < 120) continue;
            for (const double price : options.prices) {
                StreamParams params = knot_params(channel, price);
                options.change.apply(params);
                params.delay = delay;
                const Halves& halves = study.halves(channel);
                const std::vector<Result> found = halves.run(params, {train({}), train({})});
                std::array<Sum, 2> sums;
                for (std::size_t i = 0; i < found.size(); ++i) {
                    const Cell& cell = halves.cells()[i];
                    check(cell, found[i], delay);
                    const double ratio =
                        static_cast<double>(found[i].control_points) / points.at(cell.label());
                    if (options.verbose)
                        std::fprintf(stderr, "%s, delay %d: %zu control points, %.3f of libsisl\n",
                                     cell.label().c_str(), delay, found[i].control_points, ratio);
                    Sum& s = sums[cell.coarse ? 1 : 0];
                    s.log_ratio += std::log(ratio);
                    s.worst = std::max(s.worst, ratio);
                    ++s.cells;
                    s.points += found[i].control_points;
                    s.bytes += found[i].bytes;
                    s.breaks += found[i].breaks;
                }
                const double both = std::sqrt(sums[0].ratio() * sums[1].ratio());
                std::fprintf(stderr, "%s, delay %d, price %g: %.3f of libsisl\n",
                             to_string(channel), delay, price, both);
                for (const bool coarse : {false, true}) {
                    const Sum& s = sums[coarse ? 1 : 0];
                    out += text("| %d | %g | %s | %.3f | %.3f | %.3f | %zu | %zu | %zu |\n", delay,
                                price, tolerance_name(channel, coarse).c_str(), s.ratio(), s.worst,
                                both, s.points, s.bytes, s.breaks);
                }
            }
        }
        publish(options, std::string{"knots "} + to_string(channel), out);
    }
}

}  // namespace fairlead::sim::cubics
