#pragma once
// The calibration of a sensor unit, from a file: either the bytes of fairlead::save(calibration),
// as a board or a program stored them (docs/calibrate.md), or a TOML text with any of these keys.
//
//   temperature_C = 25                   # at which the gyroscope's offset holds
//   gyro_offset_rad_s = [0.01, 0, 0]     # truth = matrix * (reading - offset)
//   gyro_matrix = [1, 0, 0,  0, 1, 0,  0, 0, 1]
//   gyro_offset_per_K = [0, 0, 0]        # rad/s per kelvin
//   accel_offset_m_s2, accel_matrix, mag_offset_uT, mag_matrix: as for the gyroscope
#include <string>
#include <vector>

#include "fairlead/sense/calibrate.hpp"

namespace fairlead::gateway {

/// Replaces `out` when the file is good; otherwise appends what is wrong to `errors`.
void read_calibration(const std::string& path, Calibration& out, std::vector<std::string>& errors);

/// Equal in every bit.
bool same_calibration(const Calibration& a, const Calibration& b) noexcept;

/// A mounting as the configuration spells it: "-y x z" says that the body's x axis is the sensor's
/// -y axis, the body's y axis the sensor's x axis, and so on. False: no right-handed set of axes.
bool parse_mounting(const std::string& text, Quat& q_bs) noexcept;

}  // namespace fairlead::gateway
