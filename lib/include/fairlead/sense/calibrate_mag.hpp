#pragma once
// Hard and soft iron of a magnetometer: the ellipsoid on which its readings lie while the board is
// turned through all directions. Least squares on the quadric v' A v + 2 g' v + h = 0 with the
// trace of A fixed [Li & Griffiths 2004, the algebraic fit], which holds wherever the origin lies:
//   |v|^2 = p0 (x^2 + y^2 - 2 z^2) + p1 (x^2 + z^2 - 2 y^2) + 2 p2 yz + ... + p8;
// centre = -A^-1 g. The soft-iron matrix is the symmetric root of A, scaled to keep the mean
// radius. In double: the normal equations square the quadric's condition, and float would lose it.
// This runs while a user calibrates, not in flight. Cost: 56 multiply-adds a reading, result() a 9
// x 9 Cholesky. RAM: 0.5 kB, whatever the number of readings.
#include <array>
#include <cstdint>

#include "fairlead/base/status.hpp"
#include "fairlead/sense/calibrate.hpp"
#include "fairlead/sense/calibrate_fit.hpp"

namespace fairlead {

struct MagCalibration {
    Affine correction{};
    float radius_uT{};        // of the corrected readings: the field's strength
    float residual{};         // quality: RMS distance from the sphere over its radius
    float offset_error_uT{};  // quality: standard error of the hard iron, from coverage and noise
};

class MagFit {
  public:
    static constexpr std::uint32_t samples_min = 100;
    static constexpr float offset_error_max_uT = 1.0f;  // more: turn it through more directions
    static constexpr float residual_max = 0.1f;         // more: this is no ellipsoid
    static constexpr float stretch_max = 4.0f;          // longest over shortest half-axis

    void push(const Vec3& mag_uT) noexcept {
        if (!is_finite(mag_uT)) return;
        const double x = scaled(mag_uT.x), y = scaled(mag_uT.y), z = scaled(mag_uT.z);
        const Row row{x * x + y * y - 2 * z * z,
                      x * x + z * z - 2 * y * y,
                      2 * y * z,
                      2 * z * x,
                      2 * x * y,
                      2 * x,
                      2 * y,
                      2 * z,
                      1};
        const double r2 = x * x + y * y + z * z;
        for (std::size_t i = 0; i < unknowns; ++i) {
            for (std::size_t j = 0; j <= i; ++j) normal_[at(i, j)] += row[i] * row[j];
            right_[i] += row[i] * r2;
        }
        squares_ += r2 * r2;
        ++count_;
    }
    void reset() noexcept { *this = {}; }
    std::uint32_t count() const noexcept { return count_; }

    Result<MagCalibration> result() const noexcept {
        if (count_ < samples_min) return Status::not_enough_data;
        Packed l{};
        if (!factor(l)) return Status::not_enough_data;  // all in one plane, say
        const Row p = solve(l, right_);
        const Matrix a{{p[0] + p[1] - 1, p[4], p[3]},
                       {p[4], p[0] - 2 * p[1] - 1, p[2]},
                       {p[3], p[2], p[1] - 2 * p[0] - 1}};
        const Vector g{p[5], p[6], p[7]};
        const Vector centre = -(inverse(a) * g);
        const double k = -p[8] - dot(g, centre);  // (v - c)' A (v - c) = k
        const Matrix shape = (1 / k) * a;
        if (!positive(shape)) return Status::not_enough_data;  // a cap fits a hyperboloid as well

        double left2 = squares_;
        for (std::size_t i = 0; i < unknowns; ++i) left2 -= p[i] * right_[i];
        const double noise2 = (left2 > 0 ? left2 : 0) / static_cast<double>(count_ - unknowns);
        MagCalibration out;
        out.residual = static_cast<float>(approx::sqrt(noise2) / (2 * approx::absolute(k)));
        const double spread = centre_variance(l, a);
        out.offset_error_uT = static_cast<float>(unit_uT * approx::sqrt(noise2 * spread));
        if (spread * static_cast<double>(count_) > spread_max) return Status::not_enough_data;

        Matrix root{};
        if (!square_root(shape, root)) return Status::bad_data;
        const double volume = determinant(root);  // product of the inverse half-axes
        const auto radius =
            1 / static_cast<double>(approx::exp(approx::log(static_cast<float>(volume)) / 3));
        out.correction.offset = {unscaled(centre.x), unscaled(centre.y), unscaled(centre.z)};
        out.correction.matrix = {narrowed(radius * root.x), narrowed(radius * root.y),
                                 narrowed(radius * root.z)};
        out.radius_uT = static_cast<float>(unit_uT * radius);
        if (!is_finite(out.correction.offset) || !(out.residual <= residual_max))
            return Status::bad_data;
        if (!(out.offset_error_uT <= offset_error_max_uT)) return Status::not_enough_data;
        if (stretch(shape) > static_cast<double>(stretch_max)) return Status::bad_data;
        return out;
    }

  private:
    static constexpr std::size_t unknowns = 9;
    static constexpr double unit_uT = 50;  // brings the sums near 1
    // how far the directions alone blow up the centre's variance: 2 for a whole sphere, 100 for a
    // half, 1e4 for a cap of 45 degrees; beyond, residuals cannot tell a sphere from anything
    static constexpr double spread_max = 1e4;
    using Vector = BasicVec3<double>;
    using Matrix = BasicMat3<double>;
    using Row = std::array<double, unknowns>;
    using Packed = std::array<double, unknowns*(unknowns + 1) / 2>;

    static double scaled(float v) noexcept { return static_cast<double>(v) / unit_uT; }
    static float unscaled(double v) noexcept { return static_cast<float>(v * unit_uT); }
    static Vec3 narrowed(const Vector& v) noexcept {
        return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    }
    static constexpr std::size_t at(std::size_t i, std::size_t j) noexcept {
        return i * (i + 1) / 2 + j;
    }

    bool factor(Packed& l) const noexcept {
        constexpr double dependent = 1e-9;  // of the diagonal: below, a direction is missing
        for (std::size_t i = 0; i < unknowns; ++i)
            for (std::size_t j = 0; j <= i; ++j) {
                double sum = normal_[at(i, j)];
                for (std::size_t k = 0; k < j; ++k) sum -= l[at(i, k)] * l[at(j, k)];
                if (i != j) {
                    l[at(i, j)] = sum / l[at(j, j)];
                    continue;
                }
                if (!(sum > dependent * normal_[at(i, i)])) return false;
                l[at(i, i)] = approx::sqrt(sum);
            }
        return true;
    }
    static Row solve(const Packed& l, const Row& b) noexcept {
        Row x = b;
        for (std::size_t i = 0; i < unknowns; ++i) {
            for (std::size_t k = 0; k < i; ++k) x[i] -= l[at(i, k)] * x[k];
            x[i] /= l[at(i, i)];
        }
        for (std::size_t i = unknowns; i-- > 0;) {
            for (std::size_t k = i + 1; k < unknowns; ++k) x[i] -= l[at(k, i)] * x[k];
            x[i] /= l[at(i, i)];
        }
        return x;
    }
    /// Largest diagonal of the centre's covariance per unit of noise: A^-1 cov(g) A^-1, the part
    /// that coverage decides.
    static double centre_variance(const Packed& l, const Matrix& a) noexcept {
        const Matrix by = inverse(a);
        double most = 0;
        for (const Vector& direction : {by.x, by.y, by.z}) {
            Row e{};
            e[5] = direction.x;
            e[6] = direction.y;
            e[7] = direction.z;
            const Row s = solve(l, e);
            const double variance = e[5] * s[5] + e[6] * s[6] + e[7] * s[7];
            most = variance > most ? variance : most;
        }
        return most;
    }
    static bool positive(const Matrix& m) noexcept {
        return m.x.x > 0 && m.x.x * m.y.y - m.x.y * m.x.y > 0 && determinant(m) > 0;
    }
    /// [Denman & Beavers 1976]: root -> m^1/2, other -> m^-1/2; quadratic, so few rounds do.
    static bool square_root(const Matrix& m, Matrix& root) noexcept {
        constexpr int rounds = 20;
        root = m;
        Matrix other{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        for (int i = 0; i < rounds; ++i) {
            const Matrix next = 0.5 * (root + inverse(other));
            other = 0.5 * (other + inverse(root));
            root = next;
        }
        const Matrix again = root * root;
        return approx::absolute(determinant(again) / determinant(m) - 1) < 1e-6;
    }
    /// Of a positive symmetric matrix: its powers, by squaring, turn into the projection on it.
    static double largest_eigenvalue(const Matrix& m) noexcept {
        constexpr int squarings = 8;  // the 256th power
        const auto trace = [](const Matrix& a) { return a.x.x + a.y.y + a.z.z; };
        Matrix power = (1 / trace(m)) * m;
        for (int i = 0; i < squarings; ++i) {
            power = power * power;
            power = (1 / trace(power)) * power;
        }
        return trace(m * power);
    }
    /// Longest over shortest half-axis: the roots of m^-1's and of m's largest eigenvalue.
    static double stretch(const Matrix& m) noexcept {
        return approx::sqrt(largest_eigenvalue(m) * largest_eigenvalue(inverse(m)));
    }

    Packed normal_{};
    Row right_{};
    double squares_{0};
    std::uint32_t count_{0};
};

}  // namespace fairlead
