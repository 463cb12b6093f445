// Errors of velocity and acceleration: lines, quadratics, cubics and the earlier search beside each
// other, on the recordings against means of the samples, on generated motions against the truth.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "host_sim/generate/generate.hpp"
#include "host_sim/recording/writers.hpp"
#include "host_sim/study/baselines/compress/segments.hpp"
#include "host_sim/study/bench_cubics/measure.hpp"
#include "host_sim/study/bench_cubics/motion.hpp"
#include "host_sim/study/bench_peers/ours.hpp"
#include "host_sim/study/experiments/plot.hpp"

namespace fairlead::sim::cubics {
namespace {

constexpr std::int32_t delay = 120;
constexpr std::size_t kinds = 4, lines = 0, earlier = 3;
constexpr std::array<const char*, kinds> kind_names{"lines (swing filter)", "C1, medium",
                                                    "C2 cubics", "earlier search"};

struct Seen {
    Cell cell;
    std::vector<double> truth;  // empty: a recording
};

/// Motions with known truth, seen by a tracker with noise.
std::vector<Seen> generated(Channel channel, const std::string& folder) {
    constexpr std::pair<const char*, const char*> motions[] = {
        {"reaches", "model:optical+rest:1+reach:0.9:14+reach:0.5:20+rest:1"},
        {"oscillations", "model:optical+rest:1+oscillate:10:0.7+oscillate:10:1.5+rest:1"},
        {"turns", "model:optical+rest:1+turn:1.2:10+turn:0.8:8+rest:1"}};
    std::vector<Seen> all;
    for (const auto& [name, spec] : motions) {
        if (channel == Channel::position && std::string{name} == "turns") continue;  // it rests
        Recording recording = generate(spec, 1);
        recording.name = std::string{"generated_"} + name;
        for (const bool coarse : {false, true}) {
            Seen s;
            s.cell.track = longest_run(recording, channel);
            s.cell.generated = true;
            s.cell.coarse = coarse;
            s.cell.tolerance = tolerance_of(channel, coarse);
            for (std::size_t i = 0; i < s.cell.track.size(); ++i) {
                const Pose& pose = recording.truth[i];
                const Vec3& p = pose.p_w_m;
                const Quat& q = pose.q_wb;
                if (channel == Channel::position)
                    s.truth.insert(s.truth.end(), {p.x, p.y, p.z});
                else
                    s.truth.insert(s.truth.end(), {q.w, q.x, q.y, q.z});
            }
            write_bytes(folder + "/cut/" + s.cell.file_name(), to_trk(cut(recording, channel)));
            all.push_back(std::move(s));
        }
    }
    return all;
}

std::vector<double> swing(const Cell& cell) {
    SegmentParams params;
    params.pieces = Pieces::swing;
    params.choice = Choice::near_prediction;
    params.slope_share = 0.5;
    const auto frames = encode(cell.track, cell.tolerance, params, delay);
    std::vector<double> values;
    for (const sim::State& s : decode(frames, cell.track, cell.tolerance, params))
        values.insert(values.end(), s.begin(),
                      s.begin() + static_cast<std::ptrdiff_t>(cell.track.dim()));
    return values;
}

/// The values that a reader of each kind has; empty where the program is absent.
std::array<std::vector<double>, kinds> decoded(const Cell& cell, const Result& cubic,
                                               const Program& program) {
    return {
        swing(cell), program.values(cell, delay, settings[medium]).value_or(std::vector<double>{}),
        cubic.decoded, program.values(cell, delay, settings[3]).value_or(std::vector<double>{})};
}

/// Geometric means over subjects: velocity rms and largest, acceleration rms and largest.
struct Means {
    std::array<double, 4> log_sum{};
    std::size_t count{};
    void add(const MotionErrors& e) {
        const double all[] = {e.velocity.rms, e.velocity.most, e.acceleration.rms,
                              e.acceleration.most};
        for (std::size_t i = 0; i < 4; ++i) log_sum[i] += std::log((std::max)(all[i], 1e-12));
        ++count;
    }
    double of(std::size_t i) const {
        return std::exp(log_sum[i] / static_cast<double>((std::max)(count, std::size_t{1})));
    }
};
using Row = std::array<Means, kinds>;

std::string rows(Channel channel, const std::string& tolerance, const char* against,
                 const Row& row) {
    std::string out;
    const double unit = channel == Channel::position ? 1 : 180 / std::acos(-1);
    for (std::size_t k = 0; k < kinds; ++k) {
        if (row[k].count == 0) continue;
        out += text("| %s | %s | %s |", tolerance.c_str(), against, kind_names[k]);
        for (std::size_t i = 0; i < 4; ++i) {
            out += text(" %.4g |", unit * row[k].of(i));
            if (row[earlier].count > 0)
                out += text(" %.2f |", row[k].of(i) / row[earlier].of(i));
            else
                out += " |";
        }
        out += '\n';
    }
    return out;
}

/// Two seconds of one axis: what a reader has who differentiates once and twice.
void plot(const std::string& path, const Seen& s,
          const std::array<std::vector<double>, kinds>& values) {
    const std::size_t from = s.cell.track.size() / 3, n = 240;
    const double period = s.cell.track.period_s;
    const auto series = [&](const std::vector<double>& x, bool twice) {
        std::vector<std::pair<double, double>> points;
        for (std::size_t i = from; i < from + n; ++i) {
            const double a = x[3 * i - 3], b = x[3 * i], c = x[3 * i + 3];
            points.emplace_back(static_cast<double>(i - from) * period,
                                twice ? (a - 2 * b + c) / (period * period) : (c - b) / period);
        }
        return points;
    };
    std::vector<Panel> panels;
    for (const bool twice : {false, true}) {
        Panel panel{twice ? "acceleration of x, m/s2" : "velocity of x, m/s", "s", "", {}};
        panel.series.push_back({"truth", series(s.truth, twice), Curve::Style::dashed});
        for (std::size_t k = 1; k < kinds; ++k)
            if (!values[k].empty())
                panel.series.push_back({kind_names[k], series(values[k], twice)});
        panels.push_back(std::move(panel));
    }
    write_plot(path, panels, 900, 340);
}

}  // namespace

void motion_table(Study& study) {
    const Options& options = study.options();
    const std::string head =
        "| tolerance | against | kind | velocity rms | over earlier | largest | over "
        "earlier | acceleration rms | over earlier | largest | over earlier |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n";
    const Program program{options.program, options.folder, ""};
    for (const Channel channel : {Channel::position, Channel::orientation}) {
        if (!options.has(channel)) continue;
        std::string out = head;
        const Halves& halves = study.halves(channel);
        if (halves.cells().empty()) return;
        const std::vector<Result>& found = study.results(channel, delay);
        std::map<std::pair<bool, bool>, Row> sums;  // generated, coarse
        const auto add = [&](const Seen& s, const Result& cubic) {
            check(s.cell, cubic, delay);
            const auto values = decoded(s.cell, cubic, program);
            Row& row = sums[{s.cell.generated, s.cell.coarse}];
            for (std::size_t k = 0; k < kinds; ++k)
                if (!values[k].empty()) row[k].add(motion_errors(s.cell.track, values[k], s.truth));
            if (channel == Channel::position && !options.plot.empty() && !s.cell.coarse &&
                s.cell.track.name == "generated_oscillations")
                plot(options.plot, s, values);
            if (options.verbose) std::fprintf(stderr, "%s\n", s.cell.label().c_str());
        };
        for (std::size_t i = 0; i < found.size(); ++i) add({halves.cells()[i], {}}, found[i]);
        for (const Seen& s : generated(channel, options.folder)) {
            Counts counts;
            add(s, run(s.cell.track, s.cell.tolerance, study.params(channel),
                       study.costs(channel)[0], counts));
        }
        for (const auto& [which, row] : sums)
            out += rows(channel, tolerance_name(channel, which.second),
                        which.first ? "truth" : "means of 9", row);
        publish(options, std::string{"motion "} + to_string(channel), out);
    }
}

}  // namespace fairlead::sim::cubics
