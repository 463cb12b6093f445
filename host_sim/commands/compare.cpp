// fairlead-sim compare IN...: our causal filters beside the published ones, on noisy recordings.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

#include "host_sim/commands/commands.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/study/experiments/frontier.hpp"
#include "host_sim/study/experiments/plot.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    std::vector<std::string> files;
    std::string out, page;
    NoisePlan noise{0.002, 0.02, 1, 20};
    double above_hz{5};
};

constexpr double lag_of_interest = 20;  // samples; beyond, nobody would call it live

struct Side {
    const char* name;
    const char* unit;
    ChannelFigures Figures::*channel;
    double scale;
};
constexpr Side sides[] = {{"position", "mm", &Figures::position, 1e3},
                          {"orientation", "mrad", &Figures::orientation, 1e3}};

std::vector<Entry> sweep(const NoisyMotion& motion, double above_hz, const std::string& name) {
    std::vector<Entry> entries;
    const auto all = candidates(motion.step_s);
    Progress progress{name.c_str(), all.size(), "settings"};
    for (const auto& c : all) {
        progress.show(entries.size());
        entries.push_back({c.family, c.setting, c.ours, measure(c, motion, above_hz)});
    }
    return entries;
}

std::string text_of(const Entry* entry) {
    return entry ? entry->family + ", " + entry->setting : "none";
}

/// Each family at the setting that comes closest to the truth of the same instant.
std::string family_table(const std::vector<Entry>& entries, const Side& side) {
    std::vector<const Entry*> best;
    const auto late = [&](const Entry& e) { return (e.figures.*side.channel).late_error; };
    for (const auto& entry : entries) {
        const auto same = [&](const Entry* e) { return e->family == entry.family; };
        const auto found = std::find_if(best.begin(), best.end(), same);
        if (found == best.end()) {
            best.push_back(&entry);
        } else if (late(entry) < late(**found)) {
            *found = &entry;
        }
    }
    const std::string unit = side.unit;
    Table table({"family", "setting", "lag, samples", "noise, " + unit, "error now, " + unit,
                 "overshoot, %", "ns a sample"});
    for (const auto* e : best) {
        const auto& f = e->figures.*side.channel;
        table.add(
            {(e->ours ? "" : "rival: ") + e->family, e->setting, formatted("%.2f", f.lag),
             formatted("%.3f", f.noise * side.scale), formatted("%.3f", f.late_error * side.scale),
             formatted("%.1f", f.overshoot * 100), formatted("%.0f", e->figures.ns_per_sample)});
    }
    return table.text();
}

std::string match_table(const std::vector<Match>& all, const Side& side) {
    const std::string unit = side.unit;
    Table table({"best rival at its lag", "lag", "noise, " + unit, "ours at that lag",
                 "noise, " + unit, "ratio", "ours at that noise: lag saved"});
    for (const auto& m : all) {
        if (m.rival.lag > lag_of_interest) continue;
        const bool has = m.same_lag.entry != nullptr, early = m.same_noise.entry != nullptr;
        table.add({text_of(m.rival.entry), formatted("%.2f", m.rival.lag),
                   formatted("%.3f", m.rival.noise * side.scale), text_of(m.same_lag.entry),
                   has ? formatted("%.3f", m.same_lag.noise * side.scale) : "-",
                   has ? formatted("%.2f", m.same_lag.noise / m.rival.noise) : "-",
                   early ? formatted("%.2f", m.rival.lag - m.same_noise.lag) : "-"});
    }
    return table.text();
}

/// One channel over all recordings: how often ours is better, by how much, and where it is not.
struct Summary {
    Table table;
    std::size_t count{}, quieter{}, earlier{};
    std::string exceptions;
};

std::string exception(const std::string& name, const Match& m, const Side& side) {
    std::string line =
        "- " + name + ", " + text_of(m.rival.entry) +
        formatted(": lag %.2f, noise %.3f ", m.rival.lag, m.rival.noise * side.scale) + side.unit;
    if (m.same_lag.entry)
        line += formatted("; ours at that lag %.3f ", m.same_lag.noise * side.scale) + side.unit;
    if (m.same_noise.entry) line += formatted("; at that noise lag %.2f", m.same_noise.lag);
    return line + "\n";
}

void add_row(Summary& summary, const std::string& name, const std::vector<Match>& all,
             const Side& side) {
    std::vector<double> ratios, saved;
    std::size_t count = 0, quieter = 0, earlier = 0;
    for (const auto& m : all) {
        if (m.rival.lag > lag_of_interest) continue;
        ++count;
        if (m.same_lag.entry) ratios.push_back(m.same_lag.noise / m.rival.noise);
        if (m.same_noise.entry) saved.push_back(m.rival.lag - m.same_noise.lag);
        const bool quiet = m.same_lag.entry && ratios.back() < 1;
        const bool early = m.same_noise.entry && saved.back() > 0;
        quieter += quiet;
        earlier += early;
        if (!quiet || !early) summary.exceptions += exception(name, m, side);
    }
    summary.count += count;
    summary.quieter += quieter;
    summary.earlier += earlier;
    const auto middle = [](std::vector<double>& v, const char* pattern) -> std::string {
        if (v.empty()) return "-";
        std::sort(v.begin(), v.end());
        return formatted(pattern, v[v.size() / 2]);
    };
    const auto of = [count](std::size_t n) {
        return std::to_string(n) + " of " + std::to_string(count);
    };
    const std::string worst_ratio =
        ratios.empty() ? "-" : formatted("%.2f", *std::max_element(ratios.begin(), ratios.end()));
    const std::string worst_saved =
        saved.empty() ? "-" : formatted("%.2f", *std::min_element(saved.begin(), saved.end()));
    summary.table.add({name, of(quieter), middle(ratios, "%.2f"), worst_ratio, of(earlier),
                       middle(saved, "%.2f"), worst_saved});
}

std::string text_of(const Summary& summary, const Side& side) {
    const std::string count = std::to_string(summary.count);
    std::string text = std::string("### ") + side.name + "\n\n" + summary.table.text() +
                       "\nIn all " + std::to_string(summary.quieter) + " of " + count +
                       " are quieter at the same lag, and " + std::to_string(summary.earlier) +
                       " of " + count + " earlier at the same noise.";
    if (!summary.exceptions.empty()) text += " Not so:\n\n" + summary.exceptions;
    return text + (summary.exceptions.empty() ? "\n\n" : "\n");
}

/// Puts the tables between the page's marks.
void write_page(const std::string& path, const std::string& tables) {
    static const std::string from = "<!-- compare -->\n", to = "<!-- compare: end -->";
    std::string page = read_bytes(path);
    const auto a = page.find(from), b = page.find(to);
    if (a == std::string::npos || b == std::string::npos || b < a)
        throw BadData(path + ": has no place for the tables");
    write_bytes(path, page.replace(a + from.size(), b - a - from.size(), "\n" + tables));
}

/// Of each family the settings that no other of it beats.
Panel panel(const std::vector<Entry>& entries, const Side& side, const std::string& name) {
    Panel p;
    p.title = name + ", " + side.name;
    p.x_label = "lag, samples";
    p.y_label = std::string("noise above the limit, ") + side.unit;
    p.log_y = true;
    std::map<std::string, std::vector<Entry>> families;
    for (const auto& e : entries)
        families[(e.ours ? "ours: " : "rival: ") + e.family.substr(0, e.family.find(','))]
            .push_back(e);
    for (const auto& [family, members] : families) {
        const bool ours = members.front().ours;
        Curve curve{family, {}, ours ? Curve::Style::both : Curve::Style::dashed};
        for (const Point& point : frontier(members, ours, side.channel))
            if (point.lag >= -0.5 && point.lag <= 12)
                curve.points.emplace_back(point.lag, point.noise * side.scale);
        p.series.push_back(curve);
    }
    return p;
}

void run(const Options& options) {
    const std::vector<std::string> head{
        "recording", "quieter at the same lag",   "noise ratio: middle",
        "worst",     "earlier at the same noise", "lag saved: middle",
        "least"};
    std::vector<Summary> summaries{{Table{head}, 0, 0, 0, {}}, {Table{head}, 0, 0, 0, {}}};
    std::size_t ours = 0, rivals = 0;
    for (const auto& file : options.files) {
        const auto recording = read_recording(file);
        const auto motion = noisy(recording, options.noise);
        const auto entries = sweep(motion, options.above_hz, stem_of(file));
        std::vector<Panel> panels;
        std::string report;
        for (std::size_t k = 0; k < 2; ++k) {
            const Side& side = sides[k];
            const auto all = matches(entries, side.channel);
            add_row(summaries[k], stem_of(file), all, side);
            panels.push_back(panel(entries, side, stem_of(file)));
            report += std::string("## ") + side.name + "\n\n" + family_table(entries, side) + "\n" +
                      match_table(all, side) + "\n";
        }
        if (options.files.size() == 1) std::printf("%s", report.c_str());
        if (!options.out.empty()) {
            make_folder(options.out);
            const std::string base = options.out + "/compare_" + stem_of(file);
            write_bytes(base + ".md", report);
            write_plot(base + ".svg", panels, 860, 520);
        }
        ours = rivals = 0;
        for (const Entry& entry : entries) ++(entry.ours ? ours : rivals);
        std::fprintf(stderr, "%s: %zu settings\n", stem_of(file).c_str(), entries.size());
    }
    std::string tables = std::to_string(ours) + " settings of ours, " + std::to_string(rivals) +
                         " of the rivals.\n\n";
    for (std::size_t k = 0; k < 2; ++k) tables += text_of(summaries[k], sides[k]);
    if (!options.page.empty()) write_page(options.page, tables);
    std::fputs(tables.c_str(), stdout);
}

}  // namespace

void add_compare(CLI::App& app) {
    auto* command = app.add_subcommand(
        "compare", "Set our causal filters beside the published ones: lag, noise, overshoot, time");
    auto options = std::make_shared<Options>();
    command->add_option("IN", options->files, "Recordings of poses; noise is added to them")
        ->required()
        ->check(CLI::ExistingFile);
    command->add_option("--noise-m", options->noise.noise_m, "Noise of positions, per axis")
        ->capture_default_str();
    command->add_option("--noise-rad", options->noise.noise_rad, "Noise of orientations, per axis")
        ->capture_default_str();
    command->add_option("--seed", options->noise.seed, "Of the noise")->capture_default_str();
    command->add_option("--seconds", options->noise.seconds_max, "Use at most so much of each")
        ->capture_default_str();
    command->add_option("--above", options->above_hz, "Noise is what remains above this, Hz")
        ->capture_default_str();
    command->add_option("--page", options->page, "Page whose tables are replaced");
    command->add_option("--out", options->out, "Folder for a table and a plot of each recording");
    command->callback([options] { run(*options); });
}

}  // namespace fairlead::sim
