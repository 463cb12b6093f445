#pragma once
// Options that several subcommands share.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "host_sim/stream.hpp"

namespace fairlead::sim {

/// IN and --salvage.
struct InputOptions {
    std::string path;
    bool salvage{false};

    void add_to(CLI::App& command, const std::string& name = "IN") {
        command.add_option(name, path, "Recording: .imu, .trk, EuRoC IMU CSV, pose CSV or TUM")
            ->required()
            ->check(CLI::ExistingFile);
        command.add_flag("--salvage", salvage,
                         "Use the complete records before the damage of a bad file");
    }

    Recording read() const {
        Recording recording = read_recording(path, salvage ? Salvage::yes : Salvage::no);
        if (!recording.damage.empty())
            std::fprintf(stderr, "fairlead-sim: %s; %zu records before it are used\n",
                         recording.damage.c_str(), recording.size());
        if (!recording.note.empty())
            std::fprintf(stderr, "fairlead-sim: %s: %s\n", path.c_str(), recording.note.c_str());
        return recording;
    }
};

}  // namespace fairlead::sim
