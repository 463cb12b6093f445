#pragma once
// What the attitude filter thought of itself during a replay, sample by sample, beside the truth
// where a recording has one: the material of the report's figures.
#include <cstdint>
#include <limits>
#include <vector>

#include "fairlead/sense/attitude.hpp"
#include "fairlead/sense/attitude_gyro.hpp"
#include "host_sim/replay/attitude_run.hpp"

namespace fairlead::sim {

struct AttitudePoint {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();

    std::int64_t t_ns{};
    std::uint32_t flags{};
    Vec3 bias_rad_s{};
    double inclination_sigma{none}, heading_sigma{none};  // rad, as the filter reports them
    double field_off_uT{none};  // distance of the field from its reference
    double inclination_error{none}, heading_error{none};  // rad, against the truth; heading signed
    double turn_error{none};                              // rad, whole angle
};

struct AttitudeTrace {
    AttitudeMode mode{AttitudeMode::imu_mag};
    std::vector<AttitudePoint> points;
    bool has_truth{false};
    Score estimate, curve;  // over the movement phase; count is 0 where there is no truth

    template <AttitudeMode of>
    void note(const Pose& pose, const BasicAttitude<float, of>& filter) {
        AttitudePoint p;
        p.t_ns = pose.t_ns;
        p.flags = pose.flags;
        p.bias_rad_s = filter.bias_rad_s();
        if constexpr (of != AttitudeMode::gyro)
            p.inclination_sigma = static_cast<double>(filter.inclination_sigma());
        if constexpr (of == AttitudeMode::imu_mag) {
            p.heading_sigma = static_cast<double>(filter.heading_sigma());
            p.field_off_uT = static_cast<double>(approx::sqrt(filter.state().field.residual2));
        }
        points.push_back(p);
    }
};

/// Fills in the errors of `estimate`, one pose a point. Without a magnetometer heading is relative,
/// and without an accelerometer all of the orientation: the first pose with a truth defines zero.
void add_errors(AttitudeTrace& trace, const Recording& recording,
                const std::vector<Pose>& estimate);

}  // namespace fairlead::sim
