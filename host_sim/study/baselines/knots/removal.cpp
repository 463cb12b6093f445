#include "host_sim/study/baselines/knots/removal.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::sim {
namespace {

bool is_interior(const Spline& spline, std::size_t i) {
    return i >= spline.order && i < spline.size();
}

std::vector<double> without(const std::vector<double>& knots,
                            const std::vector<std::size_t>& removed, std::size_t count) {
    std::vector<char> gone(knots.size(), 0);
    for (std::size_t i = 0; i < count; ++i) gone[removed[i]] = 1;
    std::vector<double> left;
    for (std::size_t i = 0; i < knots.size(); ++i)
        if (gone[i] == 0) left.push_back(knots[i]);
    return left;
}

/// Removes the longest prefix of `order` that a search by halves finds; false where none goes.
bool remove_prefix(Spline& g, const std::vector<std::size_t>& order,
                   const Approximate& approximate) {
    std::size_t fits = 0, fails = order.size() + 1;
    Spline best, trial;
    for (std::size_t count = order.size(); fails - fits > 1; count = (fits + fails) / 2) {
        if (approximate(without(g.knots, order, count), trial)) {
            fits = count;
            best = trial;
        } else {
            fails = count;
        }
    }
    if (fits == 0) return false;
    g = best;
    return true;
}

/// Tries every knot alone, lightest first; false where none goes.
bool remove_one(Spline& g, const Approximate& approximate) {
    std::vector<std::pair<double, std::size_t>> weights;
    for (std::size_t i = g.order; i < g.size(); ++i)
        if (g.knots[i] < g.knots[i + 1]) weights.push_back({knot_weight(g, i), i});
    std::sort(weights.begin(), weights.end());
    constexpr std::size_t tries_max = 24;
    Spline trial;
    for (std::size_t i = 0; i < std::min(weights.size(), tries_max); ++i) {
        if (!approximate(without(g.knots, {weights[i].second}, 1), trial)) continue;
        g = trial;
        return true;
    }
    return false;
}

}  // namespace

double knot_weight(const Spline& spline, std::size_t i) {
    const std::size_t k = spline.order, first = i - k;
    const double x = spline.knots[i];
    const auto coarse = [&](std::size_t j) { return spline.knots[j < i ? j : j + 1]; };
    // the k + 1 coefficients around the knot are refined from k: v spans what these cannot reach
    double v[order_max + 1] = {1}, length = 1;
    for (std::size_t j = 1; j <= k; ++j) {
        // c_j = a_j d_j + (1 - a_j) d_{j-1}, columns of d made zero one after another
        const auto share = [&](std::size_t row) {
            const double lo = coarse(first + row), hi = coarse(first + row + k - 1);
            return (x - lo) / (hi - lo);
        };
        const double above = j == 1 ? 1 : share(j - 1);
        const double below = j == k ? 1 : 1 - share(j);
        v[j] = -v[j - 1] * above / below;
        length += std::fabs(v[j]);
    }
    double weight = 0;
    for (std::size_t d = 0; d < spline.dim; ++d) {
        double out = 0;
        for (std::size_t j = 0; j <= k; ++j) out += v[j] * spline.c[(first + j) * spline.dim + d];
        weight = std::max(weight, std::fabs(out) / length);
    }
    return weight;
}

std::vector<std::size_t> removal_order(const Spline& spline, double tolerance) {
    struct Ranked {
        int group;
        double weight;
        std::size_t i;
    };
    std::vector<Ranked> ranked;
    for (std::size_t i = spline.order; i < spline.size(); ++i) {
        if (!(spline.knots[i] < spline.knots[i + 1])) continue;
        const double weight = knot_weight(spline, i);
        const double ratio = std::max(weight / tolerance, 1e-3);
        ranked.push_back({static_cast<int>(std::floor(std::log2(ratio))), weight, i});
    }
    std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
        return a.group != b.group ? a.group < b.group : a.weight < b.weight;
    });
    std::vector<char> taken(spline.knots.size() + 1, 0);
    std::vector<std::size_t> order;
    for (std::size_t begin = 0, end = 0; begin < ranked.size(); begin = end) {
        while (end < ranked.size() && ranked[end].group == ranked[begin].group) ++end;
        std::vector<std::size_t> later;
        for (std::size_t r = begin; r < end; ++r) {
            const std::size_t i = ranked[r].i;
            const bool crowded = taken[i - 1] != 0 || taken[i + 1] != 0;
            (crowded ? later : order).push_back(i);
            if (!crowded) taken[i] = 1;
        }
        for (const std::size_t i : later) taken[i] = 1;
        order.insert(order.end(), later.begin(), later.end());
    }
    return order;
}

Spline remove_knots(Spline start, const Approximate& approximate, const RemovalParams& params) {
    for (std::size_t round = 0; round < params.rounds_max; ++round) {
        const auto order = removal_order(start, params.tolerance);
        if (order.empty() || !remove_prefix(start, order, approximate)) break;
    }
    while (params.one_by_one && is_interior(start, start.order) && remove_one(start, approximate)) {
    }
    return start;
}

Spline reduce_curve(const Spline& f, double tolerance) {
    const std::size_t k = f.order;
    const auto approximate = [&](const std::vector<double>& knots, Spline& out) {
        out = {k, f.dim, knots, {}};
        BandSystem system{out.size(), k, f.dim};
        std::vector<InsertionRow> rows(f.size());
        for (std::size_t i = 0; i < f.size(); ++i) {
            rows[i] = insertion_row(knots, f.knots, k, i);
            const double support = f.knots[i + k] - f.knots[i];  // as in the L2 norm of the curve
            system.add(rows[i].first, rows[i].value, k, &f.c[i * f.dim], support);
        }
        if (!system.solve()) return false;
        out.c = system.solution();
        for (std::size_t i = 0; i < f.size(); ++i) {
            for (std::size_t d = 0; d < f.dim; ++d) {
                double v = -f.c[i * f.dim + d];
                for (std::size_t j = 0; j < k; ++j)
                    v += rows[i].value[j] * out.c[(rows[i].first + j) * f.dim + d];
                if (!(std::fabs(v) <= tolerance)) return false;
            }
        }
        return true;
    };
    return remove_knots(f, approximate, {tolerance, 40, false});
}

Spline lyche_morken(const Track& track, std::size_t order, double tolerance, double share) {
    std::vector<double> inner(track.t.begin() + 1, track.t.end() - 1);
    Spline linear{2, track.dim(), clamped(track, 2, inner), track.x};
    if (share > 0) linear = reduce_curve(linear, share * tolerance);
    if (order == 2) return reduce_curve(linear, (1 - share) * tolerance);
    return reduce_curve(elevated(linear, order), (1 - share) * tolerance);
}

Spline global_removal(const Track& track, std::size_t order, double tolerance) {
    constexpr int passes_max = 8;
    std::vector<double> errors;
    const auto approximate = [&](const std::vector<double>& knots, Spline& out) {
        out = {order, track.dim(), knots, {}};
        std::vector<double> weights(track.size(), 1);
        for (int pass = 0; pass < passes_max; ++pass) {
            if (!fit_samples(track, weights, out)) return false;
            const double largest = sample_errors(track, out, errors);
            if (largest <= tolerance) return true;
            if (!(largest < (pass == 0 ? 3 : 1.6) * tolerance)) return false;  // out of reach
            double sum = 0;
            for (std::size_t i = 0; i < weights.size(); ++i)
                sum += weights[i] *= 0.02 + errors[i] / largest;
            for (double& w : weights) w *= static_cast<double>(weights.size()) / sum;
        }
        return false;
    };
    Spline best;
    const auto offer = [&](const std::vector<double>& knots) {
        Spline start;
        if (!approximate(knots, start)) return false;
        const Spline reduced = remove_knots(start, approximate, {tolerance, 40, true});
        if (best.c.empty() || reduced.size() < best.size()) best = reduced;
        return true;
    };
    for (const std::size_t step : {2u, 1u}) {
        std::vector<double> inner;
        for (std::size_t i = step; i + order < track.size(); i += step)
            if (i >= order / 2) inner.push_back(track.t[i]);
        if (offer(clamped(track, order, inner))) break;
    }
    const double component = track.channel == Channel::position ? tolerance : tolerance / 4;
    const Spline published = lyche_morken(track, order, component, 0);
    offer(published.knots);
    if (best.c.empty()) best = published;
    return best;
}

}  // namespace fairlead::sim
