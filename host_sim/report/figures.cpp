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

/// Rotation vectors without jumps: the principal one plus the whole turns that it has jumped back
/// by, each about the axis of its time. Near no rotation the axis is noise, so that only a vector
/// of more than a radian can have jumped.
class Unwrapped {
  public:
    using Vector = BasicVec3<double>;

    Vector next(const Quat& q) {
        last_ = nearest(q);
        turns_ = last_ - rotation_vector(normalised(wide(q)));
        return last_;
    }
    /// Another rotation at the same time, as near to the last one as whole turns can bring it.
    Vector nearest(const Quat& q) const {
        const Vector r = rotation_vector(normalised(wide(q)));
        const double angle = norm(r);
        Vector best = r + turns_;
        if (angle < 1) return best;
        for (const double sign : {-1.0, 1.0}) {
            const Vector other = r + turns_ + (sign * 2 * pi_v<double> / angle) * r;
            if (norm(other - last_) < norm(best - last_)) best = other;
        }
        return best;
    }

  private:
    Vector last_{}, turns_{};
};

std::array<double, 3> as_array(const BasicVec3<double>& v) { return {v.x, v.y, v.z}; }

using Components = std::array<std::vector<double>, 3>;

/// Position in m, or the rotation vector in degrees, before and after.
void components(const Replay& replay, bool position, Components& before, Components& after) {
    const std::uint32_t valid = position ? flag::position_valid : flag::orientation_valid;
    Unwrapped unwrapped;
    const auto put = [](Components& out, const std::array<double, 3>& v) {
        for (std::size_t k = 0; k < 3; ++k) out[k].push_back(v[k]);
    };
    const auto place = [](const Pose& pose) {
        return std::array<double, 3>{d(pose.p_w_m.x), d(pose.p_w_m.y), d(pose.p_w_m.z)};
    };
    const std::array<double, 3> missing{none, none, none};
    for (std::size_t i = 0; i < replay.raw.size(); ++i) {
        const Pose& pose = replay.raw[i];
        const bool known = (pose.flags & valid) != 0;
        put(before, !known     ? missing
                    : position ? place(pose)
                               : as_array(deg * unwrapped.next(pose.q_wb)));
        if (i >= replay.decoded.size()) continue;
        const Pose& curve = replay.decoded[i];
        put(after, (curve.flags & valid) == 0 ? missing
                   : position                 ? place(curve)
                                              : as_array(deg * unwrapped.nearest(curve.q_wb)));
    }
}

/// Before and after, component by component.
Figure course(const Replay& replay, const TimeAxis& axis, bool position) {
    Figure figure =
        position
            ? framed("position", "Position, before and after", "m",
                     "Grey: what the sensor said. Colour: the curve that a reader decodes.", axis)
            : framed("orientation", "Orientation, before and after", "deg",
                     "Rotation vector from body to world, without jumps at whole turns. Grey: "
                     "before. Colour: the curve that a reader decodes.",
                     axis);
    const std::string source = replay.attitude ? "estimate " : "sensor ";
    Components before, after;
    components(replay, position, before, after);
    const auto lines = [&](const std::vector<Pose>& poses, const Components& values,
                           const std::string& name, const char* colour, double width) {
        for (std::size_t k = 0; k < 3; ++k)
            add(figure,
                styled(series(poses, axis, [&](std::size_t i) { return values[k][i]; }),
                       (name + axes[k]).c_str(), colour != nullptr ? colour : colours[k], width));
    };
    lines(replay.raw, before, source, raw_colour, 2.2);
    lines(replay.decoded, after, "", nullptr, 1.2);
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
