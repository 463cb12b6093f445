#pragma once
// The numbers of a page: quantised, deflated, as text. A browser unpacks them (page/report.js).
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

/// Collects arrays; each add returns what a page needs to find and read the array, as JSON.
class Packed {
  public:
    static constexpr int levels = 65534;  // of values, from the least to the largest

    /// {"at":, "n":, "zero":, "step":}: value = zero + step * level; NaN is kept as no value.
    std::string add_values(const std::vector<double>& values);
    /// {"at":, "n":}: seconds in steps of a microsecond, in order. Equal arrays are kept once.
    std::string add_times(const std::vector<double>& seconds);

    /// All arrays, deflated, in base64.
    std::string text(const Steps& progress = {}) const;

  private:
    void put_planes(const std::vector<std::uint32_t>& words, int bytes);

    std::string bytes_;
    std::map<std::string, std::string> times_;  // what is there already, by its bytes
};

}  // namespace fairlead::sim
