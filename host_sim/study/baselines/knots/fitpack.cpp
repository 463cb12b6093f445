#include "host_sim/study/baselines/knots/fitpack.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::sim {
namespace {

constexpr std::size_t order = 4;
constexpr double close_enough = 1e-3;  // of s, as in FITPACK

/// Squared residuals of the samples, summed over components; returns their sum.
double residuals(const Track& track, const Spline& spline, std::vector<double>& squares) {
    squares.assign(track.size(), 0);
    double sum = 0;
    for (std::size_t i = 0; i < track.size(); ++i) {
        double value[4];
        spline.evaluate(track.t[i], value);
        for (std::size_t d = 0; d < spline.dim; ++d) {
            const double e = value[d] - track.at(i)[d];
            squares[i] += e * e;
        }
        sum += squares[i];
    }
    return sum;
}

/// Knots stand at samples, given by index. An interval between two of them, with what it misses.
struct Interval {
    std::size_t begin{}, end{};
    double sum{};
};

/// Adds up to `count` knots, one after another, at the middle sample of the interval with the
/// largest sum; false where no interval holds another sample.
bool add_knots(std::vector<std::size_t>& at, const std::vector<double>& squares,
               std::size_t count) {
    std::vector<Interval> intervals;
    for (std::size_t q = 0; q + 1 < at.size(); ++q) {
        Interval interval{at[q], at[q + 1], 0};
        for (std::size_t i = at[q]; i < at[q + 1]; ++i) interval.sum += squares[i];
        intervals.push_back(interval);
    }
    bool added = false;
    for (; count > 0; --count) {
        Interval* worst = nullptr;
        for (Interval& interval : intervals)
            if (interval.end - interval.begin >= 2 &&
                (worst == nullptr || interval.sum > worst->sum))
                worst = &interval;
        if (worst == nullptr) break;
        const std::size_t middle = worst->begin + (worst->end - worst->begin) / 2;
        const double part = static_cast<double>(middle - worst->begin) /
                            static_cast<double>(worst->end - worst->begin);
        const Interval right{middle, worst->end, worst->sum * (1 - part)};
        *worst = {worst->begin, middle, worst->sum * part};
        intervals.push_back(right);
        at.insert(std::upper_bound(at.begin(), at.end(), middle), middle);
        added = true;
    }
    return added;
}

std::vector<double> knots_at(const Track& track, const std::vector<std::size_t>& at) {
    std::vector<double> interior;
    for (std::size_t q = 1; q + 1 < at.size(); ++q) interior.push_back(track.t[at[q]]);
    return clamped(track, order, interior);
}

/// The jump of the third derivative at interior knot i as a row over coefficients i - order ... i.
void jump_row(const std::vector<double>& knots, std::size_t i, double scale, double* row) {
    const std::size_t first = i - order;
    for (std::size_t j = 0; j <= order; ++j) {
        double product = 1;  // divided difference of (t - .)^3 over the knots j .. j + order
        for (std::size_t m = 0; m <= order; ++m)
            if (first + j + m != i) product *= (knots[i] - knots[first + j + m]) / scale;
        row[j] = (knots[first + j + order] - knots[first + j]) / scale / product;
    }
}

/// Least squares plus the squared jumps / p.
bool fit_damped(const Track& track, double p, Spline& spline) {
    BandSystem system{spline.size(), order + 1, spline.dim};
    double b[order_max];
    for (std::size_t i = 0; i < track.size(); ++i) {
        const std::size_t at = spline.span(track.t[i]);
        basis(spline.knots, order, at, track.t[i], b);
        system.add(at + 1 - order, b, order, track.at(i), 1);
    }
    const double zero[order_max] = {};
    const double scale =
        (track.t.back() - track.t.front()) / static_cast<double>(spline.size() - order + 1);
    for (std::size_t i = order; i < spline.size(); ++i) {
        double row[order + 1];
        jump_row(spline.knots, i, scale, row);
        system.add(i - order, row, order + 1, zero, 1 / p);
    }
    if (!system.solve()) return false;
    spline.c = system.solution();
    return true;
}

}  // namespace

Spline smoothing_spline(const Track& track, double s) {
    std::vector<std::size_t> at{0, track.size() - 1};
    std::vector<double> squares;
    std::size_t count = 1;
    double sum = 0, sum_before = 0;
    Spline spline;
    for (bool first = true;; first = false) {
        spline = {order, track.dim(), knots_at(track, at), {}};
        if (!fit_samples(track, {}, spline)) return spline;
        sum_before = sum;
        sum = residuals(track, spline, squares);
        if (sum <= s * (1 + close_enough)) break;
        if (!first) {
            const double gain = sum_before - sum;
            const double wanted = gain > close_enough * s
                                      ? static_cast<double>(count) * (sum - s) / gain
                                      : 2 * static_cast<double>(count);
            const auto low = static_cast<double>(std::max<std::size_t>(count / 2, 1));
            count = static_cast<std::size_t>(
                std::min(2 * static_cast<double>(count), std::max(wanted, low)));
        }
        if (!add_knots(at, squares, count)) return spline;
    }
    if (std::fabs(sum - s) <= close_enough * s || at.size() == 2) return spline;
    Spline damped = spline;
    double low = -12, high = 12;  // log10 p
    for (int step = 0; step < 40 && std::fabs(sum - s) > close_enough * s; ++step) {
        const double middle = (low + high) / 2;
        if (!fit_damped(track, std::pow(10, middle), damped)) return spline;
        sum = residuals(track, damped, squares);
        (sum > s ? low : high) = middle;
    }
    return damped;
}

Spline smoothing_within(const Track& track, double tolerance) {
    const auto parts = static_cast<double>(track.size() * track.dim());
    double low = -5, high = 0.5;  // log10 of s / (samples x components x tolerance^2)
    Spline best;
    for (int step = 0; step < 24; ++step) {
        const double middle = (low + high) / 2;
        const Spline trial =
            smoothing_spline(track, std::pow(10, middle) * parts * tolerance * tolerance);
        const bool fits = !trial.c.empty() && largest_error(track, trial) <= tolerance;
        (fits ? low : high) = middle;
        if (fits && (best.c.empty() || trial.size() < best.size())) best = trial;
    }
    return best;
}

}  // namespace fairlead::sim
