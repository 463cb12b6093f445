#pragma once
// The front of a pipeline: from what the intake accepted to what the filter takes. Poses and
// vectors pass as they are; the sample of an IMU is calibrated and becomes an orientation.
#include <optional>

#include "fairlead/base/check.hpp"
#include "fairlead/board.hpp"
#include "fairlead/sense/attitude.hpp"
#include "fairlead/sense/attitude_gyro.hpp"
#include "fairlead/sense/calibrate.hpp"
#include "fairlead/sense/clip.hpp"

namespace fairlead {

namespace detail {

/// From what the intake accepted to what the filter takes: nothing to do for poses and vectors.
template <class Input>
class Front {
  public:
    using Record = typename InputTraits<Input>::Record;
    struct Params {};
    static constexpr flag::Bits takes = ~flag::Bits{0};
    static constexpr Check check(const Params&) noexcept { return {}; }
    constexpr explicit Front(const Params&) noexcept {}
    static std::optional<Record> push(const Record& record) noexcept { return record; }
    static constexpr void reset() noexcept {}
};

/// An IMU's sample to its orientation.
template <AttitudeMode mode>
class Front<Imu<mode>> {
  public:
    using Attitude = BasicAttitude<float, mode>;
    struct Params {
        Calibration calibration{};
        AttitudeParams attitude{};
    };
    static constexpr flag::Bits takes = flag::gyro_valid |
                                        (mode == AttitudeMode::gyro ? 0u : +flag::accel_valid) |
                                        (mode == AttitudeMode::imu_mag ? +flag::mag_valid : 0u);
    static constexpr Check check(const Params& params) noexcept {
        const Calibration& c = params.calibration;
        if (!finite(c.gyro) || !finite(c.accel) || !finite(c.mag) || !is_finite(c.q_bs))
            return {Status::bad_argument, "calibration"};
        return fairlead::check(params.attitude);
    }

    explicit Front(const Params& params) noexcept
        : calibrate_{params.calibration},
          attitude_{without_ranges(params.attitude)},
          gyro_full_scale_rad_s_{params.attitude.gyro_full_scale_rad_s},
          accel_full_scale_m_s2_{params.attitude.accel_full_scale_m_s2} {}

    std::optional<Pose> push(const Sample& sample) noexcept {
        return attitude_.push(
            calibrate_(mark_clipped(sample, gyro_full_scale_rad_s_, accel_full_scale_m_s2_)));
    }
    void reset() noexcept { attitude_.reset(); }

    Attitude& attitude() noexcept { return attitude_; }
    const Attitude& attitude() const noexcept { return attitude_; }

  private:
    static constexpr bool finite(const Affine& a) noexcept {
        return is_finite(a.offset) && is_finite(a.matrix.x) && is_finite(a.matrix.y) &&
               is_finite(a.matrix.z);
    }
    /// Ranges are those of the raw readings: calibration and mounting would move them.
    static AttitudeParams without_ranges(AttitudeParams params) noexcept {
        params.gyro_full_scale_rad_s = params.accel_full_scale_m_s2 = 0;
        return params;
    }

    Calibrator calibrate_;
    Attitude attitude_;
    float gyro_full_scale_rad_s_, accel_full_scale_m_s2_;
};

}  // namespace detail

}  // namespace fairlead
