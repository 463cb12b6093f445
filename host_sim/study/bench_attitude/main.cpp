// bench-attitude: orientation on the recordings.
//   bench-attitude table DIR [--into docs/attitude.md]   every figure of that page
//   bench-attitude day DIR                               a day of data: float, double, covariance
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "fairlead/sense/attitude.hpp"
#include "host_sim/replay/attitude_settings.hpp"
#include "host_sim/study/baselines/ahrs/ahrs.hpp"
#include "host_sim/study/bench_attitude/foreign.hpp"
#include "host_sim/study/bench_attitude/locks.hpp"
#include "host_sim/study/bench_attitude/smoothing.hpp"
#include "host_sim/study/bench_attitude/trials.hpp"

namespace fairlead::sim {
namespace {

std::vector<Recording> read_all(const std::string& folder) {
    std::vector<std::string> paths;
    if (std::filesystem::is_directory(folder))
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            if (entry.path().extension() == ".imu") paths.push_back(entry.path().string());
    std::sort(paths.begin(), paths.end());
    std::vector<Recording> out;
    for (const auto& path : paths) {
        out.push_back(read_recording(path));
        out.back().name = stem_of(path);
    }
    return out;
}

template <class... Args>
std::string text(const char* format, Args... args) {
    std::array<char, 400> line{};
    std::snprintf(line.data(), line.size(), format, args...);
    return line.data();
}

std::string each_recording(const std::vector<Recording>& recordings) {
    std::string out =
        "| recording | 9D total | heading | inclination | 6D inclination | float - double |\n"
        "|---|---|---|---|---|---|\n";
    std::array<double, 5> sum{};
    for (const Recording& r : recordings) {
        const Score nine = score(r, run_attitude(r, AttitudeMode::imu_mag));
        const Score six = score(r, run_attitude(r, AttitudeMode::imu));
        const std::array<double, 5> row{nine.total_deg, nine.heading_deg, nine.inclination_deg,
                                        six.inclination_deg, float_against_double(r)};
        for (std::size_t i = 0; i < row.size(); ++i) sum[i] += row[i];
        out += text("| %s | %.2f | %.2f | %.2f | %.2f | %.4f |\n", r.name.c_str(), row[0], row[1],
                    row[2], row[3], row[4]);
    }
    const auto n = static_cast<double>(recordings.size());
    return out + text("| mean | %.3f | %.3f | %.3f | %.3f | %.4f |\n", sum[0] / n, sum[1] / n,
                      sum[2] / n, sum[3] / n, sum[4] / n);
}

std::string consistency(const std::vector<Recording>& recordings) {
    std::string out =
        "| recording | inclination, moving | inclination, at rest | heading, moving |\n"
        "|---|---|---|---|\n";
    std::vector<Honesty> all;
    Honesty mean;
    const auto n = static_cast<double>(recordings.size());
    for (const Recording& r : recordings) {
        all.push_back(honesty(r));
        const Honesty& h = all.back();
        out += text("| %s | %.2f | %.2f | %.2f |\n", r.name.c_str(), h.inclination,
                    h.inclination_at_rest, h.heading);
        mean.inclination += h.inclination / n;
        mean.inclination_at_rest += h.inclination_at_rest / n;
        mean.heading += h.heading / n;
    }
    out += text("| mean | %.2f | %.2f | %.2f |\n\n", mean.inclination, mean.inclination_at_rest,
                mean.heading);
    const Independence i = independence(all);
    out += text(
        "Heading errors stay correlated for %.0f s, so a recording holds about %.1f independent "
        "ones: an honest filter's mean lies\nbetween %.2f and %.1f in 95 %% of such recordings, "
        "and "
        "the mean of all of them between %.2f and %.2f.\n",
        i.correlation_s, i.draws, i.lowest, i.highest, i.mean_lowest, i.mean_highest);
    out += text(
        "The heading error is within one reported standard deviation for %.0f %% of the time and "
        "within two for %.0f %%.\n",
        100 * share_within(all, 1), 100 * share_within(all, 2));
    return out;
}

/// broken: set where a trial is worse than its bound.
std::string all_trials(const std::vector<Recording>& recordings, bool& broken) {
    std::string out =
        "| delivered | total | heading | inclination | bound |\n|---|---|---|---|---|\n";
    for (const Trial& trial : trials()) {
        const Means m = run_trial(recordings, trial);
        broken = broken || (trial.bound_deg > 0 && !(m.total <= trial.bound_deg));
        out +=
            text("| %s | %.3f | %.3f | %.3f | %s |\n", trial.name.c_str(), m.total, m.heading,
                 m.inclination, trial.bound_deg > 0 ? text("%.2f", trial.bound_deg).c_str() : "");
    }
    return out;
}

std::string all_breaks(const std::vector<Recording>& recordings) {
    std::string out =
        "| broken | total during | inclination during | worst inclination | total after | "
        "inclination after | not finite |\n|---|---|---|---|---|---|---|\n";
    for (const Break& broken : breaks()) {
        const BreakErrors e = run_break(recordings, broken);
        out += text("| %s | %.2f | %.2f | %.1f | %.2f | %.2f | %zu |\n", broken.name.c_str(),
                    e.during.total, e.during.inclination, e.during.worst_inclination, e.after.total,
                    e.after.inclination, e.during.not_finite + e.after.not_finite);
    }
    return out;
}

/// Every fold: the setting that is best on the other recordings, tried on the one left out.
std::string leave_one_out(const std::vector<Recording>& recordings) {
    const auto grid = settings_grid();
    std::vector<std::vector<double>> total(grid.size());
    for (std::size_t g = 0; g < grid.size(); ++g)
        for (const Recording& r : recordings)
            total[g].push_back(score(r, run_attitude(r, AttitudeMode::imu_mag, grid[g])).total_deg);
    std::string out =
        "| left out | total with the best of the others | field_uT | field_s | "
        "scale_error | velocity_m_s | total with the defaults |\n"
        "|---|---|---|---|---|---|---|\n";
    double sum = 0, sum_default = 0;
    for (std::size_t k = 0; k < recordings.size(); ++k) {
        std::size_t best = 0;
        double least = 1e300;
        for (std::size_t g = 0; g < grid.size(); ++g) {
            double others = 0;
            for (std::size_t i = 0; i < recordings.size(); ++i)
                if (i != k) others += total[g][i];
            if (others < least) {
                least = others;
                best = g;
            }
        }
        const double plain =
            score(recordings[k], run_attitude(recordings[k], AttitudeMode::imu_mag)).total_deg;
        const AttitudeParams& p = grid[best];
        out +=
            text("| %s | %.2f | %.1f | %.0f | %.3f | %.1f | %.2f |\n", recordings[k].name.c_str(),
                 total[best][k], static_cast<double>(p.field_uT), static_cast<double>(p.field_s),
                 static_cast<double>(p.scale_error), static_cast<double>(p.velocity_m_s), plain);
        sum += total[best][k];
        sum_default += plain;
    }
    const auto n = static_cast<double>(recordings.size());
    return out + text("| mean | %.3f | | | | | %.3f |\n", sum / n, sum_default / n);
}

Means baseline(const std::vector<Recording>& recordings, const AhrsKind& kind, const AhrsGain& gain,
               bool use_field) {
    Means sum;
    for (const Recording& r : recordings) {
        const auto filter = kind.make(gain);
        std::vector<Pose> estimate;
        std::int64_t before = r.samples.front().t_ns;
        for (const Sample& s : r.samples) {
            const auto& q =
                filter->update(s, static_cast<double>(s.t_ns - before) * 1e-9, use_field);
            before = s.t_ns;
            Pose pose;
            pose.t_ns = s.t_ns;
            pose.q_wb = {static_cast<float>(q.w()), static_cast<float>(q.x()),
                         static_cast<float>(q.y()), static_cast<float>(q.z())};
            estimate.push_back(pose);
        }
        const Score s = score(r, estimate);
        sum.total += s.total_deg / static_cast<double>(recordings.size());
        sum.inclination += s.inclination_deg / static_cast<double>(recordings.size());
    }
    return sum;
}

std::string baselines(const std::vector<Recording>& recordings) {
    std::string out =
        "| filter | gains, best for 9D | 9D total | gains, best for 6D | 6D inclination |\n"
        "|---|---|---|---|---|\n";
    for (const AhrsKind& kind : ahrs_kinds()) {
        double nine = 1e300, six = 1e300;
        AhrsGain nine_gain, six_gain;
        for (const AhrsGain& gain : kind.gains) {
            const double total = baseline(recordings, kind, gain, true).total;
            const double inclination = baseline(recordings, kind, gain, false).inclination;
            if (total < nine) {
                nine = total;
                nine_gain = gain;
            }
            if (inclination < six) {
                six = inclination;
                six_gain = gain;
            }
        }
        const auto said = [](const AhrsGain& g) {
            return g.integral > 0 ? text("%g, %g", g.first, g.integral) : text("%g", g.first);
        };
        out += text("| %s, tuned on these recordings | %s | %.2f | %s | %.2f |\n",
                    kind.name.c_str(), said(nine_gain).c_str(), nine, said(six_gain).c_str(), six);
    }
    const Means m = mean_score(recordings, AttitudeMode::imu_mag, {});
    const Means six = mean_score(recordings, AttitudeMode::imu, {});
    return out + text("| fairlead, defaults | | %.2f | | %.2f |\n", m.total, six.inclination);
}

/// Puts `content` between `<!-- name -->` and `<!-- end name -->`.
void replace(std::string& page, const std::string& name, const std::string& content) {
    const std::string from = "<!-- " + name + " -->\n", to = "<!-- end " + name + " -->";
    const auto a = page.find(from), b = page.find(to);
    if (a == std::string::npos || b == std::string::npos)
        throw BadData("the page has no place for the table '" + name + "'");
    page.replace(a + from.size(), b - a - from.size(), content);
}

int table(const std::string& folder, const std::string& into) {
    const auto recordings = read_all(folder);
    if (recordings.empty()) {
        std::printf("skipped attitude-table: no recordings in %s\n", folder.c_str());
        return 0;
    }
    bool broken = false;
    const std::array<std::pair<const char*, std::string>, 6> parts{
        {{"recordings", each_recording(recordings)},
         {"consistency", consistency(recordings)},
         {"trials", all_trials(recordings, broken)},
         {"breaks", all_breaks(recordings)},
         {"leave-one-out", leave_one_out(recordings)},
         {"baselines", baselines(recordings)}}};
    std::string page = into.empty() ? std::string() : read_bytes(into);
    for (const auto& [name, content] : parts) {
        std::printf("%s\n", content.c_str());
        if (!into.empty()) replace(page, name, content);
    }
    if (!into.empty()) write_bytes(into, page);
    if (broken) std::printf("FAIL attitude-table: a bound is exceeded\n");
    return broken ? 1 : 0;
}

int foreign(const std::string& folder, const std::string& into,
            const std::vector<std::string>& set) {
    AttitudeParams params;
    apply_settings(params, set);
    std::string page = into.empty() ? std::string() : read_bytes(into);
    const std::array<std::pair<const char*, std::string>, 3> parts{
        {{"foreign recordings", foreign_recordings(folder, params)},
         {"foreign simulations", foreign_simulations(params)},
         {"speed", foreign_speed(params)}}};
    for (const auto& [name, content] : parts) {
        std::printf("%s\n", content.c_str());
        if (!into.empty()) replace(page, name, content);
    }
    if (!into.empty()) write_bytes(into, page);
    return 0;
}

int locks(std::size_t count, const std::string& into) {
    std::string out =
        "| trial | mode | runs | locked | settled, more than 20 deg off | worst while settled | "
        "heading beyond 3 sigma | settled |\n|---|---|---|---|---|---|---|---|\n";
    constexpr double turned_most = 1, tilted_most = 0.005;  // % of the settled samples
    std::size_t locked = 0;
    bool broken = false;
    for (const bool loss : {false, true})
        for (const AttitudeMode mode : {AttitudeMode::imu_mag, AttitudeMode::imu}) {
            std::fprintf(stderr, "%s, %s ...\n", loss ? "losses" : "starts",
                         mode == AttitudeMode::imu ? "6D" : "9D");
            const LockCounts c =
                count_locks(loss ? upside_down_loss : start_in_motion, mode, 1, count);
            const auto share = [&](std::size_t n) {
                return 100 * static_cast<double>(n) /
                       static_cast<double>(std::max<std::size_t>(c.samples, 1));
            };
            out += text("| %s | %s | %zu | %zu | %.3f %% | %.0f deg | %.2f %% | %.0f %% |\n",
                        loss ? "turned upside down while readings fail" : "started in motion",
                        mode == AttitudeMode::imu ? "6D" : "9D", c.runs, c.locked, share(c.tilted),
                        c.worst_deg, share(c.turned), 100 * c.clear_share);
            locked += c.locked;
            broken = broken || share(c.turned) > turned_most || share(c.tilted) > tilted_most;
            if (c.locked > 0)
                std::fprintf(stderr, "first locked: seed %llu\n",
                             static_cast<unsigned long long>(c.first_locked));
        }
    std::printf("%s", out.c_str());
    if (!into.empty()) {
        std::string page = read_bytes(into);
        replace(page, "locks", out);
        write_bytes(into, page);
    }
    if (broken) std::printf("FAIL attitude-locks: settled, and wrong\n");
    return locked == 0 && !broken ? 0 : 1;
}

int smoothing(const std::string& folder, const std::string& into) {
    const std::string out = smoothing_table(folder);
    if (out.empty()) {
        std::printf("skipped attitude-smooth: no recordings in %s\n", folder.c_str());
        return 0;
    }
    std::printf("%s", out.c_str());
    if (!into.empty()) {
        std::string page = read_bytes(into);
        replace(page, "smoothing", out);
        write_bytes(into, page);
    }
    return 0;
}

/// The least eigenvalue's sign by Cholesky in double, of the matrix scaled to unit diagonal.
double least_pivot(const Attitude::State& s) {
    constexpr std::size_t n = Attitude::State::size;
    std::array<std::array<double, n>, n> l{};
    double least = 1;
    for (std::size_t r = 0; r < n; ++r)
        for (std::size_t c = 0; c <= r; ++c) {
            const double scale = std::sqrt(static_cast<double>(s.covariance(r, r)) *
                                           static_cast<double>(s.covariance(c, c)));
            double sum = static_cast<double>(s.covariance(r, c)) / scale;
            for (std::size_t k = 0; k < c; ++k) sum -= l[r][k] * l[c][k];
            if (r != c) {
                l[r][c] = sum / l[c][c];
                continue;
            }
            if (!(sum > 0)) return -1;
            least = std::min(least, sum);
            l[r][c] = std::sqrt(sum);
        }
    return least;
}

int day(const std::string& folder, double hours) {
    const auto recordings = read_all(folder);
    if (recordings.empty()) {
        std::printf("skipped attitude-day: no recordings in %s\n", folder.c_str());
        return 0;
    }
    Attitude narrow;
    BasicAttitude<double, AttitudeMode::imu_mag> wide;
    constexpr std::int64_t period_ns = 3'500'000;
    std::int64_t t_ns = 0;
    double worst_deg = 0, least = 1;
    std::size_t n = 0;
    while (static_cast<double>(t_ns) < hours * 3600e9)
        for (const Recording& r : recordings)  // the jump between two is part of the trial
            for (Sample sample : r.samples) {
                t_ns += period_ns;
                sample.t_ns = t_ns;
                narrow.push(sample);
                wide.push(sample);
                if (++n % 997 != 0 || n < 2000) continue;
                least = std::min(least, least_pivot(narrow.state()));
                const auto q = narrow.orientation();
                const BasicQuat<double> single{static_cast<double>(q.w), static_cast<double>(q.x),
                                               static_cast<double>(q.y), static_cast<double>(q.z)};
                worst_deg =
                    std::max(worst_deg, 57.29577951308232 *
                                            rotation_angle(normalised(single), wide.orientation()));
            }
    std::printf(
        "%.1f h, %zu samples: least pivot of the scaled covariance %.3g, float and double "
        "at most %.4f deg apart\n",
        static_cast<double>(t_ns) * 1e-9 / 3600, n, least, worst_deg);
    return least > 0 ? 0 : 1;
}

}  // namespace
}  // namespace fairlead::sim

int main(int argc, char** argv) {
    CLI::App app{"Orientation on the recordings: the figures of docs/attitude.md"};
    app.require_subcommand(1);
    std::string folder, into;
    double hours = 24;
    auto* table = app.add_subcommand("table", "All tables of the page");
    table->add_option("DIR", folder, "Folder of .imu recordings")->required();
    table->add_option("--into", into, "Page whose tables are rewritten");
    std::vector<std::string> set;
    auto* foreign = app.add_subcommand("foreign", "Other devices and motions");
    foreign->add_option("DIR", folder, "Folder of .imu recordings")->required();
    foreign->add_option("--into", into, "Page whose tables are rewritten");
    foreign->add_option("--set", set, "NAME=VALUE of a parameter");
    std::size_t count = 1000;
    auto* locks = app.add_subcommand("locks", "Seeded starts in motion and upside-down losses");
    locks->add_option("--count", count, "Runs of each")->check(CLI::Range(1, 1000000));
    locks->add_option("--into", into, "Page whose table is rewritten");
    auto* smooth = app.add_subcommand("smooth", "What a lag, and the whole recording, are worth");
    smooth->add_option("DIR", folder, "Folder of .imu recordings")->required();
    smooth->add_option("--into", into, "Page whose table is rewritten");
    auto* day = app.add_subcommand("day", "A day of recordings on end");
    day->add_option("DIR", folder, "Folder of .imu recordings")->required();
    day->add_option("--hours", hours, "Another length");
    CLI11_PARSE(app, argc, argv);
    try {
        if (*locks) return fairlead::sim::locks(count, into);
        if (*smooth) return fairlead::sim::smoothing(folder, into);
        if (*foreign) return fairlead::sim::foreign(folder, into, set);
        if (*day) return fairlead::sim::day(folder, hours);
        return fairlead::sim::table(folder, into);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench-attitude: %s\n", error.what());
        return 1;
    }
}
