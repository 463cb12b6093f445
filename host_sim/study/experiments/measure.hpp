#pragma once
// What a causal filter does to a noisy motion whose truth is known: lag, noise left, overshoot,
// time.
#include <cstdint>
#include <vector>

#include "fairlead/base/types.hpp"
#include "host_sim/recording/recording.hpp"
#include "host_sim/study/experiments/candidates.hpp"

namespace fairlead::sim {

struct NoisyMotion {
    std::vector<Pose> truth, input;  // both channels valid, no gaps
    double step_s{};
};

struct NoisePlan {
    double noise_m{0.002}, noise_rad{0.02};  // normal, per axis
    std::uint64_t seed{1};
    double seconds_max{60};
};

/// The liveliest part of the longest stretch in which both channels are valid, with noise added.
/// Throws BadData when there are less than two seconds of it.
NoisyMotion noisy(const Recording& recording, const NoisePlan& plan);

struct ChannelFigures {
    double lag{};    // samples from the truth to what was emitted: the best match, interpolated
    double noise{};  // RMS of what differs from the truth at that lag, above the frequency
    double error{};  // RMS of all that differs from the truth at that lag
    double late_error{};  // RMS against the truth of the same instant: lag and noise together
    double overshoot{};   // of a reach from rest to rest in 0.3 s, in parts of it
};

struct Figures {
    ChannelFigures position, orientation;
    double ns_per_sample{};
};

Figures measure(const Candidate& candidate, const NoisyMotion& motion, double above_hz);

}  // namespace fairlead::sim
