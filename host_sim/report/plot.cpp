#include "host_sim/report/plot.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace fairlead::sim {
namespace {

namespace fs = std::filesystem;

[[gnu::format(printf, 2, 3)]] void append(std::string& out, const char* format, ...) {
    char line[512];
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    out += line;
}

class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string name = (fs::temp_directory_path() / "fairlead-XXXXXX").string();
        if (mkdtemp(name.data()) != nullptr) path_ = name;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        if (!path_.empty()) fs::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

std::string content_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void append_data(std::string& script, const Series& series, std::size_t index) {
    append(script, "$d%zu << EOD\n", index);
    for (std::size_t i = 0; i < series.x.size(); ++i) {
        const double y = series.style == Series::Style::rug ? 0 : series.y[i];
        if (std::isfinite(y))
            append(script, "%.6g %.6g\n", series.x[i], y);
        else
            script += "\n";
    }
    script += "EOD\n";
}

void append_series(std::string& script, const Series& series, std::size_t index) {
    const char* colour = series.colour.c_str();
    switch (series.style) {
        case Series::Style::line:
            append(script, "$d%zu with lines lw %g lc rgb '%s'", index, series.width, colour);
            break;
        case Series::Style::dashed:
            append(script, "$d%zu with lines lw %g dt (6,4) lc rgb '%s'", index, series.width,
                   colour);
            break;
        case Series::Style::dots:
            append(script, "$d%zu with points pt 7 ps %g lc rgb '%s'", index, series.width * 0.25,
                   colour);
            break;
        case Series::Style::rug:
            append(script, "$d%zu using 1:(rug0):(0):(rug1) with vectors nohead lw %g lc rgb '%s'",
                   index, series.width, colour);
            break;
    }
}

/// The rug stands in the lowest 6 % of the range, so the range must be known to the script.
void append_range(std::string& script, const Figure& figure) {
    double low = figure.y_min, high = figure.y_max;
    if (!(low < high)) {
        low = INFINITY, high = -INFINITY;
        for (const Series& s : figure.series) {
            if (s.style == Series::Style::rug) continue;
            for (const double y : s.y)
                if (std::isfinite(y)) low = std::min(low, y), high = std::max(high, y);
        }
        if (!(low <= high)) low = 0, high = 1;
        const double margin = high > low ? 0.08 * (high - low) : 0.5;
        low -= margin, high += margin;
    }
    append(script, "set yrange [%.9g:%.9g]\nrug0=%.9g\nrug1=%.9g\n", low, high, low,
           0.06 * (high - low));
}

void append_figure(std::string& script, const Figure& figure, const fs::path& out) {
    append(
        script,
        "reset\nset terminal svg size 1000,%d dynamic font 'system-ui,sans-serif,13' name '%s'\n",
        figure.height, figure.id.c_str());
    append(script, "set output '%s'\n", out.c_str());
    script +=
        "set datafile missing NaN\nunset key\nset border 1 lc rgb '#8a8f98'\n"
        "set lmargin 9\nset rmargin 2\nset tmargin 0.6\nset bmargin 2.2\n"
        "set tics nomirror out scale 0.4 textcolor rgb '#808691'\n"
        "set ytics scale 0\nset grid ytics lt 1 lw 1\n";
    append(script, "set xrange [%.9g:%.9g]\nset format x '%%g s'\n", figure.x_min, figure.x_max);
    append(script, "set ylabel '%s' offset 1 textcolor rgb '#808691'\n", figure.y_label.c_str());
    if (figure.log_x) script += "set logscale x\nset grid xtics\n";
    if (figure.log_y) script += "set logscale y\nset format y '10^{%L}'\n";
    for (std::size_t i = 0; i < figure.rows.size(); ++i)
        append(script, "set ytics %s ('%s' %zu)\n", i == 0 ? "" : "add", figure.rows[i].c_str(),
               i + 1);
    append_range(script, figure);
    for (std::size_t i = 0; i < figure.series.size(); ++i) append_data(script, figure.series[i], i);
    script += "plot ";
    for (std::size_t i = 0; i < figure.series.size(); ++i) {
        if (i > 0) script += ", ";
        append_series(script, figure.series[i], i);
    }
    script += "\n";
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

void drop_between(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at)) {
        const std::size_t end = text.find(to, at);
        if (end == std::string::npos) return;
        text.erase(at, end + to.size() - at);
    }
}

/// gnuplot's file, made fit to stand beside others in a page of either colour scheme.
std::string inlined(std::string svg, const Figure& figure) {
    const std::size_t start = svg.find("<svg");
    if (start == std::string::npos) return {};
    svg.erase(0, start);
    replace_all(svg, " xmlns:xlink=\"http://www.w3.org/1999/xlink\"\n", "");
    replace_all(svg, " xmlns=\"http://www.w3.org/2000/svg\"\n", " role=\"img\"\n");
    replace_all(svg, "xlink:href='#", "href='#" + figure.id + "-");
    for (const char* id : {"gpPt", "gpDot", "gnuplot_canvas"}) {
        replace_all(svg, "id='" + std::string(id), "id='" + figure.id + "-" + id);
        replace_all(svg, "id=\"" + std::string(id), "id=\"" + figure.id + "-" + id);
    }
    drop_between(svg, "<filter", "</filter>");
    drop_between(svg, "<desc>", "</desc>");
    drop_between(svg, "<title>", "</title>");  // gnuplot's own names, shown on hover
    svg.insert(svg.find('>') + 1, "<title>" + figure.title + "</title>");
    replace_all(svg, "fill=\"black\"", "fill=\"currentColor\"");
    replace_all(svg, "color=\"black\"", "");
    return svg;
}

}  // namespace

Series thinned(const Series& series, double x_min, double x_max, std::size_t buckets) {
    Series out = series;
    out.x.clear();
    out.y.clear();
    const double per_bucket = (x_max - x_min) / static_cast<double>(buckets);
    const auto inside = [&](std::size_t i) { return series.x[i] >= x_min && series.x[i] <= x_max; };
    const auto keep = [&](std::size_t i) {
        out.x.push_back(series.x[i]);
        out.y.push_back(series.y.empty() ? 0 : series.y[i]);
    };
    const std::size_t n = series.x.size();
    for (std::size_t i = 0; i < n;) {
        if (!inside(i)) {
            ++i;
            continue;
        }
        const bool broken = !series.y.empty() && std::isnan(series.y[i]);
        const auto bucket_of = [&](std::size_t k) {
            return std::floor((series.x[k] - x_min) / per_bucket);
        };
        std::size_t end = i + 1, low = i, high = i;
        while (!series.y.empty() && end < n && inside(end) && bucket_of(end) == bucket_of(i) &&
               std::isnan(series.y[end]) == broken) {
            if (series.y[end] < series.y[low]) low = end;
            if (series.y[end] > series.y[high]) high = end;
            ++end;
        }
        if (series.y.empty()) {  // a rug: one tick a bucket
            while (end < n && bucket_of(end) == bucket_of(i)) ++end;
            keep(i);
        } else {
            keep(std::min(low, high));
            if (low != high) keep(std::max(low, high));
        }
        i = end;
    }
    return out;
}

std::vector<std::string> draw(const std::vector<Figure>& figures) {
    std::vector<std::string> svgs(figures.size());
    const TemporaryFolder folder;
    if (folder.path().empty()) return svgs;
    std::string script;
    const auto file_of = [&](std::size_t i) {
        return folder.path() / (std::to_string(i) + ".svg");
    };
    for (std::size_t i = 0; i < figures.size(); ++i) append_figure(script, figures[i], file_of(i));
    const fs::path script_path = folder.path() / "figures.gp";
    std::ofstream(script_path) << script;
    const std::string command = "gnuplot '" + script_path.string() + "' >/dev/null 2>&1";
    if (std::system(command.c_str()) != 0) return svgs;  // NOLINT: a program of the system's path
    for (std::size_t i = 0; i < figures.size(); ++i)
        svgs[i] = inlined(content_of(file_of(i)), figures[i]);
    return svgs;
}

}  // namespace fairlead::sim
