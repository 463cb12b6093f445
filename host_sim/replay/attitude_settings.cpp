#include "host_sim/replay/attitude_settings.hpp"

#include <algorithm>
#include <array>

#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {
namespace {

struct Setting {
    const char* name;
    float AttitudeParams::*value;
};

constexpr std::array settings{
    Setting{"step_s", &AttitudeParams::step_s},
    Setting{"align_s", &AttitudeParams::align_s},
    Setting{"gap_periods", &AttitudeParams::gap_periods},
    Setting{"gap_s_max", &AttitudeParams::gap_s_max},
    Setting{"rate_walk", &AttitudeParams::rate_walk},
    Setting{"gyro_noise", &AttitudeParams::gyro_noise},
    Setting{"gyro_scale_noise", &AttitudeParams::gyro_scale_noise},
    Setting{"bias_rad_s", &AttitudeParams::bias_rad_s},
    Setting{"bias_max_rad_s", &AttitudeParams::bias_max_rad_s},
    Setting{"bias_walk", &AttitudeParams::bias_walk},
    Setting{"bias_trend_s", &AttitudeParams::bias_trend_s},
    Setting{"bias_trend_sigma", &AttitudeParams::bias_trend_sigma},
    Setting{"bias_trend_max", &AttitudeParams::bias_trend_max},
    Setting{"clock_error", &AttitudeParams::clock_error},
    Setting{"scale_error", &AttitudeParams::scale_error},
    Setting{"misalignment", &AttitudeParams::misalignment},
    Setting{"gyro_full_scale_rad_s", &AttitudeParams::gyro_full_scale_rad_s},
    Setting{"accel_full_scale_m_s2", &AttitudeParams::accel_full_scale_m_s2},
    Setting{"velocity_m_s", &AttitudeParams::velocity_m_s},
    Setting{"velocity_s", &AttitudeParams::velocity_s},
    Setting{"accel_noise", &AttitudeParams::accel_noise},
    Setting{"accel_offset_m_s2", &AttitudeParams::accel_offset_m_s2},
    Setting{"accel_zero_m_s2", &AttitudeParams::accel_zero_m_s2},
    Setting{"restless_s", &AttitudeParams::restless_s},
    Setting{"restless_memory_s", &AttitudeParams::restless_memory_s},
    Setting{"restless_gain", &AttitudeParams::restless_gain},
    Setting{"restless_knee", &AttitudeParams::restless_knee},
    Setting{"restless_max", &AttitudeParams::restless_max},
    Setting{"restless_tilt", &AttitudeParams::restless_tilt},
    Setting{"drive_s", &AttitudeParams::drive_s},
    Setting{"force_s", &AttitudeParams::force_s},
    Setting{"verify_s", &AttitudeParams::verify_s},
    Setting{"force_tilt", &AttitudeParams::force_tilt},
    Setting{"force_lost", &AttitudeParams::force_lost},
    Setting{"force_lost_s", &AttitudeParams::force_lost_s},
    Setting{"verify_gap_s", &AttitudeParams::verify_gap_s},
    Setting{"dead_axis_s", &AttitudeParams::dead_axis_s},
    Setting{"dead_sensor_s", &AttitudeParams::dead_sensor_s},
    Setting{"dead_rate_rad_s", &AttitudeParams::dead_rate_rad_s},
    Setting{"rest_s", &AttitudeParams::rest_s},
    Setting{"rest_window_s", &AttitudeParams::rest_window_s},
    Setting{"rest_gyro_rad_s", &AttitudeParams::rest_gyro_rad_s},
    Setting{"rest_accel_m_s2", &AttitudeParams::rest_accel_m_s2},
    Setting{"rest_noise_max", &AttitudeParams::rest_noise_max},
    Setting{"rest_rate_rad_s", &AttitudeParams::rest_rate_rad_s},
    Setting{"rest_gate", &AttitudeParams::rest_gate},
    Setting{"rest_gate_rad_s", &AttitudeParams::rest_gate_rad_s},
    Setting{"rest_field_uT", &AttitudeParams::rest_field_uT},
    Setting{"rest_tilt", &AttitudeParams::rest_tilt},
    Setting{"rest_velocity_m_s", &AttitudeParams::rest_velocity_m_s},
    Setting{"rest_velocity_s", &AttitudeParams::rest_velocity_s},
    Setting{"field_uT", &AttitudeParams::field_uT},
    Setting{"field_s", &AttitudeParams::field_s},
    Setting{"field_residual_s", &AttitudeParams::field_residual_s},
    Setting{"field_start_uT", &AttitudeParams::field_start_uT},
    Setting{"field_memory_s", &AttitudeParams::field_memory_s},
    Setting{"field_rest", &AttitudeParams::field_rest},
    Setting{"field_disturbed_uT", &AttitudeParams::field_disturbed_uT},
    Setting{"field_next_s", &AttitudeParams::field_next_s},
    Setting{"field_young_s", &AttitudeParams::field_young_s},
    Setting{"field_young_doubt_s", &AttitudeParams::field_young_doubt_s},
    Setting{"field_change_s", &AttitudeParams::field_change_s},
    Setting{"field_offset", &AttitudeParams::field_offset},
    Setting{"sigma_scale", &AttitudeParams::sigma_scale},
    Setting{"settled_tilt", &AttitudeParams::settled_tilt},
    Setting{"settled_heading", &AttitudeParams::settled_heading},
};
// every parameter is a float: one that is added must be named above
static_assert(sizeof(AttitudeParams) == settings.size() * sizeof(float));

}  // namespace

std::vector<std::string> attitude_setting_names() {
    std::vector<std::string> out;
    for (const Setting& s : settings) out.emplace_back(s.name);
    return out;
}

void apply_settings(AttitudeParams& params, const std::vector<std::string>& items) {
    for (const std::string& item : items) {
        const auto parts = split(item, '=');
        const auto found = std::find_if(settings.begin(), settings.end(), [&](const Setting& s) {
            return parts.size() == 2 && parts[0] == s.name;
        });
        if (found == settings.end())
            throw BadSpec("'" + item + "' is not NAME=VALUE with the name of a parameter");
        params.*(found->value) = static_cast<float>(parse_real(parts[1]));
    }
    if (check(params) != Status::ok)
        throw BadSpec("a parameter of the filter is out of its range (docs/attitude.md)");
}

}  // namespace fairlead::sim
