// Hours of looped data through one pipeline, judged from the bytes: every accepted record is
// covered in time and within tolerance, and nothing grows or drifts as the hours pass.
//
//     build/pipeline-soak [--hours 24] [--seed 1] [RECORDING...]
//
// Tracker recordings are played again and again on one clock, with the place where one follows the
// other as a jump; without recordings, generated ones. Prints a line for each hour of data.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "host_sim/generate/generate.hpp"
#include "host_sim/recording/recording.hpp"
#include "tests/pipeline/pipeline_check.hpp"

namespace {

using namespace fairlead;

struct Board {
    using Input = Pose;
    using Channels = fairlead::Channels<Position, Orientation>;
    using Filter = NoFilter;
    static constexpr std::size_t delay_records_max = 120;
    static constexpr Beam beam = Beam::medium;
    static constexpr std::size_t events_max = 0;
};
using Check = test::PipelineCheck<Board>;

const char* const motions[] = {
    "model:optical+rest:20+reach:0.9:12+oscillate:60:1.5+gap:0.4+reach:0.7:8+turn:10:3+rest:30",
    "model:optical+reach:1.4:5+oscillate:90:4+rest:5+turn:30:6+gap:3+reach:0.8:8+rest:60",
};

std::vector<sim::Recording> read_all(const std::vector<std::string>& paths, std::uint64_t seed) {
    std::vector<sim::Recording> out;
    for (const std::string& path : paths) {
        out.push_back(sim::read_recording(path));
        if (out.back().poses.size() < 2) throw sim::BadData{path + ": holds no poses"};
    }
    if (paths.empty())
        for (const char* motion : motions) out.push_back(sim::generate(motion, seed++));
    return out;
}

void print(double hours, const test::Verdict& v, std::clock_t begin) {
    const auto n = [](std::uint64_t count) { return static_cast<unsigned long long>(count); };
    std::printf(
        "%6.2f h: %llu records, %llu accepted, %llu values in %llu runs: %llu outside, %llu late, "
        "%llu uncovered, %llu damaged; %llu bytes, largest error %.4f of the tolerance; %.0f s\n",
        hours, n(v.pushed), n(v.accepted), n(v.values), n(v.runs), n(v.violations), n(v.late),
        n(v.uncovered), n(v.damaged + v.unknown + v.overflows), n(v.bytes), v.worst,
        static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    std::fflush(stdout);
}

int soak(double hours, const std::vector<sim::Recording>& recordings) {
    Check::Params params;
    params.sample_period_ns = std::llround(recordings.front().period_s * 1e9);
    Check check{params};
    if (const auto fault = check.chain().check(); !fault) {
        std::printf("FAIL soak: %s\n", fault.field);
        return 1;
    }
    const std::clock_t begin = std::clock();
    const std::int64_t start_ns = 1'700'000'000'000'000'000;
    const auto length_ns = static_cast<std::int64_t>(hours * 3.6e12);
    std::int64_t told_ns = 3'600'000'000'000;
    std::int64_t t = start_ns;  // of the first record of this turn
    for (std::size_t turn = 0; t - start_ns < length_ns; ++turn) {
        const sim::Recording& r = recordings[turn % recordings.size()];
        for (Pose pose : r.poses) {
            pose.t_ns = t + (pose.t_ns - r.poses.front().t_ns);
            if (pose.t_ns - start_ns >= length_ns) break;
            check.push(pose);
            if (pose.t_ns - start_ns < told_ns) continue;
            print(static_cast<double>(told_ns) / 3.6e12, check.verdict(), begin);
            told_ns += 3'600'000'000'000;
        }
        t += r.poses.back().t_ns - r.poses.front().t_ns + params.sample_period_ns;
        if (!check.verdict().good()) break;
    }
    check.finish();
    const test::Verdict& v = check.verdict();
    print(static_cast<double>(std::min(t - start_ns, length_ns)) / 3.6e12, v, begin);
    if (!v.good()) return std::printf("FAIL soak: %s\n", v.first.c_str()), 1;
    std::printf("ok soak\n");
    return 0;
}

}  // namespace

int main(int argc, char** argv) try {
    double hours = 24;
    std::uint64_t seed = 1;
    std::vector<std::string> paths;
    for (int i = 1; i < argc; ++i) {
        const std::string arg = argv[i];
        if (arg == "--hours" && i + 1 < argc)
            hours = std::stod(argv[++i]);
        else if (arg == "--seed" && i + 1 < argc)
            seed = std::stoull(argv[++i]);
        else if (arg.rfind("--", 0) == 0)
            return std::fprintf(stderr, "unknown option %s\n", arg.c_str()), 2;
        else
            paths.push_back(arg);
    }
    if (!(hours > 0 && hours <= 1e4)) return std::fprintf(stderr, "--hours: 0 to 10000\n"), 2;
    return soak(hours, read_all(paths, seed));
} catch (const std::exception& e) {
    std::fprintf(stderr, "pipeline-soak: %s\n", e.what());
    return 1;
}
