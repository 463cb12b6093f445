#pragma once
// Both channels of a recording in one stream, whose frames they share, beside the rivals.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/study/bench_peers/report.hpp"

namespace fairlead::sim {

struct SixDofResult {
    std::string name;
    bool coarse{}, generated{};
    std::array<std::size_t, delays.size()> rivals{};  // bytes
    std::array<std::array<std::optional<Ours>, delays.size()>, settings.size()> ours;
};

/// Pairs the channels of each recording, of the same records and both at the fine or both at the
/// coarse tolerance. The rivals have the best of each channel, less 3 bytes for each frame that
/// the delay bound demands of both: such frames can be shared.
class SixDof {
  public:
    explicit SixDof(const Program& program) : program_{program} {}
    /// Cells in the order of for_each_cell(), with what was measured.
    void add(const Cell& cell, const CellResult& result);
    const std::vector<SixDofResult>& results() const { return results_; }

  private:
    struct Measured {
        Cell cell;
        CellResult result;
    };
    Program program_;
    std::array<std::optional<Measured>, 2> position_;  // at the fine and the coarse tolerance
    std::vector<SixDofResult> results_;
};

std::string to_markdown(const std::vector<SixDofResult>& results);

}  // namespace fairlead::sim
