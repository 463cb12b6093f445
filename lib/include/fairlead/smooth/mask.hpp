#pragma once
// Masks: the taps of a filter, oldest first, and the place of the centre tap among them.
//
// A mask is affine-invariant: its taps sum to one, so that a constant passes unchanged. With the
// centre tap as origin, tap m weighs sample i + m. Filters work on the steps between neighbours and
// need the partial sums [Lee & Shin 2002, eq. (20)]
//   b_m = sum_{j>m} a_j for m >= 0,   b_m = -sum_{j<=m} a_j for m < 0,
// which are computed here once, in double, and stored as Real beside the taps. Masks are constexpr:
// on a board they are tables in flash, and a wrong one does not compile.
//
// Mask<Taps, Centre> has its shape in its type, AnyMask<Capacity> at run time (for command lines).
#include <array>
#include <cstddef>

#include "fairlead/base/status.hpp"
#include "fairlead/base/tolerance.hpp"

namespace fairlead {

namespace detail {

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

/// The least-squares polynomial of the given degree through all samples, read at the centre
/// [Savitzky & Golay 1964]. Discrete orthogonal polynomials by their three-term recurrence: tap i =
/// sum_k p_k(i) p_k(centre) / |p_k|^2.
constexpr void fill_savitzky_golay(double* a, std::size_t size, std::size_t centre,
                                   std::size_t degree) noexcept {
    // monic: p_{k+1}(x) = x p_k(x) - beta_k p_{k-1}(x) on equal steps symmetric about 0
    const auto n = static_cast<double>(size), scale = size > 1 ? 2 / (n - 1) : 1;
    const auto x_of = [n, scale](std::size_t i) {
        return (static_cast<double>(i) - (n - 1) / 2) * scale;
    };
    for (std::size_t i = 0; i < size; ++i) {
        const double x = x_of(i), c = x_of(centre);
        double px = 1, px_before = 0, pc = 1, pc_before = 0, norm = n, sum = 1 / n;
        for (std::size_t k = 1; k <= degree && k < size; ++k) {
            const auto j = static_cast<double>(k - 1);
            const double beta = j * j * (n * n - j * j) / (4 * (4 * j * j - 1)) * scale * scale;
            const double px_next = x * px - beta * px_before, pc_next = c * pc - beta * pc_before;
            px_before = px, pc_before = pc, px = px_next, pc = pc_next;
            const auto d = static_cast<double>(k);
            norm *= d * d * (n * n - d * d) / (4 * (4 * d * d - 1)) * scale * scale;
            sum += px * pc / norm;
        }
        a[i] = sum;
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

}  // namespace detail

/// A mask whose length and centre are part of its type. Centre = Taps - 1: causal, latency 0.
template <std::size_t Taps, std::size_t Centre = Taps / 2, class Number = float>
class Mask {
    static_assert(Taps > 0 && Centre < Taps);

  public:
    using Real = Number;
    static constexpr std::size_t capacity = Taps;
    static constexpr std::size_t ahead_max = Taps - 1 - Centre;
    static constexpr std::size_t behind_max = Centre;

    /// The mask that changes nothing.
    constexpr Mask() noexcept {
        std::array<double, Taps> a{};
        a[Centre] = 1;
        table_.fill(a.data(), Taps, Centre);
    }
    /// Taps that do not sum to one are a mistake in the program: they do not compile in a constant
    /// expression and stop the program elsewhere. Taps from outside go through checked().
    constexpr explicit Mask(const std::array<double, Taps>& taps) noexcept {
        FAIRLEAD_ASSERT(detail::check_taps(taps.data(), Taps, Centre) == Status::ok);
        table_.fill(taps.data(), Taps, Centre);
    }
    static constexpr Result<Mask> checked(const std::array<double, Taps>& taps) noexcept {
        const Status s = detail::check_taps(taps.data(), Taps, Centre);
        if (s != Status::ok) return s;
        return Mask{taps};
    }

    static constexpr std::size_t size() noexcept { return Taps; }
    static constexpr std::size_t centre() noexcept { return Centre; }
    constexpr Real tap(std::size_t i) const noexcept { return table_.taps[i]; }
    constexpr Real step(std::size_t i) const noexcept { return table_.steps[i]; }

  private:
    detail::MaskTable<Real, Taps> table_{};
};

/// A mask of any length up to Capacity, chosen and checked at run time.
template <std::size_t Capacity, class Number = float>
class AnyMask {
    static_assert(Capacity > 0);

  public:
    using Real = Number;
    static constexpr std::size_t capacity = Capacity;
    static constexpr std::size_t ahead_max = Capacity - 1;
    static constexpr std::size_t behind_max = Capacity - 1;

    /// The mask that changes nothing.
    constexpr AnyMask() noexcept { table_.taps[0] = 1; }

    static constexpr Result<AnyMask> from_taps(const double* taps, std::size_t size,
                                               std::size_t centre) noexcept {
        if (size > Capacity) return Status::bad_argument;
        const Status s = detail::check_taps(taps, size, centre);
        if (s != Status::ok) return s;
        return AnyMask{taps, size, centre};
    }
    /// An odd number of taps, centred.
    static constexpr Result<AnyMask> binomial(std::size_t size) noexcept {
        if (size > Capacity || size % 2 == 0) return Status::bad_argument;
        std::array<double, Capacity> a{};
        detail::fill_binomial(a.data(), size);
        return from_taps(a.data(), size, size / 2);
    }
    static constexpr Result<AnyMask> smoothing(double lambda) noexcept {
        return from_taps(detail::smoothing_taps(lambda).data(), 5, 2);
    }
    static constexpr Result<AnyMask> sharpening(double lambda) noexcept {
        return from_taps(detail::sharpening_taps(lambda).data(), 5, 2);
    }
    /// centre = size / 2: the usual one; centre = size - 1: causal.
    static constexpr Result<AnyMask> savitzky_golay(std::size_t size, std::size_t degree,
                                                    std::size_t centre) noexcept {
        if (size > Capacity || degree >= size) return Status::bad_argument;
        std::array<double, Capacity> a{};
        detail::fill_savitzky_golay(a.data(), size, centre, degree);
        return from_taps(a.data(), size, centre);
    }

    constexpr std::size_t size() const noexcept { return size_; }
    constexpr std::size_t centre() const noexcept { return centre_; }
    constexpr Real tap(std::size_t i) const noexcept { return table_.taps[i]; }
    constexpr Real step(std::size_t i) const noexcept { return table_.steps[i]; }

  private:
    constexpr AnyMask(const double* taps, std::size_t size, std::size_t centre) noexcept
        : size_{size}, centre_{centre} {
        table_.fill(taps, size, centre);
    }

    detail::MaskTable<Real, Capacity> table_{};
    std::size_t size_{1};
    std::size_t centre_{0};
};

/// Low-pass, close to a Gaussian of variance (Taps - 1) / 4 samples^2 [eq. (23)]. Taps is odd.
template <std::size_t Taps>
constexpr Mask<Taps> binomial_mask() noexcept {
    static_assert(Taps % 2 == 1, "a centred mask has an odd number of taps");
    std::array<double, Taps> a{};
    detail::fill_binomial(a.data(), Taps);
    return Mask<Taps>{a};
}

/// H^S of eq. (22): gain 1 - lambda / 24 (2 sin(pi f h))^4. Damps every frequency for 0 < lambda
/// <= 3, removes the highest at 1.5.
constexpr Mask<5> smoothing_mask(double lambda) noexcept {
    return Mask<5>{detail::smoothing_taps(lambda)};
}

/// H^U of eq. (25): gain 1 + lambda (1 - cos(pi f h)^4), a boost of high frequencies.
constexpr Mask<5> sharpening_mask(double lambda) noexcept {
    return Mask<5>{detail::sharpening_taps(lambda)};
}

/// Keeps polynomials up to Degree exactly, in the middle of its window.
template <std::size_t Taps, std::size_t Degree>
constexpr Mask<Taps> savitzky_golay_mask() noexcept {
    static_assert(Taps % 2 == 1, "a centred mask has an odd number of taps");
    static_assert(Degree < Taps);
    std::array<double, Taps> a{};
    detail::fill_savitzky_golay(a.data(), Taps, Taps / 2, Degree);
    return Mask<Taps>{a};
}

/// The same read at its newest sample: latency 0 and, for Degree >= 1, zero first moment, so that a
/// constant-rate motion does not lag.
template <std::size_t Taps, std::size_t Degree>
constexpr Mask<Taps, Taps - 1> causal_savitzky_golay_mask() noexcept {
    static_assert(Degree < Taps);
    std::array<double, Taps> a{};
    detail::fill_savitzky_golay(a.data(), Taps, Taps - 1, Degree);
    return Mask<Taps, Taps - 1>{a};
}

/// Sum of a_m m: how many samples a constant-rate motion is ahead (> 0) or late (< 0).
template <class AMask>
constexpr typename AMask::Real first_moment(const AMask& mask) noexcept {
    // sum of a_m m = sum of b_m: each step is counted by every tap beyond it
    typename AMask::Real sum = 0;
    for (std::size_t i = 0; i + 1 < mask.size(); ++i) sum += mask.step(i);
    return sum;
}

/// Sum of a_m^2: variance of white noise after the mask over that before it.
template <class AMask>
constexpr typename AMask::Real noise_variance(const AMask& mask) noexcept {
    typename AMask::Real sum = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) sum += mask.tap(i) * mask.tap(i);
    return sum;
}

}  // namespace fairlead
