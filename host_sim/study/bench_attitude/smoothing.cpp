#include "host_sim/study/bench_attitude/smoothing.hpp"

#include <array>
#include <cstdio>

#include "fairlead/sense/attitude_lag.hpp"
#include "fairlead/sense/intake.hpp"
#include "host_sim/replay/attitude_run.hpp"
#include "host_sim/replay/attitude_smooth.hpp"
#include "host_sim/study/bench_attitude/foreign.hpp"

namespace fairlead::sim {
namespace {

template <std::size_t N>
std::vector<Pose> lagged(const Recording& recording) {
    Intake<Sample> intake;
    LaggedAttitude<N> filter;
    std::vector<Pose> out;
    for (const Sample& raw : recording.samples)
        if (const auto sample = intake.push(raw))
            if (const auto pose = filter.push(*sample)) out.push_back(*pose);
    while (const auto pose = filter.flush()) out.push_back(*pose);
    return out;
}

struct Sum {
    double total{}, inclination{};
};

}  // namespace

std::string smoothing_table(const std::string& folder) {
    constexpr std::size_t ways = 6;
    const std::array<const char*, ways> names{"causal",  "lag 50 samples", "lag 143",
                                              "lag 286", "lag 572",        "whole recording"};
    std::string out = "| recordings |";
    for (const char* name : names) out += std::string(" ") + name + " |";
    out += "\n|---|---|---|---|---|---|---|\n";
    const auto row = [&](const std::string& name, const std::vector<Recording>& recordings,
                         double from_s) {
        std::array<Sum, ways> sums{};
        for (const Recording& r : recordings) {
            const std::array<std::vector<Pose>, ways> estimates{
                run_attitude(r, AttitudeMode::imu_mag),
                lagged<50>(r),
                lagged<143>(r),
                lagged<286>(r),
                lagged<572>(r),
                smooth_attitude(r, AttitudeMode::imu_mag)};
            for (std::size_t k = 0; k < ways; ++k) {
                const auto& e = estimates[k];
                const Score s = from_s > 0 ? score(r, aligned(r, e, Align::heading, from_s), from_s)
                                           : score(r, e);
                sums[k].total += s.total_deg / static_cast<double>(recordings.size());
                sums[k].inclination += s.inclination_deg / static_cast<double>(recordings.size());
            }
        }
        out += "| " + name + " |";
        for (const Sum& s : sums) {
            std::array<char, 48> cell{};
            std::snprintf(cell.data(), cell.size(), " %.2f/%.2f |", s.total, s.inclination);
            out += cell.data();
        }
        out += "\n";
    };
    const auto own = read_imu_folder(folder);
    if (own.empty()) return {};
    row("the " + std::to_string(own.size()) + " above (286 Hz)", own, 0);
    for (const Recording& r : read_imu_folder(folder + "/foreign"))
        if (all_sensors(r) == AttitudeMode::imu_mag) row(r.name, {r}, 5);
    return out;
}

}  // namespace fairlead::sim
