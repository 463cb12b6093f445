#pragma once
// What the tables of docs/cubics.md are made of: the recordings in two halves, each coded with the
// symbol costs that were trained on the other one.
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/study/bench_cubics/stream.hpp"
#include "host_sim/study/bench_peers/subjects.hpp"

namespace fairlead::sim::cubics {

/// Options of all tables. `change` holds what the command line says of the search: it is applied to
/// the usual parameters of a channel.
struct Options {
    std::string recordings{"../shared/recordings/tracker120"};
    std::string folder{"build/peers"};  // kept results of the rivals, cut recordings
    std::string program{"build/fairlead-sim"};
    std::string page;  // whose tables are replaced; empty: none
    std::string plot;  // of a motion and what the kinds make of it; empty: none
    std::string only;  // part of the names of the recordings, empty: all
    std::string control_points{"host_sim/study/bench_peers/control_points.csv"};  // of libsisl
    std::vector<std::int32_t> delays{60, 120, 240};
    std::vector<double> prices{20};  // of a piece, where few control points are wanted
    std::vector<std::string> channels{"position", "orientation"};
    int passes{4};
    bool rivals{true}, verbose{};
    struct Change {
        double step{-1}, break_bits{-1}, chart_rad{-1}, control_weight{-1}, vertex_weight{-1},
            commit{-1}, margin_bits{-1};
        int width{-1}, values{-1}, look_ahead{-1}, look{-1}, restart{-1}, repeats{-1};
        void apply(StreamParams& params) const;
    } change;
    bool has(Channel channel) const;
};

/// Symbol costs for each half.
using BothCosts = std::array<Costs, 2>;

/// The cells of a channel of the recordings, by halves: two cells a recording, and recordings take
/// turns.
class Halves {
  public:
    Halves(const Options& options, Channel channel);
    const std::vector<Cell>& cells() const { return cells_; }
    /// Costs for each half, trained on the other one, at a delay of 120.
    BothCosts trained(const StreamParams& params, int passes) const;
    /// Costs trained on all cells.
    Costs trained_on_all(const StreamParams& params, int passes) const;
    /// The result of each cell, in order; both halves at the same time.
    std::vector<Result> run(const StreamParams& params, const BothCosts& costs) const;

  private:
    std::array<std::vector<const Cell*>, 2> half_;
    std::vector<Cell> cells_;
};

/// What the tables share, computed where it is first asked for.
class Study {
  public:
    explicit Study(Options options) : options_{std::move(options)} {}
    const Options& options() const { return options_; }
    const Halves& halves(Channel channel);
    StreamParams params(Channel channel) const;
    const BothCosts& costs(Channel channel);
    Costs costs_of_all(Channel channel);
    /// Of the search for bytes.
    const std::vector<Result>& results(Channel channel, std::int32_t delay);

  private:
    struct Part {
        std::optional<Halves> halves;
        std::optional<BothCosts> costs;
        std::map<std::int32_t, std::vector<Result>> results;
    };
    Part& part(Channel channel) { return parts_[channel == Channel::position ? 0 : 1]; }
    Options options_;
    std::array<Part, 2> parts_;
};

/// Fails with a sentence where a reader differs or a sample is outside.
void check(const Cell& cell, const Result& result, std::int32_t delay);

/// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string text(const char* pattern, ...);
/// Prints a table, and puts it between the marks of its name where there is a page.
void publish(const Options& options, const std::string& name, const std::string& table);

/// The tables.
void bytes_table(Study& study);
void motion_table(Study& study);
void knots_table(Study& study);

}  // namespace fairlead::sim::cubics
