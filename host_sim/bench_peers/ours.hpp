#pragma once
// Our reducer through its own program, fairlead-sim: `reduce` for the figures, `decode` for the
// check of every sample in double.
#include <array>
#include <optional>
#include <string>

#include "host_sim/bench_peers/subjects.hpp"

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

/// Work on the search, as `fairlead-sim reduce --slice` names it.
constexpr std::array<const char*, 3> slices{"small", "medium", "large"};

struct Program {
    std::string path, folder, extra_arguments;
    /// Empty where the program is absent or refuses; the reason goes to standard error once.
    std::optional<Ours> reduce(const Cell& cell, std::size_t delay, const char* slice) const;
};

}  // namespace fairlead::sim
