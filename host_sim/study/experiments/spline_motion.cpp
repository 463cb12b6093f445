#include <cmath>

#include "fairlead/math/quat.hpp"
#include "host_sim/generate/random.hpp"
#include "host_sim/study/experiments/experiment.hpp"

namespace fairlead::sim {
namespace {

using Vec3d = BasicVec3<double>;
using Quatd = BasicQuat<double>;

/// The four uniform cubic B-splines at s in [0, 1).
struct Blend {
    double b[4];
    explicit Blend(double s) {
        const double r = 1 - s;
        b[0] = r * r * r / 6;
        b[1] = (3 * s * s * s - 6 * s * s + 4) / 6;
        b[2] = (-3 * s * s * s + 3 * s * s + 3 * s + 1) / 6;
        b[3] = s * s * s / 6;
    }
};

Vec3 narrow(const Vec3d& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
Quat narrow(const Quatd& q) {
    return {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
            static_cast<float>(q.z)};
}

/// Random direction, length even below `most`.
Vec3d perturbation(Random& random, double most) {
    const Vec3d direction = random.direction();
    return random.uniform(0, most) * direction;
}

}  // namespace

std::string finding(const std::string& name, const std::string& paper, const std::string& seen) {
    return "- **" + name + ".** Paper: " + paper + " We see: " + seen + "\n";
}

Perturbed spline_motion(const SplineMotion& plan) {
    Random random{plan.seed};
    std::vector<Vec3d> p;
    std::vector<Quatd> q;
    for (std::size_t i = 0; i < plan.control_points; ++i) {
        const double x = random.uniform(), y = random.uniform(), z = random.uniform();
        p.push_back(plan.cube_m * Vec3d{x, y, z});
        const Vec3d turn = 0.5 * perturbation(random, plan.turn_rad);
        q.push_back(i == 0 ? exp(turn) : normalised(q.back() * exp(turn)));
    }
    Perturbed out;
    for (std::size_t i = 0; i < plan.n; ++i) {
        const double span = static_cast<double>(plan.control_points - 3);
        const double t = span * static_cast<double>(i) / static_cast<double>(plan.n);
        const auto k = static_cast<std::size_t>(t);
        const Blend blend{t - static_cast<double>(k)};
        Vec3d position{};
        for (std::size_t j = 0; j < 4; ++j) position += blend.b[j] * p[k + j];
        Quatd turn = q[k];
        double rest = blend.b[1] + blend.b[2] + blend.b[3];
        for (std::size_t j = 1; j < 4; ++j) {
            turn = turn * exp(rest * log(conj(q[k + j - 1]) * q[k + j]));
            rest -= blend.b[j];
        }
        Pose pose;
        pose.t_ns = std::llround((1 + static_cast<double>(i) * plan.step_s) * 1e9);
        pose.flags = flag::position_valid | flag::orientation_valid;
        pose.p_w_m = narrow(position);
        pose.q_wb = narrow(turn);
        out.truth.push_back(pose);
        pose.p_w_m = narrow(position + perturbation(random, plan.noise_m));
        pose.q_wb = narrow(turn * exp(perturbation(random, plan.noise_half_rad)));
        out.noisy.push_back(pose);
    }
    return out;
}

double mean_half_angle(const std::vector<Pose>& a, const std::vector<Pose>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += static_cast<double>(rotation_angle(a[i].q_wb, b[i].q_wb)) / 2;
    return sum / static_cast<double>(a.size());
}
double mean_distance(const std::vector<Pose>& a, const std::vector<Pose>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += static_cast<double>(norm(b[i].p_w_m - a[i].p_w_m));
    return sum / static_cast<double>(a.size());
}

std::vector<double> accelerations(const std::vector<Pose>& m) {
    std::vector<double> out;
    for (std::size_t i = 1; i + 1 < m.size(); ++i)
        out.push_back(static_cast<double>(
            norm((m[i + 1].p_w_m - m[i].p_w_m) - (m[i].p_w_m - m[i - 1].p_w_m))));
    return out;
}
std::vector<double> angular_accelerations(const std::vector<Pose>& m) {
    std::vector<double> out;
    for (std::size_t i = 1; i + 1 < m.size(); ++i)
        out.push_back(static_cast<double>(
            norm(log(conj(m[i].q_wb) * m[i + 1].q_wb) - log(conj(m[i - 1].q_wb) * m[i].q_wb))));
    return out;
}
double mean(const std::vector<double>& v) {
    double sum = 0;
    for (const double x : v) sum += x;
    return sum / static_cast<double>(v.empty() ? 1 : v.size());
}

const std::vector<Experiment>& experiments() {
    static const std::vector<Experiment> all{
        {"fairing", "[Lee & Shin 1996], figures 2 to 8 and the time", run_fairing_experiment},
        {"strain", "[Hsieh et al. 1998], figures 1 to 5", run_strain_experiment},
        {"knots", "[Balaguer & Gobbetti 1995], figures 1, 2, 4 and tables 8, 10",
         run_knots_experiment},
        {"filters", "[Lee & Shin 2002], figures 1, 4, 5 and 6", run_filters_experiment}};
    return all;
}

}  // namespace fairlead::sim
