#pragma once
// A B-spline curve of any order and dimension, in double, and the fits that the rivals share.
// Coefficient i belongs to the knots i .. i + order. Ends are clamped where not said otherwise.
#include <cstddef>
#include <vector>

#include "host_sim/study/baselines/track.hpp"

namespace fairlead::sim {

struct Spline {
    std::size_t order{4}, dim{};
    std::vector<double> knots;  // size() + order of them
    std::vector<double> c;      // size() x dim

    std::size_t size() const { return knots.size() - order; }
    /// Largest i in [order - 1, size()) with knots[i] <= t and knots[i] < knots[i + 1].
    std::size_t span(double t) const;
    void evaluate(double t, double* value) const;
};

constexpr std::size_t order_max = 6;

/// The `order` B-splines that live on `span`, at t (Cox, de Boor).
void basis(const std::vector<double>& knots, std::size_t order, std::size_t span, double t,
           double* values);

/// One row of the knot insertion matrix from `coarse` to `fine`: coefficient i of the refined
/// curve is the sum of row[j] times coefficient first + j, j < order (Oslo algorithm 1).
struct InsertionRow {
    std::size_t first{};
    double value[order_max]{};
};
InsertionRow insertion_row(const std::vector<double>& coarse, const std::vector<double>& fine,
                           std::size_t order, std::size_t i);

/// The same curve on the knots `fine`, which must contain the spline's own.
Spline refined(const Spline& spline, const std::vector<double>& fine);

/// The same curve one or more orders higher; knots multiply so that smoothness stays.
/// Only for linear splines (order 2), where the coefficients are values at the knot averages.
Spline elevated(const Spline& linear, std::size_t order);

/// Clamped knots over the track: both ends `order` times, `interior` between them.
std::vector<double> clamped(const Track& track, std::size_t order,
                            const std::vector<double>& interior);

/// Symmetric positive definite system with `band` diagonals on and above the main one and
/// several right-hand sides, solved in place by LDL^T.
class BandSystem {
  public:
    BandSystem(std::size_t n, std::size_t band, std::size_t sides);
    void clear();
    /// Adds weight * row^T row and weight * row^T value, row standing at columns first ...
    void add(std::size_t first, const double* row, std::size_t count, const double* value,
             double weight);
    /// Overwrites the system; false where a pivot vanishes. solution() is n x sides.
    bool solve();
    const std::vector<double>& solution() const { return b_; }

  private:
    std::size_t n_, band_, sides_;
    std::vector<double> a_, b_;
};

/// Least squares through all samples (weights may be empty); false where the knots do not allow it.
bool fit_samples(const Track& track, const std::vector<double>& weights, Spline& spline);

/// Error of every sample, and the largest of them.
double sample_errors(const Track& track, const Spline& spline, std::vector<double>& errors);
double largest_error(const Track& track, const Spline& spline);

}  // namespace fairlead::sim
