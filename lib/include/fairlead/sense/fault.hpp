#pragma once
// The kinds of doubtful input that the intake meets, and their counts.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

enum class Fault : std::uint8_t {
    repeated_time,  // record refused
    backward_time,  // record refused: a lone stamp in the past
    leap,           // record refused: a lone stamp far ahead
    too_close,      // record refused: nearer to the one before than a curve can carry
    gap,            // data missing before a record, of all channels or of one
    new_run,        // accepted, with a time base of its own: the clock went back or leapt
    not_finite,     // channel refused: NaN or infinity
    out_of_range,   // channel refused
    not_unit,       // channel refused: a quaternion far from unit length
    stuck,          // channel refused: the same value for too many records
};
inline constexpr std::size_t fault_kinds = 10;

constexpr const char* to_string(Fault f) noexcept {
    switch (f) {
        case Fault::repeated_time: return "repeated time";
        case Fault::backward_time: return "backward time";
        case Fault::leap: return "leap in time";
        case Fault::too_close: return "too close in time";
        case Fault::gap: return "gap";
        case Fault::new_run: return "new run";
        case Fault::not_finite: return "not finite";
        case Fault::out_of_range: return "out of range";
        case Fault::not_unit: return "not a rotation";
        case Fault::stuck: return "stuck";
        default: break;
    }
    return "unknown";
}

/// How often each kind was met.
class FaultCounts {
  public:
    constexpr std::uint64_t operator[](Fault f) const noexcept {
        return counts_[static_cast<std::size_t>(f)];
    }
    constexpr void add(Fault f) noexcept { ++counts_[static_cast<std::size_t>(f)]; }
    constexpr std::uint64_t total() const noexcept {
        std::uint64_t sum = 0;
        for (const std::uint64_t n : counts_) sum += n;
        return sum;
    }

  private:
    std::array<std::uint64_t, fault_kinds> counts_{};
};

}  // namespace fairlead
