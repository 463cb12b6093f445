#pragma once
// Strain smoothing as published [Hsieh et al. 1998, sec. 3.3]: gradient descent with a constant
// step. Host only: the yardstick of smooth/strain.hpp, at even time steps.
//
// The paper leaves the step open. Here it is the best constant one for the quadratic problem,
// 2 / (smallest + largest eigenvalue) = 1 / (2 + 16 lambda) of twice the cost.
#include <cstddef>
#include <vector>

#include "fairlead/base/types.hpp"

namespace fairlead::sim {

struct DescentResult {
    std::size_t rounds{};
    double cost{};
};

/// F of eq. (22): squared deviations plus lambda = alpha / h^4 times squared second differences.
double strain_cost(const std::vector<Vec3>& raw, const std::vector<Vec3>& p, double lambda);
double strain_cost(const std::vector<Quat>& raw, const std::vector<Quat>& q, double lambda);

/// Descends from the raw data until the cost is at most `goal`, or for `rounds_max` rounds.
DescentResult descend(const std::vector<Vec3>& raw, std::vector<Vec3>& p, double lambda,
                      double goal, std::size_t rounds_max = 1000000);
DescentResult descend(const std::vector<Quat>& raw, std::vector<Quat>& q, double lambda,
                      double goal, std::size_t rounds_max = 1000000);

}  // namespace fairlead::sim
