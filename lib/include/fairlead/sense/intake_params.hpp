#pragma once
// What a user may set at an intake; what the fields do when raised and lowered: docs/parameters.md.
#include <cstdint>

#include "fairlead/base/check.hpp"
#include "fairlead/sense/intake_limits.hpp"

namespace fairlead {

struct IntakeParams {
    std::int64_t gap_ns{0};                // a longer pause is a gap; 0: as IntakeLimits says
    std::int64_t leap_ns{60'000'000'000};  // a longer step ahead must be confirmed by a second
                                           // record, and begins a run of its own
    std::uint32_t stuck_records{0};        // as many equal values in a row are refused; 0: never
    float position_max_m{0};               // |component|; 0: what the stages behind can carry
    float value_max{0};                    // the same for vectors
    float gyro_max_rad_s{100};             // |component|
    float accel_max_m_s2{2000};            // |component|
    float mag_max_uT{5000};                // |component|
    float unit_tolerance{0.01f};           // largest | |q| - 1 | that is mended

    template <class Params, class Visit>
    static constexpr void each(Params& p, Visit&& visit) noexcept {
        constexpr std::int64_t longest = IntakeLimits::run_ns / 2;
        constexpr float any = 3e38f;
        visit("gap_ns", p.gap_ns, std::int64_t{0}, longest);
        visit("leap_ns", p.leap_ns, std::int64_t{1}, longest);
        visit("stuck_records", p.stuck_records, std::uint32_t{0}, ~std::uint32_t{0});
        visit("position_max_m", p.position_max_m, 0.0f, any);
        visit("value_max", p.value_max, 0.0f, any);
        visit("gyro_max_rad_s", p.gyro_max_rad_s, 1e-3f, 1e6f);
        visit("accel_max_m_s2", p.accel_max_m_s2, 1e-3f, 1e6f);
        visit("mag_max_uT", p.mag_max_uT, 1e-3f, 1e6f);
        visit("unit_tolerance", p.unit_tolerance, 1e-6f, 0.5f);
    }
};

/// The parameters with each 0 replaced by what the limits say.
constexpr IntakeParams completed(IntakeParams p, const IntakeLimits& limits) noexcept {
    if (p.gap_ns == 0) p.gap_ns = limits.gap_ns;
    if (p.position_max_m <= 0) p.position_max_m = limits.position_max_m;
    if (p.value_max <= 0) p.value_max = limits.value_max;
    return p;
}

/// The parameters, completed, with each that is beyond the limits at its limit.
constexpr IntakeParams within(IntakeParams p, const IntakeLimits& limits) noexcept {
    if (p.gap_ns < limits.spacing_min_ns) p.gap_ns = limits.spacing_min_ns;
    if (p.gap_ns > limits.gap_ns_max) p.gap_ns = limits.gap_ns_max;
    if (p.leap_ns < p.gap_ns) p.leap_ns = p.gap_ns;
    if (p.position_max_m > limits.position_max_m) p.position_max_m = limits.position_max_m;
    if (p.value_max > limits.value_max) p.value_max = limits.value_max;
    return p;
}

/// Refuses a field that is out of its range, and one that lets in what the limits forbid.
constexpr Check check(const IntakeParams& params, const IntakeLimits& limits = {}) noexcept {
    const Check ranges = detail::check_ranges(params);
    if (!ranges) return ranges;
    const IntakeParams p = completed(params, limits);
    if (p.gap_ns > limits.gap_ns_max || p.gap_ns < limits.spacing_min_ns)
        return {Status::bad_argument, "gap_ns"};
    if (p.leap_ns < p.gap_ns) return {Status::bad_argument, "leap_ns"};
    if (p.position_max_m > limits.position_max_m) return {Status::bad_argument, "position_max_m"};
    if (p.value_max > limits.value_max) return {Status::bad_argument, "value_max"};
    return {};
}

}  // namespace fairlead
