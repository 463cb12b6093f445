#pragma once
// How stiff the strain smoother is: a cut-off frequency, turned into the weight of strain.
//
// [Hsieh et al. 1998, eq. (22)] minimises sum |p_i - y_i|^2 + alpha sum |p''_i|^2. Their alpha
// carries seconds^4: the same number is another filter at another rate. With lambda = alpha /
// step^4 the gain at frequency f is 1 / (1 + lambda (2 sin(pi f step))^4), so
//   lambda = (2 sin(pi cutoff step))^-4
// halves the amplitude at the cut-off. The gain falls by 24 dB an octave beyond it, without lag.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/check.hpp"
#include "fairlead/base/status.hpp"
#include "fairlead/math/approx.hpp"

namespace fairlead {

/// Below this many cycles a sample float32 has too few digits for the weight (lambda > 157000), and
/// a filter at a lower rate does the same work for less. (test_strain)
inline constexpr float strain_cutoff_step_min = 0.008f;
/// Above it the smoother would let everything pass.
inline constexpr float strain_cutoff_step_max = 0.5f;

/// Made by strain_weight() alone, so that a smoother cannot be given a weight that it cannot bear.
class StrainWeight {
  public:
    /// No strain term: everything passes.
    constexpr StrainWeight() noexcept = default;
    constexpr float lambda() const noexcept { return lambda_; }
    constexpr float step_s() const noexcept { return step_s_; }

  private:
    constexpr StrainWeight(float lambda, float step_s) noexcept
        : lambda_{lambda}, step_s_{step_s} {}
    friend Result<StrainWeight> strain_weight(float cutoff_hz, float step_s) noexcept;

    float lambda_{0};
    float step_s_{1};
};

/// What is wrong with the pair, in words; null where nothing is.
constexpr const char* strain_weight_error(float cutoff_hz, float step_s) noexcept {
    if (!(step_s > 0) || !approx::is_finite(step_s)) return "the step must be positive";
    if (!(cutoff_hz > 0) || !approx::is_finite(cutoff_hz)) return "the cut-off must be positive";
    const float cycles = cutoff_hz * step_s;
    if (!(cycles >= strain_cutoff_step_min))
        return "cut-off x step is below 0.008 cycles a sample: thin the samples out first";
    if (!(cycles < strain_cutoff_step_max))
        return "cut-off x step must stay below 0.5 cycles a sample";
    return nullptr;
}

/// Half-amplitude frequency and nominal time step -> weight; bad_argument where
/// strain_weight_error() has something to say.
inline Result<StrainWeight> strain_weight(float cutoff_hz, float step_s) noexcept {
    if (strain_weight_error(cutoff_hz, step_s) != nullptr) return Status::bad_argument;
    const float s = 2 * approx::sin(pi_v<float> * (cutoff_hz * step_s));
    return StrainWeight{1 / (s * s * s * s), step_s};
}

/// The lag, in samples, at which a fixed-lag result is within 2e-6 m and 1e-5 rad of the
/// whole-buffer one on human motion: what later samples would still change fades by e in 0.23 /
/// (cut-off x step) samples.
constexpr std::size_t strain_lag(float cutoff_hz, float step_s) noexcept {
    const float lag = 3 / (cutoff_hz * step_s);
    return lag < 1e6f ? static_cast<std::size_t>(lag) + 1 : 1000000;
}

struct StrainParams {
    static constexpr std::size_t steps_max = 64;  // they converge in some ten
    StrainWeight position;
    StrainWeight orientation;
    std::size_t steps{8};  // Gauss-Newton: of a whole buffer; a stream does one or two a push

    /// One cut-off for both channels; bad_argument where strain_weight_error() says why, and for
    /// steps that check() refuses.
    static Result<StrainParams> from_cutoff(float cutoff_hz, float step_s,
                                            std::size_t steps = 8) noexcept {
        const auto weight = strain_weight(cutoff_hz, step_s);
        if (!weight) return weight.status();
        if (steps < 1 || steps > steps_max) return Status::bad_argument;
        return StrainParams{*weight, *weight, steps};
    }

    template <class Params, class Visit>
    static constexpr void each(Params& p, Visit&& visit) noexcept {
        visit("steps", p.steps, std::size_t{1}, +steps_max);
    }
};
/// The weights are good as they are: only strain_weight() makes them.
constexpr Check check(const StrainParams& params) noexcept { return detail::check_ranges(params); }

namespace detail {

/// From one sample of a channel to the next, in nominal steps.
inline float nominal_steps(std::int64_t from_ns, std::int64_t to_ns, float step_s) noexcept {
    FAIRLEAD_ASSERT(to_ns > from_ns);
    return static_cast<float>(to_ns - from_ns) / (1e9f * step_s);
}

template <class Nodes>
std::size_t segment_end(const Nodes& nodes, std::size_t first, std::size_t n) noexcept {
    std::size_t i = first + 1;
    while (i < n && !nodes[i].first) ++i;
    return i;
}

}  // namespace detail

}  // namespace fairlead
