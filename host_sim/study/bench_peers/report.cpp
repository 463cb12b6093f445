#include "host_sim/study/bench_peers/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <functional>

namespace fairlead::sim {
namespace {

constexpr double rounding = 1e-6;  // of the tolerance: printed and float tolerances are rounded
constexpr const char* begin_mark = "<!-- tables: make bench-peers -->\n";
constexpr const char* end_mark = "<!-- end of tables -->";

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...) {
    char line[512];
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    return line;
}

using Results = std::vector<CellResult>;
using Takes = std::function<bool(const CellResult&)>;
using Value = std::function<std::optional<double>(const CellResult&)>;

/// Geometric mean and largest over the cells taken that have a value.
Ratio ratio(const Results& results, const Takes& takes, const Value& value) {
    Ratio out;
    for (const CellResult& cell : results) {
        if (!takes(cell)) continue;
        const auto v = value(cell);
        if (!v || !(*v > 0)) continue;
        out.mean += std::log(*v);
        out.worst = std::max(out.worst, *v);
        ++out.count;
    }
    out.mean = out.count > 0 ? std::exp(out.mean / static_cast<double>(out.count)) : 0;
    return out;
}

std::string shown(const Ratio& r) {
    return r.count == 0 ? "-" : text("%.2f (%.2f)", r.mean, r.worst);
}

struct Column {
    Channel channel;
    int coarse;  // -1: both tolerances
    bool takes(const CellResult& cell) const {
        return cell.channel == channel && (coarse < 0 || cell.coarse == (coarse == 1));
    }
};
constexpr Column columns[] = {{Channel::position, 0},    {Channel::position, 1},
                              {Channel::position, -1},   {Channel::orientation, 0},
                              {Channel::orientation, 1}, {Channel::orientation, -1}};
constexpr const char* column_heads =
    " position 1 mm | position 5 mm | both | orientation 0.25 deg | orientation 1 deg | both |";
constexpr const char* column_rule = "---|---|---|---|---|---|";

std::string row(const Results& results, const std::string& head, bool generated,
                const Value& value) {
    std::string out = "| " + head + " |";
    for (const Column& column : columns)
        out += ' ' +
               shown(ratio(
                   results,
                   [&](const CellResult& c) { return column.takes(c) && c.generated == generated; },
                   value)) +
               " |";
    return out + '\n';
}

std::optional<double> yardstick(const CellResult& cell) {
    if (cell.knots.empty() || cell.knots[0].control_points == 0) return {};
    return static_cast<double>(cell.knots[0].control_points);
}

const Tried* rival(const CellResult& cell, std::size_t bound, const std::string& name) {
    for (const Tried& tried : cell.bytes[bound])
        if (tried.rival == name) return &tried;
    return nullptr;
}

const Tried* best_rival(const CellResult& cell, std::size_t bound) {
    const auto& all = cell.bytes[bound];
    const auto best = std::min_element(
        all.begin(), all.end(), [](const Tried& a, const Tried& b) { return a.bytes < b.bytes; });
    return best == all.end() ? nullptr : &*best;
}

std::string bound_name(std::size_t bound) {
    return bound < delays.size() ? text("delay %zu", delays[bound]) : "no bound";
}

/// Calls `each(setting, delay, "medium, delay 120")`.
template <class Each>
void for_each_of_ours(Each each) {
    for (std::size_t s = 0; s < settings.size(); ++s)
        for (std::size_t d = 0; d < delays.size(); ++d)
            each(s, d, text("%s, delay %zu", settings[s].name, delays[d]));
}

/// Speeds: of the samples, and by how much they are off after decoding.
std::string speed_table(const Results& results) {
    std::string out =
        text("| speed error, mm/s or deg/s |%s\n|---|%s\n", column_heads, column_rule);
    const auto line = [&](const std::string& head, std::size_t s, std::size_t d,
                          double Ours::*which) {
        out += row(results, head, false, [&](const CellResult& c) -> std::optional<double> {
            if (!c.ours[s][d]) return {};
            return *c.ours[s][d].*which *
                   (c.channel == Channel::position ? 1e3 : 180 / 3.14159265358979323846);
        });
    };
    line("samples: the speed itself", medium, 1, &Ours::speed);
    for_each_of_ours([&](std::size_t s, std::size_t d, const std::string& name) {
        line("fairlead, " + name, s, d, &Ours::speed_error);
    });
    return out + '\n';
}

std::string control_point_table(const Results& results, bool generated) {
    std::string out = text("| control points / libsisl |%s\n|---|%s\n", column_heads, column_rule);
    for_each_of_ours([&](std::size_t s, std::size_t d, const std::string& name) {
        out += row(results, "**fairlead, " + name + "**", generated,
                   [&](const CellResult& c) -> std::optional<double> {
                       const auto of = yardstick(c);
                       if (!of || !c.ours[s][d]) return {};
                       return static_cast<double>(c.ours[s][d]->control_points) / *of;
                   });
    });
    std::vector<std::string> methods;
    for (const CellResult& cell : results)
        for (const KnotResult& k : cell.knots)
            if (std::find(methods.begin(), methods.end(), k.method) == methods.end())
                methods.push_back(k.method);
    for (std::size_t m = 1; m < methods.size(); ++m) {
        std::size_t broken = 0, count = 0;
        const Value value = [&](const CellResult& c) -> std::optional<double> {
            const auto of = yardstick(c);
            if (!of || m >= c.knots.size() || c.knots[m].control_points == 0) return {};
            return static_cast<double>(c.knots[m].control_points) / *of;
        };
        for (const CellResult& c : results) {
            if (c.generated != generated || !value(c)) continue;
            ++count;
            if (c.knots[m].error > 1 + rounding) ++broken;
        }
        const std::string note =
            broken > 0 ? text(", tolerance broken on %zu of %zu", broken, count) : "";
        out += row(results, methods[m] + note, generated, value);
    }
    out += row(results, "proved necessary", generated,
               [](const CellResult& c) -> std::optional<double> {
                   const auto of = yardstick(c);
                   if (!of || !c.least) return {};
                   return static_cast<double>(*c.least) / *of;
               });
    return out + '\n';
}

std::string byte_tables(const Results& results, bool generated) {
    std::string out = text("| fairlead's bytes / |%s\n|---|%s\n", column_heads, column_rule);
    for (const std::string& name : {std::string{}, std::string{"delta + Rice"}})
        for_each_of_ours([&](std::size_t s, std::size_t d, const std::string& of_ours) {
            const std::string head = (name.empty() ? "best rival" : name) + ", " + of_ours;
            out += row(results, head, generated, [&](const CellResult& c) -> std::optional<double> {
                const Tried* of = name.empty() ? best_rival(c, d) : rival(c, d, name);
                if (of == nullptr || !c.ours[s][d]) return {};
                return static_cast<double>(c.ours[s][d]->bytes) / static_cast<double>(of->bytes);
            });
        });
    std::vector<std::string> names;
    for (const CellResult& cell : results)
        for (const Tried& tried : cell.bytes[0])
            if (std::find(names.begin(), names.end(), tried.rival) == names.end())
                names.push_back(tried.rival);
    out += text("\n| bytes a second, geometric mean (worst) |%s\n|---|%s\n", column_heads,
                column_rule);
    for_each_of_ours([&](std::size_t s, std::size_t d, const std::string& name) {
        out += row(results, "**fairlead, " + name + "**", generated,
                   [&](const CellResult& c) -> std::optional<double> {
                       if (!c.ours[s][d]) return {};
                       return static_cast<double>(c.ours[s][d]->bytes) / c.seconds;
                   });
    });
    for (std::size_t bound = 0; bound < bound_count; ++bound)
        for (const std::string& name : names) {
            out += row(results, name + ", " + bound_name(bound), generated,
                       [&](const CellResult& c) -> std::optional<double> {
                           const Tried* r = rival(c, bound, name);
                           if (r == nullptr) return {};
                           return static_cast<double>(r->bytes) / c.seconds;
                       });
        }
    return out + '\n';
}

std::string recording_table(const Results& results) {
    std::string out =
        "| recording, channel, tolerance | samples | libsisl | global removal | proved necessary |"
        " best rival's bytes at delay 60, 120, 240, and which at 120 |"
        " fairlead's control points, medium | and bytes "
        "|\n|---|---|---|---|---|---|---|---|\n";
    for (const CellResult& c : results) {
        out += text("| %s, %s, %s | %zu | %zu |", c.name.c_str(), to_string(c.channel),
                    tolerance_name(c.channel, c.coarse).c_str(), c.samples,
                    c.knots.empty() ? 0 : c.knots[0].control_points);
        std::string global = "-";
        for (const KnotResult& k : c.knots)
            if (k.method == "global removal at samples") global = text("%zu", k.control_points);
        out += ' ' + global + " | " + (c.least ? text("%zu", *c.least) : "-") + " | ";
        for (std::size_t d = 0; d < delays.size(); ++d)
            if (const Tried* best = best_rival(c, d)) out += text("%zu ", best->bytes);
        if (const Tried* best = best_rival(c, 1)) out += best->rival;
        out += " | ";
        for (const auto& o : c.ours[medium]) out += o ? text("%zu ", o->control_points) : "- ";
        out += "| ";
        for (const auto& o : c.ours[medium]) out += o ? text("%zu ", o->bytes) : "- ";
        out += "|\n";
    }
    return out;
}

std::string guarantee_line(const Results& results) {
    double error = 0, delay_share = 0;
    std::size_t missing = 0, runs = 0;
    for (const CellResult& c : results)
        for_each_of_ours([&](std::size_t s, std::size_t d, const std::string&) {
            const auto& o = c.ours[s][d];
            if (!o) return;
            error = std::max(error, o->error);
            delay_share = std::max(delay_share, o->max_delay / static_cast<double>(delays[d]));
            missing += o->samples_missing;
            ++runs;
        });
    if (runs == 0) return "fairlead's reducer was not run.\n\n";
    return text(
        "fairlead over %zu runs: largest decoded error %.4f of the tolerance, %zu samples "
        "without a decoded value, largest delay %.3f of the bound.\n\n",
        runs, error, missing, delay_share);
}

}  // namespace

std::string to_markdown(const Results& results) {
    std::string out = guarantee_line(results);
    out += "### Recordings: control points\n\n" + control_point_table(results, false);
    out += "### Recordings: bytes\n\n" + byte_tables(results, false);
    out += "### Recordings: speed\n\n" + speed_table(results);
    const bool any = std::any_of(results.begin(), results.end(),
                                 [](const CellResult& c) { return c.generated; });
    if (any) {
        out += "### Generated jumps, rests and teleports: control points\n\n" +
               control_point_table(results, true);
        out += "### Generated jumps, rests and teleports: bytes\n\n" + byte_tables(results, true);
    }
    return out + "### One by one\n\n" + recording_table(results);
}

std::string to_json(const Results& results) {
    std::string out = "[";
    for (const CellResult& c : results) {
        if (out.size() > 1) out += ',';
        out += text(
            "\n{\"name\": \"%s\", \"channel\": \"%s\", \"tolerance\": \"%s\", \"samples\": "
            "%zu, \"seconds\": %.3f, \"generated\": %s,\n \"control_points\": {",
            c.name.c_str(), to_string(c.channel), tolerance_name(c.channel, c.coarse).c_str(),
            c.samples, c.seconds, c.generated ? "true" : "false");
        for (std::size_t m = 0; m < c.knots.size(); ++m)
            out += text("%s\"%s\": {\"count\": %zu, \"error\": %.6f}", m > 0 ? ", " : "",
                        c.knots[m].method.c_str(), c.knots[m].control_points, c.knots[m].error);
        out += c.least ? text("},\n \"proved_necessary\": %zu", *c.least) : "}";
        for (std::size_t b = 0; b < bound_count; ++b) {
            out += text(",\n \"bytes %s\": {", bound_name(b).c_str());
            for (std::size_t r = 0; r < c.bytes[b].size(); ++r)
                out += text("%s\"%s\": {\"bytes\": %zu, \"setting\": \"%s\"}", r > 0 ? ", " : "",
                            c.bytes[b][r].rival.c_str(), c.bytes[b][r].bytes,
                            c.bytes[b][r].setting.c_str());
            out += '}';
        }
        for_each_of_ours([&](std::size_t s, std::size_t d, const std::string& name) {
            if (const auto& o = c.ours[s][d])
                out += text(
                    ",\n \"fairlead, %s\": {\"control_points\": %zu, \"bytes\": %zu, "
                    "\"error\": %.6f, \"missing\": %zu, \"max_delay\": %g, \"mean_delay\": "
                    "%g, \"speed\": %.6g, \"speed_error\": %.6g}",
                    name.c_str(), o->control_points, o->bytes, o->error, o->samples_missing,
                    o->max_delay, o->mean_delay, o->speed, o->speed_error);
        });
        out += '}';
    }
    return out + "\n]\n";
}

std::string with_tables(const std::string& page, const std::string& tables) {
    const std::size_t begin = page.find(begin_mark), end = page.find(end_mark);
    if (begin == std::string::npos || end == std::string::npos || end < begin)
        throw BadData("the page has no place for the tables");
    return page.substr(0, begin) + begin_mark + '\n' + tables + '\n' + page.substr(end);
}

}  // namespace fairlead::sim
