#include "host_sim/study/experiments/plot.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {
namespace {

std::string quoted(std::string text) {
    std::replace(text.begin(), text.end(), '"', '\'');
    return '"' + text + '"';
}

const char* style_of(Curve::Style style) {
    switch (style) {
        case Curve::Style::line: return "lines";
        case Curve::Style::dashed: return "lines dashtype 2";
        case Curve::Style::points: return "points";
        case Curve::Style::both: return "linespoints";
    }
    return "lines";
}

/// Places for the labels of a logarithmic axis.
std::string decades() {
    std::string places;
    for (int e = -5; e <= 4; ++e) {
        for (const char* digit : {"1", "2", "5"})
            places += (places.empty() ? "" : ",") + std::string(digit) + "e" + std::to_string(e);
    }
    return places;
}

std::string script(const std::string& path, const std::vector<Panel>& panels, int width,
                   int height) {
    std::string s = "set terminal svg noenhanced background 'white' font 'sans,11' size " +
                    std::to_string(width) + "," +
                    std::to_string(height * static_cast<int>(panels.size())) + "\nset output " +
                    quoted(path) + "\nset grid lc rgb '#dddddd'\n" +
                    "set key outside bottom center horizontal\nset pointsize 0.5\n"
                    "set format '%g'\nset linetype cycle 8\n";
    int colour = 0;  // grey comes first: the measurement, or the older of two
    for (const char* rgb :
         {"7f8c99", "d1495b", "2e86ab", "3a7d44", "000000", "e09f3e", "7b4fa3", "17a2a2"})
        s += "set linetype " + std::to_string(++colour) + " lw 1.3 lc rgb '#" + rgb + "'\n";
    s += "set multiplot layout " + std::to_string(panels.size()) + ",1\n";
    std::size_t block = 0;
    for (const auto& panel : panels) {
        for (const auto& series : panel.series) {
            s += "$d" + std::to_string(block++) + " << EOD\n";
            for (const auto& [x, y] : series.points)
                s += formatted("%.7g", x) + ' ' + formatted("%.7g", y) + '\n';
            s += "EOD\n";
        }
    }
    block = 0;
    for (const auto& panel : panels) {
        s += "set title " + quoted(panel.title) + "\nset xlabel " + quoted(panel.x_label) +
             " offset 0,0.6" + "\nset ylabel " + quoted(panel.y_label) + '\n';
        s += std::string(panel.log_x ? "set" : "unset") + " logscale x\n";
        s += panel.log_y ? "set logscale y\nset autoscale yfix\nset ytics (" + decades() + ")\n"
                         : "unset logscale y\nset autoscale y\nset ytics autofreq\n";
        s += panel.equal_axes ? "unset lmargin\nunset rmargin\nset size ratio -1\n"
                              : "set size noratio\nset lmargin at screen 0.11\n"
                                "set rmargin at screen 0.97\n";
        std::string plots;
        for (const auto& series : panel.series) {
            if (!plots.empty()) plots += ", ";
            plots += "$d" + std::to_string(block++) + " with " + style_of(series.style) +
                     " title " + quoted(series.name);
        }
        s += "plot " + plots + '\n';
    }
    return s + "unset multiplot\n";
}

}  // namespace

void write_plot(const std::string& path, const std::vector<Panel>& panels, int width,
                int height_per_panel) {
    const std::string text = script(path, panels, width, height_per_panel);
    std::FILE* pipe = popen("gnuplot", "w");
    if (!pipe) throw BadData("cannot start gnuplot");
    std::fwrite(text.data(), 1, text.size(), pipe);
    if (pclose(pipe) != 0)
        throw BadData("gnuplot could not draw " + path + " (Debian package gnuplot-nox)");
}

std::string Table::text() const {
    std::vector<std::size_t> width;
    for (const auto& row : rows_) {
        width.resize(std::max(width.size(), row.size()), 1);
        for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
    }
    std::string out;
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        for (std::size_t i = 0; i < rows_[r].size(); ++i)
            out += "| " + rows_[r][i] + std::string(width[i] - rows_[r][i].size() + 1, ' ');
        out += "|\n";
        if (r > 0) continue;
        for (const auto w : width) out += "|" + std::string(w + 2, '-');
        out += "|\n";
    }
    return out;
}

std::string formatted(const char* pattern, double value) {
    char text[512];
    std::snprintf(text, sizeof text, pattern, value);
    return text;
}
std::string formatted(const char* pattern, double a, double b) {
    char text[512];
    std::snprintf(text, sizeof text, pattern, a, b);
    return text;
}

void make_folder(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error) throw BadData("cannot create " + path + ": " + error.message());
}

}  // namespace fairlead::sim
