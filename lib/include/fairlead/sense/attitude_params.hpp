#pragma once
// What the attitude filter assumes about the sensor, the motion and the field: SI units, defaults
// for consumer MEMS sensors on a hand, a body or a vehicle. Where each number comes from, and what
// changing it costs: docs/attitude.md.
#include <array>

#include "fairlead/base/check.hpp"

namespace fairlead {

struct AttitudeParams {
    static constexpr float deg = 0.01745329252f;

    // ---- time
    float step_s = 0.08f;      // the Kalman step; gyro and accelerometer run at full rate
    float align_s = 0.7f;      // first levelling
    float gap_periods = 1.5f;  // a longer time step is a gap: the rate in it is taken as linear
    float gap_s_max = 0.4f;    // a longer one loses the orientation: align again
    float rate_walk = 0.5f;    // rad/s/sqrt(s): how the rate may wander within a gap

    // ---- gyro errors, standard deviations
    float gyro_noise = 0.01f * deg;      // rad/sqrt(s), white
    float gyro_scale_noise = 0.003f;     // rad/sqrt(rad turned): what no constant matrix explains
    float bias_rad_s = 0.95f * deg;      // prior: what a start in motion assumes
    float bias_max_rad_s = 25.0f * deg;  // limit: a rest may show as much, never believed beyond
    float bias_walk = 0.01f * deg;       // rad/s/sqrt(s)
    float bias_trend_s = 12.0f;          // corrections that keep their sign so long show a drift,
    float bias_trend_sigma = 2.0f;       // where they exceed so many sigmas of white ones,
    float bias_trend_max = 0.06f * deg;  // and raise bias_walk up to this
    float clock_error = 0.008f;          // common to the three axes: the sensor's oscillator
    float scale_error = 0.008f;          // per axis
    float misalignment = 0.002f;         // rad

    // ---- ranges, of the readings as they come to the filter; 0: not known, flags speak (clip.hpp)
    float gyro_full_scale_rad_s = 0;
    float accel_full_scale_m_s2 = 0;
    float accel_beyond = 0.2f;  // of a clipped reading: what it misses on average

    // ---- motion: a body's velocity stays bounded, which is what makes gravity visible
    float velocity_m_s = 0.7f;        // standard deviation of the horizontal velocity, 0.1 to 30
    float velocity_s = 0.5f;          // its correlation time
    float accel_noise = 0.05f;        // m/s^2 sqrt(s)
    float accel_offset_m_s2 = 0.03f;  // error of a calibrated zero, an axis: in the report only
    float accel_zero_m_s2 = 0.3f;     // of an uncalibrated one: in the heading's report, by the dip

    // ---- sustained motion (running, flying, riding) shows as a slow innovation of the velocity
    // and raises its variance, so that it is taken neither for tilt nor for bias
    float restless_s = 1.0f;          // what lasts longer is motion, not noise
    float restless_memory_s = 12.0f;  // its mean square r is taken over this time
    float restless_gain = 3.0f;       // variance * time >= 2 gain restless_s r (1 + knee r)
    float restless_knee = 2.0f;       // 1/(m/s)^2
    float restless_max = 25.0f;       // at most so many times the usual variance
    float restless_tilt = 0.03f;      // rad of tilt per m/s beyond 1 m/s: in the report only
    float shake_m_s2 = 8.0f;          // a runner's: before the first rest such motion teaches less
    float cruise_s = 10.0f;   // a velocity that turns with the body is known after this time
    float cruise_m_s = 0.7f;  // if it is so large: a hand's motion does not count
    float drive_s = 0.5f;     // a reading of the speed input serves for so long

    // ---- contradictions
    float force_s = 1.5f;            // the specific force is averaged over this time
    float verify_s = 0.5f;           // after readings that were lost or wrong: over this time
    float force_tilt = 15.0f * deg;  // its mean so far from the vertical: flag::settling
    float force_lost = 30.0f * deg;  // and so far, for force_lost_s: the inclination is lost
    float force_lost_s = 5.0f;
    float prove_s = 6.0f;  // a start in motion: for so long nothing may contradict the inclination
    float corrected_s = 5.0f;          // the sum of the tilt's corrections over this time,
    float corrected_max = 3.5f * deg;  // if larger: flag::settling, and prove_s begins anew
    float verify_gap_s = 0.15f;        // a gap, or blind gyro, so long: the inclination is verified
    float held_s = 0.035f;             // a gyro that repeats itself in motion so long may be frozen
    float dead_axis_s = 0.25f;         // a gyro axis that repeats its reading in motion is dead
    float dead_sensor_s = 0.1f;        // a whole sensor likewise
    float dead_rate_rad_s = 0.5f * deg;  // at a rate farther from the bias than this

    // ---- rest
    float rest_s = 1.5f;                  // quiet for so long
    float rest_window_s = 0.5f;           // deviations are from a mean over this time
    float rest_gyro_rad_s = 2.0f * deg;   // a smaller deviation is quiet
    float rest_accel_m_s2 = 0.5f;         // likewise
    float rest_noise_max = 3.0f;          // a noisy sensor may raise the two so many times
    float rest_rate_rad_s = 0.03f * deg;  // error of the mean rate over rest_window_s
    float rest_gate = 3.0f;               // sigmas of the known bias that a rest may contradict
    float rest_gate_rad_s = 0.2f * deg;   // and so much beside
    float rest_field_uT = 1.0f;           // the field moved so far in the body: no rest
    float rest_tilt = 1.0f * deg;         // gravity moved so far in the body: no rest
    float rest_velocity_m_s = 0.02f;
    float rest_velocity_s = 0.1f;

    // ---- magnetic field
    float field_uT = 1.0f;            // noise and small disturbances
    float field_s = 3.0f;             // their correlation time
    float field_residual_s = 0.5f;    // the distance from the reference is averaged over this time
    float field_start_uT = 3.0f;      // error of a reference that rests on one field_s
    float field_memory_s = 300.0f;    // of the reference
    float field_rest = 10.0f;         // at rest the reference learns so much faster
    float field_disturbed_uT = 5.0f;  // farther from the reference: flag::mag_rejected
    float field_next_s = 1.0f;        // a second reference follows the field so fast
    float field_young_s = 10.0f;      // a younger reference is contradicted, not disturbed:
    float field_young_doubt_s = 30.0f;  // the heading taken with it loses so much more trust
    float field_change_s = 20.0f;       // a new field, steady for so long in motion, is believed
    float field_offset = 1.0f * deg;    // error of magnetic north itself: reported, never corrected

    // ---- reporting
    float sigma_scale = 0.6f;         // of the reported standard deviations
    float settled_tilt = 3.0f * deg;  // flag::settling until both are known so well
    float settled_heading = 10.0f * deg;

    /// Visits each field: name, value, least and greatest value.
    template <class Params, class Visit>
    static constexpr void each(Params& p, Visit&& visit) noexcept;
};

namespace detail {

/// A parameter of the filter, and its range.
struct AttitudeField {
    const char* name;
    float AttitudeParams::*value;
    float least, greatest;
};

inline constexpr std::array<AttitudeField, 74> attitude_fields{{
    {"step_s", &AttitudeParams::step_s, 0.02f, 0.5f},
    {"align_s", &AttitudeParams::align_s, 0.1f, 10},
    {"gap_periods", &AttitudeParams::gap_periods, 1, 100},
    {"gap_s_max", &AttitudeParams::gap_s_max, 0.01f, 2},
    {"rate_walk", &AttitudeParams::rate_walk, 0, 100},
    {"gyro_noise", &AttitudeParams::gyro_noise, 1e-7f, 0.1f},
    {"gyro_scale_noise", &AttitudeParams::gyro_scale_noise, 0, 0.1f},
    {"bias_rad_s", &AttitudeParams::bias_rad_s, 1e-5f, 1},
    {"bias_max_rad_s", &AttitudeParams::bias_max_rad_s, 1e-5f, 2},
    {"bias_walk", &AttitudeParams::bias_walk, 0, 0.1f},
    {"bias_trend_s", &AttitudeParams::bias_trend_s, 1e-3f, 1e4f},
    {"bias_trend_sigma", &AttitudeParams::bias_trend_sigma, 0, 100},
    {"bias_trend_max", &AttitudeParams::bias_trend_max, 0, 0.1f},
    {"clock_error", &AttitudeParams::clock_error, 0, 0.2f},
    {"scale_error", &AttitudeParams::scale_error, 0, 0.2f},
    {"misalignment", &AttitudeParams::misalignment, 0, 0.2f},
    {"gyro_full_scale_rad_s", &AttitudeParams::gyro_full_scale_rad_s, 0, 1e3f},
    {"accel_full_scale_m_s2", &AttitudeParams::accel_full_scale_m_s2, 0, 1e5f},
    {"accel_beyond", &AttitudeParams::accel_beyond, 0, 1},
    {"velocity_m_s", &AttitudeParams::velocity_m_s, 0.1f, 30},
    {"velocity_s", &AttitudeParams::velocity_s, 1e-3f, 1e4f},
    {"accel_noise", &AttitudeParams::accel_noise, 1e-4f, 10},
    {"accel_offset_m_s2", &AttitudeParams::accel_offset_m_s2, 0, 10},
    {"accel_zero_m_s2", &AttitudeParams::accel_zero_m_s2, 0, 10},
    {"restless_s", &AttitudeParams::restless_s, 1e-3f, 1e4f},
    {"restless_memory_s", &AttitudeParams::restless_memory_s, 1e-3f, 1e4f},
    {"restless_gain", &AttitudeParams::restless_gain, 0, 100},
    {"restless_knee", &AttitudeParams::restless_knee, 0, 100},
    {"restless_max", &AttitudeParams::restless_max, 1, 1e4f},
    {"restless_tilt", &AttitudeParams::restless_tilt, 0, 1},
    {"shake_m_s2", &AttitudeParams::shake_m_s2, 0.1f, 1e4f},
    {"cruise_s", &AttitudeParams::cruise_s, 0.1f, 1e4f},
    {"cruise_m_s", &AttitudeParams::cruise_m_s, 0.01f, 1e4f},
    {"drive_s", &AttitudeParams::drive_s, 1e-3f, 1e4f},
    {"force_s", &AttitudeParams::force_s, 1e-3f, 1e4f},
    {"verify_s", &AttitudeParams::verify_s, 1e-3f, 1e4f},
    {"force_tilt", &AttitudeParams::force_tilt, 0.01f, 1.5f},
    {"force_lost", &AttitudeParams::force_lost, 0.01f, 1.5f},
    {"force_lost_s", &AttitudeParams::force_lost_s, 1e-3f, 1e4f},
    {"prove_s", &AttitudeParams::prove_s, 0, 60},
    {"corrected_s", &AttitudeParams::corrected_s, 0.1f, 1e3f},
    {"corrected_max", &AttitudeParams::corrected_max, 1e-3f, 3},
    {"verify_gap_s", &AttitudeParams::verify_gap_s, 1e-3f, 1e4f},
    {"held_s", &AttitudeParams::held_s, 0, 1},
    {"dead_axis_s", &AttitudeParams::dead_axis_s, 1e-3f, 1e4f},
    {"dead_sensor_s", &AttitudeParams::dead_sensor_s, 1e-3f, 1e4f},
    {"dead_rate_rad_s", &AttitudeParams::dead_rate_rad_s, 0, 1},
    {"rest_s", &AttitudeParams::rest_s, 1e-3f, 1e4f},
    {"rest_window_s", &AttitudeParams::rest_window_s, 1e-3f, 1e4f},
    {"rest_gyro_rad_s", &AttitudeParams::rest_gyro_rad_s, 1e-4f, 1},
    {"rest_accel_m_s2", &AttitudeParams::rest_accel_m_s2, 1e-3f, 10},
    {"rest_noise_max", &AttitudeParams::rest_noise_max, 1, 100},
    {"rest_rate_rad_s", &AttitudeParams::rest_rate_rad_s, 1e-7f, 1},
    {"rest_gate", &AttitudeParams::rest_gate, 0, 100},
    {"rest_gate_rad_s", &AttitudeParams::rest_gate_rad_s, 0, 1},
    {"rest_field_uT", &AttitudeParams::rest_field_uT, 0.05f, 100},
    {"rest_tilt", &AttitudeParams::rest_tilt, 1e-3f, 1},
    {"rest_velocity_m_s", &AttitudeParams::rest_velocity_m_s, 1e-4f, 10},
    {"rest_velocity_s", &AttitudeParams::rest_velocity_s, 1e-3f, 1e4f},
    {"field_uT", &AttitudeParams::field_uT, 1e-3f, 100},
    {"field_s", &AttitudeParams::field_s, 1e-3f, 1e4f},
    {"field_residual_s", &AttitudeParams::field_residual_s, 1e-3f, 1e4f},
    {"field_start_uT", &AttitudeParams::field_start_uT, 0, 100},
    {"field_memory_s", &AttitudeParams::field_memory_s, 1e-3f, 1e4f},
    {"field_rest", &AttitudeParams::field_rest, 1, 1e3f},
    {"field_disturbed_uT", &AttitudeParams::field_disturbed_uT, 0.1f, 1e3f},
    {"field_next_s", &AttitudeParams::field_next_s, 1e-3f, 1e4f},
    {"field_young_s", &AttitudeParams::field_young_s, 1e-3f, 1e4f},
    {"field_young_doubt_s", &AttitudeParams::field_young_doubt_s, 0, 1e4f},
    {"field_change_s", &AttitudeParams::field_change_s, 1e-3f, 1e4f},
    {"field_offset", &AttitudeParams::field_offset, 0, 1},
    {"sigma_scale", &AttitudeParams::sigma_scale, 1e-3f, 1e3f},
    {"settled_tilt", &AttitudeParams::settled_tilt, 1e-3f, 1},
    {"settled_heading", &AttitudeParams::settled_heading, 1e-3f, 3},
}};
// every parameter is a float: one that is added must be named above
static_assert(sizeof(AttitudeParams) == attitude_fields.size() * sizeof(float));

}  // namespace detail

template <class Params, class Visit>
constexpr void AttitudeParams::each(Params& p, Visit&& visit) noexcept {
    for (const auto& f : detail::attitude_fields) visit(f.name, p.*f.value, f.least, f.greatest);
}

/// Can the filter work with these? The name of the first field that is out of its range.
constexpr Check check(const AttitudeParams& params) noexcept {
    return detail::check_ranges(params);
}

}  // namespace fairlead
