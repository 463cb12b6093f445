#pragma once
// A causal filter whose cut-off grows with speed, as One Euro's does, but without its lag.
//
// One Euro [Casiez et al. 2012] is a first-order low-pass: a turn at rate w leaves it w T behind,
// and a cut-off raised against that lets noise through. Here a straight line (a constant rate) is
// fitted to the past by least squares, with weights that fade as exp(-age / T); the output is the
// line's value now. A constant rate passes without lag, a constant acceleration a leaves at most
// a T^2. For steps well below T that is the transfer function (1 + 2 T s) / (1 + T s)^2, whose
// half-power point gives T = 0.3951 / cutoff; its largest gain is 1.155, at cutoff / 3.5.
//   cutoff = cutoff_hz + slope * speed,   speed: the rate of the line before the new sample.
//
// Orientations live in the tangent space of the prediction: e = log(predicted^-1 measured), so the
// filter turns with its input, from either side. The sums of weights are kept exactly for whatever
// time steps come, so uneven ones and the start of a segment need no special care. A turn of more
// than pi per sample is understood once its rate is known.
// In: records in rising time; a gap flag starts a segment. Out: one per record, latency 0.
// Cost: per record and channel one log, three exps and a square root. State: two numbers in size.
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fairlead/base/check.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/smooth/space.hpp"

namespace fairlead {

/// Half-power frequency at rest, and its growth per unit of speed: rad/s turning, m/s moving.
struct AdaptiveParams {
    float cutoff_hz{2};
    float slope{0.6f};

    template <class Params, class Visit>
    static constexpr void each(Params& p, Visit&& visit) noexcept {
        visit("cutoff_hz", p.cutoff_hz, 1e-3f, 1e4f);
        visit("slope", p.slope, 0.0f, 1e4f);
    }
};
constexpr Check check(const AdaptiveParams& params) noexcept {
    return detail::check_ranges(params);
}

namespace detail {

/// T = this / cutoff: (1 + 4 x^2) / (1 + x^2)^2 = 1/2 at x = 2 pi T cutoff = sqrt(3 + sqrt(10)).
inline constexpr double fading_time_times_cutoff = 0.39509;

/// The line fitted to one channel.
template <class Space>
class FadingLine {
  public:
    using Real = typename Space::Real;
    using Value = typename Space::Value;
    using Step = typename Space::Step;

    constexpr void reset() noexcept { running_ = false; }
    constexpr bool running() const noexcept { return running_; }

    /// The line's value at the new sample's time.
    Value push(std::int64_t t_ns, const Value& measured, const AdaptiveParams& p) noexcept {
        if (!running_) {
            running_ = true;
            t_ns_ = t_ns;
            value_ = measured;
            rate_ = {};
            sum0_ = 1;
            sum1_ = sum2_ = 0;
            return value_;
        }
        const Value predicted = at(t_ns);
        const Value sample = Space::continued(predicted, measured);
        const Step error = Space::step(predicted, sample);
        age(seconds(t_ns), p);
        t_ns_ = t_ns;
        // the line's normal equations before and after the sample: their determinants
        const Real before = sum0_ * sum2_ - sum1_ * sum1_, after = before + sum2_;
        sum0_ += 1;
        rate_ += (sum1_ / after) * error;
        // equal to predicted + (1 - before / after) error, but unit as the sample is unit
        value_ = Space::moved(sample, (-before / after) * error);
        return value_;
    }

    /// The line at t_ns.
    Value at(std::int64_t t_ns) const noexcept {
        return Space::moved(value_, seconds(t_ns) * rate_);
    }

  private:
    Real seconds(std::int64_t t_ns) const noexcept {
        return static_cast<Real>(t_ns - t_ns_) * static_cast<Real>(1e-9);
    }

    /// Weights fade over dt; ages grow by it. sums_k: of weight * age^k.
    void age(Real dt, const AdaptiveParams& p) noexcept {
        const Real cutoff =
            static_cast<Real>(p.cutoff_hz) + static_cast<Real>(p.slope) * Space::size(rate_);
        const Real fade = approx::exp(-dt * cutoff / static_cast<Real>(fading_time_times_cutoff));
        constexpr Real least =
            static_cast<Real>(1e-9);  // as good as forgotten, yet no sum vanishes
        const Real w = fade > least ? fade : least;
        sum2_ = w * (sum2_ + dt * (2 * sum1_ + dt * sum0_));
        sum1_ = w * (sum1_ + dt * sum0_);
        sum0_ = w * sum0_;
    }

    std::int64_t t_ns_{};
    Value value_{};
    Step rate_{};  // steps per second
    Real sum0_{}, sum1_{}, sum2_{};
    bool running_{false};
};

/// Pose records through a line per channel; a channel that is left alone passes as it is.
template <bool Orientation, bool Position>
class AdaptiveFilter {
  public:
    static constexpr std::size_t latency = 0;

    /// Both must pass check(): asserted.
    constexpr AdaptiveFilter(const AdaptiveParams& orientation,
                             const AdaptiveParams& position) noexcept
        : orientation_params_{orientation}, position_params_{position} {
        FAIRLEAD_ASSERT(check(orientation) && check(position));
    }

    std::optional<Pose> push(const Pose& pose) noexcept {
        Pose out = pose;
        if (out.flags & (flag::gap_before | flag::orientation_gap)) orientation_.reset();
        if (out.flags & (flag::gap_before | flag::position_gap)) position_.reset();
        if (Orientation && (out.flags & flag::orientation_valid))
            out.q_wb = orientation_.push(out.t_ns, out.q_wb, orientation_params_);
        if (Position && (out.flags & flag::position_valid))
            out.p_w_m = position_.push(out.t_ns, out.p_w_m, position_params_);
        return out;
    }
    std::optional<Pose> flush() noexcept {
        reset();
        return std::nullopt;
    }
    constexpr void reset() noexcept {
        orientation_.reset();
        position_.reset();
    }
    static constexpr std::size_t delay() noexcept { return 0; }

    /// Where the body will be at t_ns if it keeps its rates. Of constant acceleration a, dt after
    /// the newest sample and in the steady state, the error is at most a (T + dt)^2 at the present
    /// T. Valid: the channels that are filtered and have had a sample since their last gap.
    Pose predict(std::int64_t t_ns) const noexcept {
        Pose out{t_ns, {}, {}, 0};
        if (orientation_.running()) {
            out.q_wb = orientation_.at(t_ns);
            out.flags |= flag::orientation_valid;
        }
        if (position_.running()) {
            out.p_w_m = position_.at(t_ns);
            out.flags |= flag::position_valid;
        }
        return out;
    }

  private:
    AdaptiveParams orientation_params_{};
    AdaptiveParams position_params_{};
    FadingLine<OrientationSpace<float>> orientation_{};
    FadingLine<PositionSpace<float>> position_{};
};

}  // namespace detail

/// Filters both channels.
class AdaptivePoseFilter : public detail::AdaptiveFilter<true, true> {
  public:
    constexpr explicit AdaptivePoseFilter(const AdaptiveParams& orientation = {},
                                          const AdaptiveParams& position = {2, 4}) noexcept
        : detail::AdaptiveFilter<true, true>{orientation, position} {}
};

/// Filters q_wb; positions pass beside it.
class AdaptiveOrientationFilter : public detail::AdaptiveFilter<true, false> {
  public:
    constexpr explicit AdaptiveOrientationFilter(const AdaptiveParams& params = {}) noexcept
        : detail::AdaptiveFilter<true, false>{params, {}} {}
};

/// Filters p_w_m; orientations pass beside it.
class AdaptivePositionFilter : public detail::AdaptiveFilter<false, true> {
  public:
    constexpr explicit AdaptivePositionFilter(const AdaptiveParams& params = {2, 4}) noexcept
        : detail::AdaptiveFilter<false, true>{{}, params} {}
};

}  // namespace fairlead
