#pragma once
// A gyro's bias over temperature as a table: for a sensor whose drift is no straight line
// (GyroDrift in calibrate_gyro.hpp), measured once, applied to every sample that carries its
// temperature.
//
// Temperature enters with the sample: drivers and file readers set Sample::temperature_c and
// flag::temperature_valid. Cost: a search of N - 1 comparisons and one interpolation a sample.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/math/vec.hpp"

namespace fairlead {

/// Straight lines between N nodes at most; beyond the first and last node their offset holds.
template <std::size_t N>
struct GyroTemperatureTable {
    static_assert(N >= 2 && N <= 64, "2 to 64 nodes");
    static constexpr std::uint32_t saved_version = 1;

    std::array<float, N> temperature_c{};  // rising
    std::array<Vec3, N> offset_rad_s{};
    std::uint32_t count{};  // nodes in use; 0: no table, no correction

    /// Offset at this temperature, rad/s. Not finite: that of the first node.
    constexpr Vec3 at(float c) const noexcept {
        const std::size_t n = count < N ? count : N;
        if (n == 0) return {};
        if (!(c > temperature_c[0])) return offset_rad_s[0];
        for (std::size_t i = 1; i < n; ++i) {
            if (c >= temperature_c[i]) continue;
            const float span = temperature_c[i] - temperature_c[i - 1];
            if (!(span > 0)) return offset_rad_s[i];
            const float u = (c - temperature_c[i - 1]) / span;
            return (1 - u) * offset_rad_s[i - 1] + u * offset_rad_s[i];
        }
        return offset_rad_s[n - 1];
    }

    /// The sample without the offset of its temperature; unchanged where it carries none.
    /// In the sensor's own frame: before a Calibrator, whose gyro offset then is what is left.
    constexpr Sample operator()(const Sample& sample) const noexcept {
        if ((sample.flags & flag::temperature_valid) == 0) return sample;
        Sample out = sample;
        out.gyro_rad_s = sample.gyro_rad_s - at(sample.temperature_c);
        return out;
    }
};

/// Fills a table from biases of rests at many temperatures (GyroBiasFit, or the filter's own while
/// the board rests), while a board warms up: one node for each step of temperature that was seen.
template <std::size_t N>
class GyroTableFit {
  public:
    static constexpr float bias_max_rad_s = 2;  // a larger one is no bias

    /// Nodes lie step_c apart, the first cell begins at low_c. step_c > 0.
    constexpr GyroTableFit(float low_c, float step_c) noexcept
        : low_c_{low_c}, step_c_{step_c > 0 ? step_c : 1} {}

    constexpr void push(const Vec3& bias_rad_s, float temperature_c) noexcept {
        const float cell = (temperature_c - low_c_) / step_c_;
        if (!is_finite(bias_rad_s) ||
            !(dot(bias_rad_s, bias_rad_s) < bias_max_rad_s * bias_max_rad_s))
            return;
        if (!(cell >= 0 && cell < static_cast<float>(N))) {
            ++outside_;
            return;
        }
        Cell& c = cells_[static_cast<std::size_t>(cell)];
        ++c.count;
        const float share = 1 / static_cast<float>(c.count);
        c.temperature_c += share * (temperature_c - c.temperature_c);
        c.bias += share * (bias_rad_s - c.bias);
    }
    constexpr std::uint32_t outside() const noexcept { return outside_; }

    /// not_enough_data: fewer than two cells were seen.
    constexpr Result<GyroTemperatureTable<N>> result() const noexcept {
        GyroTemperatureTable<N> out;
        for (const Cell& c : cells_) {
            if (c.count == 0) continue;
            out.temperature_c[out.count] = c.temperature_c;
            out.offset_rad_s[out.count++] = c.bias;
        }
        if (out.count < 2) return Status::not_enough_data;
        return out;
    }

  private:
    struct Cell {
        Vec3 bias{};
        float temperature_c{};
        std::uint32_t count{};
    };
    float low_c_, step_c_;
    std::array<Cell, N> cells_{};
    std::uint32_t outside_{};
};

}  // namespace fairlead
