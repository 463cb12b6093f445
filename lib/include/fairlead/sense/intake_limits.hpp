#pragma once
// What an intake may let in: the range, spacing and clock rules that the stages behind it can
// carry. A stage states its limits; the intake enforces them; no stage has such a rule of its own.
#include <cstdint>
#include <limits>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

/// The limits of the stages behind an intake. Defaults: no stage that needs a limit.
struct IntakeLimits {
    std::int64_t spacing_min_ns{1};    // smallest step from one accepted time to the next
    std::int64_t gap_ns{100'000'000};  // a longer pause is a gap, where the user names none
    std::int64_t gap_ns_max{run_ns};   // largest gap_ns that a user may name
    std::int64_t run_ns_max{run_ns};   // a run lasts at most so long; then a new one begins
    float position_max_m{1e4f};        // largest |component| of a position
    float value_max{3e38f};            // largest |component| of a vector
    bool first_waits{false};           // the first record is given with the second one: the
                                       // stages behind need to know the step between the two

    /// Differences of two times of one run fit int64 with room to add a few of them.
    static constexpr std::int64_t run_ns = std::int64_t{1} << 61;
};

/// Sample periods that a pipeline takes: 8 kHz to 1 Hz.
inline constexpr std::int64_t sample_period_min_ns = 125'000;
inline constexpr std::int64_t sample_period_max_ns = 1'000'000'000;

/// The pause that ends a curve by default: 100 ms, but at least 12 and at most 64 sample periods.
/// A curve may bridge a pause of 64 ticks at most (a tick is a sample period), and a slow sensor
/// must not make a gap of each lost record.
constexpr std::int64_t default_gap_ns(std::int64_t sample_period_ns) noexcept {
    const std::int64_t least = 12 * sample_period_ns, most = 64 * sample_period_ns;
    constexpr std::int64_t usual = 100'000'000;
    return usual < least ? least : usual < most ? usual : most;
}

}  // namespace fairlead
