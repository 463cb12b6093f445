#pragma once
// All results of one run, and their two forms: JSON and the tables of docs/peers.md.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/study/bench_peers/byte_rivals.hpp"
#include "host_sim/study/bench_peers/knot_rivals.hpp"
#include "host_sim/study/bench_peers/ours.hpp"

namespace fairlead::sim {

constexpr std::size_t bound_count = delays.size() + 1;  // the last: no delay bound, one restart

struct CellResult {
    std::string name;
    Channel channel{};
    bool coarse{}, generated{};
    std::size_t samples{};
    double seconds{};
    std::vector<KnotResult> knots;                      // the yardstick first
    std::optional<std::size_t> least;                   // control points proved necessary
    std::array<std::vector<Tried>, bound_count> bytes;  // best setting of every rival
    std::array<std::array<std::optional<Ours>, delays.size()>, settings.size()> ours;
};

std::string to_json(const std::vector<CellResult>& results);
std::string to_markdown(const std::vector<CellResult>& results);

/// `page` with the text between its two table markers replaced.
std::string with_tables(const std::string& page, const std::string& tables);

/// Geometric mean and largest of some cells.
struct Ratio {
    double mean{}, worst{};
    std::size_t count{};
};

}  // namespace fairlead::sim
