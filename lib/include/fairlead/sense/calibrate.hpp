#pragma once
// What is known to be wrong with a board's sensors, and its correction: offset, 3 x 3 matrix and
// temperature, then the sensor's mounting in the body. The fits that find the numbers on the board:
// calibrate_gyro.hpp, calibrate_accel.hpp, calibrate_mag.hpp. Cost: 9 + 9 multiplications a sensor.
#include <cstdint>

#include "fairlead/math/mat3.hpp"
#include "fairlead/math/quat.hpp"
#include "fairlead/sense/saved.hpp"

namespace fairlead {

/// truth = matrix * (reading - offset).
struct Affine {
    Vec3 offset{};
    Mat3 matrix{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

    constexpr Vec3 operator()(const Vec3& reading) const noexcept {
        return matrix * (reading - offset);
    }
};

/// All of a board, ready to be kept: save(calibration), restore(saved).
struct Calibration {
    static constexpr std::uint32_t saved_version = 1;

    Affine gyro{}, accel{}, mag{};
    Vec3 gyro_offset_per_K{};  // the gyro's offset changes by so much with temperature
    float temperature_C{25};   // at which gyro.offset holds
    Quat q_bs{};               // sensor to body
};

class Calibrator {
  public:
    /// Identity until the board is calibrated.
    constexpr Calibrator() noexcept = default;
    constexpr explicit Calibrator(const Calibration& calibration) noexcept : c_{calibration} {}

    Sample operator()(const Sample& sample) const noexcept {
        const bool told = (sample.flags & flag::temperature_valid) != 0;
        return (*this)(sample, told ? sample.temperature_c : c_.temperature_C);
    }
    /// With a temperature from elsewhere. Times and flags pass unchanged.
    Sample operator()(const Sample& sample, float temperature_C) const noexcept {
        Sample out = sample;
        const Vec3 drift = (temperature_C - c_.temperature_C) * c_.gyro_offset_per_K;
        out.gyro_rad_s = rotate(c_.q_bs, c_.gyro(sample.gyro_rad_s - drift));
        out.accel_m_s2 = rotate(c_.q_bs, c_.accel(sample.accel_m_s2));
        out.mag_uT = rotate(c_.q_bs, c_.mag(sample.mag_uT));
        return out;
    }

  private:
    Calibration c_{};
};

}  // namespace fairlead
