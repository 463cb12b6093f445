#pragma once
// What the magnetometer drivers share: settings that are checked again, samples from raw counts,
// and a self test that compares two means.
#include <cstddef>
#include <cstdint>

#include "fairlead/math/vec.hpp"
#include "port/sensors/driver.hpp"

namespace fairlead::port {

/// `Most`: settings at most.
template <class Bus, std::size_t Most>
class MagDriver {
  public:
    /// Do the settings still stand? bad_data after a reset or a brown-out. One transaction each.
    Status check() const noexcept { return settings_.check(chip_); }
    float temperature_c() const noexcept { return temperature_c_; }

  protected:
    MagDriver(Bus& bus, std::uint8_t address, UnknownId unknown) noexcept
        : chip_{bus, address}, unknown_{unknown} {}

    static Sample to_sample(const Vec3& mag_uT, std::int64_t t_ns, bool clipped,
                            bool overwritten) noexcept {
        Sample sample;
        sample.t_ns = t_ns;
        sample.mag_uT = mag_uT;
        sample.flags = flag::mag_valid;
        if (clipped) sample.flags |= flag::clipped | flag::mag_clipped;
        if (overwritten) sample.flags |= flag::gap_before;
        return sample;
    }

    /// Mean of `count` readings, `pause_us` apart, the first after one pause.
    template <class Read>
    Status average(int count, std::uint32_t pause_us, Vec3& mean, Read read) const noexcept {
        mean = {};
        const float part = 1.0f / static_cast<float>(count);
        for (int n = 0; n < count; ++n) {
            chip_.bus().pause_us(pause_us);
            const Result<Sample> sample = read();
            if (!sample) return sample.status();
            mean = mean + part * sample->mag_uT;
        }
        return Status::ok;
    }

    /// Passes when every axis has moved by `low` to `high`, in either direction.
    static void judge(const Vec3& off, const Vec3& on, const Vec3& low, const Vec3& high,
                      SelfTest& result) noexcept {
        const auto size = [](float v) { return v < 0 ? -v : v; };
        const float moved[3] = {size(on.x - off.x), size(on.y - off.y), size(on.z - off.z)};
        const float least[3] = {low.x, low.y, low.z}, most[3] = {high.x, high.y, high.z};
        result.passed = true;
        for (std::size_t i = 0; i < 3; ++i) {
            result.response[i] = moved[i];
            if (!(moved[i] >= least[i] && moved[i] <= most[i])) result.passed = false;
        }
    }

    Registers<Bus> chip_;
    UnknownId unknown_;
    Settings<Most> settings_{};
    float temperature_c_{0};
};

}  // namespace fairlead::port
