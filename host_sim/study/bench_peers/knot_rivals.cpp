#include "host_sim/study/bench_peers/knot_rivals.hpp"

#include <cmath>
#include <functional>

#include "host_sim/study/baselines/knots/fitpack.hpp"
#include "host_sim/study/baselines/knots/removal.hpp"
#include "host_sim/study/baselines/knots/sisl.hpp"
#include "host_sim/study/baselines/knots/windowed.hpp"

namespace fairlead::sim {
namespace {

constexpr int sisl_settings = 26;    // tolerances of the four components, orientations only
constexpr double sisl_first = 0.25;  // of the angle: safe, as the angle is at most 4 x that
constexpr double sisl_ratio = 1.04;  // the last is 0.67 of the angle

std::string to_text(std::size_t control_points, double error) {
    char text[64];
    std::snprintf(text, sizeof text, "%zu %.9g", control_points, error);
    return text;
}

KnotResult parse(const std::string& method, const std::string& text) {
    KnotResult result{method, 0, 0};
    std::sscanf(text.c_str(), "%zu %lf", &result.control_points, &result.error);
    return result;
}

KnotResult sisl_call(const Cell& cell, Cache& cache, SislMethod method, double tolerance) {
    const std::string name = std::string{"sisl-1 "} + to_string(method);
    const auto text = cache.get(cache_key(name, hash(cell.track), tolerance), [&] {
        const SislResult result = sisl(cell.track, method, tolerance);
        return to_text(result.control_points, result.error);
    });
    KnotResult result = parse(sisl_name, text);
    result.error /= cell.tolerance;
    return result;
}

bool better(const KnotResult& a, const KnotResult& b) {
    return a.control_points > 0 && (b.control_points == 0 || a.control_points < b.control_points);
}

struct SislFigures {
    KnotResult yardstick, best;  // as defined; with every setting tried
};

SislFigures sisl_figures(const Cell& cell, Cache& cache) {
    SislFigures figures{{sisl_name, 0, 0}, {"libsisl best of 78", 0, 0}};
    const bool tuned = cell.track.channel == Channel::orientation;
    for (const SislMethod method : sisl_methods) {
        KnotResult widest;
        for (int i = 0; i < (tuned ? sisl_settings : 1); ++i) {
            const double factor = tuned ? sisl_first * std::pow(sisl_ratio, i) : 1;
            const KnotResult result = sisl_call(cell, cache, method, factor * cell.tolerance);
            if (result.control_points == 0 || (tuned && result.error > 1)) continue;
            widest = result;
            if (better(result, figures.best))
                figures.best = {figures.best.method, result.control_points, result.error};
        }
        if (better(widest, figures.yardstick)) figures.yardstick = widest;
    }
    return figures;
}

/// Methods whose tolerance holds per component: a ladder of shares of the angle, for orientations.
std::vector<double> component_tolerances(const Cell& cell) {
    if (cell.track.channel == Channel::position) return {cell.tolerance};
    std::vector<double> out;
    for (const double share : {0.25, 0.35, 0.45, 0.55}) out.push_back(share * cell.tolerance);
    return out;
}

/// Fewest control points within the tolerance; where none is within it, the smallest error.
class Best {
  public:
    explicit Best(const Cell& cell) : cell_{cell} {}
    void offer(const Spline& spline) {
        if (spline.c.empty()) return;  // the method failed
        const double error = largest_error(cell_.track, spline) / cell_.tolerance;
        const bool in = error <= 1, held = count_ > 0 && error_ <= 1;
        const bool wins = count_ == 0 || (in && !held) || (in && spline.size() < count_) ||
                          (!in && !held && error < error_);
        if (!wins) return;
        count_ = spline.size();
        error_ = error;
    }
    std::string text() const { return to_text(count_, error_); }

  private:
    const Cell& cell_;
    std::size_t count_{};
    double error_{};
};

std::string run_lyche_morken(const Cell& cell) {
    Best best{cell};
    for (const double tolerance : component_tolerances(cell))
        for (const double share : {0.0, 0.1})
            best.offer(lyche_morken(cell.track, 4, tolerance, share));
    return best.text();
}

std::string run_windowed(const Cell& cell, WindowParams params) {
    Best best{cell};
    const Spline first = samples_as_control_points(cell.track);
    for (const double tolerance : component_tolerances(cell)) {
        params.tolerance = tolerance;
        best.offer(reduce_windowed(first, params));
    }
    return best.text();
}

struct Method {
    std::string name;  // changes with every change of the method: it is part of the cache's key
    std::function<std::string(const Cell&)> run;
};

std::vector<Method> methods() {
    std::vector<Method> out{{"Lyche-Morken", run_lyche_morken},
                            {"global removal at samples",
                             [](const Cell& cell) {
                                 Best best{cell};
                                 best.offer(global_removal(cell.track, 4, cell.tolerance));
                                 return best.text();
                             }},
                            {"smoothing spline", [](const Cell& cell) {
                                 Best best{cell};
                                 best.offer(smoothing_within(cell.track, cell.tolerance));
                                 return best.text();
                             }}};
    for (const std::size_t window : {10u, 50u, 100u}) {
        WindowParams published;
        published.window = window;
        out.push_back({"Balaguer-Gobbetti window " + std::to_string(window),
                       [=](const Cell& cell) { return run_windowed(cell, published); }});
    }
    WindowParams banks;
    banks.head_anchored = false;
    banks.tail_share = 1;
    banks.against_first = true;
    out.push_back({"Banks window 50", [=](const Cell& c) { return run_windowed(c, banks); }});
    return out;
}

}  // namespace

KnotResult sisl_yardstick(const Cell& cell, Cache& cache) {
    return sisl_figures(cell, cache).yardstick;
}

std::vector<KnotResult> knot_rivals(const Cell& cell, Cache& cache) {
    const SislFigures figures = sisl_figures(cell, cache);
    std::vector<KnotResult> results{figures.yardstick, figures.best};
    for (const Method& method : methods())
        results.push_back(
            parse(method.name, cache.get(cache_key(method.name, hash(cell.track), cell.tolerance),
                                         [&] { return method.run(cell); })));
    return results;
}

}  // namespace fairlead::sim
