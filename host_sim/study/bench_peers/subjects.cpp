#include "host_sim/study/bench_peers/subjects.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "host_sim/generate/generate.hpp"
#include "host_sim/recording/writers.hpp"

namespace fairlead::sim {
namespace {

struct Generated {
    const char* name;
    const char* spec;
};
constexpr std::uint64_t seed = 4;
constexpr Generated generated[] = {
    {"generated_jumps",  // quick reaches with short stops
     "model:optical+rest:1+reach:0.35:30:0.6:1.5+rest:1+reach:0.6:30:0.4:1+rest:1+reach:0.25:40"},
    {"generated_rests",  // long rests, few motions
     "model:optical+rest:12+reach:1.5+rest:15+reach:0.8:2+rest:10+turn:1.2:4+rest:15"},
    {"generated_teleports",  // the pose jumps between two records
     "model:optical+oscillate:6:0.4+jump+oscillate:5:0.7+jump+rest:4+jump:1:2+reach:1:5+jump+"
     "oscillate:6:0.3+jump:0.05:0.1+rest:3+jump+reach:0.7:8+jump:2:3+oscillate:6:1+jump+rest:5+"
     "jump+oscillate:6:0.5"},
};

constexpr double degree = 3.14159265358979323846 / 180;

void visit_channels(const Recording& recording, bool is_generated, const std::string& cut_folder,
                    const std::function<void(const Cell&)>& visit) {
    for (const Channel channel : {Channel::position, Channel::orientation}) {
        Cell cell;
        cell.track = longest_run(recording, channel);
        cell.generated = is_generated;
        write_bytes(cut_folder + "/" + cell.file_name(), to_trk(cut(recording, channel)));
        for (const bool coarse : {false, true}) {
            cell.coarse = coarse;
            cell.tolerance = tolerance_of(channel, coarse);
            visit(cell);
        }
    }
}

}  // namespace

std::string tolerance_name(Channel channel, bool coarse) {
    if (channel == Channel::position) return coarse ? "5 mm" : "1 mm";
    return coarse ? "1 deg" : "0.25 deg";
}

double tolerance_of(Channel channel, bool coarse) {
    if (channel == Channel::position) return coarse ? 0.005 : 0.001;
    return (coarse ? 1.0 : 0.25) * degree;
}

std::string Cell::label() const {
    return track.name + " " + to_string(track.channel) + " " +
           tolerance_name(track.channel, coarse);
}

std::string Cell::file_name() const { return track.name + "." + to_string(track.channel) + ".trk"; }

void for_each_cell(const std::string& folder, const std::string& cut_folder,
                   const std::string& only, const std::function<void(const Cell&)>& visit) {
    std::filesystem::create_directories(cut_folder);
    std::vector<std::string> paths;
    if (std::filesystem::is_directory(folder)) {
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            if (entry.path().extension() == ".trk") paths.push_back(entry.path().string());
    } else {
        std::fprintf(stderr, "skipped the recordings: no folder %s\n", folder.c_str());
    }
    std::sort(paths.begin(), paths.end());
    const auto wanted = [&](const std::string& name) {
        return name.find(only) != std::string::npos;
    };
    for (const std::string& path : paths) {
        if (!wanted(stem_of(path))) continue;
        Recording recording = read_recording(path);
        recording.name = stem_of(path);
        visit_channels(recording, false, cut_folder, visit);
    }
    for (const Generated& item : generated) {
        if (!wanted(item.name)) continue;
        Recording recording = generate(item.spec, seed);
        recording.name = item.name;
        visit_channels(recording, true, cut_folder, visit);
    }
}

}  // namespace fairlead::sim
