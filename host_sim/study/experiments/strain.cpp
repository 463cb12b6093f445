// [Hsieh et al. 1998], section 3.4: a perturbed B-spline and quaternion B-spline, smoothed.
#include "fairlead/smooth/strain.hpp"

#include <chrono>
#include <cmath>

#include "fairlead/math/quat.hpp"
#include "fairlead/smooth/strain_buffer.hpp"
#include "host_sim/study/baselines/filters/gradient_descent.hpp"
#include "host_sim/study/experiments/experiment.hpp"
#include "host_sim/study/experiments/plot.hpp"

namespace fairlead::sim {
namespace {

constexpr std::size_t n = 120;

/// The cut-off, in cycles a sample, at which the weight is `lambda`: (2 sin(pi f))^-4 = lambda.
double cutoff_of(double lambda) { return std::asin(std::pow(lambda, -0.25) / 2) / 3.14159265359; }

std::vector<Pose> smoothed(const std::vector<Pose>& raw, double lambda) {
    static StrainBuffer<n> buffer;
    std::vector<Pose> out(raw.size());
    const auto params =
        StrainParams::from_cutoff(static_cast<float>(cutoff_of(lambda)), 1.0f);  // a step of 1 s
    buffer.smooth(raw.data(), out.data(), raw.size(), *params);
    return out;
}

struct Columns {
    std::vector<Vec3> p;
    std::vector<Quat> q;
    explicit Columns(const std::vector<Pose>& poses) {
        for (const auto& pose : poses) p.push_back(pose.p_w_m), q.push_back(pose.q_wb);
    }
};

template <class Get>
Curve curve(const std::string& name, const std::vector<Pose>& poses, Get get) {
    Curve c{name, {}, Curve::Style::line};
    for (std::size_t i = 0; i < poses.size(); ++i)
        c.points.emplace_back(i, static_cast<double>(get(poses[i])));
    return c;
}

void plot(const std::string& path, const Perturbed& motion,
          const std::vector<std::pair<std::string, std::vector<Pose>>>& results) {
    const auto panel = [&](const std::string& title, const std::string& y, auto get) {
        Panel p{title, "sample", y, {curve("perturbed", motion.noisy, get)}};
        for (const auto& [name, poses] : results) p.series.push_back(curve(name, poses, get));
        p.series.push_back(curve("truth", motion.truth, get));
        return p;
    };
    write_plot(path, {panel("Position, x", "m", [](const Pose& a) { return a.p_w_m.x; }),
                      panel("Quaternion, w", "", [](const Pose& a) { return a.q_wb.w; }),
                      panel("Quaternion, x", "", [](const Pose& a) { return a.q_wb.x; })});
}

/// Both solvers of one channel to the same cost, and what that took.
template <class Value>
void race(Table& table, const std::string& name, const std::vector<Value>& raw,
          const std::vector<Value>& best, double lambda) {
    const double least = strain_cost(raw, best, lambda);
    std::vector<Value> x = raw;
    const auto start = std::chrono::steady_clock::now();
    const auto descent = descend(raw, x, lambda, 1.001 * least, 200000);
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    table.add({name, formatted("%.3g", lambda), formatted("%.6g", strain_cost(raw, raw, lambda)),
               formatted("%.6g", least), formatted("%.6g", descent.cost),
               std::to_string(descent.rounds), formatted("%.0f", took.count())});
}

}  // namespace

std::string run_strain_experiment(const std::string& folder) {
    SplineMotion plan;
    plan.n = n;
    plan.noise_m = 0.01;
    plan.noise_half_rad = 0.05;
    const auto motion = spline_motion(plan);
    const Columns raw(motion.noisy);
    Table figures({"alpha = beta", "cut-off, cycles a sample", "position to the truth, mm",
                   "orientation to the truth, mrad on S^3", "mean second difference, mm",
                   "angular, mrad on S^3"});
    Table races({"channel", "weight", "cost before", "least cost (ours)", "gradient descent",
                 "its rounds", "its time, us"});
    std::vector<std::pair<std::string, std::vector<Pose>>> results;
    const auto row = [&](const std::string& name, const std::string& cutoff,
                         const std::vector<Pose>& out) {
        figures.add({name, cutoff, formatted("%.2f", mean_distance(motion.truth, out) * 1e3),
                     formatted("%.1f", mean_half_angle(motion.truth, out) * 1e3),
                     formatted("%.3f", mean(accelerations(out)) * 1e3),
                     formatted("%.2f", mean(angular_accelerations(out)) * 1e3)});
    };
    row("perturbed", "-", motion.noisy);
    for (const double weight : {0.1, 0.3, 0.7, 100.0}) {
        const auto out = smoothed(motion.noisy, weight);
        const Columns best(out);
        row(formatted("%.1f", weight), formatted("%.3f", cutoff_of(weight)), out);
        race(races, "position", raw.p, best.p, weight);
        race(races, "orientation", raw.q, best.q, weight);
        if (weight != 0.7) results.emplace_back("weight " + formatted("%.1f", weight), out);
    }
    plot(folder + "/strain.svg", motion, results);
    return "# Strain smoothing [Hsieh et al. 1998]\n\nA perturbed B-spline and quaternion "
           "B-spline of 120 samples. The paper does not say its time step; alpha and beta are "
           "taken at a step of 1 s, where they are the weights themselves. 100 is added: what a "
           "cut-off of 0.05 cycles a sample needs.\n\n" +
           figures.text() + "\n" + races.text() + "\n" +
           finding("Figures 2 to 5",
                   "with alpha = beta = 0.1 wiggles remain in the orientation; with 0.3 it is "
                   "smoother.",
                   "the same, row by row; both weights are small: most of the noise needs a "
                   "weight of 100.") +
           finding("Robustness",
                   "the formulation does not loop for ever and is invariant to scale.",
                   "no loop at all; one elimination for positions, eight steps for orientations.") +
           "\n![Before and after](strain.svg)\n";
}

}  // namespace fairlead::sim
