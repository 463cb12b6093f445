#include "host_sim/study/bench_cubics/measure.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <future>
#include <stdexcept>

#include "host_sim/recording/writers.hpp"

namespace fairlead::sim::cubics {
namespace {

using Half = std::vector<const Cell*>;

Costs trained_on(const Half& half, StreamParams params, int passes) {
    params.delay = 120;
    Costs costs = train({});
    for (int pass = 0; pass < passes; ++pass) {
        Counts counts;
        for (const Cell* cell : half) run(cell->track, cell->tolerance, params, costs, counts);
        costs = train(counts);
    }
    return costs;
}

std::vector<Result> results(const Half& half, const Costs& costs, const StreamParams& params) {
    std::vector<Result> all;
    for (const Cell* cell : half) {
        Counts counts;
        all.push_back(run(cell->track, cell->tolerance, params, costs, counts));
    }
    return all;
}

}  // namespace

void Options::Change::apply(StreamParams& params) const {
    if (step >= 0) params.step = step;
    if (commit >= 0) params.commit = commit;
    if (restart >= 0) params.restart = restart;
    if (look_ahead >= 0) params.look_ahead = look_ahead;
    SearchParams& search = params.search;
    if (break_bits >= 0) search.break_bits = break_bits;
    if (chart_rad >= 0) search.chart_rad = static_cast<float>(chart_rad);
    if (control_weight >= 0) search.control_weight = control_weight;
    if (vertex_weight >= 0) search.vertex_weight = vertex_weight;
    if (width >= 0) search.width = static_cast<std::size_t>(width);
    if (values >= 0) search.values = static_cast<std::size_t>(values);
    if (margin_bits >= 0) search.margin_bits = margin_bits;
    if (repeats >= 0) search.repeats = repeats;
    if (look >= 0) search.look = look;
}

bool Options::has(Channel channel) const {
    return std::find(channels.begin(), channels.end(), to_string(channel)) != channels.end();
}

Halves::Halves(const Options& options, Channel channel) {
    for_each_cell(options.recordings, options.folder + "/cut", options.only, [&](const Cell& cell) {
        if (cell.track.channel == channel && !cell.generated) cells_.push_back(cell);
    });
    for (std::size_t i = 0; i < cells_.size(); ++i) half_[i / 2 % 2].push_back(&cells_[i]);
}

BothCosts Halves::trained(const StreamParams& params, int passes) const {
    auto other =
        std::async(std::launch::async, [&] { return trained_on(half_[0], params, passes); });
    BothCosts costs;
    costs[0] = trained_on(half_[1], params, passes);
    costs[1] = other.get();
    return costs;
}

Costs Halves::trained_on_all(const StreamParams& params, int passes) const {
    Half all;
    for (const Cell& cell : cells_) all.push_back(&cell);
    return trained_on(all, params, passes);
}

std::vector<Result> Halves::run(const StreamParams& params, const BothCosts& costs) const {
    auto other =
        std::async(std::launch::async, [&] { return results(half_[1], costs[1], params); });
    std::array<std::vector<Result>, 2> found{results(half_[0], costs[0], params), other.get()};
    std::vector<Result> all;
    std::array<std::size_t, 2> next{};
    for (std::size_t i = 0; i < cells_.size(); ++i)
        all.push_back(std::move(found[i / 2 % 2][next[i / 2 % 2]++]));
    return all;
}

const Halves& Study::halves(Channel channel) {
    auto& halves = part(channel).halves;
    if (!halves) halves.emplace(options_, channel);
    return *halves;
}

StreamParams Study::params(Channel channel) const {
    StreamParams params = usual_params(channel);
    options_.change.apply(params);
    return params;
}

const BothCosts& Study::costs(Channel channel) {
    auto& costs = part(channel).costs;
    if (!costs) costs = halves(channel).trained(params(channel), options_.passes);
    return *costs;
}

Costs Study::costs_of_all(Channel channel) {
    return halves(channel).trained_on_all(params(channel), options_.passes);
}

const std::vector<Result>& Study::results(Channel channel, std::int32_t delay) {
    auto& kept = part(channel).results;
    const auto at = kept.find(delay);
    if (at != kept.end()) return at->second;
    StreamParams usual = params(channel);
    usual.delay = delay;
    return kept[delay] = halves(channel).run(usual, costs(channel));
}

void check(const Cell& cell, const Result& result, std::int32_t delay) {
    if (result.fault.empty() && result.error <= 1) return;
    throw std::runtime_error(text("%s, delay %d: %s, error %.6f of the tolerance",
                                  cell.label().c_str(), delay, result.fault.c_str(), result.error));
}

std::string text(const char* pattern, ...) {
    char out[512];
    va_list values;
    va_start(values, pattern);
    std::vsnprintf(out, sizeof out, pattern, values);
    va_end(values);
    return out;
}

void publish(const Options& options, const std::string& name, const std::string& table) {
    std::printf("%s\n", table.c_str());
    if (options.page.empty()) return;
    std::string page = read_bytes(options.page);
    const std::string begin = "<!-- bench-cubics " + name + " -->\n", end = "<!-- end -->";
    const std::size_t a = page.find(begin);
    const std::size_t b = a == std::string::npos ? a : page.find(end, a);
    if (b == std::string::npos)
        throw std::runtime_error(options.page + " has no place for the table " + name);
    page.replace(a + begin.size(), b - a - begin.size(), table);
    write_bytes(options.page, page);
}

}  // namespace fairlead::sim::cubics
