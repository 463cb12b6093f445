// fairlead-sim decode STREAM.flr --at IN --out OUT.csv: the curve at the times of a recording; and
// the stream's discrete events, --events EVENTS.csv.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>

#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"
#include "host_sim/recording/event_file.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/recording/spec.hpp"
#include "host_sim/recording/writers.hpp"
#include "host_sim/replay/curve_store.hpp"
#include "host_sim/study/baselines/earlier/curve_store.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    std::string stream, at, out, events;
    ReadOptions reading;
    std::size_t run{0};  // from 1; 0: not said
    bool salvage{false}, earlier{false};
};

std::string span_text(std::int64_t from_ns, std::int64_t to_ns) {
    char text[96];
    std::snprintf(text, sizeof text, "from %.3f s to %.3f s", static_cast<double>(from_ns) * 1e-9,
                  static_cast<double>(to_ns) * 1e-9);
    return text;
}

CurvePoint point_of(const CurveRun& run, std::int64_t t_ns) { return run.point_at(t_ns); }
CurvePoint point_of(const earlier::CurveRun& run, std::int64_t t_ns) {
    return CurvePoint::of(run.at(t_ns));
}

/// The curve at a time, of the run that covers it. Several cover it: only the user knows.
template <class Store>
CurvePoint point_at(const Store& store, std::int64_t t_ns, const Options& options) {
    const auto& runs = store.runs();
    if (options.run > 0) return point_of(runs[options.run - 1], t_ns);
    CurvePoint found;
    for (const auto& run : runs) {
        if (run.empty() || t_ns < run.begin_ns() || t_ns > run.end_ns()) continue;
        const CurvePoint point = point_of(run, t_ns);
        if (point.flags == 0) continue;
        if (found.flags != 0)
            throw BadData(options.stream + ": several runs of the board's clock cover " +
                          std::to_string(t_ns) + " ns; choose one: --run 1 to " +
                          std::to_string(runs.size()));
        found = point;
    }
    return found;
}

/// In double: what the guarantee speaks of.
std::string point_row(std::int64_t t_ns, const CurvePoint& point) {
    char p[96] = ",,,", q[128] = ",,,,";
    if ((point.flags & flag::position_valid) != 0)
        std::snprintf(p, sizeof p, ",%.15g,%.15g,%.15g", point.p_m.x, point.p_m.y, point.p_m.z);
    if ((point.flags & flag::orientation_valid) != 0)
        std::snprintf(q, sizeof q, ",%.12g,%.12g,%.12g,%.12g", point.q.w, point.q.x, point.q.y,
                      point.q.z);
    return std::to_string(t_ns) + p + q + "\n";
}

/// Says where the stream does not cover the times; none at all is an error.
template <class Store>
void judge_cover(const Store& store, const Recording& times, std::size_t covered,
                 const Options& options) {
    if (covered == times.size()) return;
    std::int64_t first = times.t_ns(0), last = times.t_ns(0);
    for (std::size_t i = 0; i < times.size(); ++i) {
        first = std::min(first, times.t_ns(i));
        last = std::max(last, times.t_ns(i));
    }
    std::string text = std::to_string(times.size() - covered) + " of " +
                       std::to_string(times.size()) + " times have no curve: " + options.at +
                       " is " + span_text(first, last) + ", the stream";
    for (const auto& run : store.runs())
        text += run.empty() ? " holds no curve"
                            : (&run == &store.runs()[0] ? " " : ", ") +
                                  span_text(run.begin_ns(), run.end_ns());
    if (covered == 0) throw BadData(options.stream + ": " + text);
    std::fprintf(stderr, "fairlead-sim: %s: %s\n", options.stream.c_str(), text.c_str());
}

template <class Store>
void write_curve(const Store& store, const Options& options) {
    ReadOptions reading = options.reading;
    reading.salvage = options.salvage ? Salvage::yes : Salvage::no;
    reading.progress = progress_steps("read", "bytes");
    const Recording times = read_recording(options.at, reading);
    reading.progress = {};
    if (options.run > store.runs().size())
        throw BadSpec("--run " + std::to_string(options.run) + ": the stream holds " +
                      std::to_string(store.runs().size()));
    std::string csv = "t_ns,px,py,pz,qw,qx,qy,qz\n";
    std::size_t covered = 0;
    Progress progress{"evaluate", times.size(), "times"};
    for (std::size_t i = 0; i < times.size(); ++i) {
        progress.show(i);
        const CurvePoint point = point_at(store, times.t_ns(i), options);
        csv += point_row(times.t_ns(i), point);
        if (point.flags != 0) ++covered;
    }
    write_bytes(options.out, csv);
    judge_cover(store, times, covered, options);
}

template <class Store>
void decode(const Options& options) {
    Store store;
    const std::string bytes = read_bytes(options.stream);
    Progress progress{"decode", bytes.size(), "bytes"};
    constexpr std::size_t portion = 4096;
    for (std::size_t i = 0; i < bytes.size(); i += portion) {
        progress.show(i);
        store.push(std::string_view(bytes).substr(i, portion));
    }
    store.finish();
    const std::string damage = store.damage();
    if (store.empty()) throw BadData(options.stream + ": " + damage);
    if (!options.events.empty()) write_bytes(options.events, to_events_csv(store.events()));
    if (!damage.empty() && options.salvage)
        std::fprintf(stderr, "fairlead-sim: %s: %s\n", options.stream.c_str(), damage.c_str());
    if (!options.out.empty()) write_curve(store, options);
    // what could be decoded is written all the same: decoding went on at the next good frame
    if (!damage.empty() && !options.salvage) throw BadData(options.stream + ": " + damage);
}

void run(const Options& options) {
    if (options.out.empty() && options.events.empty())
        throw BadSpec("decode needs --at and --out for the curve, or --events for the events");
    options.earlier ? decode<earlier::CurveStore>(options) : decode<CurveStore>(options);
}

}  // namespace

void add_decode(CLI::App& app) {
    auto* command = app.add_subcommand(
        "decode", "Evaluate a stream at the times of a recording; empty fields: no curve there");
    auto options = std::make_shared<Options>();
    command->add_option("STREAM", options->stream, "Stream, .flr")
        ->required()
        ->check(CLI::ExistingFile);
    auto* at = command->add_option("--at", options->at, "Recording whose times are wanted")
                   ->check(CLI::ExistingFile);
    auto* out = command->add_option("--out", options->out, "Pose CSV to write")->needs(at);
    at->needs(out);
    command->add_option("--events", options->events,
                        "CSV to write: the discrete events, t_ns,channel,value,gap");
    command->add_option(
        "--run", options->run,
        "Of a stream in which the board's clock has started anew: this run alone, from 1");
    command->add_option("--columns", options->reading.columns,
                        "Of a text file at --at: what its columns are");
    command->add_option("--units", options->reading.units, "Of a text file at --at: its units");
    command->add_flag("--earlier", options->earlier,
                      "The stream has the earlier format, as --objective knots writes it");
    command->add_flag("--salvage", options->salvage,
                      "A damaged stream is no error: what is good of it is decoded");
    command->callback([options] { run(*options); });
}

}  // namespace fairlead::sim
