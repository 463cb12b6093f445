#pragma once
// The strain smoother in double precision, by other means: sparse normal equations (Eigen), full
// Jacobians, body-frame increments, Levenberg-Marquardt to the end.
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <vector>

#include "tests/ref/motions.hpp"

namespace fairlead::test {

inline double strain_lambda(double cutoff_hz, double step_s) {
    return std::pow(2 * std::sin(3.14159265358979323846 * cutoff_hz * step_s), -4);
}

/// One channel of a recording: the valid samples, in segments.
struct Samples {
    std::vector<std::size_t> record;  // where each came from
    std::vector<double> step;         // into each, in nominal steps; 0: it starts a segment
};

inline Samples samples_of(const std::vector<Pose>& motion, std::uint32_t valid, std::uint32_t gap,
                          double step_s) {
    Samples s;
    bool anew = true;
    for (std::size_t i = 0; i < motion.size(); ++i) {
        anew = anew || (motion[i].flags & (gap | flag::gap_before));
        if (!(motion[i].flags & valid)) continue;
        const double dt =
            anew ? 0 : static_cast<double>(motion[i].t_ns - motion[s.record.back()].t_ns) * 1e-9;
        s.step.push_back(dt / step_s);
        s.record.push_back(i);
        anew = false;
    }
    return s;
}
/// Samples i - 1, i and i + 1 belong together.
inline bool inside(const Samples& s, std::size_t i) {
    return i > 0 && i + 1 < s.step.size() && s.step[i] > 0 && s.step[i + 1] > 0;
}

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

inline Eigen::MatrixXd solve_sparse(const Sparse& a, const Eigen::MatrixXd& b) {
    return Eigen::SimplicialLDLT<Sparse>(a).solve(b);
}

/// Positions of the valid samples, smoothed.
inline std::vector<Vector3d> strain_positions(const std::vector<Pose>& motion, double cutoff_hz,
                                              double step_s) {
    const Samples s = samples_of(motion, flag::position_valid, flag::position_gap, step_s);
    const auto n = static_cast<Eigen::Index>(s.record.size());
    const double lambda = strain_lambda(cutoff_hz, step_s);
    Triplets rows;
    Eigen::MatrixXd y(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto k = static_cast<std::size_t>(i);
        y.row(i) = to_double(motion[s.record[k]].p_w_m);
        if (!inside(s, k)) continue;
        const double before = s.step[k], after = s.step[k + 1];
        const double w = std::sqrt(2 * lambda / (before + after));
        rows.emplace_back(i, i - 1, w / before);
        rows.emplace_back(i, i, -w / before - w / after);
        rows.emplace_back(i, i + 1, w / after);
    }
    Sparse d(n, n), a(n, n);
    d.setFromTriplets(rows.begin(), rows.end());
    a.setIdentity();
    a += Sparse(d.transpose()) * d;
    const Eigen::MatrixXd p = solve_sparse(a, y);
    std::vector<Vector3d> out;
    for (Eigen::Index i = 0; i < n; ++i) out.emplace_back(p.row(i).transpose());
    return out;
}

inline Eigen::Matrix3d cross_matrix(const Vector3d& v) {
    Eigen::Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}
/// Inverse of the right Jacobian of the rotation group.
inline Eigen::Matrix3d right_jacobian_inverse(const Vector3d& v) {
    const double a = v.norm();
    const Eigen::Matrix3d x = cross_matrix(v), one = Eigen::Matrix3d::Identity();
    if (a < 1e-5) return one + x / 2 + x * x / 12;
    return one + x / 2 + (1 / (a * a) - (1 + std::cos(a)) / (2 * a * std::sin(a))) * x * x;
}

class StrainOrientations {
  public:
    StrainOrientations(const std::vector<Pose>& motion, double cutoff_hz, double step_s)
        : s_{samples_of(motion, flag::orientation_valid, flag::orientation_gap, step_s)},
          lambda_{strain_lambda(cutoff_hz, step_s)} {
        for (const auto i : s_.record) raw_.push_back(to_double(motion[i].q_wb));
    }

    double cost(const std::vector<Quaterniond>& q) const {
        double sum = 0;
        for (std::size_t i = 0; i < q.size(); ++i) {
            sum += log_d(raw_[i].conjugate() * q[i]).squaredNorm();
            if (inside(s_, i)) sum += (weight(i) * bend(q, i)).squaredNorm();
        }
        return sum;
    }

    std::vector<Quaterniond> solve() const { return solve(raw_); }
    std::vector<Quaterniond> solve(std::vector<Quaterniond> q, int rounds = 200) const {
        double best = cost(q), damping = 0;
        for (int k = 0; k < rounds; ++k) {
            const Eigen::VectorXd x = step(q, damping);
            auto trial = q;
            for (std::size_t i = 0; i < q.size(); ++i)
                trial[i] =
                    (q[i] * exp_d(x.segment<3>(3 * static_cast<Eigen::Index>(i)))).normalized();
            const double c = cost(trial);
            if (c <= best * (1 + 1e-12)) {
                q = trial;
                best = c;
                damping = damping < 1e-6 ? 0 : damping / 10;
                if (x.lpNorm<Eigen::Infinity>() < 1e-9) break;
            } else {
                damping = damping == 0 ? 1e-3 : damping * 10;
            }
        }
        return q;
    }
    const std::vector<Quaterniond>& raw() const { return raw_; }

  private:
    double weight(std::size_t i) const {
        return std::sqrt(2 * lambda_ / (s_.step[i] + s_.step[i + 1]));
    }
    static Vector3d turn(const std::vector<Quaterniond>& q, std::size_t i) {
        return log_d(q[i].conjugate() * q[i + 1]);
    }
    Vector3d bend(const std::vector<Quaterniond>& q, std::size_t i) const {
        return turn(q, i) / s_.step[i + 1] - turn(q, i - 1) / s_.step[i];
    }

    Eigen::VectorXd step(const std::vector<Quaterniond>& q, double damping) const {
        const auto n = static_cast<Eigen::Index>(q.size());
        Triplets entries;
        const auto put = [&](Eigen::Index row, Eigen::Index sample, const Eigen::Matrix3d& m) {
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b) entries.emplace_back(row + a, 3 * sample + b, m(a, b));
        };
        Eigen::VectorXd r = Eigen::VectorXd::Zero(6 * n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const auto k = static_cast<std::size_t>(i);
            const Vector3d d = log_d(raw_[k].conjugate() * q[k]);
            r.segment<3>(3 * i) = d;
            put(3 * i, i, right_jacobian_inverse(d));
            if (!inside(s_, k)) continue;
            const Eigen::Index row = 3 * (n + i);
            const double w = weight(k), after = w / s_.step[k + 1], before = w / s_.step[k];
            r.segment<3>(row) = w * bend(q, k);
            const Eigen::Matrix3d a = right_jacobian_inverse(turn(q, k));
            const Eigen::Matrix3d b = right_jacobian_inverse(turn(q, k - 1));
            put(row, i + 1, after * a);
            put(row, i, -after * a.transpose() - before * b);
            put(row, i - 1, before * b.transpose());
        }
        Sparse j(6 * n, 3 * n), h(3 * n, 3 * n);
        j.setFromTriplets(entries.begin(), entries.end());
        h.setIdentity();
        h *= damping;
        h += Sparse(j.transpose()) * j;
        return -solve_sparse(h, j.transpose() * r);
    }

    Samples s_;
    double lambda_;
    std::vector<Quaterniond> raw_;
};

}  // namespace fairlead::test
