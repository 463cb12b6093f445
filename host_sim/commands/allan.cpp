// fairlead-sim allan IN: the noise of a sensor, from its longest rest.
#include "host_sim/allan.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

#include "fairlead/math/vec.hpp"
#include "host_sim/commands/commands.hpp"
#include "host_sim/commands/options.hpp"
#include "host_sim/report/plot.hpp"

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

Figure figure_of(const std::string& id, const std::string& unit) {
    Figure figure;
    figure.id = id;
    figure.title =
        "Allan deviation of the " + id + ", " + unit + ", over log10(averaging time / s)";
    figure.y_label = unit;
    figure.log_y = true;
    figure.height = 320;
    return figure;
}

void run(const Options& o) {
    const Recording recording = o.input.read();
    if (recording.samples.empty()) throw BadData(recording.name + ": holds no IMU samples");
    std::vector<double> speed;
    for (const Sample& s : recording.samples)
        speed.push_back(static_cast<double>(norm(s.gyro_rad_s)));
    constexpr double quiet_rad_s = 0.03;
    const Stretch rest = longest_rest(speed, recording.period_s, quiet_rad_s);
    const double seconds = static_cast<double>(rest.last - rest.first) * recording.period_s;
    if (seconds < 5) throw BadData(recording.name + ": no rest of at least 5 s");

    std::printf("rest from %.1f s, %.1f s long\n",
                static_cast<double>(rest.first) * recording.period_s, seconds);
    std::printf("%-8s %-6s %14s %14s %10s %14s\n", "", "unit", "density /rtHz", "instability",
                "at tau s", "walk /rt s");
    std::array<Figure, 2> figures{figure_of("gyro", "deg/s"), figure_of("accelerometer", "m/s^2")};
    const char* colours[] = {"#c0392b", "#27864f", "#2c5f9e"};
    std::string csv = "channel,tau_s,deviation\n";
    const auto channels = channels_of(recording, rest);
    for (std::size_t c = 0; c < channels.size(); ++c) {
        const Channel& channel = channels[c];
        const auto points = allan_deviation(channel.values, recording.period_s);
        const AllanFigures f = allan_figures(points);
        std::printf("%-8s %-6s %14.6f %14.6f %10.2f", channel.name, channel.unit, f.density,
                    f.instability, f.instability_tau_s);
        if (f.walk > 0)
            std::printf(" %14.6f\n", f.walk);
        else
            std::printf(" %14s\n", "not seen");
        Series series;
        series.legend = channel.name;
        series.colour = colours[c % 3];
        for (const AllanPoint& p : points) {
            series.x.push_back(std::log10(p.tau_s));
            series.y.push_back(p.deviation);
            csv += std::string(channel.name) + "," + std::to_string(p.tau_s) + "," +
                   std::to_string(p.deviation) + "\n";
        }
        Figure& figure = figures[c / 3];
        figure.x_min = series.x.front();
        figure.x_max = series.x.back();
        const auto [low, high] = std::minmax_element(series.y.begin(), series.y.end());
        figure.y_min = figure.series.empty() ? 0.7 * *low : std::min(figure.y_min, 0.7 * *low);
        figure.y_max = std::max(figure.y_max, 1.4 * *high);
        figure.series.push_back(series);
    }
    if (!o.csv.empty()) write_bytes(o.csv, csv);
    if (o.plot.empty()) return;
    std::string page = "<!doctype html><meta charset=\"utf-8\"><title>Allan deviation of " +
                       recording.name + "</title>\n";
    for (const std::string& svg : draw({figures[0], figures[1]})) {
        if (svg.empty()) throw BadData("gnuplot cannot be run: no plot (Debian: gnuplot-nox)");
        page +=
            "<p>Allan deviation over log10 of the averaging time in s; red x, green y, blue z</p>" +
            svg;
    }
    write_bytes(o.plot, page);
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
