#pragma once
// Our reducer through its own program, fairlead-sim: `reduce` for the figures, `decode` for the
// check of every sample in double.
#include <array>
#include <optional>
#include <string>

#include "host_sim/study/bench_peers/subjects.hpp"

namespace fairlead::sim {

struct Ours {
    std::size_t control_points{}, bytes{};
    double error{};                 // largest, decoded, over the tolerance
    std::size_t samples_missing{};  // without a decoded value
    double max_delay{}, mean_delay{};
    // chord lengths over record times, of the samples and off by how much after decoding: root mean
    // squares, m/s or rad/s
    double speed{}, speed_error{};
};

/// A way to run it: the name of its rows, and what `fairlead-sim reduce` is told.
struct Setting {
    const char* name;
    const char* arguments;
    bool earlier;  // its stream has the earlier format
};
constexpr std::array<Setting, 4> settings{{{"narrow", "--beam narrow", false},
                                           {"medium", "--beam medium", false},
                                           {"wide", "--beam wide", false},
                                           {"few knots", "--objective knots --beam medium", true}}};
constexpr std::size_t medium = 1;  // of the settings

struct Program {
    std::string path, folder, extra_arguments;
    /// Empty where the program is absent or refuses; the reason goes to standard error once.
    std::optional<Ours> reduce(const Cell& cell, std::size_t delay, const Setting& setting) const;
};

}  // namespace fairlead::sim
