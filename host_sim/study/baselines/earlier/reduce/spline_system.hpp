#pragma once
// Least squares for the control points of a spline that may continue a given polynomial.
//
// Its B-splines have the first control points given (the blossom of the polynomial that is
// continued), which turns the ill-conditioned problem of jumps into a banded system that float
// solves: one row a control point, Order entries wide, L D L^T. Every portion of the work is a
// call, so that it may stop after any sample sum and any row. RAM: sizeof.
#include <array>
#include <cstddef>

#include "fairlead/base/each.hpp"
#include "host_sim/study/baselines/earlier/reduce/span.hpp"

namespace fairlead::earlier {

template <std::size_t D, std::size_t Order, std::size_t MaxKnots>
class SplineSystem {
  public:
    using Vector = std::array<float, D>;

    // ---- the knots
    /// Begins a spline on [begin, end] with `fixed` given control points; interior knots follow.
    void open(float begin, std::size_t fixed, const Vector& anchor) noexcept {
        begin_ = begin;
        fixed_ = fixed;
        interior_ = 0;
        anchor_ = anchor;
    }
    void add_knot(float at) noexcept { t_[Order + interior_++] = at; }
    void close(float end) noexcept {
        for (std::size_t j = 0; j < Order; ++j) {
            t_[j] = begin_;
            t_[interior_ + Order + j] = end;
        }
    }
    /// The first control points continue a polynomial, whose Taylor coefficients at `begin` these
    /// are: its blossom.
    void give(const Polynomial<D, Order>& at) noexcept {
        for (std::size_t j = 0; j < fixed_; ++j) {
            std::array<float, Order> e{};  // elementary symmetric polynomials of the knots
            e[0] = 1;
            for (std::size_t k = 1; k < Order; ++k)
                for (std::size_t m = k; m > 0; --m) e[m] += (t_[j + k] - t_[0]) * e[m - 1];
            float binomial = 1;
            Vector sum{};
            for (std::size_t m = 0; m < Order; ++m) {
                const float f = e[m] / binomial;
                for (std::size_t d = 0; d < D; ++d) sum[d] += f * at.c[m][d];
                binomial = binomial * static_cast<float>(Order - 1 - m) / static_cast<float>(m + 1);
            }
            for (std::size_t d = 0; d < D; ++d) given_[j][d] = sum[d] - anchor_[d];
        }
    }

    std::size_t rows() const noexcept { return points() - fixed_; }
    std::size_t points() const noexcept { return interior_ + Order; }
    std::size_t fixed() const noexcept { return fixed_; }
    /// Spans are numbered by the knot at their left.
    static constexpr std::size_t first_span = Order - 1;
    std::size_t last_span() const noexcept { return interior_ + Order - 1; }
    float span_end(std::size_t span) const noexcept {
        return span < last_span() ? t_[span + 1] : 1e30f;
    }

    // ---- the sums
    void clear() noexcept {
        for (std::size_t i = 0; i < rows(); ++i) {
            a_[i].fill(0);
            c_[i + fixed_].fill(0);
        }
        for (std::size_t i = 0; i < fixed_; ++i) c_[i] = given_[i];
    }

    /// B-splines of a span as polynomials in s = (u - middle) / length (Cox, de Boor).
    struct Basis {
        std::array<std::array<float, Order>, Order> c{};
        float middle{0}, per_length{0};
    };
    Basis basis(std::size_t span) const noexcept {
        Basis out;
        const float begin = t_[span], length = t_[span + 1] - begin;
        out.middle = begin + length / 2;
        out.per_length = length > 0 ? 1 / length : 0;
        out.c[0][0] = 1;
        each<Order - 1>([&](std::size_t k0) FAIRLEAD_INLINE {
            const std::size_t k = k0 + 1;
            std::array<float, Order> carry{};
            each<Order - 1>([&](std::size_t i) FAIRLEAD_INLINE {
                if (i >= k) return;
                const float right = t_[span + 1 + i], left = t_[span + 1 + i - k];
                const float per = right > left ? 1 / (right - left) : 0;
                const float r = (right - out.middle) * per, l = (out.middle - left) * per,
                            slope = length * per;
                std::array<float, Order> next{};
                each<Order - 1>([&](std::size_t m) FAIRLEAD_INLINE {
                    if (m >= k) return;
                    const float b = out.c[i][m];
                    out.c[i][m] = carry[m] + r * b;
                    next[m] += l * b;
                    next[m + 1] += slope * b;
                    carry[m + 1] -= slope * b;
                });
                out.c[i][k] = carry[k];
                carry = next;
            });
            out.c[k] = carry;
        });
        return out;
    }

    /// Moments of samples of one span: sums of w s^k, and of w x s^k for W right sides. They cost
    /// less than the sums of the B-splines' products, which follow from them once a span.
    template <std::size_t W>
    struct Moments {
        std::array<float, 2 * Order - 1> w{};
        std::array<std::array<float, W>, Order> x{};

        FAIRLEAD_INLINE void add(const Basis& basis, float u, float weight,
                                 std::array<float, W> value) noexcept {
            const float s = (u - basis.middle) * basis.per_length;
            each<W>([&](std::size_t d) FAIRLEAD_INLINE { value[d] *= weight; });
            each<2 * Order - 1>([&](std::size_t k) FAIRLEAD_INLINE {
                w[k] += weight;
                weight *= s;
            });
            each<Order>([&](std::size_t k) FAIRLEAD_INLINE {
                each<W>([&](std::size_t d) FAIRLEAD_INLINE {
                    x[k][d] += value[d];
                    value[d] *= s;
                });
            });
        }
    };
    /// Puts the moments of a span into the band; given control points go to the right side. The W
    /// right sides are those of the components after `from`.
    template <std::size_t W>
    void gather(const Moments<W>& sums, const Basis& basis, std::size_t span,
                std::size_t from) noexcept {
        const std::size_t base = span + 1 - Order;
        for (std::size_t i = 0; i < Order; ++i) {
            const auto& b = basis.c[i];
            std::array<float, Order> half{};  // sums of w B_i s^k
            each<Order>([&](std::size_t k) FAIRLEAD_INLINE {
                each<Order>([&](std::size_t m)
                                FAIRLEAD_INLINE { half[k] += b[m] * sums.w[k + m]; });
            });
            const std::size_t point = base + i;
            const bool given = point < fixed_;
            for (std::size_t j = i; j < Order; ++j) {
                float a = 0;
                each<Order>([&](std::size_t k) FAIRLEAD_INLINE { a += half[k] * basis.c[j][k]; });
                if (!given)
                    a_[point - fixed_][j - i] += a;
                else if (base + j >= fixed_)
                    each<W>([&](std::size_t d) FAIRLEAD_INLINE {
                        c_[base + j][from + d] -= a * given_[point][from + d];
                    });
            }
            if (given) continue;
            each<W>([&](std::size_t d) FAIRLEAD_INLINE {
                float r = 0;
                each<Order>([&](std::size_t k) FAIRLEAD_INLINE { r += b[k] * sums.x[k][d]; });
                c_[point][from + d] += r;
            });
        }
    }
    const Vector& anchor() const noexcept { return anchor_; }

    // ---- the solution: call factor() for every row upwards, then substitute() downwards
    void start_factor() noexcept {
        float largest = 0;
        for (std::size_t i = 0; i < rows(); ++i) largest = a_[i][0] > largest ? a_[i][0] : largest;
        ridge_ = 1e-7f * largest + 1e-12f;
    }
    template <std::size_t W>
    void factor(std::size_t i, std::size_t from) noexcept {
        auto& row = a_[i];
        row[0] += ridge_;
        if (!(row[0] > ridge_)) row[0] = ridge_;
        const float per = 1 / row[0];
        auto& right = c_[i + fixed_];
        const std::size_t left = rows() - i;
        each<Order - 1>([&](std::size_t j0) FAIRLEAD_INLINE {
            const std::size_t j = j0 + 1;
            if (j >= left) return;
            const float f = row[j] * per;
            each<Order>([&](std::size_t k) FAIRLEAD_INLINE {
                if (k + j < Order) a_[i + j][k] -= f * row[j + k];
            });
            each<W>([&](std::size_t d)
                        FAIRLEAD_INLINE { c_[i + j + fixed_][from + d] -= f * right[from + d]; });
        });
    }
    template <std::size_t W>
    void substitute(std::size_t i, std::size_t from) noexcept {
        const float per = 1 / a_[i][0];
        const std::size_t left = rows() - i;
        std::array<float, W> v;
        each<W>([&](std::size_t d) FAIRLEAD_INLINE { v[d] = c_[i + fixed_][from + d]; });
        each<Order - 1>([&](std::size_t j0) FAIRLEAD_INLINE {
            const std::size_t j = j0 + 1;
            if (j >= left) return;
            const float a = a_[i][j];
            each<W>([&](std::size_t d)
                        FAIRLEAD_INLINE { v[d] -= a * c_[i + j + fixed_][from + d]; });
        });
        each<W>([&](std::size_t d) FAIRLEAD_INLINE { c_[i + fixed_][from + d] = v[d] * per; });
    }

    // ---- its derivatives
    /// Control points -> those of the k-th derivative from those of the one before.
    template <std::size_t W>
    void differentiate(std::size_t k, std::size_t from) noexcept {
        for (std::size_t j = points(); j-- > k;) {
            const float width = t_[j + Order - k] - t_[j];
            const float f = width > 0 ? static_cast<float>(Order - k) / width : 0;
            each<W>([&](std::size_t d) FAIRLEAD_INLINE {
                c_[j][from + d] = f * (c_[j][from + d] - c_[j - 1][from + d]);
            });
        }
    }
    const Vector& point(std::size_t i) const noexcept { return c_[i]; }

  private:
    static constexpr std::size_t Points = MaxKnots + Order;

    std::array<float, Points + Order> t_{};
    std::array<std::array<float, Order>, Points> a_{};  // upper band of the normal matrix
    std::array<Vector, Points> c_{};                    // right sides, then control points
    std::array<Vector, Order - 1> given_{};
    Vector anchor_{};
    float begin_{0}, ridge_{0};
    std::size_t fixed_{0}, interior_{0};
};

}  // namespace fairlead::earlier
