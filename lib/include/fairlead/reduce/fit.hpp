#pragma once
// Least squares of the window on a spline that continues the frozen polynomial, driven towards the
// largest errors.
//
// Beyond the frozen polynomial P the curve is P + sum of jumps at the planned knots. As unknowns
// the jumps are hopelessly conditioned; the same functions are spanned by the B-splines whose first
// Order - 1 coefficients are zero (they leave P as it is at the first knot), which give a banded,
// well-conditioned system. Where the plain fit leaves the tolerance, Lawson's reweighting
// [C. L. Lawson 1961: weights times error, again] moves it towards the smallest largest error.
// Cost per pass: about 100 instructions per sample and 300 per knot (D = 3, Order = 4).
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
    float worst{0};                                     // largest error, 1 = tolerance
    float objective{0};                                 // sum of squared errors of the plain fit
    std::size_t covers{0};  // leading samples of the window within tolerance

    void insert(std::int32_t at) noexcept {
        std::size_t i = size;
        for (; i > 0 && knot[i - 1] > at; --i) knot[i] = knot[i - 1];
        knot[i] = at;
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
    std::array<std::array<float, Channel::dimension>, Count> r{};
    std::array<float, Count> weight{};
};

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
class Fit {
  public:
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    using Samples = Window<Channel, N>;
    using KnotPlan = Plan<Channel, MaxKnots>;
    using Ahead = Future<Channel, Horizons>;

    /// Fits plan.knot to the first `count` samples; fills everything else of the plan. `frozen` is
    /// the polynomial that the residuals r refer to; a free fit may leave it from u = 0 on.
    /// @return whether every sample is within `limit` times the tolerance.
    bool operator()(const Samples& samples, std::size_t count, const Ahead& ahead,
                    const Polynomial<D, Order>& frozen, const typename Channel::Judge& judge,
                    bool free, std::size_t passes, float limit, KnotPlan& plan) noexcept {
        fixed_ = free ? 0 : Order - 1;
        if (!free && plan.size == 0) {
            check(samples, count, frozen, judge, limit, plan);
            plan.objective = objective_;
            return plan.covers == count;
        }
        lay_knots(samples, count, ahead, free, plan);
        for (std::size_t i = 0; i < count; ++i) weight_[i] = 1;
        float future = 1, best = 1e30f;
        for (std::size_t pass = 0;; ++pass) {
            solve(samples, count, ahead, future);
            to_jumps(plan, free, frozen);
            check(samples, count, frozen, judge, limit, plan);
            if (pass == 0) plan.objective = objective_ + misfit(ahead, frozen, free, plan, judge);
            if (plan.covers == count) return true;
            best = plan.worst < best ? plan.worst : best;
            if (pass >= passes || plan.worst > 4) break;
            // the weighted mean square is a lower bound of the squared minimax error
            if (pass >= 2 && weighted_square(count) > Channel::Judge::square_bound * limit * limit)
                break;
            if (pass >= 3 && best > 1 + 3.0f / static_cast<float>(pass)) break;
            reweight(count, plan.worst);
            future *= 0.3f;
        }
        plan.worst = best;
        return false;
    }

  private:
    static constexpr std::size_t Unknowns = MaxKnots + Order;
    using Vector = std::array<float, D>;

    void lay_knots(const Samples& samples, std::size_t count, const Ahead& ahead, bool free,
                   const KnotPlan& plan) noexcept {
        const std::size_t first =
            free ? 0 : 1;  // the first knot is the boundary of a continued curve
        interior_ = plan.size - first;
        const float begin = free ? 0.0f : static_cast<float>(plan.knot[0]);
        const float last = ahead.size ? ahead.u[ahead.size - 1] : samples.u[count - 1];
        const float end = (last > begin ? last : begin) + 2;
        const std::size_t total = interior_ + Order;
        for (std::size_t j = 0; j < Order; ++j) {
            t_[j] = begin;
            t_[total + j] = end;
        }
        for (std::size_t j = 0; j < interior_; ++j)
            t_[Order + j] = static_cast<float>(plan.knot[first + j]);
        unknowns_ = total - fixed_;
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

    void solve(const Samples& samples, std::size_t count, const Ahead& ahead,
               float future) noexcept {
        const std::size_t m = unknowns_;
        for (std::size_t i = 0; i < m; ++i) a_[i].fill(0);
        for (std::size_t i = 0; i < m + fixed_; ++i) c_[i].fill(0);
        std::size_t h = Order - 1;
        const std::size_t last = interior_ + Order - 1;
        for (std::size_t i = 0; i < count; ++i) {
            if (samples.u[i] <= t_[0] && fixed_) continue;
            while (h < last && t_[h + 1] <= samples.u[i]) ++h;
            add(h, samples.u[i], weight_[i], samples.r[i]);
        }
        for (std::size_t i = 0; i < ahead.size; ++i) {
            while (h < last && t_[h + 1] <= ahead.u[i]) ++h;
            const float w = ahead.weight[i] * future;
            add(h, ahead.u[i], w > 1e-6f ? w : 1e-6f, ahead.r[i]);
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
    void to_jumps(KnotPlan& plan, bool free, const Polynomial<D, Order>& frozen) noexcept {
        const std::size_t total = interior_ + Order;
        float factorial = 1;
        if (free)
            for (std::size_t d = 0; d < D; ++d) plan.start[0][d] = frozen.c[0][d] + c_[0][d];
        for (std::size_t k = 1; k < Order; ++k) {
            for (std::size_t j = total; j-- > k;) {
                const float width = t_[j + Order - k] - t_[j];
                const float f = width > 0 ? static_cast<float>(Order - k) / width : 0;
                for (std::size_t d = 0; d < D; ++d) c_[j][d] = f * (c_[j][d] - c_[j - 1][d]);
            }
            factorial *= static_cast<float>(k);
            if (free)
                for (std::size_t d = 0; d < D; ++d)
                    plan.start[k][d] = frozen.c[k][d] + c_[k][d] / factorial;
        }
        for (std::size_t q = 0; q < plan.size; ++q) {
            const std::size_t j = Order - 1 + q + (free ? 1 : 0);
            for (std::size_t d = 0; d < D; ++d)
                plan.jump[q][d] = (c_[j][d] - (j > Order - 1 ? c_[j - 1][d] : 0)) / factorial;
        }
    }

    /// Walks the very polynomials that would be frozen over the samples.
    void check(const Samples& samples, std::size_t count, const Polynomial<D, Order>& frozen,
               const typename Channel::Judge& judge, float limit, KnotPlan& plan) noexcept {
        Polynomial<D, Order> p = frozen;
        if (fixed_ == 0) p.c = plan.start;
        std::size_t next = 0;
        float origin = 0;
        plan.worst = 0;
        plan.covers = count;
        objective_ = 0;
        for (std::size_t i = 0; i < count; ++i) {
            while (next < plan.size && static_cast<float>(plan.knot[next]) < samples.u[i]) {
                const float knot = static_cast<float>(plan.knot[next]);
                p = p.shifted(knot - origin);
                origin = knot;
                for (std::size_t d = 0; d < D; ++d) p.c[Order - 1][d] += plan.jump[next][d];
                ++next;
            }
            const float e = judge.error(p(samples.u[i] - origin), samples.x[i], samples.witness[i]);
            error_[i] = e;
            objective_ += e * e;
            if (!(e <= limit) && plan.covers == count) plan.covers = i;
            if (!(e <= plan.worst)) plan.worst = e;
        }
    }

    float misfit(const Ahead& ahead, const Polynomial<D, Order>& frozen, bool free,
                 const KnotPlan& plan, const typename Channel::Judge& judge) const noexcept {
        float sum = 0;
        for (std::size_t i = 0; i < ahead.size; ++i) {
            Vector e = ahead.r[i];
            if (free) {
                float power = 1;
                for (std::size_t m = 0; m < Order; ++m, power *= ahead.u[i])
                    for (std::size_t d = 0; d < D; ++d)
                        e[d] -= (plan.start[m][d] - frozen.c[m][d]) * power;
            }
            for (std::size_t q = 0; q < plan.size; ++q) {
                const float u = ahead.u[i] - static_cast<float>(plan.knot[q]);
                float power = 1;
                for (std::size_t m = 1; m < Order; ++m) power *= u;
                for (std::size_t d = 0; d < D; ++d) e[d] -= plan.jump[q][d] * power;
            }
            for (std::size_t d = 0; d < D; ++d) {
                const float s = e[d] * judge.per_limit[d];
                sum += ahead.weight[i] * s * s;
            }
        }
        return sum;
    }

    float weighted_square(std::size_t count) const noexcept {
        float sum = 0;
        for (std::size_t i = 0; i < count; ++i) sum += weight_[i] * error_[i] * error_[i];
        return sum / static_cast<float>(count);
    }

    void reweight(std::size_t count, float worst) noexcept {
        float sum = 0;
        for (std::size_t i = 0; i < count; ++i) {
            weight_[i] *= 0.02f + error_[i] / worst;
            sum += weight_[i];
        }
        const float scale = static_cast<float>(count) / sum;
        for (std::size_t i = 0; i < count; ++i) weight_[i] *= scale;
    }

    std::array<float, Unknowns + Order> t_{};
    std::array<std::array<float, Order>, Unknowns> a_{};  // upper band of the normal matrix
    std::array<Vector, Unknowns> c_{};                    // right sides, then control points
    std::array<float, Samples::capacity> weight_{};
    std::array<float, Samples::capacity> error_{};
    std::size_t interior_{0}, unknowns_{0}, fixed_{0};
    float objective_{0};
};

}  // namespace fairlead
