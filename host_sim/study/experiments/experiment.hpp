#pragma once
// The experiments of the four papers, rerun. Each writes NAME.md and its plots into a folder and
// returns the text of NAME.md; each finding is one line "paper: ... | we see: ...".
#include <string>
#include <vector>

#include "fairlead/base/types.hpp"

namespace fairlead::sim {

struct Experiment {
    const char* name;
    const char* what;
    std::string (*run)(const std::string& folder);
};
const std::vector<Experiment>& experiments();

std::string run_fairing_experiment(const std::string& folder);
std::string run_strain_experiment(const std::string& folder);
std::string run_knots_experiment(const std::string& folder);
std::string run_filters_experiment(const std::string& folder);

/// "- NAME. Paper: ... We see: ..."
std::string finding(const std::string& name, const std::string& paper, const std::string& seen);

// ---- motions of the papers' kind
struct SplineMotion {
    std::size_t n{100};
    std::size_t control_points{8};
    double cube_m{0.4};          // side of the cube that holds the positions
    double turn_rad{1.2};        // largest rotation between control orientations
    double noise_m{0.01};        // perturbations: random direction, length even below these;
    double noise_half_rad{0.1};  // of orientations on S^3, half a rotation angle
    std::uint64_t seed{1};
    double step_s{1.0};
};
struct Perturbed {
    std::vector<Pose> truth, noisy;
};
/// A uniform cubic B-spline and a cumulative quaternion B-spline [Kim, Kim & Shin 1995], sampled
/// evenly and perturbed.
Perturbed spline_motion(const SplineMotion& plan);

/// Mean over i of the length on S^3 between two motions, as in [Lee & Shin 1996, (19)].
double mean_half_angle(const std::vector<Pose>& a, const std::vector<Pose>& b);
double mean_distance(const std::vector<Pose>& a, const std::vector<Pose>& b);

/// Magnitude of the second differences: of positions, and of half-angle steps of orientations.
std::vector<double> accelerations(const std::vector<Pose>& motion);
std::vector<double> angular_accelerations(const std::vector<Pose>& motion);
double mean(const std::vector<double>& v);

}  // namespace fairlead::sim
