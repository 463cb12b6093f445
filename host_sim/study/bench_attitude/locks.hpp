#pragma once
// Does the filter ever stay in a wrong state, and does it say so meanwhile? Seeded starts in
// motion, and boards turned upside down while samples are lost, saturated or frozen.
#include <cstdint>

#include "fairlead/sense/attitude_params.hpp"
#include "fairlead/sense/attitude_state.hpp"
#include "host_sim/study/bench_attitude/simulated.hpp"

namespace fairlead::sim {

/// A start in the middle of a motion: its kind, chip, rate and moment follow from the seed.
SimPlan start_in_motion(std::uint64_t seed);
/// A board turned over while something fails, 20 to 25 s after the start; likewise.
SimPlan upside_down_loss(std::uint64_t seed);

struct LockCounts {
    std::size_t runs{}, locked{};  // locked: more than 30 degrees of inclination at the end
    std::size_t samples{};         // with flag::settling clear
    std::size_t tilted{};          // of these, more than 20 degrees of inclination error
    std::size_t turned{};          // of these, a heading error beyond three sigma
    double worst_deg{};            // largest inclination error with flag::settling clear
    double clear_share{};          // of all samples, settling clear
    std::uint64_t first_locked{};  // its seed
};

/// Runs seeds first ... first + count - 1.
LockCounts count_locks(SimPlan (*plan)(std::uint64_t), AttitudeMode mode, std::uint64_t first,
                       std::size_t count, const AttitudeParams& params = {});

}  // namespace fairlead::sim
