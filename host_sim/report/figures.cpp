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

BasicQuat<double> wide(const Quat& q) { return {d(q.w), d(q.x), d(q.y), d(q.z)}; }

const std::array<const char*, 3> axes{"x", "y", "z"};

/// Rotation vectors without jumps: of those that mean the same rotation, apart by whole turns, the
/// one that is nearest to the one before.
class Unwrapped {
  public:
    BasicVec3<double> next(const Quat& q) {
        const BasicVec3<double> r =
            rotation_vector(normalised(BasicQuat<double>{d(q.w), d(q.x), d(q.y), d(q.z)}));
        const double angle = norm(r);
        // of no rotation any axis does: that of the vector before
        const BasicVec3<double> axis = angle > 1e-6        ? (1 / angle) * r
                                       : norm(last_) > 1e-6 ? (1 / norm(last_)) * last_
                                                            : BasicVec3<double>{1, 0, 0};
        const double turn = 2 * pi_v<double>;
        const double turns = std::round((dot(axis, last_) - angle) / turn);
        last_ = (angle + turns * turn) * axis;
        return last_;
    }

  private:
    BasicVec3<double> last_{};
};

std::array<double, 3> as_array(const BasicVec3<double>& v) { return {v.x, v.y, v.z}; }

/// Three lines over poses: position in m, or the unwrapped rotation vector in degrees.
std::array<Series, 3> component_series(const std::vector<Pose>& poses, const TimeAxis& axis,
                                       bool position) {
    std::array<std::vector<double>, 3> values;
    Unwrapped unwrapped;
    for (const Pose& pose : poses) {
        const std::uint32_t valid = position ? flag::position_valid : flag::orientation_valid;
        std::array<double, 3> v{none, none, none};
        if ((pose.flags & valid) != 0)
            v = position ? std::array<double, 3>{d(pose.p_w_m.x), d(pose.p_w_m.y), d(pose.p_w_m.z)}
                         : as_array(deg * unwrapped.next(pose.q_wb));
        for (std::size_t k = 0; k < 3; ++k) values[k].push_back(v[k]);
    }
    std::array<Series, 3> out;
    for (std::size_t k = 0; k < 3; ++k)
        out[k] = series(poses, axis, [&](std::size_t i) { return values[k][i]; });
    return out;
}

/// Before and after, component by component.
Figure course(const Replay& replay, const TimeAxis& axis, bool position) {
    Figure figure =
        position ? framed("position", "Position, before and after", "m",
                          "Grey: what the sensor said. Colour: the curve that a reader decodes.",
                          axis)
                 : framed("orientation", "Orientation, before and after", "deg",
                          "Rotation vector from body to world, without jumps at whole turns. Grey: "
                          "before. Colour: the curve that a reader decodes.",
                          axis);
    const std::string source = replay.attitude ? "estimate " : "sensor ";
    const auto before = component_series(replay.raw, axis, position);
    const auto after = component_series(replay.decoded, axis, position);
    for (std::size_t k = 0; k < 3; ++k)
        add(figure, styled(before[k], (source + axes[k]).c_str(), raw_colour, 2.2));
    for (std::size_t k = 0; k < 3; ++k) add(figure, styled(after[k], axes[k], colours[k], 1.2));
    figure.height = 270;
    return figure;
}

/// After minus before, axis by axis; of orientations the rotation between them, in the body frame.
Figure difference(const Replay& replay, const TimeAxis& axis, bool position) {
    Figure figure = position
                        ? framed("position_difference", "Position, after minus before", "mm",
                                 "The decoded curve against what the sensor said: what the filter "
                                 "and the reduction changed.",
                                 axis)
                        : framed("orientation_difference", "Orientation, after minus before", "deg",
                                 "Rotation vector from before to after, in the body frame.", axis);
    const std::uint32_t valid = position ? flag::position_valid : flag::orientation_valid;
    const std::size_t n = std::min(replay.raw.size(), replay.decoded.size());
    std::array<std::vector<double>, 3> values;
    for (std::size_t i = 0; i < n; ++i) {
        const Pose &a = replay.raw[i], &b = replay.decoded[i];
        std::array<double, 3> v{none, none, none};
        if ((a.flags & b.flags & valid) != 0 && position)
            v = {1e3 * (d(b.p_w_m.x) - d(a.p_w_m.x)), 1e3 * (d(b.p_w_m.y) - d(a.p_w_m.y)),
                 1e3 * (d(b.p_w_m.z) - d(a.p_w_m.z))};
        else if ((a.flags & b.flags & valid) != 0)
            v = as_array(deg * rotation_vector(conj(wide(a.q_wb)) * wide(b.q_wb)));
        for (std::size_t k = 0; k < 3; ++k) values[k].push_back(v[k]);
    }
    for (std::size_t k = 0; k < 3; ++k)
        add(figure, styled(line(
                               n, axis, [&](std::size_t i) { return replay.input[i].t_ns; },
                               [&](std::size_t i) { return values[k][i]; }),
                           axes[k], colours[k], 1));
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
                           "Records between a sample and the byte with which a decoder can "
                           "evaluate the final curve at its time.",
                           axis);
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
        figures.push_back(difference(replay, axis, p));
        figures.push_back(errors(replay, axis, p));
    }
    if (replay.attitude) append_attitude_figures(figures, *replay.attitude, axis);
    figures.push_back(delays(replay, axis));
    if (orientation) figures.push_back(accelerations(replay, axis));
    return figures;
}

}  // namespace fairlead::sim
