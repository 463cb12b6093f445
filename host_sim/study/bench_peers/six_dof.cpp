#include "host_sim/study/bench_peers/six_dof.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_sim/study/baselines/compress/coder.hpp"
#include "host_sim/study/baselines/compress/rice.hpp"

namespace fairlead::sim {
namespace {

/// Frames that a track needs at least: groups in parts that keep the delay.
std::size_t frames_of(const Track& track, std::size_t delay) {
    const Schedule schedule{track, delay};
    std::size_t count = 0;
    for (std::size_t i = 0; i < track.size(); i = schedule.end(i, track.size())) ++count;
    return count;
}

std::size_t best_of(const CellResult& result, std::size_t bound) {
    const auto& all = result.bytes[bound];
    return std::min_element(all.begin(), all.end(),
                            [](const Tried& a, const Tried& b) { return a.bytes < b.bytes; })
        ->bytes;
}

}  // namespace

void SixDof::add(const Cell& cell, const CellResult& result) {
    if (cell.track.channel == Channel::position) {
        position_[cell.coarse ? 1 : 0] = Measured{cell, result};
        return;
    }
    const auto& position = position_[cell.coarse ? 1 : 0];
    if (!position || position->cell.track.name != cell.track.name ||
        position->cell.track.t != cell.track.t)
        return;
    SixDofResult both;
    both.name = cell.track.name;
    both.coarse = cell.coarse;
    both.generated = cell.generated;
    for (std::size_t d = 0; d < delays.size(); ++d) {
        if (position->result.bytes[d].empty() || result.bytes[d].empty()) return;
        both.rivals[d] = best_of(position->result, d) + best_of(result, d) -
                         frame_overhead * frames_of(cell.track, delays[d]);
        for (std::size_t s = 0; s < settings.size(); ++s)
            if (!settings[s].earlier)
                both.ours[s][d] =
                    program_.reduce_both(position->cell, cell, delays[d], settings[s]);
    }
    results_.push_back(both);
}

std::string to_markdown(const std::vector<SixDofResult>& results) {
    if (results.empty()) return {};
    std::string out =
        "### Recordings: 6-DOF streams\n\n"
        "| fairlead's bytes / best rivals sharing frames | 1 mm, 0.25 deg | 5 mm, 1 deg | both | "
        "largest error / tolerance |\n|---|---|---|---|---|\n";
    for (std::size_t s = 0; s < settings.size(); ++s) {
        if (settings[s].earlier) continue;
        for (std::size_t d = 0; d < delays.size(); ++d) {
            std::array<Ratio, 3> ratios;  // fine, coarse, both
            double error = 0;
            for (const SixDofResult& r : results) {
                if (r.generated || !r.ours[s][d]) continue;
                const double ratio =
                    static_cast<double>(r.ours[s][d]->bytes) / static_cast<double>(r.rivals[d]);
                error = std::max(error, r.ours[s][d]->error);
                for (const std::size_t column : {r.coarse ? std::size_t{1} : 0, std::size_t{2}}) {
                    ratios[column].mean += std::log(ratio);
                    ratios[column].worst = std::max(ratios[column].worst, ratio);
                    ++ratios[column].count;
                }
            }
            char line[160];
            std::snprintf(line, sizeof line, "| %s, delay %zu |", settings[s].name, delays[d]);
            out += line;
            for (const Ratio& r : ratios) {
                std::snprintf(line, sizeof line, " %.2f (%.2f) |",
                              r.count > 0 ? std::exp(r.mean / static_cast<double>(r.count)) : 0.0,
                              r.worst);
                out += line;
            }
            std::snprintf(line, sizeof line, " %.4f |\n", error);
            out += line;
        }
    }
    return out + '\n';
}

}  // namespace fairlead::sim
