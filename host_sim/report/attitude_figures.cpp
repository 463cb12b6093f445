#include "host_sim/report/attitude_figures.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::sim {
namespace {

constexpr double deg = 180 / pi_v<double>;
const char* const sigma_colour = "#8a8f98";

using Member = double AttitudePoint::*;

Series line(const AttitudeTrace& trace, const TimeAxis& axis, const Value& value) {
    return line(
        trace.points.size(), axis, [&](std::size_t i) { return trace.points[i].t_ns; }, value);
}

Series line(const AttitudeTrace& trace, const TimeAxis& axis, Member member, double scale) {
    return line(trace, axis, [&, scale](std::size_t i) { return scale * trace.points[i].*member; });
}

/// The largest magnitude once the filter has settled, so that its start does not dwarf the rest.
double settled_peak(const AttitudeTrace& trace, std::initializer_list<Member> members) {
    double most = 0, all = 0;
    for (const AttitudePoint& p : trace.points)
        for (const Member member : members) {
            const double y = std::abs(p.*member);
            if (!std::isfinite(y)) continue;
            all = std::max(all, y);
            if ((p.flags & flag::settling) == 0) most = std::max(most, y);
        }
    return deg * (most > 0 ? most : all > 0 ? all : 1);
}

Figure inclination(const AttitudeTrace& trace, const TimeAxis& axis) {
    Figure figure = framed(
        "inclination_error",
        trace.has_truth ? "Inclination: error and reported standard deviation"
                        : "Inclination: reported standard deviation",
        "deg",
        trace.has_truth ? "Angle between the estimated vertical and the reference's, and what the "
                          "filter's covariance says of it."
                        : "Square root of the covariance that the filter reports; the recording "
                          "has no reference.",
        axis);
    if (trace.has_truth)
        add(figure, styled(line(trace, axis, &AttitudePoint::inclination_error, deg), "error",
                           colours[0], 1));
    add(figure, styled(line(trace, axis, &AttitudePoint::inclination_sigma, deg),
                       "standard deviation", sigma_colour, 1.4, Series::Style::dashed));
    figure.y_min = 0;
    figure.y_max = 1.15 * settled_peak(trace, {&AttitudePoint::inclination_error,
                                               &AttitudePoint::inclination_sigma});
    figure.height = 190;
    return figure;
}

Figure heading(const AttitudeTrace& trace, const TimeAxis& axis) {
    const bool absolute = trace.mode == AttitudeMode::imu_mag;
    const char* caption =
        !absolute ? "Against the reference, counterclockwise from above; zero is where the "
                    "reference begins."
        : trace.has_truth
            ? "Against the reference, counterclockwise from above; dashed: plus and minus what "
              "the filter's covariance says of it."
            : "Square root of the covariance that the filter reports; the recording has no "
              "reference.";
    Figure figure = framed("heading_error",
                           !absolute         ? "Heading: drift without a magnetometer"
                           : trace.has_truth ? "Heading: error and reported standard deviation"
                                             : "Heading: reported standard deviation",
                           "deg", caption, axis);
    if (trace.has_truth)
        add(figure,
            styled(line(trace, axis, &AttitudePoint::heading_error, deg), "error", colours[0], 1));
    if (absolute) {
        const auto sigma = [&](double sign, const char* legend) {
            add(figure, styled(line(trace, axis, &AttitudePoint::heading_sigma, sign * deg), legend,
                               sigma_colour, 1.4, Series::Style::dashed));
        };
        sigma(1, "standard deviation");
        if (trace.has_truth) sigma(-1, "");
    }
    const double most =
        settled_peak(trace, {&AttitudePoint::heading_error, &AttitudePoint::heading_sigma});
    figure.y_max = 1.15 * most;
    figure.y_min = trace.has_truth ? -1.15 * most : 0;
    figure.height = 190;
    return figure;
}

Figure turn(const AttitudeTrace& trace, const TimeAxis& axis) {
    Figure figure =
        framed("turn_error", "Orientation: drift of the gyro alone", "deg",
               "Whole angle against the reference; zero is where the reference begins.", axis);
    add(figure, styled(line(trace, axis, &AttitudePoint::turn_error, deg), "error", colours[0], 1));
    figure.height = 190;
    return figure;
}

Figure bias(const AttitudeTrace& trace, const TimeAxis& axis) {
    Figure figure = framed("gyro_bias", "Gyro bias", "deg/s",
                           "As the filter estimates it: learned at rest, and from gravity in "
                           "motion.",
                           axis);
    const auto one = [&](float Vec3::*component, const char* legend, const char* colour) {
        add(figure,
            styled(line(trace, axis,
                        [&, component](std::size_t i) {
                            return deg * static_cast<double>(trace.points[i].bias_rad_s.*component);
                        }),
                   legend, colour, 1.4));
    };
    one(&Vec3::x, "x", colours[0]);
    one(&Vec3::y, "y", colours[1]);
    one(&Vec3::z, "z", colours[2]);
    figure.height = 190;
    return figure;
}

Figure field(const AttitudeTrace& trace, const TimeAxis& axis) {
    Figure figure = framed("field_distance", "Magnetic field: distance from its reference", "µT",
                           "Low-passed, of the horizontal and vertical part. Beyond the dashed "
                           "line the field counts as disturbed.",
                           axis);
    const double limit = static_cast<double>(AttitudeParams{}.field_disturbed_uT);
    add(figure,
        styled(line(trace, axis, &AttitudePoint::field_off_uT, 1), "distance", colours[0], 1.2));
    add(figure, level(limit, axis, "disturbed"));
    double most = limit;
    for (const AttitudePoint& p : trace.points) most = std::max(most, p.field_off_uT);
    figure.y_min = 0;
    figure.y_max = 1.12 * most;
    figure.height = 170;
    return figure;
}

}  // namespace

void append_attitude_figures(std::vector<Figure>& figures, const AttitudeTrace& trace,
                             const TimeAxis& axis) {
    if (trace.mode == AttitudeMode::gyro) {
        if (trace.has_truth) figures.push_back(turn(trace, axis));
    } else {
        figures.push_back(inclination(trace, axis));
        if (trace.mode == AttitudeMode::imu_mag || trace.has_truth)
            figures.push_back(heading(trace, axis));
    }
    figures.push_back(bias(trace, axis));
    if (trace.mode == AttitudeMode::imu_mag) figures.push_back(field(trace, axis));
}

}  // namespace fairlead::sim
