#pragma once
// What the sensor in the machine feels: a recording, sample by sample, or, without one, a motion
// that anyone can compute. The model plays it; afterwards the host expects it, count for count.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/chip_models/chip_model.hpp"
#include "host_sim/recording/recording.hpp"

namespace fairlead::vm {

class Source {
  public:
    /// A recording's path; "-" for the computed motion; "still" for constant, non-zero values.
    explicit Source(const std::string& path) : still_{path == "still"} {
        if (path != "-" && !still_) samples_ = sim::read_recording(path).samples;
    }
    sim::Truth at(std::int64_t index) const {
        sim::Truth t;
        if (still_) {
            t.gyro_rad_s = {0.5f, -0.3f, 0.2f};
            t.accel_m_s2 = {1, -2, 9};
            t.mag_uT = {20, -30, 40};
            return t;
        }
        if (!samples_.empty()) {
            const auto n = static_cast<std::int64_t>(samples_.size());
            const Sample& s = samples_[static_cast<std::size_t>(index % n)];
            t.gyro_rad_s = s.gyro_rad_s;
            t.accel_m_s2 = s.accel_m_s2;
            t.mag_uT = s.mag_uT;
            return t;
        }
        const double x = static_cast<double>(index) * 0.0024;
        const auto wave = [x](double hz, double size) {
            return static_cast<float>(size * std::sin(2 * sim::pi * hz * x));
        };
        t.gyro_rad_s = {wave(0.31, 2), wave(0.83, 1.1), wave(1.7, 0.4)};
        t.accel_m_s2 = {wave(0.57, 3), wave(1.1, 2), 9.8f + wave(2.3, 1)};
        t.mag_uT = {wave(0.1, 30), wave(0.2, 30), 40};
        return t;
    }
    /// One record per chip sample, in order of time, holes included.
    sim::Motion motion(double period_ns) const {
        return [this, period_ns, origin = std::int64_t{-1}](std::int64_t t_ns) mutable {
            if (origin < 0) origin = t_ns;
            return at(std::llround(static_cast<double>(t_ns - origin) / period_ns));
        };
    }

  private:
    bool still_;
    std::vector<Sample> samples_;
};

}  // namespace fairlead::vm
