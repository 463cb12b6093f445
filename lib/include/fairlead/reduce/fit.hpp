#pragma once
// Least squares of the window on a spline that continues a given polynomial, driven towards the
// largest errors.
//
// Beyond its head the curve is a polynomial P plus a jump of the highest coefficient at each later
// knot. As unknowns the jumps are hopelessly conditioned; the same functions are spanned by the
// B-splines whose first Order - 1 coefficients are zero (they leave P as it is at the first knot),
// which give a banded, well-conditioned system. Where the plain fit leaves the tolerance, Lawson's
// reweighting [C. L. Lawson 1961: weights times error, again] moves it towards the smallest largest
// error. Cost per pass: about 100 instructions per sample beyond the head and 300 per free knot (D
// = 3, Order = 4).
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/reduce/window.hpp"

namespace fairlead {

/// Planned knots beyond the frozen polynomial, in ticks after its knot.
template <class Channel, std::size_t MaxKnots>
struct Plan {
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;

    std::size_t size{0};
    std::array<std::int32_t, MaxKnots> knot{};
    std::array<std::array<float, D>, MaxKnots> jump{};  // of the coefficient of u^(Order - 1)
    std::array<std::array<float, D>, Order> start{};    // free start: coefficients at the start
    float worst{0};           // largest error beyond the head, 1 = tolerance
    std::size_t worst_at{0};  // and the sample where it stands
    float objective{0};       // sum of squared errors of the plain fit beyond the head
    std::size_t landing{0};   // this many of the last knots bring the curve to rest
    std::size_t covers{0};    // leading samples of the window within tolerance

    void insert(std::int32_t at) noexcept {
        std::size_t i = size;
        for (; i > 0 && knot[i - 1] > at; --i) {
            knot[i] = knot[i - 1];
            jump[i] = jump[i - 1];
        }
        knot[i] = at;
        jump[i] = {};
        ++size;
    }
    void erase(std::size_t i) noexcept {
        for (; i + 1 < size; ++i) {
            knot[i] = knot[i + 1];
            jump[i] = jump[i + 1];
        }
        --size;
    }
};

/// Values that the signal may take after the window: weak pseudo-samples that keep a plan from
/// running away beyond its data.
template <class Channel, std::size_t Count>
struct Future {
    std::size_t size{0};
    std::array<float, Count> u{};
    std::array<std::array<float, Channel::dimension>, Count> x{};
    std::array<float, Count> weight{};
};

/// A walk along the polynomials of a plan.
template <class Channel, std::size_t MaxKnots>
struct PlanWalk {
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;

    Polynomial<D, Order> p;
    float origin{0};      // tick that p is about
    std::size_t next{0};  // the next knot

    PlanWalk(const Polynomial<D, Order>& frozen, bool free,
             const Plan<Channel, MaxKnots>& plan) noexcept
        : p{frozen} {
        if (free) p.c = plan.start;
    }
    void pass_knot(const Plan<Channel, MaxKnots>& plan) noexcept {
        const auto knot = static_cast<float>(plan.knot[next]);
        p = p.shifted(knot - origin);
        origin = knot;
        for (std::size_t d = 0; d < D; ++d) p.c[Order - 1][d] += plan.jump[next][d];
        ++next;
    }
    /// Value at u, which must not fall. The knots between are passed: at most MaxKnots in all.
    std::array<float, D> at(float u, const Plan<Channel, MaxKnots>& plan) noexcept {
        while (next < plan.size && static_cast<float>(plan.knot[next]) < u) pass_knot(plan);
        return p(u - origin);
    }
};

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
class Fit {
  public:
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    using Samples = Window<Channel, N>;
    using KnotPlan = Plan<Channel, MaxKnots>;
    using Walk = PlanWalk<Channel, MaxKnots>;
    using Ahead = Future<Channel, Horizons>;

    struct Problem {
        const Samples& samples;
        std::size_t count;  // samples to serve, from the front
        const Ahead& ahead;
        const Polynomial<D, Order>& frozen;
        const typename Channel::Judge& judge;
        bool free;  // nothing is frozen yet: the fit may leave `frozen` from u = 0 on
    };

    /// Fits the jumps of the knots after the first `head`, which stay as they are; fills the rest
    /// of the plan. The samples that the head serves are taken as served.
    /// @return whether every sample is within `limit` times the tolerance.
    bool operator()(const Problem& problem, std::size_t head, std::size_t passes, float limit,
                    KnotPlan& plan) noexcept {
        plan.landing = 0;
        set_base(problem, head, plan);
        if (fixed_ != 0 && plan.size == head) {
            check_beyond(problem, limit, plan);
            plan.objective = objective_;
            return plan.covers == problem.count;
        }
        lay_knots(problem, plan);
        for (std::size_t i = first_; i < problem.count; ++i) weight_[i] = 1;
        float future = 1, best = 1e30f;
        for (std::size_t pass = 0;; ++pass) {
            solve(problem, future);
            to_jumps(plan);
            check_beyond(problem, limit, plan);
            if (pass == 0) plan.objective = objective_ + misfit(problem, plan);
            if (plan.covers == problem.count) return true;
            best = plan.worst < best ? plan.worst : best;
            if (pass >= passes || plan.worst > 4) break;
            // the weighted mean square is a lower bound of the squared minimax error
            if (pass >= 2 &&
                weighted_square(problem.count) > Channel::Judge::square_bound * limit * limit)
                break;
            if (pass >= 3 && best > 1 + 2.0f / static_cast<float>(pass)) break;
            reweight(problem.count, plan.worst);
            future *= 0.3f;
        }
        plan.worst = best;
        return false;
    }

    /// Tests a plan as it stands. @return whether it serves all samples.
    bool check(const Problem& problem, float limit, KnotPlan& plan) noexcept {
        set_base(problem, 0, plan);
        if (problem.free) base_.c = plan.start;
        check_beyond(problem, limit, plan);
        return plan.covers == problem.count;
    }

  private:
    static constexpr std::size_t Unknowns = MaxKnots + Order;
    using Vector = std::array<float, D>;

    /// The polynomial that is continued, and what the samples beyond leave of it.
    void set_base(const Problem& problem, std::size_t head, const KnotPlan& plan) noexcept {
        fixed_ = problem.free && head == 0 ? 0 : Order - 1;
        head_ = head;
        Walk walk{problem.frozen, problem.free && head > 0, plan};
        for (std::size_t q = 0; q < head; ++q) walk.pass_knot(plan);
        base_ = walk.p;
        origin_ = walk.origin;
        first_ = 0;
        if (head > 0)
            while (first_ < problem.count && problem.samples.u[first_] <= origin_) ++first_;
    }

    void lay_knots(const Problem& problem, const KnotPlan& plan) noexcept {
        // the first knot of a continued curve is the boundary
        const std::size_t from = head_ + (fixed_ ? 1 : 0);
        interior_ = plan.size - from;
        const float begin = fixed_ ? static_cast<float>(plan.knot[head_]) : 0.0f;
        // ahead of the samples the last polynomial goes on: basis functions made for the samples'
        // range keep the system well conditioned in float
        const float last = problem.samples.u[problem.count - 1];
        const float end = (last > begin ? last : begin) + 2;
        const std::size_t total = interior_ + Order;
        for (std::size_t j = 0; j < Order; ++j) {
            t_[j] = begin;
            t_[total + j] = end;
        }
        for (std::size_t j = 0; j < interior_; ++j)
            t_[Order + j] = static_cast<float>(plan.knot[from + j]);
        unknowns_ = total - fixed_;
        for (std::size_t i = first_; i < problem.count; ++i) {
            const Vector y = base_(problem.samples.u[i] - origin_);
            for (std::size_t d = 0; d < D; ++d) residual_[i][d] = problem.samples.x[i][d] - y[d];
        }
    }

    /// B-splines of the interval t_[h] <= u < t_[h + 1] (Cox, de Boor).
    void basis(std::size_t h, float u, std::array<float, Order>& b) const noexcept {
        b[0] = 1;
        for (std::size_t k = 1; k < Order; ++k) {
            float carry = 0;
            for (std::size_t i = 0; i < k; ++i) {
                const float right = t_[h + 1 + i], left = t_[h + 1 + i - k];
                const float share = right > left ? b[i] / (right - left) : 0;
                b[i] = carry + (right - u) * share;
                carry = (u - left) * share;
            }
            b[k] = carry;
        }
    }

    void add(std::size_t h, float u, float weight, const Vector& r) noexcept {
        std::array<float, Order> b;
        basis(h, u, b);
        const std::size_t skip = h + 1 < Order + fixed_ ? Order + fixed_ - 1 - h : 0;
        const std::size_t base = h + 1 - Order + skip - fixed_;
        for (std::size_t i = skip; i < Order; ++i) {
            const std::size_t row = base + (i - skip);
            const float wb = weight * b[i];
            for (std::size_t k = i; k < Order; ++k) a_[row][k - i] += wb * b[k];
            for (std::size_t d = 0; d < D; ++d) c_[row + fixed_][d] += wb * r[d];
        }
    }

    void solve(const Problem& problem, float future) noexcept {
        const std::size_t m = unknowns_;
        for (std::size_t i = 0; i < m; ++i) a_[i].fill(0);
        for (std::size_t i = 0; i < m + fixed_; ++i) c_[i].fill(0);
        std::size_t h = Order - 1;
        const std::size_t last = interior_ + Order - 1;
        for (std::size_t i = first_; i < problem.count; ++i) {
            const float u = problem.samples.u[i];
            if (u <= t_[0] && fixed_) continue;
            while (h < last && t_[h + 1] <= u) ++h;
            add(h, u, weight_[i], residual_[i]);
        }
        for (std::size_t i = 0; i < problem.ahead.size; ++i) {
            const float u = problem.ahead.u[i];
            while (h < last && t_[h + 1] <= u) ++h;
            const Vector y = base_(u - origin_);
            Vector r;
            for (std::size_t d = 0; d < D; ++d) r[d] = problem.ahead.x[i][d] - y[d];
            const float w = problem.ahead.weight[i] * future;
            add(h, u, w > 1e-6f ? w : 1e-6f, r);
        }
        factor(m);
        substitute(m);
    }

    void factor(std::size_t m) noexcept {
        float largest = 0;
        for (std::size_t i = 0; i < m; ++i) largest = a_[i][0] > largest ? a_[i][0] : largest;
        const float ridge = 1e-7f * largest + 1e-12f;
        for (std::size_t i = 0; i < m; ++i) {
            a_[i][0] += ridge;
            if (!(a_[i][0] > ridge)) a_[i][0] = ridge;
            for (std::size_t j = 1; j < Order && i + j < m; ++j) {
                const float f = a_[i][j] / a_[i][0];
                for (std::size_t k = j; k < Order; ++k) a_[i + j][k - j] -= f * a_[i][k];
            }
        }
    }

    void substitute(std::size_t m) noexcept {
        for (std::size_t i = 0; i < m; ++i)
            for (std::size_t j = 1; j < Order && i + j < m; ++j) {
                const float f = a_[i][j] / a_[i][0];
                for (std::size_t d = 0; d < D; ++d) c_[i + j + fixed_][d] -= f * c_[i + fixed_][d];
            }
        for (std::size_t i = m; i-- > 0;)
            for (std::size_t d = 0; d < D; ++d) {
                float v = c_[i + fixed_][d];
                for (std::size_t j = 1; j < Order && i + j < m; ++j)
                    v -= a_[i][j] * c_[i + j + fixed_][d];
                c_[i + fixed_][d] = v / a_[i][0];
            }
    }

    /// Control points -> jumps of the highest coefficient (and the free start), by differencing.
    void to_jumps(KnotPlan& plan) noexcept {
        const bool free = fixed_ == 0;
        const std::size_t total = interior_ + Order;
        float factorial = 1;
        if (free)
            for (std::size_t d = 0; d < D; ++d) plan.start[0][d] = base_.c[0][d] + c_[0][d];
        for (std::size_t k = 1; k < Order; ++k) {
            for (std::size_t j = total; j-- > k;) {
                const float width = t_[j + Order - k] - t_[j];
                const float f = width > 0 ? static_cast<float>(Order - k) / width : 0;
                for (std::size_t d = 0; d < D; ++d) c_[j][d] = f * (c_[j][d] - c_[j - 1][d]);
            }
            factorial *= static_cast<float>(k);
            if (free)
                for (std::size_t d = 0; d < D; ++d)
                    plan.start[k][d] = base_.c[k][d] + c_[k][d] / factorial;
        }
        for (std::size_t q = head_; q < plan.size; ++q) {
            const std::size_t j = Order - 1 + (q - head_) + (free ? 1 : 0);
            for (std::size_t d = 0; d < D; ++d)
                plan.jump[q][d] = (c_[j][d] - (j > Order - 1 ? c_[j - 1][d] : 0)) / factorial;
        }
    }

    /// Walks the very polynomials that would be frozen over the samples beyond the head.
    void check_beyond(const Problem& problem, float limit, KnotPlan& plan) noexcept {
        Walk walk{base_, fixed_ == 0, plan};
        walk.origin = origin_;
        walk.next = head_;
        plan.worst = 0;
        plan.worst_at = first_;
        plan.covers = problem.count;
        objective_ = 0;
        for (std::size_t i = first_; i < problem.count; ++i) {
            const float e =
                problem.judge.error(walk.at(problem.samples.u[i], plan), problem.samples.x[i]);
            error_[i] = e;
            objective_ += e * e;
            if (!(e <= limit) && plan.covers == problem.count) plan.covers = i;
            if (!(e <= plan.worst)) {
                plan.worst = e;
                plan.worst_at = i;
            }
        }
    }

    float misfit(const Problem& problem, const KnotPlan& plan) const noexcept {
        Walk walk{base_, fixed_ == 0, plan};
        walk.origin = origin_;
        walk.next = head_;
        float sum = 0;
        for (std::size_t i = 0; i < problem.ahead.size; ++i) {
            const Vector y = walk.at(problem.ahead.u[i], plan);
            for (std::size_t d = 0; d < D; ++d) {
                const float e = (problem.ahead.x[i][d] - y[d]) * problem.judge.per_limit[d];
                sum += problem.ahead.weight[i] * e * e;
            }
        }
        return sum;
    }

    float weighted_square(std::size_t count) const noexcept {
        float sum = 0;
        for (std::size_t i = first_; i < count; ++i) sum += weight_[i] * error_[i] * error_[i];
        return sum / static_cast<float>(count - first_);
    }

    void reweight(std::size_t count, float worst) noexcept {
        float sum = 0;
        for (std::size_t i = first_; i < count; ++i) {
            weight_[i] *= 0.02f + error_[i] / worst;
            sum += weight_[i];
        }
        const float scale = static_cast<float>(count - first_) / sum;
        for (std::size_t i = first_; i < count; ++i) weight_[i] *= scale;
    }

    std::array<float, Unknowns + Order> t_{};
    std::array<std::array<float, Order>, Unknowns> a_{};  // upper band of the normal matrix
    std::array<Vector, Unknowns> c_{};                    // right sides, then control points
    std::array<Vector, Samples::capacity> residual_{};
    std::array<float, Samples::capacity> weight_{};
    std::array<float, Samples::capacity> error_{};
    Polynomial<D, Order> base_{};
    float origin_{0}, objective_{0};
    std::size_t first_{0}, head_{0}, interior_{0}, unknowns_{0}, fixed_{0};
};

}  // namespace fairlead
