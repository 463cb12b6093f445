// Which column of several is the clock.
#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/recording/evidence.hpp"
#include "host_sim/recording/settle.hpp"

namespace fairlead::sim {
namespace {

/// Of several columns of time those that hold no clock: no numbers, or numbers that stand still.
void set_dead_times_aside(std::vector<Column>& columns, const Evidence& evidence,
                          std::vector<std::string>& notes) {
    const auto is_time = [](const Column& c) {
        return c.role == Role::time || c.role == Role::time_rest;
    };
    std::vector<std::size_t> dead;
    std::size_t live = 0;
    for (std::size_t i = 0; i < columns.size(); ++i)
        if (is_time(columns[i]))
            typical_step(evidence.columns[i]) > 0 ? void(++live) : dead.push_back(i);
    if (evidence.rows < 2 || live + dead.size() < 2) return;
    const bool seconds = std::any_of(columns.begin(), columns.end(),
                                     [](const Column& c) { return c.role == Role::time_rest; });
    for (const std::size_t i : dead) {
        // the seconds beside nanoseconds stand still in a short file
        if (seconds && std::isfinite(median(evidence.columns[i]))) continue;
        if (live == 0 && i == dead.front()) continue;  // it is told what is wrong with the first
        set_unused(columns[i]);
        notes.push_back("column '" + columns[i].name + "' is not used: it holds no clock");
    }
}

/// Whole seconds and the nanoseconds beside them, as one column of numbers.
Numbers joined_times(const Evidence& evidence, std::size_t seconds, std::size_t rest) {
    Numbers out = evidence.columns[seconds];
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += 1e-9 * evidence.columns[rest][i];
    return out;
}

/// One clock in two units: the steps are a power of a thousand apart.
bool one_clock(const Numbers& a, const Numbers& b) {
    const double ratio = std::log10(typical_step(a) / typical_step(b)) / 3;
    return std::fabs(ratio - std::round(ratio)) < 1e-3;
}

[[noreturn]] void refuse_two_clocks(const Column& a, const Column& b) {
    throw BadData("two columns are times, '" + a.name + "' and '" + b.name +
                  "', and they do not agree; say which one is meant, with - for the other: "
                  "--columns t_ns,-,...");
}

}  // namespace

void settle_times(std::vector<Column>& columns, const Evidence& evidence,
                  std::vector<std::string>& notes) {
    const auto at = [&](Role role) {
        std::vector<std::size_t> out;
        for (std::size_t i = 0; i < columns.size(); ++i)
            if (columns[i].role == role) out.push_back(i);
        return out;
    };
    set_dead_times_aside(columns, evidence, notes);
    const auto rest = at(Role::time_rest);
    auto times = at(Role::time);
    const auto pair = std::find_if(times.begin(), times.end(), [&](std::size_t i) {
        return columns[i].unit && columns[i].unit->name == "s" && evidence.whole[i];
    });
    if (rest.size() == 1 && pair != times.end()) {  // a complete stamp
        const Numbers stamp = joined_times(evidence, *pair, rest[0]);
        for (const std::size_t i : times) {
            if (i == *pair) continue;
            if (!one_clock(evidence.columns[i], stamp))
                refuse_two_clocks(columns[*pair], columns[i]);
            set_unused(columns[i]);
            notes.push_back("times are those of columns '" + columns[*pair].name + "' and '" +
                            columns[rest[0]].name + "'");
        }
        return;
    }
    for (const std::size_t i : rest) columns[i].role = Role::time;
    times = at(Role::time);
    if (times.size() < 2) return;
    for (std::size_t k = 1; k < times.size(); ++k)
        if (!one_clock(evidence.columns[times[0]], evidence.columns[times[k]]))
            refuse_two_clocks(columns[times[0]], columns[times[k]]);
    // the time of the measurement before that of its arrival; then the finer one
    const auto rank = [&](std::size_t i) {
        const std::string& name = columns[i].name;
        const bool measured = name.find("header") != name.npos || name.find("sample") != name.npos;
        const double step = evidence.whole[i] ? typical_step(evidence.columns[i]) : 0;
        return std::pair{measured, step};
    };
    const auto finer = std::max_element(times.begin(), times.end(),
                                        [&](auto a, auto b) { return rank(a) < rank(b); });
    for (const std::size_t i : times)
        if (i != *finer) set_unused(columns[i]);
    notes.push_back("times are those of column '" + columns[*finer].name + "'");
}

}  // namespace fairlead::sim
