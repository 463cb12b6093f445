#pragma once
// How few control points could there be at all? A lower bound with proof, for positions.
//
// If no single cubic is within the tolerance of the samples a ... b, every spline has a knot in
// (t_a, t_b). The proof is five samples on which every cubic misses by more than the tolerance
// (de la Vallee Poussin): they are found by the exchange algorithm and are exact in themselves.
// Stretches that only share an end sample need a knot each.
#include <array>

#include "host_sim/study/baselines/track.hpp"

namespace fairlead::sim {

struct Proof {
    std::size_t axis{};
    std::array<std::size_t, 5> samples{};
    double missed{};  // every cubic misses one of them by at least this much
};

/// Least largest error of any cubic on five samples, by their alternating divided difference.
double least_error(const Track& track, const Proof& proof);

/// True with a proof where no cubic is within the tolerance of axis `axis` of the samples a ... b.
bool impossible(const Track& track, std::size_t axis, std::size_t a, std::size_t b,
                double tolerance, Proof& proof);

/// One proof per stretch: any spline of order 4 needs at least 4 + size() control points.
std::vector<Proof> knots_needed(const Track& track, double tolerance);

}  // namespace fairlead::sim
