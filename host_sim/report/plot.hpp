#pragma once
// Figures as SVG, drawn by gnuplot (Debian package gnuplot-nox), ready to stand inside a page.
#include <cstdint>
#include <string>
#include <vector>

namespace fairlead::sim {

struct Series {
    enum class Style { line, dashed, dots, rug };  // rug: ticks on the time axis, y is not used

    std::string legend, colour;
    Style style{Style::line};
    double width{1.2};
    std::vector<double> x, y;  // a NaN in y breaks the line
};

struct Figure {
    std::string id;  // letters, digits and _
    std::string title, y_label, caption;
    std::vector<Series> series;
    double x_min{}, x_max{};
    double y_min{}, y_max{};        // equal: gnuplot chooses
    std::vector<std::string> rows;  // names of y = 1, 2, ... where y is no number
    bool log_x{false}, log_y{false};
    int height{230};
};

/// At most about 2 * buckets points, keeping the extremes of each stretch of x, so that no peak is
/// lost. Lines break where y is NaN.
Series thinned(const Series& series, double x_min, double x_max, std::size_t buckets);

/// One SVG element per figure; empty strings where gnuplot cannot be run.
std::vector<std::string> draw(const std::vector<Figure>& figures);

}  // namespace fairlead::sim
