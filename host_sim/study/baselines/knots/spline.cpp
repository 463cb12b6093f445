#include "host_sim/study/baselines/knots/spline.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::sim {
namespace {

std::size_t find_span(const std::vector<double>& knots, std::size_t order, double t) {
    const auto begin = knots.begin() + static_cast<std::ptrdiff_t>(order - 1);
    const auto end = knots.end() - static_cast<std::ptrdiff_t>(order);
    auto above = std::upper_bound(begin, end, t);
    if (above == begin) ++above;
    auto i = static_cast<std::size_t>(above - knots.begin()) - 1;
    while (i > order - 1 && !(knots[i] < knots[i + 1])) --i;  // the right end belongs to the left
    return i;
}

}  // namespace

std::size_t Spline::span(double t) const { return find_span(knots, order, t); }

void basis(const std::vector<double>& knots, std::size_t order, std::size_t span, double t,
           double* values) {
    double left[order_max], right[order_max];
    values[0] = 1;
    for (std::size_t j = 1; j < order; ++j) {
        left[j] = t - knots[span + 1 - j];
        right[j] = knots[span + j] - t;
        double saved = 0;
        for (std::size_t r = 0; r < j; ++r) {
            const double width = right[r + 1] + left[j - r];
            const double part = width != 0 ? values[r] / width : 0;
            values[r] = saved + right[r + 1] * part;
            saved = left[j - r] * part;
        }
        values[j] = saved;
    }
}

void Spline::evaluate(double t, double* value) const {
    const std::size_t at = span(t);
    double b[order_max];
    basis(knots, order, at, t, b);
    for (std::size_t d = 0; d < dim; ++d) {
        value[d] = 0;
        for (std::size_t j = 0; j < order; ++j)
            value[d] += b[j] * c[(at + 1 - order + j) * dim + d];
    }
}

InsertionRow insertion_row(const std::vector<double>& coarse, const std::vector<double>& fine,
                           std::size_t order, std::size_t i) {
    const std::size_t span = find_span(coarse, order, fine[i]);
    InsertionRow row;
    row.first = span + 1 - order;
    row.value[0] = 1;
    for (std::size_t j = 1; j < order; ++j) {  // the blossom: a new argument at every level
        const double t = fine[i + j];
        double saved = 0;
        for (std::size_t r = 0; r < j; ++r) {
            const double lo = coarse[span + 1 + r - j], hi = coarse[span + 1 + r];
            const double part = hi > lo ? row.value[r] / (hi - lo) : 0;
            row.value[r] = saved + (hi - t) * part;
            saved = (t - lo) * part;
        }
        row.value[j] = saved;
    }
    return row;
}

Spline refined(const Spline& spline, const std::vector<double>& fine) {
    Spline out{spline.order, spline.dim, fine, {}};
    out.c.resize(out.size() * out.dim);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const InsertionRow row = insertion_row(spline.knots, fine, spline.order, i);
        for (std::size_t d = 0; d < out.dim; ++d)
            for (std::size_t j = 0; j < out.order; ++j)
                out.c[i * out.dim + d] += row.value[j] * spline.c[(row.first + j) * out.dim + d];
    }
    return out;
}

Spline elevated(const Spline& linear, std::size_t order) {
    Spline out{order, linear.dim, {}, {}};
    for (std::size_t i = 1; i + 1 < linear.knots.size(); ++i) {
        const bool end = i == 1 || i + 2 == linear.knots.size();
        out.knots.insert(out.knots.end(), end ? order : order - 1, linear.knots[i]);
    }
    out.c.resize(out.size() * out.dim);
    for (std::size_t i = 0; i < out.size(); ++i) {
        double average = 0;
        for (std::size_t j = 1; j < order; ++j) average += out.knots[i + j];
        linear.evaluate(average / static_cast<double>(order - 1), &out.c[i * out.dim]);
    }
    return out;
}

std::vector<double> clamped(const Track& track, std::size_t order,
                            const std::vector<double>& interior) {
    std::vector<double> knots(order, track.t.front());
    knots.insert(knots.end(), interior.begin(), interior.end());
    knots.insert(knots.end(), order, track.t.back());
    return knots;
}

BandSystem::BandSystem(std::size_t n, std::size_t band, std::size_t sides)
    : n_{n}, band_{band}, sides_{sides}, a_(n * band), b_(n * sides) {}

void BandSystem::clear() {
    std::fill(a_.begin(), a_.end(), 0.0);
    std::fill(b_.begin(), b_.end(), 0.0);
}

void BandSystem::add(std::size_t first, const double* row, std::size_t count, const double* value,
                     double weight) {
    for (std::size_t i = 0; i < count; ++i) {
        const double w = weight * row[i];
        for (std::size_t j = i; j < count; ++j) a_[(first + i) * band_ + (j - i)] += w * row[j];
        for (std::size_t d = 0; d < sides_; ++d) b_[(first + i) * sides_ + d] += w * value[d];
    }
}

bool BandSystem::solve() {
    for (std::size_t i = 0; i < n_; ++i) {
        const double* const pivot = &a_[i * band_];
        if (!(pivot[0] > 0)) return false;
        const std::size_t reach = std::min(band_, n_ - i);
        for (std::size_t j = 1; j < reach; ++j) {
            const double f = pivot[j] / pivot[0];
            for (std::size_t k = j; k < reach; ++k) a_[(i + j) * band_ + (k - j)] -= f * pivot[k];
            for (std::size_t d = 0; d < sides_; ++d)
                b_[(i + j) * sides_ + d] -= f * b_[i * sides_ + d];
        }
    }
    for (std::size_t i = n_; i-- > 0;) {
        const std::size_t reach = std::min(band_, n_ - i);
        for (std::size_t d = 0; d < sides_; ++d) {
            double v = b_[i * sides_ + d];
            for (std::size_t k = 1; k < reach; ++k)
                v -= a_[i * band_ + k] * b_[(i + k) * sides_ + d];
            b_[i * sides_ + d] = v / a_[i * band_];
        }
    }
    return true;
}

bool fit_samples(const Track& track, const std::vector<double>& weights, Spline& spline) {
    const std::size_t k = spline.order, n = spline.size();
    BandSystem system{n, k, spline.dim};
    double b[order_max];
    std::size_t at = k - 1;
    for (std::size_t i = 0; i < track.size(); ++i) {
        const double t = track.t[i];
        if (!(at + 1 < n && t < spline.knots[at + 1])) at = spline.span(t);
        basis(spline.knots, k, at, t, b);
        system.add(at + 1 - k, b, k, track.at(i), weights.empty() ? 1.0 : weights[i]);
    }
    // coefficients that no sample supports: a trace of second difference keeps them defined
    const double bend[3] = {1, -2, 1}, zero[order_max] = {};
    for (std::size_t i = 0; i + 2 < n; ++i) system.add(i, bend, 3, zero, 1e-9);
    if (!system.solve()) return false;
    spline.c = system.solution();
    return true;
}

double sample_errors(const Track& track, const Spline& spline, std::vector<double>& errors) {
    errors.resize(track.size());
    double largest = 0;
    for (std::size_t i = 0; i < track.size(); ++i) {
        double value[4];
        spline.evaluate(track.t[i], value);
        errors[i] = track.error(i, value);
        if (!(errors[i] <= largest)) largest = errors[i];
    }
    return largest;
}

double largest_error(const Track& track, const Spline& spline) {
    std::vector<double> errors;
    return sample_errors(track, spline, errors);
}

}  // namespace fairlead::sim
