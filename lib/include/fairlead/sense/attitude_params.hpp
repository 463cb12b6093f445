#pragma once
// What the attitude filter assumes about the sensor, the motion and the field: SI units, defaults
// for consumer MEMS sensors on a hand, a body or a vehicle. Where each number comes from, and what
// changing it costs: docs/attitude.md.
#include "fairlead/base/compiler.hpp"

namespace fairlead {

struct AttitudeParams {
    static constexpr float deg = 0.01745329252f;

    // ---- time
    float step_s = 0.07f;      // the Kalman step; gyro and accelerometer run at full rate
    float align_s = 0.5f;      // first levelling
    float gap_periods = 1.5f;  // a longer time step is a gap: the rate in it is taken as linear
    float gap_s_max = 0.4f;    // a longer one loses the orientation: align again
    float rate_walk = 0.5f;    // rad/s/sqrt(s): how the rate may wander within a gap

    // ---- gyro errors, standard deviations
    float gyro_noise = 0.01f * deg;     // rad/sqrt(s), white
    float gyro_scale_noise = 0.003f;    // rad/sqrt(rad turned): what no constant matrix explains
    float bias_rad_s = 0.6f * deg;      // at switch-on
    float bias_max_rad_s = 2.0f * deg;  // never believed beyond
    float bias_walk = 0.01f * deg;      // rad/s/sqrt(s)
    float clock_error = 0.01f;          // common to the three axes: the sensor's oscillator
    float scale_error = 0.008f;         // per axis
    float misalignment = 0.002f;        // rad

    // ---- ranges, of the readings as they come to the filter; 0: not known, flags speak (clip.hpp)
    float gyro_max_rad_s = 0;
    float accel_max_m_s2 = 0;

    // ---- motion: a body's velocity stays bounded, which is what makes gravity visible
    float velocity_m_s = 0.7f;        // standard deviation of the horizontal velocity
    float velocity_s = 0.5f;          // its correlation time
    float accel_noise = 0.05f;        // m/s^2 sqrt(s)
    float accel_offset_m_s2 = 0.03f;  // error of its zero, an axis: reported, never corrected

    // ---- rest
    float rest_s = 1.5f;                  // quiet for so long
    float rest_window_s = 0.5f;           // deviations are from a mean over this time
    float rest_gyro_rad_s = 2.0f * deg;   // a smaller deviation is quiet
    float rest_accel_m_s2 = 0.5f;         // likewise
    float rest_noise_max = 3.0f;          // a noisy sensor may raise the two so many times
    float rest_rate_rad_s = 0.03f * deg;  // error of the mean rate over rest_window_s
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
    float field_change_s = 20.0f;     // a new field, steady for so long in motion, is believed
    float field_offset = 1.0f * deg;  // error of magnetic north itself: reported, never corrected

    // ---- reporting
    float sigma_scale = 0.6f;         // of the reported standard deviations
    float settled_tilt = 3.0f * deg;  // flag::settling until both are known so well
    float settled_heading = 10.0f * deg;
};

}  // namespace fairlead
