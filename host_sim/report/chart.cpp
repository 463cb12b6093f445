#include "host_sim/report/chart.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::sim {

TimeAxis::TimeAxis(const std::vector<Pose>& poses) {
    if (poses.empty()) return;
    start_ns = poses.front().t_ns;
    end_s = s(poses.back().t_ns);
    period_s = end_s / static_cast<double>(std::max<std::size_t>(poses.size(), 2) - 1);
    if (!(end_s > 0)) end_s = 1;
}

Series line(std::size_t n, const TimeAxis& axis, const Time& t_ns, const Value& value) {
    Series out;
    double last_s = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double t_s = axis.s(t_ns(i));
        if (i > 0 && t_s - last_s > 2.5 * axis.period_s) {
            out.x.push_back((t_s + last_s) / 2);
            out.y.push_back(NAN);
        }
        out.x.push_back(t_s);
        out.y.push_back(value(i));
        last_s = t_s;
    }
    return out;
}

Series series(const std::vector<Pose>& poses, const TimeAxis& axis, const Value& value) {
    return line(
        poses.size(), axis, [&](std::size_t i) { return poses[i].t_ns; }, value);
}

Series styled(Series s, const char* legend, const char* colour, double width, Series::Style style) {
    s.legend = legend;
    s.colour = colour;
    s.width = width;
    s.style = style;
    return s;
}

Series level(double y, const TimeAxis& axis, const char* legend) {
    Series s = styled({}, legend, limit_colour, 1.2, Series::Style::dashed);
    s.x = {0, axis.end_s};
    s.y = {y, y};
    return s;
}

Figure framed(const char* id, const char* title, const char* y_label, const char* caption,
              const TimeAxis& axis) {
    Figure figure;
    figure.id = id;
    figure.title = title;
    figure.y_label = y_label;
    figure.caption = caption;
    figure.x_max = axis.end_s;
    return figure;
}

void add(Figure& figure, const Series& s) { figure.series.push_back(s); }

}  // namespace fairlead::sim
