#pragma once
// Streaming knot removal with a hard guarantee and even work.
//
// Samples wait in a window of at most N records. What is frozen of the curve goes on as long as it
// fits; a planned knot becomes final only when samples that are soon due lie beyond it. Before a
// sample counts as covered it is tested against the very polynomial that the decoder will evaluate,
// in the very arithmetic; when nothing else serves, a knot of full multiplicity starts the curve
// anew at the sample that is due. So the tolerance never depends on the search, and the search may
// stop whenever its work is used up. Bounds: memory is sizeof; work per record is one slice of the
// search and one step of finality, a few where a sample is due; delay at most delay_max.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"
#include "host_sim/study/baselines/earlier/reduce/predict.hpp"
#include "host_sim/study/baselines/earlier/reduce/search.hpp"

namespace fairlead::earlier {

template <class Channel>
struct ReduceParams {
    typename Channel::Tolerance tol{};  // absolute; per component, or the rotation angle in rad
    std::uint32_t tick_ns{4000000};     // grid of the knots: at most the smallest sample spacing
    std::uint32_t delay_max{60};        // records; at most N
    std::uint32_t goal{30};             // records that a frame leaves open, where it has the choice
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
/// 2^coarse ticks: less than a jump's, since nothing before it can make up for it.
constexpr int start_shift(std::size_t m, int coarse) noexcept {
    const int places = fraction_bits(m) - rounding_places - 3 - static_cast<int>(m) * coarse;
    return places > 0 ? places : 0;
}

template <class Channel, std::size_t N>
class Reducer {
    static_assert(N >= 2 && N < 32768);  // records are counted in 16 bits

  public:
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    static constexpr std::size_t horizons = Predictor<Channel>::horizons;
    static constexpr std::size_t max_knots = 8 + N / 8;  // that a plan may hold
    static constexpr std::size_t batch_knots = 4;        // that a frame carries
    static constexpr std::size_t cover_max = 16;         // samples tested in one step
    static constexpr std::size_t rounding_max = 128;     // samples that choose a knot's rounding
    static constexpr std::int32_t rest_places = 64;      // last places that a stop may cut off
    using Value = typename Channel::Value;
    using Params = ReduceParams<Channel>;
    using Frozen = Batch<Channel, batch_knots>;

    struct Counters {
        std::uint32_t samples{0}, knots{0}, curves{0}, breaks{0}, refused{0};
        std::uint32_t unserved{0};  // samples that not even a constant represents within tolerance
    };

    Reducer() = default;
    explicit Reducer(const Params& params) noexcept
        : params_{params}, scale_{Channel::scale(params.tol)}, judge_{params.tol, scale_} {
        if (params_.delay_max > N) params_.delay_max = N;
        if (params_.delay_max < 2) params_.delay_max = 2;
        if (params_.goal >= params_.delay_max) params_.goal = params_.delay_max - 1;
    }

    /// A record that this channel has a sample in. Room is guaranteed while due() is obeyed.
    /// A sample closer than a tick to the one before is refused and counted.
    void push(std::int64_t t_ns, const Value& value, bool starts_curve) noexcept {
        ++records_;
        if (any_ && t_ns - last_ns_ < static_cast<std::int64_t>(params_.tick_ns)) {
            ++counters_.refused;
            return;
        }
        FAIRLEAD_ASSERT(!samples_.full());
        const bool starts = starts_curve || !any_;
        last_ns_ = t_ns;
        ++counters_.samples;
        last_ = any_ ? Channel::continued(last_, value) : value;
        any_ = true;
        const bool waits = starts ? !samples_.empty() : own_ < samples_.size();
        Waiting<Channel> sample;
        sample.t_ns = t_ns;
        sample.value = last_;
        sample.record = static_cast<std::uint16_t>(records_);
        sample.starts_curve = starts;
        samples_.push(sample);
        predictor_.push(last_, starts, judge_);
        if (waits) return;
        if (starts) return prepare_curve();
        ++own_;
        express(samples_[own_ - 1]);
        look_ahead();
        search_.extend(view());
    }

    /// Any time of the grid of knots, at or before the first sample; before the first push.
    void set_epoch(std::int64_t t_ns) noexcept { epoch_ns_ = t_ns; }

    /// A record without a sample of this channel: delay counts records.
    void skip() noexcept { ++records_; }

    /// Allots this push's work, and does one step of finality from it where a frame will leave soon
    /// (`closing`) or a curve has ended. What an earlier push took too much is paid back.
    void allot(Credit slice, bool closing) noexcept {
        credit_ = credit_ + slice < slice ? credit_ + slice : slice;
        if (closing || ended()) finalise(false);
    }
    /// Takes work that was done elsewhere from this push's.
    void spend(Credit credit) noexcept { credit_ -= credit; }
    /// Spends what is left of it on the search, after take().
    void work() noexcept {
        while (credit_ > 0 && search_.step(view(), credit_)) {
        }
    }

    /// Must take() be called before the next record?
    bool due() const noexcept { return !empty() && age() >= params_.delay_max; }
    /// Will it be so soon?
    bool closing() const noexcept { return !empty() && age() + lead() >= params_.delay_max; }
    /// Records before its due time that a frame is begun: a record is a step of finality.
    std::uint32_t lead() const noexcept {
        return params_.delay_max > 60 ? params_.delay_max / 10 : 6;
    }
    bool empty() const noexcept { return samples_.empty() && !pending(); }
    /// Records that the oldest sample has waited whose coverage has not been taken.
    std::uint32_t age() const noexcept {
        return pending() ? since(pending_record_)
                         : (samples_.empty() ? 0 : since(samples_.oldest().record));
    }

    /// What has become final since the last call; where a sample is due, that it is covered, if the
    /// knots before it fit in. Else call again with `last`: what was final already covers it, or
    /// the curve starts anew there.
    Frozen take(bool last = false) noexcept {
        if (last && active_ && uncovered_due() && !cover(params_.delay_max)) break_curve();
        // each knot and each stretch of coverage once, and the start of a curve
        for (std::size_t i = 0; i < 2 * batch_knots + 2 && uncovered_due(); ++i)
            if (!finalise(true)) break;
        const Frozen taken = out_;
        out_ = {};
        return taken;
    }

    /// No more samples will come: one slice of work, then makes final what is well planned, at
    /// least one sample; then take().
    void close(Credit slice) noexcept {
        allot(slice, false);
        work();
        const bool planned = search_.plan().covers >= own_;
        const std::size_t steps = planned ? batch_knots + N / cover_max : 1;
        for (std::size_t i = 0; i < steps && !samples_.empty(); ++i)
            if (!finalise(false, planned ? 0 : since(samples_.oldest().record))) break;
        if (!pending()) finalise(true, 0);
    }

    const Curve<Channel>& curve() const noexcept { return curve_; }
    const typename Channel::Scale& scale() const noexcept { return scale_; }
    const Params& params() const noexcept { return params_; }
    const Counters& counters() const noexcept { return counters_; }
    std::uint32_t cover_ticks() const noexcept { return cover_ticks_; }
    bool active() const noexcept { return active_; }

  private:
    using Knots = Search<Channel, N, max_knots, horizons>;
    using Samples = typename Knots::Fitter::Samples;
    using Ahead = typename Knots::Fitter::Ahead;
    using KnotPlan = typename Knots::KnotPlan;

    // what a step of finality costs, in instructions of a Cortex-M4F, about
    static constexpr Credit accept_cost = 160 + 25 * D, freeze_cost = 1500 + 400 * D,
                            rounding_cost = 600 + 150 * D, sample_cost = 60;

    std::uint32_t since(std::uint16_t record) const noexcept {
        return static_cast<std::uint16_t>(records_ - record);
    }
    bool pending() const noexcept { return out_.begins || out_.size > 0 || out_.covers; }
    bool ended() const noexcept { return own_ < samples_.size(); }
    bool uncovered_due() const noexcept {
        return !samples_.empty() && since(samples_.oldest().record) >= params_.delay_max;
    }

    typename Knots::View view() noexcept {
        return {{samples_, own_, ahead_, frozen_, judge_, !active_, 0},
                static_cast<std::int32_t>(cover_ticks_),
                params_.delay_max,
                soon()};
    }

    /// Samples from here on will stay open for a while.
    float soon() const noexcept {
        const std::uint32_t open = params_.goal > lead() ? params_.goal - lead() : 0;
        const std::uint32_t newest = own_ > 0 ? since(samples_[own_ - 1].record) : 0;
        const std::size_t left = open > newest ? open - newest : 0;
        return own_ > left ? samples_[own_ - 1 - left].u : 0;
    }

    void express(Waiting<Channel>& sample) const noexcept {
        sample.u = ticks_between(curve_.span.t0_ns, sample.t_ns, params_.tick_ns);
    }

    /// The window's times seen from a knot `ticks` later.
    void shift_times(std::int32_t ticks) noexcept {
        for (std::size_t i = 0; i < own_; ++i) samples_[i].u -= static_cast<float>(ticks);
        look_ahead();
    }

    /// Pseudo-samples at the predictor's horizons; their weight falls with its error there.
    void look_ahead() noexcept {
        const std::size_t n = own_;
        ahead_.size = 0;
        if (n < 4) return;
        const auto& newest = samples_[n - 1];
        const float step = (newest.u - samples_[0].u) / static_cast<float>(n - 1);
        const auto changes = predictor_.changes(judge_);
        float before = 0;
        for (std::size_t h = 0; h < horizons; ++h) {
            const auto reach = static_cast<float>(Predictor<Channel>::horizon[h]);
            ahead_.x[h] = judge_.coordinates(judge_.moved(newest.value, changes[h]));
            const float spread = predictor_.variance(h) / (0.5f * 0.5f);
            ahead_.u[h] = newest.u + reach * step;
            ahead_.weight[h] = 3 * (reach - before) / (1 + spread * spread);
            before = reach;
        }
        ahead_.size = horizons;
    }

    /// Chooses coordinates for a curve that starts at the oldest sample; nothing is final yet.
    void prepare_curve() noexcept {
        const std::int64_t t = samples_.oldest().t_ns;
        const std::int64_t before = counters_.curves ? curve_.span.t0_ns : epoch_ns_;
        curve_ = {};
        curve_.span.t0_ns = before + (t - before) / params_.tick_ns * params_.tick_ns;
        active_ = false;
        cover_ticks_ = 0;
        frozen_ = {};
        frozen_.c[0] = judge_.coordinates(samples_.oldest().value);
        for (own_ = 0; own_ < samples_.size() && (own_ == 0 || !samples_[own_].starts_curve);
             ++own_)
            express(samples_[own_]);
        search_.reset();
        look_ahead();
        credit_ -= sample_cost * static_cast<Credit>(own_);
    }

    /// One step towards what the next frame shall say. @return whether there was one.
    bool finalise(bool forced) noexcept { return finalise(forced, ended() ? 0 : params_.goal); }
    bool finalise(bool forced, std::uint32_t goal) noexcept;
    /// Coverage is cheap, a knot costs the freedom to place it better: only old ones become final.
    std::uint32_t knot_age(std::uint32_t goal) const noexcept {
        return goal == 0 ? 0 : (goal + 3 * params_.delay_max) / 4;
    }
    std::int32_t first_knot_tick() const noexcept {
        return cover_ticks_ > 1 ? static_cast<std::int32_t>(cover_ticks_) : 1;
    }
    std::uint32_t half_way(std::uint32_t goal) const noexcept;
    /// The start of a curve becomes final, rounded for the interval it was planned for.
    void begin_curve(bool breaks) noexcept;
    /// Nothing else serves the sample that is due.
    void break_curve() noexcept;
    void emit_start(const Polynomial<D, Order>& start, float reach, bool breaks) noexcept;
    /// Sets the curve and what is frozen of it to the start that a decoder will read.
    void round_start(const Polynomial<D, Order>& start) noexcept;
    /// In integers, as a decoder chooses the piece that speaks for a time.
    bool before_knot(std::size_t i) const noexcept;
    /// The exact test, in the decoder's arithmetic.
    bool accepted(const Waiting<Channel>& sample) const noexcept;
    /// Before anything is added to a batch: since when has its oldest sample waited?
    void note_pending() noexcept {
        if (!pending()) pending_record_ = samples_.oldest().record;
    }
    /// Takes leading samples that the frozen polynomial covers. @return whether there was one.
    bool cover(std::uint32_t goal) noexcept;
    /// Are all derivatives below the highest gone at a knot, to rounding? Then a stop there is C2.
    bool comes_to_rest(std::int32_t ticks) const noexcept;
    /// Is the frozen polynomial a constant?
    bool resting() const noexcept;
    /// The first planned knot becomes final.
    void freeze() noexcept;
    /// Rounds the jump of the first planned knot as coarsely as its interval bears. The others have
    /// been fitted to that (`settled`), or take it up as far as they are many, or its error grows
    /// to the end of the plan.
    void round_jump(typename Frozen::Knot& knot, bool lands) noexcept;
    float planned_end(float at_least) const noexcept;
    /// Does the curve that begins with p at the first planned knot serve the samples of so many
    /// intervals?
    bool serves(Polynomial<D, Order> p, const typename KnotPlan::Absorption& changes,
                std::size_t intervals) noexcept;

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
    Credit credit_{0};
    std::size_t own_{0};  // samples of the curve that is being built
    std::uint32_t records_{0};
    std::uint32_t cover_ticks_{0};
    std::int64_t epoch_ns_{0};
    std::int64_t last_ns_{0};
    Value last_{};
    std::uint16_t pending_record_{0};  // of the oldest sample that out_ covers
    bool any_{false};
    bool active_{false};
    bool unserved_{false};  // the oldest sample: it is taken by its break all the same
};

}  // namespace fairlead::earlier

#include "host_sim/study/baselines/earlier/reduce/reducer_finality.hpp"
