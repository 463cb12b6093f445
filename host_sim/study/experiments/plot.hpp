#pragma once
// Plots and tables of the experiments. A plot is written as SVG by gnuplot, from data passed
// through a pipe; a table is aligned text.
#include <string>
#include <utility>
#include <vector>

namespace fairlead::sim {

struct Curve {
    std::string name;
    std::vector<std::pair<double, double>> points;
    enum class Style { line, dashed, points, both } style{Style::line};
};

struct Panel {
    std::string title, x_label, y_label;
    std::vector<Curve> series;
    bool log_x{false}, log_y{false};
    bool equal_axes{false};
};

/// One panel under the other. Throws BadData when gnuplot is missing or fails.
void write_plot(const std::string& path, const std::vector<Panel>& panels, int width = 760,
                int height_per_panel = 330);

class Table {
  public:
    explicit Table(std::vector<std::string> head) : rows_{std::move(head)} {}
    void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
    /// As Markdown, columns aligned: reads well as plain text too.
    std::string text() const;

  private:
    struct Rows : std::vector<std::vector<std::string>> {
        explicit Rows(std::vector<std::string> head) { push_back(std::move(head)); }
    } rows_;
};

/// printf into a string.
std::string formatted(const char* pattern, double value);
std::string formatted(const char* pattern, double a, double b);

/// Creates the folder where it is missing. Throws BadData.
void make_folder(const std::string& path);

}  // namespace fairlead::sim
