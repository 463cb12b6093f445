#pragma once
// What the figures of a report share: the time axis, lines over it, levels, colours.
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "fairlead/base/types.hpp"
#include "host_sim/report/plot.hpp"

namespace fairlead::sim {

inline constexpr const char *raw_colour = "#a9b1bc", *limit_colour = "#d9534f",
                            *knot_colour = "#7c6fd0";
inline constexpr std::array<const char*, 4> colours{"#2f7ed8", "#e0803a", "#2fa57c", "#b45fb0"};

/// Seconds from the first record.
struct TimeAxis {
    std::int64_t start_ns{};
    double period_s{}, end_s{};

    TimeAxis() = default;
    explicit TimeAxis(const std::vector<Pose>& poses);
    double s(std::int64_t t_ns) const { return static_cast<double>(t_ns - start_ns) * 1e-9; }
};

using Time = std::function<std::int64_t(std::size_t)>;
using Value = std::function<double(std::size_t)>;  // of record i; NaN: none

/// A line over n records; broken where records are missing.
Series line(std::size_t n, const TimeAxis& axis, const Time& t_ns, const Value& value);
Series series(const std::vector<Pose>& poses, const TimeAxis& axis, const Value& value);

Series styled(Series s, const char* legend, const char* colour, double width,
              Series::Style style = Series::Style::line);
/// A dashed line across the whole figure.
Series level(double y, const TimeAxis& axis, const char* legend);

Figure framed(const char* id, const char* title, const char* y_label, const char* caption,
              const TimeAxis& axis);
void add(Figure& figure, const Series& s);

}  // namespace fairlead::sim
