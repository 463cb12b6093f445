#pragma once
// Streaming knot removal with a hard guarantee.
//
// Samples wait in a window of at most N records. What is frozen of the curve goes on as long as it
// fits; a planned knot becomes final only when the sample that is due lies beyond it. Before a
// sample counts as covered it is tested against the very polynomial that the decoder will evaluate,
// in the very arithmetic; when nothing else serves, a knot of full multiplicity starts the curve
// anew at the sample that is due. So the tolerance never depends on the search, and the search may
// stop whenever its work is used up. Bounds: memory is sizeof; work per record is `slice` fits plus
// one advance; delay at most delay_max.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"
#include "fairlead/reduce/predict.hpp"
#include "fairlead/reduce/search.hpp"

namespace fairlead {

template <class Channel>
struct ReduceParams {
    typename Channel::Tolerance tol{};  // absolute; per component, or the rotation angle in rad
    std::uint32_t tick_ns{4000000};     // grid of the knots: at most the smallest sample spacing
    std::uint32_t delay_max{60};        // records; at most N
};

/// What an advance made final, for the wire: in this order.
template <class Channel, std::size_t MaxKnots>
struct Batch {
    static constexpr std::size_t D = Channel::dimension;
    struct Knot {
        std::uint32_t ticks{};               // after the previous knot
        std::uint8_t shift{};                // the jump is a multiple of 2^shift
        std::array<std::int32_t, D> jump{};  // in last places of the highest coefficient, >> shift
    };

    bool begins{false};     // a curve starts: `start` is its first span
    bool breaks{false};     // ... in the middle of a motion: a knot of full multiplicity
    std::uint8_t coarse{};  // log2 of the ticks that the start's rounding was made for
    Curve<Channel> start{};
    std::size_t size{0};
    std::array<Knot, MaxKnots> knot{};
    bool covers{false};
    std::uint32_t cover_ticks{0};  // the curve is final before this, after the last knot
};

/// Marks a knot that brings the curve to an exact stop: its jump is whatever that takes.
inline constexpr std::uint8_t stop_shift = 31;

/// Places by which the start's coefficient of power m is rounded when its first interval is
/// 2^coarse ticks.
constexpr int start_shift(std::size_t m, int coarse) noexcept {
    const int places = fraction_bits(m) - 4 - static_cast<int>(m) * coarse;
    return places > 0 ? places : 0;
}

template <class Channel, std::size_t N, std::size_t MaxKnots = 24>
class Reducer {
  public:
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    static constexpr std::size_t horizons = Predictor<Channel>::horizons;
    static constexpr std::size_t batch_knots = 8;
    static constexpr std::int32_t rest_places = 64;  // last places that a stop may cut off
    static constexpr int jump_places =
        4;  // a jump is rounded to 2^-places of a unit at the next knot
    using Value = typename Channel::Value;
    using Params = ReduceParams<Channel>;
    using Frozen = Batch<Channel, batch_knots>;

    struct Counters {
        std::uint32_t samples{0}, knots{0}, curves{0}, breaks{0}, refused{0};
    };

    Reducer() = default;
    explicit Reducer(const Params& params) noexcept
        : params_{params}, scale_{Channel::scale(params.tol)}, judge_{params.tol, scale_} {
        if (params_.delay_max > N) params_.delay_max = N;
        if (params_.delay_max < 2) params_.delay_max = 2;
    }

    /// A record that this channel has a sample in. Room is guaranteed while due() is obeyed.
    /// A sample closer than a tick to the one before is refused and counted.
    void push(std::int64_t t_ns, const Value& value, bool starts_curve) noexcept {
        ++records_;
        if (any_ && t_ns - last_ns_ < static_cast<std::int64_t>(params_.tick_ns)) {
            ++counters_.refused;
            return;
        }
        FAIRLEAD_ASSERT(samples_.size < Samples::capacity);
        const bool starts = starts_curve || !any_;
        last_ns_ = t_ns;
        ++counters_.samples;
        const Value v = any_ ? Channel::continued(last_, value) : value;
        last_ = v;
        samples_.push(t_ns, records_, starts, v, Channel::coordinates(v, scale_));
        any_ = true;
        predictor_.push(v, starts, judge_);
        if (samples_.size == 1 && starts) prepare_curve();
        if (!ended()) {
            samples_.express(samples_.size - 1, curve_.span.t0_ns, params_.tick_ns);
            search_.extend(view());
            look_ahead();
        }
    }

    /// Any time of the grid of knots, at or before the first sample; before the first push.
    void set_epoch(std::int64_t t_ns) noexcept { epoch_ns_ = t_ns; }

    /// A record without a sample of this channel: delay counts records.
    void skip() noexcept { ++records_; }

    /// `slice` pieces of the search, one fit each at most.
    void work(std::size_t slice) noexcept {
        for (std::size_t i = 0; i < slice; ++i)
            if (!search_.step(view())) return;
    }

    /// Must advance() be called before the next record? True while an ended curve waits, too.
    bool due() const noexcept {
        return samples_.size > 0 && (age() >= params_.delay_max || ended());
    }
    bool empty() const noexcept { return samples_.size == 0; }
    /// Records that the oldest uncovered sample has waited.
    std::uint32_t age() const noexcept { return samples_.size ? records_ - samples_.record[0] : 0; }

    /// Makes the curve final until the oldest uncovered sample is younger than `goal` records, as
    /// far as the plan goes. Covers at least one sample where there is one.
    const Frozen& advance(std::uint32_t goal) noexcept {
        out_ = {};
        for (std::size_t i = 0; i < 2 * batch_knots + 2; ++i) {
            if (samples_.size == 0) break;
            if (!active_) {
                if (out_.begins || out_.size || out_.covers) break;
                begin_curve(false);
                continue;
            }
            if (cover(goal)) {
                if (samples_.size == 0 || !active_ || age() < goal) break;
            } else if (search_.plan().size > 0 && !before_knot(0)) {
                if (out_.size == batch_knots) break;
                freeze();
            } else {
                if (out_.begins || out_.size || out_.covers) break;
                begin_curve(true);
            }
        }
        return out_;
    }

    const Curve<Channel>& curve() const noexcept { return curve_; }
    const typename Channel::Scale& scale() const noexcept { return scale_; }
    const Params& params() const noexcept { return params_; }
    const Counters& counters() const noexcept { return counters_; }
    std::uint32_t cover_ticks() const noexcept { return cover_ticks_; }
    bool active() const noexcept { return active_; }

  private:
    using Knots = Search<Channel, N, MaxKnots, horizons>;
    using Samples = typename Knots::Fitter::Samples;
    using Ahead = typename Knots::Fitter::Ahead;

    /// Samples of the curve that is being built.
    std::size_t count() const noexcept {
        for (std::size_t i = 0; i < samples_.size; ++i)
            if (samples_.starts_curve[i] && (i > 0 || active_)) return i;
        return samples_.size;
    }
    bool ended() const noexcept { return count() < samples_.size; }

    typename Knots::View view() const noexcept {
        return {{samples_, count(), ahead_, frozen_, judge_, !active_},
                static_cast<std::int32_t>(cover_ticks_),
                params_.delay_max};
    }

    /// Pseudo-samples at the predictor's horizons; their weight falls with its error there.
    void look_ahead() noexcept {
        const std::size_t n = count();
        ahead_.size = 0;
        if (n < 4) return;
        const float last = samples_.u[n - 1];
        const float step = (last - samples_.u[0]) / static_cast<float>(n - 1);
        float before = 0;
        for (std::size_t h = 0; h < horizons; ++h) {
            const auto reach = static_cast<float>(Predictor<Channel>::horizon[h]);
            const float u = last + reach * step;
            const Value value = judge_.moved(samples_.value[n - 1], predictor_.change(h, judge_));
            ahead_.x[h] = Channel::coordinates(value, scale_);
            const float spread = predictor_.variance(h) / (0.5f * 0.5f);
            ahead_.u[h] = u;
            ahead_.weight[h] = 3 * (reach - before) / (1 + spread * spread);
            before = reach;
        }
        ahead_.size = horizons;
    }

    void express_all() noexcept {
        const std::size_t n = samples_.size;
        for (std::size_t i = 0; i < n; ++i) {
            samples_.express(i, curve_.span.t0_ns, params_.tick_ns);
        }
        look_ahead();
    }

    /// Chooses coordinates for a curve that starts at the oldest sample; nothing is final yet.
    void prepare_curve() noexcept {
        const std::int64_t t = samples_.t_ns[0];
        const std::int64_t before = counters_.curves ? curve_.span.t0_ns : epoch_ns_;
        curve_ = {};
        curve_.span.t0_ns = before + (t - before) / params_.tick_ns * params_.tick_ns;
        active_ = false;
        cover_ticks_ = 0;
        frozen_ = {};
        frozen_.c[0] = samples_.x[0];
        search_.reset();
        express_all();
    }

    /// The start of a curve becomes final, rounded for the interval it was planned for.
    void begin_curve(bool breaks) noexcept {
        if (breaks) {
            samples_.starts_curve[0] = true;
            ++counters_.breaks;
            prepare_curve();
            search_.start_over(view());
        }
        ++counters_.curves;
        const auto& plan = search_.plan();
        const float first = plan.size ? static_cast<float>(plan.knot[0])
                                      : samples_.u[count() > 0 ? count() - 1 : 0];
        out_.coarse = static_cast<std::uint8_t>(first > 1 ? floor_log2(first) + 1 : 0);
        Polynomial<D, Order> start = frozen_;
        if (plan.covers > 0) start.c = plan.start;
        round_start(start);
        if (!accepted(0)) {  // a constant through the sample always serves
            out_.coarse = 0;
            round_start(frozen_);
        }
        active_ = true;
        samples_.starts_curve[0] = false;
        out_.begins = true;
        out_.breaks = breaks;
        out_.start = curve_;
        frozen_ = Polynomial<D, Order>{curve_.span};
        express_all();
        search_.refit(view(), Knots::hard_passes);
    }

    void round_start(const Polynomial<D, Order>& start) noexcept {
        for (std::size_t m = 0; m < Order; ++m)
            for (std::size_t d = 0; d < D; ++d) {
                const int shift = start_shift(m, out_.coarse);
                const float places = power_of_two(fraction_bits(m) - shift);
                const std::int64_t step = std::int64_t{1} << shift;
                const std::int32_t kept = clamped_sum(to_integer(start.c[m][d] * places) * step, 0);
                curve_.span.c[m][d] = static_cast<std::int32_t>(kept / step * step);
            }
    }

    /// In integers, as a decoder chooses the piece that speaks for a time.
    bool before_knot(std::size_t i) const noexcept {
        const std::int64_t knot = search_.plan().knot[0];
        return samples_.t_ns[i] - curve_.span.t0_ns <
               knot * static_cast<std::int64_t>(params_.tick_ns);
    }

    bool accepted(std::size_t i) const noexcept {
        const Polynomial<D, Order> p{curve_.span};
        const float u = ticks_between(curve_.span.t0_ns, samples_.t_ns[i], params_.tick_ns);
        return judge_.accepts(Channel::value(p(u), scale_), samples_.value[i]);
    }

    /// Takes the leading samples that the frozen polynomial covers. @return whether there was one.
    bool cover(std::uint32_t goal) noexcept {
        const auto& plan = search_.plan();
        const std::size_t n = count();
        std::size_t k = 0;
        while (k < n && (plan.size == 0 || before_knot(k)) && accepted(k)) {
            ++k;
            // with knots ahead only what is needed is made final: a later start of the next knot is
            // open
            if (!resting() && records_ - samples_.record[k - 1] < goal) break;
        }
        if (k == 0) return false;
        // the next tick after the last sample taken: samples stand at least a tick apart, so that
        // the next one is not before it, and a knot may stand on it
        const std::int64_t past = samples_.t_ns[k - 1] - curve_.span.t0_ns;
        const auto ticks = static_cast<std::uint32_t>(past / params_.tick_ns) + 1;
        out_.covers = true;
        out_.cover_ticks = cover_ticks_ = ticks;
        samples_.drop(k);
        search_.drop(k);
        if (samples_.size > 0 && samples_.starts_curve[0]) prepare_curve();
        return true;
    }

    /// Are all derivatives below the highest gone at a knot, to rounding? Then a stop there is C2.
    bool comes_to_rest(std::int32_t ticks) const noexcept {
        const auto at = carried(curve_.span, static_cast<std::uint32_t>(ticks), params_.tick_ns);
        for (std::size_t m = 1; m + 1 < Order; ++m)
            for (const std::int32_t c : at.c[m])
                if (c > rest_places || c < -rest_places) return false;
        return true;
    }

    /// Is the frozen polynomial a constant?
    bool resting() const noexcept {
        for (std::size_t m = 1; m < Order; ++m)
            for (std::size_t d = 0; d < D; ++d)
                if (curve_.span.c[m][d] != 0) return false;
        return true;
    }

    /// The first planned knot becomes final, its jump rounded to what its interval can bear.
    void freeze() noexcept {
        const Curve<Channel> before = curve_;
        const auto& plan = search_.plan();
        const std::int32_t ticks = plan.knot[0];
        const std::size_t landing = plan.landing;
        const bool lands = landing > 0 && plan.size <= landing;
        const std::array<float, D> jump = plan.jump[0];
        const float next = plan.size > 1 ? static_cast<float>(plan.knot[1])
                                         : samples_.u[count() > 0 ? count() - 1 : 0];
        const float length = next - static_cast<float>(ticks);
        float power = 1;
        for (std::size_t m = 1; m < Order; ++m) power *= length > 1 ? length : 1;
        int shift = fraction_bits(Order - 1) - jump_places - floor_log2(power);
        shift = shift > 0 ? (shift < 28 ? shift : 28) : 0;
        const std::size_t served = plan.covers;  // as far as that, nothing may be lost by rounding
        search_.froze(ticks);
        if (lands) shift = 0;
        if (lands && plan.size == 0 && comes_to_rest(ticks)) {
            curve_.stop(static_cast<std::uint32_t>(ticks), params_.tick_ns);
            frozen_ = Polynomial<D, Order>{curve_.span};
            cover_ticks_ = 0;
            express_all();
            search_.holds(view());
            out_.knot[out_.size].ticks = static_cast<std::uint32_t>(ticks);
            out_.knot[out_.size].shift = stop_shift;
            out_.knot[out_.size].jump = {};
            out_.covers = false;
            ++out_.size;
            ++counters_.knots;
            return;
        }
        auto& knot = out_.knot[out_.size];
        const auto at = frozen_(static_cast<float>(ticks));  // rounds to what the decoder will use
        for (std::size_t attempt = 0; attempt < 8; ++attempt) {
            curve_ = before;
            const float places = power_of_two(fraction_bits(Order - 1) - shift);
            const auto sent = Channel::to_wire(jump, at);
            for (std::size_t d = 0; d < D; ++d) knot.jump[d] = to_integer(sent[d] * places);
            curve_.advance(static_cast<std::uint32_t>(ticks), knot.jump,
                           static_cast<std::uint32_t>(shift), params_.tick_ns);
            frozen_ = Polynomial<D, Order>{curve_.span};
            cover_ticks_ = 0;
            express_all();
            knot.shift = static_cast<std::uint8_t>(shift);
            auto part = view();
            part.count = served < part.count ? served : part.count;
            if (search_.holds(part) || lands || search_.refit(part, Knots::hard_passes) ||
                shift == 0)
                break;
            shift = shift > 4 ? shift - 4 : 0;
        }
        knot.ticks = static_cast<std::uint32_t>(ticks);
        out_.covers = false;
        ++out_.size;
        ++counters_.knots;
    }

    Params params_{};
    typename Channel::Scale scale_{};
    typename Channel::Judge judge_{};
    Samples samples_{};
    Knots search_{};
    Predictor<Channel> predictor_{};
    Ahead ahead_{};
    Curve<Channel> curve_{};
    Polynomial<D, Order> frozen_{};
    Frozen out_{};
    Counters counters_{};
    std::uint32_t records_{0};
    std::uint32_t cover_ticks_{0};
    std::int64_t epoch_ns_{0};
    std::int64_t last_ns_{0};
    Value last_{};
    bool any_{false};
    bool active_{false};
};

}  // namespace fairlead
