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
#include "fairlead/smooth/mask_taps.hpp"

namespace fairlead {

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
        table_.taps[Centre] = Real{1};
        for (std::size_t i = 0; i < Centre; ++i) table_.steps[i] = -Real{0};  // as fill() does
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
        detail::fill_savitzky_golay(a.data(), size, static_cast<double>(centre),
                                    static_cast<double>(degree));
        return from_taps(a.data(), size, centre);
    }

    /// As late_mask(); the centre is the sample nearest to `late`.
    static constexpr Result<AnyMask> late(std::size_t size, double degree, double late) noexcept {
        if (size > Capacity || !detail::can_be_late(size, degree, late))
            return Status::bad_argument;
        std::array<double, Capacity> a{};
        detail::fill_savitzky_golay(a.data(), size, static_cast<double>(size - 1) - late, degree);
        return from_taps(a.data(), size, size - 1 - detail::nearest(late));
    }

    /// Causal, without lag at constant rate, noise brought down to noise_gain (0 < gain <= 1).
    static constexpr Result<AnyMask> zero_lag(double noise_gain) noexcept {
        if (!(noise_gain > 0 && noise_gain <= 1)) return Status::bad_argument;
        const std::size_t size = detail::zero_lag_size(noise_gain, Capacity + 1);
        if (size > Capacity) return Status::bad_argument;
        std::array<double, Capacity> a{};
        detail::fill_zero_lag(a.data(), size, noise_gain);
        return from_taps(a.data(), size, size - 1);
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
    detail::fill_savitzky_golay(a.data(), Taps, Taps / 2, double{Degree});
    return Mask<Taps>{a};
}

/// The same read at its newest sample: latency 0 and, for Degree >= 1, zero first moment, so that a
/// constant-rate motion does not lag.
template <std::size_t Taps, std::size_t Degree>
constexpr Mask<Taps, Taps - 1> causal_savitzky_golay_mask() noexcept {
    static_assert(Degree < Taps);
    std::array<double, Taps> a{};
    detail::fill_savitzky_golay(a.data(), Taps, double{Taps - 1}, double{Degree});
    return Mask<Taps, Taps - 1>{a};
}

/// Taps that zero_lag_mask needs for a noise gain: about 4 / gain^2.
constexpr std::size_t zero_lag_taps(double noise_gain) noexcept {
    FAIRLEAD_ASSERT(noise_gain > 0.05 && noise_gain <= 1);  // 1600 taps and more are no filter
    return detail::zero_lag_size(noise_gain, 2000);
}

/// Causal, without lag at constant rate, and white noise leaves it noise_gain times as strong
/// (standard deviations): zero_lag_mask<zero_lag_taps(0.5)>(0.5). No shorter mask can do that.
template <std::size_t Taps>
constexpr Mask<Taps, Taps - 1> zero_lag_mask(double noise_gain) noexcept {
    FAIRLEAD_ASSERT(zero_lag_taps(noise_gain) == Taps);
    std::array<double, Taps> a{};
    detail::fill_zero_lag(a.data(), Taps, noise_gain);
    return Mask<Taps, Taps - 1>{a};
}

/// Causal, and at a constant rate `late` samples late, which may be any number: reading a little
/// late leaves less noise than reading now. Of all masks of its length that are wrong about a
/// constant acceleration by no more it leaves the least noise: degree 1 is as wrong as a line,
/// degree 2 is right, 1.4 is 0.6 times as wrong as the line. The result stands at the centre tap,
/// `Latency` records back, and is true first_moment() samples, at most half of one, beside it.
template <std::size_t Taps, std::size_t Latency>
constexpr Mask<Taps, Taps - 1 - Latency> late_mask(double degree, double late) noexcept {
    FAIRLEAD_ASSERT(detail::can_be_late(Taps, degree, late));
    FAIRLEAD_ASSERT(detail::nearest(late) == Latency);
    std::array<double, Taps> a{};
    detail::fill_savitzky_golay(a.data(), Taps, static_cast<double>(Taps - 1) - late, degree);
    return Mask<Taps, Taps - 1 - Latency>{a};
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
