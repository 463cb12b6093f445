#include "host_sim/recording/stamps.hpp"

#include <cmath>

#include "host_sim/recording/calendar.hpp"
#include "host_sim/recording/decimal.hpp"
#include "host_sim/recording/encoding.hpp"
#include "host_sim/recording/evidence.hpp"
#include "host_sim/recording/lines.hpp"
#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {
namespace {

/// The part "t=UNIT" of --units; empty: not given.
std::string given_unit(const std::string& units) {
    for (const std::string& item : split(units, ','))
        if (item.substr(0, 2) == "t=") return item.substr(2);
    return {};
}

std::vector<std::int64_t> times_of(const ReadOptions& options, std::vector<std::string>& notes) {
    const std::string bytes = read_bytes(options.times);
    std::string storage;
    std::vector<std::string> ignored;
    std::string decimal_storage;
    std::size_t dates = std::string_view::npos;
    LineReader reader{
        with_decimal_times(as_utf8(bytes, storage, ignored), decimal_storage, dates, notes)};
    Line line;
    std::vector<Line> lines;
    Numbers numbers;
    while (reader.next(line)) {
        if (line.comment) continue;
        const auto value = real64(line.text);
        if (!value && numbers.empty()) continue;  // a header
        if (!value)
            throw BadData(options.times + ": line " + std::to_string(line.number) + ": '" +
                          std::string(line.text.substr(0, 40)) +
                          "' is not a time; the file holds one time a line");
        lines.push_back(line);
        numbers.push_back(*value);
    }
    const std::string name = dates != std::string_view::npos ? "s" : given_unit(options.units);
    std::string rates;
    const auto unit =
        name.empty() ? time_unit(numbers, pose_rates, rates) : unit_of(Quantity::time, name);
    if (!unit)
        throw BadData(options.times + ": the unit of the times is not told by their rate (" +
                      rates + "); say it: --units t=s");
    if (name.empty()) notes.push_back("times of " + options.times + " are taken as " + unit->name);
    std::vector<std::int64_t> out;
    for (const Line& l : lines) {
        const auto t_ns = scaled_integer(l.text, unit->time_shift);
        if (!t_ns)
            throw BadData(options.times + ": line " + std::to_string(l.number) +
                          ": not a time within 292 years of zero");
        out.push_back(*t_ns);
    }
    return out;
}

void set_time(Recording& recording, std::size_t i, std::int64_t t_ns) {
    if (i < recording.poses.size()) recording.poses[i].t_ns = t_ns;
    if (i < recording.samples.size()) recording.samples[i].t_ns = t_ns;
    if (i < recording.truth.size()) recording.truth[i].t_ns = t_ns;
}

}  // namespace

void give_times(const ReadOptions& options, Recording& recording) {
    if (!options.times.empty()) {
        const auto times = times_of(options, recording.notes);
        if (times.size() < recording.size())
            throw BadData(options.times + ": " + std::to_string(times.size()) + " times for " +
                          std::to_string(recording.size()) + " records");
        if (times.size() > recording.size())
            recording.notes.push_back(options.times + " holds " + std::to_string(times.size()) +
                                      " times for " + std::to_string(recording.size()) +
                                      " records; the first ones are used");
        for (std::size_t i = 0; i < recording.size(); ++i) set_time(recording, i, times[i]);
        return;
    }
    const double step_ns = 1e9 / options.rate_hz;
    if (!(static_cast<double>(recording.size()) * step_ns < 9e18))
        throw BadData("at this rate the records last longer than 292 years");
    for (std::size_t i = 0; i < recording.size(); ++i)
        set_time(recording, i, std::llround(static_cast<double>(i) * step_ns));
    recording.period_s = 1 / options.rate_hz;
    recording.notes.emplace_back("times are made from --rate, from 0 on");
}

}  // namespace fairlead::sim
