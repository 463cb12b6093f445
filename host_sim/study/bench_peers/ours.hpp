#pragma once
// Our reducer through its own program, fairlead-sim: `reduce` for the figures, `decode` for the
// check of every sample in double.
#include <array>
#include <optional>
#include <string>
#include <vector>

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
    /// The decoded values at the records of the cell, as in its track; NaN where there is none.
    std::optional<std::vector<double>> values(const Cell& cell, std::size_t delay,
                                              const Setting& setting) const;
    /// Both channels of a recording in one stream; of the same records.
    std::optional<Ours> reduce_both(const Cell& position, const Cell& orientation,
                                    std::size_t delay, const Setting& setting) const;

  private:
    struct Tolerances {
        double position_m{}, orientation_rad{};
    };
    std::string stream() const { return folder + "/ours.flr"; }
    /// Writes the stream of a recording. @return what --json says
    std::optional<std::string> stream_of(const std::string& in, const Tolerances& tolerances,
                                         std::size_t delay, const std::string& channels,
                                         const Setting& setting) const;
    /// Reduces a cell to stream(). @return what --json says
    std::optional<std::string> reduced(const Cell& cell, std::size_t delay,
                                       const Setting& setting) const;
    /// The stream at the times of the recording, as CSV.
    std::optional<std::string> decoded(const std::string& in, const Setting& setting) const;
};

}  // namespace fairlead::sim
