// fairlead-sim allan IN: the noise of a sensor, from its longest rest.
#include "host_sim/report/allan.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

#include "fairlead/math/vec.hpp"
#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"
#include "host_sim/report/chart.hpp"
#include "host_sim/report/page.hpp"

namespace fairlead::sim {
namespace {

struct Options {
    InputOptions input;
    std::string plot, csv;
};

struct Channel {
    const char* name;
    const char* unit;
    double scale;  // to the unit
    std::vector<double> values;
};

std::array<Channel, 6> channels_of(const Recording& recording, const Stretch& rest) {
    constexpr double to_deg = 57.295779513082320877;
    std::array<Channel, 6> out{{{"gyro x", "deg/s", to_deg, {}},
                                {"gyro y", "deg/s", to_deg, {}},
                                {"gyro z", "deg/s", to_deg, {}},
                                {"accel x", "m/s^2", 1, {}},
                                {"accel y", "m/s^2", 1, {}},
                                {"accel z", "m/s^2", 1, {}}}};
    for (std::size_t i = rest.first; i < rest.last; ++i) {
        const Vec3 &g = recording.samples[i].gyro_rad_s, &a = recording.samples[i].accel_m_s2;
        const float values[] = {g.x, g.y, g.z, a.x, a.y, a.z};
        for (std::size_t c = 0; c < out.size(); ++c)
            out[c].values.push_back(out[c].scale * static_cast<double>(values[c]));
    }
    return out;
}

Figure figure_of(const std::string& id, const std::string& sensor, const std::string& unit) {
    Figure figure;
    figure.id = id;
    figure.title = "Allan deviation of the " + sensor;
    figure.y_label = unit;
    figure.caption =
        "Over the averaging time. Dashed: the white noise that is read off the first decade; noise "
        "that is white throughout stays on it.";
    figure.log_x = figure.log_y = true;
    figure.height = 340;
    return figure;
}

void add_curve(Figure& figure, const std::vector<AllanPoint>& points, const AllanFigures& f,
               const char* axis, const char* colour) {
    Series curve, white;
    curve.legend = axis;
    curve.colour = white.colour = colour;
    curve.width = 1.8;
    white.style = Series::Style::dashed;
    for (const AllanPoint& p : points) {
        curve.x.push_back(p.tau_s);
        curve.y.push_back(p.deviation);
        white.x.push_back(p.tau_s);
        white.y.push_back(f.density / std::sqrt(p.tau_s));
    }
    const auto [low, high] = std::minmax_element(curve.y.begin(), curve.y.end());
    figure.x_min = curve.x.front();
    figure.x_max = curve.x.back();
    figure.y_min = figure.series.empty() ? 0.5 * *low : std::min(figure.y_min, 0.5 * *low);
    figure.y_max = std::max(figure.y_max, 2 * *high);
    figure.series.push_back(curve);
    figure.series.push_back(white);
}

/// The longest rest, or BadData.
Stretch rest_of(const Recording& recording) {
    if (recording.samples.empty()) throw BadData(recording.name + ": holds no IMU samples");
    if (!(recording.period_s > 0)) throw BadData(recording.name + ": holds no two times");
    std::vector<double> speed;  // NaN, which is no rest, where a reading is missing
    for (const Sample& s : recording.samples)
        speed.push_back(static_cast<double>(norm(s.gyro_rad_s) + 0 * norm(s.accel_m_s2)));
    constexpr double quiet_rad_s = 0.03;
    const Stretch rest = longest_rest(speed, recording.period_s, quiet_rad_s);
    if (static_cast<double>(rest.last - rest.first) * recording.period_s < 5)
        throw BadData(recording.name + ": no rest of at least 5 s");
    return rest;
}

void run(const Options& o) {
    const Recording recording = o.input.read();
    const Stretch rest = rest_of(recording);
    std::array<char, 80> found{};
    std::snprintf(found.data(), found.size(), "rest from %.1f s, %.1f s long",
                  static_cast<double>(rest.first) * recording.period_s,
                  static_cast<double>(rest.last - rest.first) * recording.period_s);
    std::printf("%s\n", found.data());
    std::printf("%-8s %-6s %14s %14s %10s %14s\n", "", "unit", "density /rtHz", "instability",
                "at tau s", "walk /rt s");
    std::vector<Figure> figures{figure_of("allan_gyro", "gyro", "deg/s"),
                                figure_of("allan_accel", "accelerometer", "m/s²")};
    std::string csv = "channel,tau_s,deviation\n";
    const auto channels = channels_of(recording, rest);
    Progress progress{"allan", channels.size(), "axes"};
    for (std::size_t c = 0; c < channels.size(); ++c) {
        progress.show(c);
        const Channel& channel = channels[c];
        const auto points = allan_deviation(channel.values, recording.period_s);
        const AllanFigures f = allan_figures(points);
        std::printf("%-8s %-6s %14.6f %14.6f %10.2f", channel.name, channel.unit, f.density,
                    f.instability, f.instability_tau_s);
        if (f.walk > 0)
            std::printf(" %14.6f\n", f.walk);
        else
            std::printf(" %14s\n", "not seen");
        for (const AllanPoint& p : points) {
            char line[80];
            std::snprintf(line, sizeof line, "%s,%.9g,%.9g\n", channel.name, p.tau_s, p.deviation);
            csv += line;
        }
        constexpr std::array<const char*, 3> axes{"x", "y", "z"};
        add_curve(figures[c / 3], points, f, axes[c % 3], colours[c % 3]);
    }
    if (!o.csv.empty()) write_bytes(o.csv, csv);
    if (o.plot.empty()) return;
    std::string page = page_head(recording.name);
    page += std::string("<p class=\"lead\">Noise of the sensors: ") + found.data() + ".</p>\n";
    if (!append_figures(page, figures))
        throw BadData("gnuplot cannot be run: no plot (Debian: gnuplot-nox)");
    write_bytes(o.plot, page + page_foot("fairlead-sim allan"));
}

}  // namespace

void add_allan(CLI::App& app) {
    auto* command = app.add_subcommand("allan", "Noise figures from a recording's longest rest");
    auto o = std::make_shared<Options>();
    o->input.add_to(*command);
    command->add_option("--plot", o->plot, "HTML page with the usual plot");
    command->add_option("--csv", o->csv, "Also write channel,tau_s,deviation");
    command->callback([o] { run(*o); });
}

}  // namespace fairlead::sim
