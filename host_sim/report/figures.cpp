#include "host_sim/report/figures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "fairlead/math/quat.hpp"
#include "host_sim/report/attitude_figures.hpp"
#include "host_sim/report/chart.hpp"

namespace fairlead::sim {
namespace {

constexpr double deg = 180 / pi_v<double>;
constexpr double none = NAN;

double d(float x) { return static_cast<double>(x); }

double component(const Pose& pose, std::size_t i) {  // 0..2: position, 3..6: quaternion
    const std::array<float, 7> v{pose.p_w_m.x, pose.p_w_m.y, pose.p_w_m.z, pose.q_wb.w,
                                 pose.q_wb.x,  pose.q_wb.y,  pose.q_wb.z};
    return d(v[i]);
}

std::uint32_t channel_of(std::size_t component_index) {
    return component_index < 3 ? flag::position_valid : flag::orientation_valid;
}

Series component_series(const std::vector<Pose>& poses, const TimeAxis& axis, std::size_t i,
                        double scale) {
    double sign = 1;  // quaternions: continuous, whatever the sensor does
    const Pose* last = nullptr;
    return series(poses, axis, [&, scale, i](std::size_t k) {
        const Pose& pose = poses[k];
        if ((pose.flags & channel_of(i)) == 0) return none;
        if (i >= 3 && last != nullptr && dot(last->q_wb, pose.q_wb) < 0) sign = -sign;
        last = &pose;
        return scale * sign * component(pose, i);
    });
}

/// Brings a decoded quaternion component to the side of the raw one.
void align(Series& series, const Series& to) {
    double dot = 0;
    for (std::size_t i = 0; i < std::min(series.y.size(), to.y.size()); ++i)
        if (std::isfinite(series.y[i] * to.y[i])) dot += series.y[i] * to.y[i];
    if (dot < 0)
        for (double& y : series.y) y = -y;
}

Series knots(const ChannelResult& channel, const TimeAxis& axis) {
    Series s = styled({}, "knots", knot_colour, 0.8, Series::Style::rug);
    for (const std::int64_t t_ns : channel.knot_ns) s.x.push_back(axis.s(t_ns));
    return s;
}

/// Before and after, component by component, with the knots on the time axis.
Figure course(const Replay& replay, const TimeAxis& axis, bool position) {
    Figure figure =
        position
            ? framed("position", "Position, before and after", "m",
                     "Grey: what the sensor said. Colour: the curve a reader decodes. Each tick "
                     "on the time axis is a knot.",
                     axis)
            : framed("orientation", "Orientation, before and after", "quaternion",
                     "The four components of the unit quaternion that takes body to world.", axis);
    const char* source = replay.attitude ? "estimate" : "sensor";
    const std::array<const char*, 7> names{"x", "y", "z", "w", "x", "y", "z"};
    const std::size_t first = position ? 0 : 3, end = position ? 3 : 7;
    std::vector<Series> after;
    for (std::size_t i = first; i < end; ++i) {
        const Series before = component_series(replay.raw, axis, i, 1);
        Series curve = component_series(replay.decoded, axis, i, 1);
        if (!position) align(curve, before);
        add(figure, styled(before, i == first ? source : "", raw_colour, 2.6));
        after.push_back(styled(curve, names[i], colours[i - first], 1.2));
    }
    for (const Series& s : after) add(figure, s);
    add(figure, knots(position ? replay.position : replay.orientation, axis));
    if (!position) figure.y_min = -1.2, figure.y_max = 1.1;
    figure.height = 270;
    return figure;
}

/// Start of the stretch of `length_s` in which the curve has most knots.
double busiest_s(const ChannelResult& channel, const TimeAxis& axis, double length_s) {
    const auto& t = channel.knot_ns;
    double best_s = 0;
    std::size_t most = 0;
    for (std::size_t i = 0, j = 0; i < t.size(); ++i) {
        while (j < t.size() && axis.s(t[j]) < axis.s(t[i]) + length_s) ++j;
        if (j - i > most) most = j - i, best_s = axis.s(t[i]);
    }
    return std::clamp(best_s - 0.05 * length_s, 0.0, std::max(0.0, axis.end_s - length_s));
}

/// The samples as dots, the curve as a line, over the three seconds with most knots.
Figure close_up(const Replay& replay, const TimeAxis& axis, bool position) {
    const ChannelResult& channel = position ? replay.position : replay.orientation;
    const double length_s = std::min(3.0, axis.end_s);
    Figure figure =
        position ? framed("position_close", "Close-up of the position", "mm",
                          "The stretch with most knots. Dots: the reducer's input, relative to the "
                          "first of them.",
                          axis)
                 : framed("orientation_close", "Close-up of the orientation", "deg",
                          "Rotation vector relative to the first sample of the stretch.", axis);
    figure.x_min = busiest_s(channel, axis, length_s);
    figure.x_max = figure.x_min + length_s;
    const std::uint32_t valid = position ? flag::position_valid : flag::orientation_valid;
    const auto starts = [&](const Pose& pose) {
        return axis.s(pose.t_ns) >= figure.x_min && (pose.flags & valid) != 0;
    };
    const auto origin = std::find_if(replay.input.begin(), replay.input.end(), starts);
    if (origin == replay.input.end()) return figure;
    const auto relative = [&](const std::vector<Pose>& poses, std::size_t axis_index) {
        return series(poses, axis, [&, axis_index](std::size_t k) {
            if ((poses[k].flags & valid) == 0) return none;
            const Vec3 p = poses[k].p_w_m - origin->p_w_m;
            const Vec3 r = rotation_vector(conj(origin->q_wb) * poses[k].q_wb);
            const std::array<float, 3> v = position ? std::array<float, 3>{p.x, p.y, p.z}
                                                    : std::array<float, 3>{r.x, r.y, r.z};
            return d(v[axis_index]) * (position ? 1e3 : deg);
        });
    };
    const std::array<const char*, 3> names{"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i)
        add(figure, styled(relative(replay.input, i), i == 0 ? "input samples" : "", raw_colour,
                           1.4, Series::Style::dots));
    for (std::size_t i = 0; i < 3; ++i)
        add(figure, styled(relative(replay.decoded, i), names[i], colours[i], 1.4));
    Series rug = knots(channel, axis);
    rug.width = 1.6;
    add(figure, rug);
    return figure;
}

Figure errors(const Replay& replay, const TimeAxis& axis, bool position) {
    const ChannelResult& channel = position ? replay.position : replay.orientation;
    const double tolerance =
        position ? replay.options.tol_pos_m * 1e3 : replay.options.tol_rot_rad * deg;
    Figure figure =
        position ? framed("position_error", "Position error against tolerance", "mm",
                          "Largest axis, the decoded curve against the reducer's input, at every "
                          "sample.",
                          axis)
                 : framed("orientation_error", "Orientation error against tolerance", "deg",
                          "Full rotation angle, the decoded curve against the reducer's input, at "
                          "every sample.",
                          axis);
    const double scale = position ? 1e3 : deg;
    add(figure,
        styled(series(replay.input, axis, [&](std::size_t i) { return scale * channel.error[i]; }),
               "error", colours[0], 1));
    add(figure, level(tolerance, axis, "tolerance"));
    figure.y_max = 1.12 * std::max(tolerance, scale * channel.max_error);
    figure.height = 180;
    return figure;
}

Figure delays(const Replay& replay, const TimeAxis& axis) {
    Figure figure = framed("delay", "Delay until a reader can use the curve", "records",
                           "Records from a sample to the byte that lets a decoder evaluate the "
                           "final curve there, frames and filter-free.",
                           axis);
    figure.caption =
        "Records between a sample and the byte with which a decoder can evaluate the final curve "
        "at "
        "its time.";
    const auto one = [&](const ChannelResult& channel, const char* legend, const char* colour) {
        if (channel.samples == 0) return;
        add(figure, styled(series(replay.input, axis,
                                  [&](std::size_t i) {
                                      return std::isnan(channel.error[i])
                                                 ? none
                                                 : static_cast<double>(channel.delay[i]);
                                  }),
                           legend, colour, 1));
    };
    one(replay.position, "position", colours[0]);
    one(replay.orientation, "orientation", colours[1]);
    add(figure, level(replay.options.delay_max, axis, "largest allowed"));
    figure.y_max = 1.12 * replay.options.delay_max;
    figure.height = 180;
    return figure;
}

/// |second difference| of the orientations, rad/s^2: the same formula before and after.
Series angular_acceleration(const std::vector<Pose>& poses, const TimeAxis& axis) {
    return series(poses, axis, [&](std::size_t i) {
        if (i == 0 || i + 1 >= poses.size()) return none;
        const Pose &a = poses[i - 1], &b = poses[i], &c = poses[i + 1];
        if ((a.flags & b.flags & c.flags & flag::orientation_valid) == 0) return none;
        const double before_s = axis.s(b.t_ns) - axis.s(a.t_ns);
        const double after_s = axis.s(c.t_ns) - axis.s(b.t_ns);
        if (std::max(before_s, after_s) > 2.5 * axis.period_s) return none;
        const auto rate = [](const Pose& p, const Pose& q, double s) {
            const auto wide = [](const Quat& x) {
                return BasicQuat<double>{d(x.w), d(x.x), d(x.y), d(x.z)};
            };
            return (1 / s) * rotation_vector(conj(wide(p.q_wb)) * wide(q.q_wb));
        };
        const auto change = rate(b, c, after_s) - rate(a, b, before_s);
        return std::max(norm(change) * 2 / (before_s + after_s), 1e-3);
    });
}

Figure accelerations(const Replay& replay, const TimeAxis& axis) {
    Figure figure =
        framed("acceleration", "Angular acceleration, before and after", "rad/s²",
               "Second differences of the orientation at the sample times: what a motor "
               "or an eye would feel.",
               axis);
    add(figure, styled(angular_acceleration(replay.raw, axis),
                       replay.attitude ? "estimate" : "sensor", raw_colour, 1));
    add(figure, styled(angular_acceleration(replay.decoded, axis), "curve", colours[0], 1));
    figure.log_y = true;
    double low = INFINITY, high = 0;
    for (const Series& s : figure.series)
        for (const double y : s.y)
            if (std::isfinite(y)) low = std::min(low, y), high = std::max(high, y);
    figure.y_min = std::max(1e-2, low / 1.5);
    figure.y_max = std::max(high * 1.5, 1.0);
    return figure;
}

}  // namespace

std::vector<Figure> figures_of(const Replay& replay) {
    const TimeAxis axis{replay.input};
    const bool position = replay.position.samples > 0, orientation = replay.orientation.samples > 0;
    std::vector<Figure> figures;
    for (const bool p : {true, false}) {
        if (!(p ? position : orientation)) continue;
        figures.push_back(course(replay, axis, p));
        figures.push_back(close_up(replay, axis, p));
        figures.push_back(errors(replay, axis, p));
    }
    if (replay.attitude) append_attitude_figures(figures, *replay.attitude, axis);
    figures.push_back(delays(replay, axis));
    if (orientation) figures.push_back(accelerations(replay, axis));
    return figures;
}

}  // namespace fairlead::sim
