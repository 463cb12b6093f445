#pragma once
// The whole way of the data for an inertial sensor: intake -> calibration -> attitude, and then the
// pipeline of poses (filter -> reduce -> codec). One orientation stream leaves; there is no
// position.
#include "fairlead/pipeline.hpp"
#include "fairlead/sense/attitude.hpp"
#include "fairlead/sense/attitude_gyro.hpp"
#include "fairlead/sense/calibrate.hpp"
#include "fairlead/sense/clip.hpp"

namespace fairlead {

/// Config as for Pipeline. Memory: the object. Work per push: an attitude step and a pipeline push.
template <class Config, AttitudeMode mode = AttitudeMode::imu_mag>
class ImuPipeline {
  public:
    using Motion = Pipeline<Config>;
    using Orientation = BasicAttitude<float, mode>;
    struct Params {
        IntakeParams intake{};
        Calibration calibration{};
        AttitudeParams attitude{};
        typename Motion::Params motion{};
    };

    explicit ImuPipeline(const Params& params) noexcept
        : intake_{params.intake},
          calibrate_{params.calibration},
          orientation_{without_ranges(params.attitude)},
          motion_{only_orientation(params.motion)},
          gyro_full_scale_rad_s_{params.attitude.gyro_full_scale_rad_s},
          accel_full_scale_m_s2_{params.attitude.accel_full_scale_m_s2} {}

    /// One raw sample. @return the frames that it completed, possibly none; valid until the next
    /// call.
    Bytes push(const Sample& raw) noexcept {
        pose_.reset();
        const auto sample = intake_.push(raw);
        if (!sample) return motion_.idle();
        const Sample marked = mark_clipped(*sample, gyro_full_scale_rad_s_, accel_full_scale_m_s2_);
        pose_ = orientation_.push(calibrate_(marked));
        return pose_ ? motion_.push(*pose_) : motion_.idle();
    }

    /// As Pipeline::push_event() and idle().
    bool push_event(const Event& event) noexcept { return motion_.push_event(event); }
    Bytes idle() noexcept {
        pose_.reset();
        return motion_.idle();
    }

    /// Lets out what is still inside. @return frames; call until there are none.
    Bytes flush() noexcept { return motion_.flush(); }

    /// What the last push made of its sample, before filter and reducer.
    const std::optional<Pose>& pose() const noexcept { return pose_; }
    const Intake<Sample>& intake() const noexcept { return intake_; }
    const Orientation& orientation() const noexcept { return orientation_; }
    const Motion& motion() const noexcept { return motion_; }

  private:
    static typename Motion::Params only_orientation(typename Motion::Params params) noexcept {
        params.encoder.position = false;
        return params;
    }

    /// Ranges are those of the raw readings: calibration and mounting would move them.
    static AttitudeParams without_ranges(AttitudeParams params) noexcept {
        params.gyro_full_scale_rad_s = params.accel_full_scale_m_s2 = 0;
        return params;
    }

    Intake<Sample> intake_;
    Calibrator calibrate_;
    Orientation orientation_;
    Motion motion_;
    float gyro_full_scale_rad_s_, accel_full_scale_m_s2_;
    std::optional<Pose> pose_{};
};

}  // namespace fairlead
