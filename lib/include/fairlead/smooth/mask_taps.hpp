#pragma once
// The arithmetic behind masks: taps of each kind, their checks, and the table a filter works on.
// What masks are and how they are used: smooth/mask.hpp. In double, since masks are made once, at
// compile time on a board; only the table is Real.
#include <array>
#include <cstddef>

#include "fairlead/base/status.hpp"
#include "fairlead/base/tolerance.hpp"

namespace fairlead::detail {

/// The integer nearest to x >= 0, halves up.
constexpr std::size_t nearest(double x) noexcept {
    return (static_cast<std::size_t>(2 * x) + 1) / 2;
}

/// Taps -> Real taps and partial sums. The centre tap takes up what rounding left of the sum.
template <class Real, std::size_t Capacity>
struct MaskTable {
    std::array<Real, Capacity> taps{};
    std::array<Real, Capacity> steps{};  // steps[m + centre] = b_m; the last one is unused

    constexpr void fill(const double* a, std::size_t size, std::size_t centre) noexcept {
        double others = 0;
        for (std::size_t i = 0; i < size; ++i) {
            if (i != centre) others += a[i];
            taps[i] = static_cast<Real>(i == centre ? 0 : a[i]);
        }
        taps[centre] = static_cast<Real>(1 - others);
        double sum = 0;
        for (std::size_t i = 0; i < centre; ++i) {
            sum += a[i];
            steps[i] = static_cast<Real>(-sum);
        }
        sum = 0;
        for (std::size_t i = size - 1; i > centre; --i) {
            sum += a[i];
            steps[i - 1] = static_cast<Real>(sum);
        }
    }
};

constexpr Status check_taps(const double* a, std::size_t size, std::size_t centre) noexcept {
    if (size == 0 || centre >= size) return Status::bad_argument;
    double sum = 0;
    for (std::size_t i = 0; i < size; ++i) {
        if (!(a[i] >= -tolerance::mask_tap && a[i] <= tolerance::mask_tap))
            return Status::bad_argument;
        sum += a[i];
    }
    const double off = sum < 1 ? 1 - sum : sum - 1;
    return off <= tolerance::mask_sum ? Status::ok : Status::bad_argument;
}

/// Binomial coefficients over 2^(size - 1) [eq. (23)].
constexpr void fill_binomial(double* a, std::size_t size) noexcept {
    double c = 1;
    for (std::size_t i = 1; i < size; ++i) c /= 2;
    for (std::size_t i = 0; i < size; ++i) {
        a[i] = c;
        c = c * static_cast<double>(size - 1 - i) / static_cast<double>(i + 1);
    }
}

/// The least-squares polynomial of the given degree through all samples, read at a place among
/// them, which may be between two [Savitzky & Golay 1964]. Discrete orthogonal polynomials by their
/// three-term recurrence: tap i = sum_k p_k(i) p_k(place) / |p_k|^2. A degree may be broken: 1.4
/// stands 0.4 of the way from the line to the parabola.
constexpr void fill_savitzky_golay(double* a, std::size_t size, double place,
                                   double degree) noexcept {
    // monic: p_{k+1}(x) = x p_k(x) - beta_k p_{k-1}(x) on equal steps symmetric about 0
    const auto n = static_cast<double>(size), scale = size > 1 ? 2 / (n - 1) : 1;
    const auto x_of = [n, scale](double i) { return (i - (n - 1) / 2) * scale; };
    for (std::size_t i = 0; i < size; ++i) {
        const double x = x_of(static_cast<double>(i)), c = x_of(place);
        double px = 1, px_before = 0, pc = 1, pc_before = 0, norm = n, sum = 1 / n;
        for (std::size_t k = 1; static_cast<double>(k) < degree + 1 && k < size; ++k) {
            const auto j = static_cast<double>(k - 1);
            const double beta = j * j * (n * n - j * j) / (4 * (4 * j * j - 1)) * scale * scale;
            const double px_next = x * px - beta * px_before, pc_next = c * pc - beta * pc_before;
            px_before = px, pc_before = pc, px = px_next, pc = pc_next;
            const auto d = static_cast<double>(k);
            norm *= d * d * (n * n - d * d) / (4 * (4 * d * d - 1)) * scale * scale;
            const double share = degree < d ? degree - j : 1;  // of the last, broken degree
            sum += share * px * pc / norm;
        }
        a[i] = sum;
    }
}

/// What late masks there are: between the line and the parabola, read within their samples.
constexpr bool can_be_late(std::size_t size, double degree, double late) noexcept {
    return size >= 2 && degree >= 1 && degree <= 2 && late >= 0 &&
           late <= static_cast<double>(size - 1);
}

/// Variance of the newest point of the line through n samples, over that of a sample.
constexpr double line_noise(std::size_t n) noexcept {
    const auto x = static_cast<double>(n);
    return (4 * x - 2) / (x * (x + 1));
}

/// The shortest window whose line brings the noise down to `gain`, at most `limit` samples.
constexpr std::size_t zero_lag_size(double gain, std::size_t limit) noexcept {
    std::size_t n = 2;
    while (n < limit && line_noise(n) > gain * gain) ++n;
    return n;
}

/// Between the line through size samples (least noise of all causal masks of zero lag and this
/// size) and that through size - 1 there is one with exactly the wanted gain: taps on the way from
/// the first to the second gain noise with the square of the way.
constexpr void fill_zero_lag(double* a, std::size_t size, double gain) noexcept {
    const double least = line_noise(size), most = line_noise(size - 1);
    const double square = size > 2 ? (gain * gain - least) / (most - least) : 0;
    double way = 1;  // square root by Newton; within [0, 1]
    for (int i = 0; i < 60 && square > 0; ++i) way = (way + square / way) / 2;
    if (!(square > 0)) way = 0;
    fill_savitzky_golay(a, size, static_cast<double>(size - 1), 1);
    const auto n = static_cast<double>(size - 1);
    for (std::size_t i = 0; i < size; ++i) {
        // the shorter line in closed form: 2 (2 n - 1 - 3 age) / (n (n + 1))
        const auto age = static_cast<double>(size - 1 - i);
        const double shorter = i == 0 ? 0 : 2 * (2 * n - 1 - 3 * age) / (n * (n + 1));
        a[i] += way * (shorter - a[i]);
    }
}

/// p - lambda D^4 p with the divided fourth difference, 1/24 (1 -4 6 -4 1) [eq. (21)].
constexpr std::array<double, 5> smoothing_taps(double lambda) noexcept {
    const double l = lambda / 24;
    return {-l, 4 * l, 1 - 6 * l, 4 * l, -l};
}

/// p + lambda (p - blurred p), blurred by the binomial mask of five taps [sec. V.C].
constexpr std::array<double, 5> sharpening_taps(double lambda) noexcept {
    const double l = lambda / 16;
    return {-l, -4 * l, 1 + 10 * l, -4 * l, -l};
}

}  // namespace fairlead::detail
