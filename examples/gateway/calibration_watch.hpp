#pragma once
// How far a calibration of the sensors has come, from the readings as they arrive: lie still, lie
// on each of six faces, turn through all directions, in any order. It watches and changes nothing;
// what it has found can be put into a calibration file (docs/gateway.md).
#include <cstddef>
#include <cstdint>

#include "examples/gateway/feed.hpp"
#include "fairlead/sense/calibrate_accel.hpp"
#include "fairlead/sense/calibrate_gyro.hpp"
#include "fairlead/sense/calibrate_mag.hpp"

namespace fairlead::gateway {

class CalibrationWatch {
  public:
    /// Raw readings: before a calibration and the mounting. Cost: constant; once a second of the
    /// sensor's time a solve of 9 unknowns.
    void push(const Sample& sample) noexcept;
    const CalibrationState& state() const noexcept { return state_; }

  private:
    void take(const Sample& sample) noexcept;
    void end_block() noexcept;
    void take_mag(const Vec3& mag_uT) noexcept;
    void judge_mag() noexcept;

    static constexpr std::int64_t spacing_ns = 10'000'000;  // of the readings that are used
    static constexpr std::size_t block = 32;                // readings that must all be still
    static constexpr std::size_t kept_max = 128;

    CalibrationState state_{};
    std::int64_t next_ns_{}, judged_ns_{};
    bool begun_{};
    std::array<Sample, block> held_{};
    std::size_t count_{};
    GyroBiasFit gyro_;
    float still_s_{};
    AccelFit accel_;
    MagFit mag_;
    std::array<Vec3, kept_max> directions_{};  // readings far from each other
    std::size_t directions_count_{};
    Vec3 last_mag_{};
};

}  // namespace fairlead::gateway
