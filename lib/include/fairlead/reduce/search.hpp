#pragma once
// The search for few knots: a resumable state machine, one fit per step.
//
// A plan covers the whole look-ahead. While new samples fit it nothing happens; when one does not,
// the last knots are moved, else a knot is inserted; every so often a knot is dropped on trial. The
// plan is advice: what is emitted is checked on its own (reduce/reducer.hpp), so that stopping at
// any step is safe and more steps per sample only mean fewer knots.
#include <cstddef>
#include <cstdint>

#include "fairlead/reduce/fit.hpp"

namespace fairlead {

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
class Search {
  public:
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    using Fitter = Fit<Channel, N, MaxKnots, Horizons>;
    using KnotPlan = typename Fitter::KnotPlan;

    /// What a step looks at; valid for that step only.
    struct View {
        const typename Fitter::Samples& samples;
        std::size_t count;  // samples of the current curve
        const typename Fitter::Ahead& ahead;
        const Polynomial<D, Order>& frozen;
        const typename Channel::Judge& judge;
        bool free;         // nothing of this curve is frozen yet
        std::int32_t low;  // no knot before this tick: the curve is final up to there
    };

    const KnotPlan& plan() const noexcept { return plan_; }
    bool settled(const View& v) const noexcept { return plan_.covers >= v.count; }

    void reset() noexcept {
        plan_ = {};
        stage_ = Stage::idle;
        retry();
        refitted_ = false;
    }

    /// A sample has joined the window: does the plan hold?
    void extend(const View& v) noexcept {
        ++age_;
        refitted_ = false;
        if (plan_.covers + 1 == v.count) catch_up(v);
    }

    /// The first n samples left the window.
    void drop(std::size_t n) noexcept {
        plan_.covers -= n < plan_.covers ? n : plan_.covers;
        stage_ = Stage::idle;
        retry();
    }

    /// The first planned knot became final: what is left of the plan, in the new span's ticks.
    void froze(std::int32_t ticks) noexcept {
        plan_.erase(0);
        for (std::size_t i = 0; i < plan_.size; ++i) plan_.knot[i] -= ticks;
        stage_ = Stage::idle;
        retry();
    }

    /// Does the plan hold as it stands? Recounts the samples that it covers.
    bool holds(const View& v) noexcept {
        plan_.covers = 0;
        for (; plan_.covers < v.count; ++plan_.covers) {
            const std::size_t k = plan_.covers;
            const float e =
                v.judge.error(value(v, v.samples.u[k]), v.samples.x[k], v.samples.witness[k]);
            if (!(e <= limit)) return false;
        }
        return true;
    }

    /// Fits the planned knots anew; keeps the plan as it is where that does not hold everywhere.
    bool refit(const View& v, std::size_t passes) noexcept {
        trial_ = plan_;
        if (!fit(v, passes, trial_)) return false;
        return accept(trial_);
    }

    /// One bounded piece of work. @return false when there is nothing worth doing.
    bool step(const View& whole) noexcept {
        if (whole.count == 0) return false;
        View v = whole;
        if (stage_ == Stage::idle) catch_up(whole);
        v.count = horizon_ < whole.count ? horizon_ : whole.count;
        switch (stage_) {
            case Stage::idle: return begin(v);
            case Stage::move: return move(v);
            case Stage::insert: return insert(v);
            case Stage::drop: return drop_one(v);
            case Stage::drop_harder: return drop_harder(v);
        }
        return false;
    }

    static constexpr float limit = 0.998f;  // planning keeps this much below the tolerance

  private:
    enum class Stage : std::uint8_t { idle, move, insert, drop, drop_harder };
    enum class Goal : std::uint8_t { repair, insertion, removal };
    static constexpr std::size_t hard_passes = 6, soft_passes = 2;
    static constexpr std::size_t grid = 12;
    static constexpr std::uint32_t drop_period = 8;
    static constexpr std::size_t ahead_step = 8;

    void retry() noexcept {
        stuck_at_ = 0;
        reach_ = ahead_step;
    }

    bool fit(const View& v, std::size_t passes, KnotPlan& plan) noexcept {
        return fitter_(v.samples, v.count, v.ahead, v.frozen, v.judge, v.free, passes, limit, plan);
    }

    std::array<float, D> value(const View& v, float u) const noexcept {
        Polynomial<D, Order> p = v.frozen;
        if (v.free) p.c = plan_.start;
        float origin = 0;
        for (std::size_t q = 0; q < plan_.size && static_cast<float>(plan_.knot[q]) < u; ++q) {
            const auto knot = static_cast<float>(plan_.knot[q]);
            p = p.shifted(knot - origin);
            origin = knot;
            for (std::size_t d = 0; d < D; ++d) p.c[Order - 1][d] += plan_.jump[q][d];
        }
        return p(u - origin);
    }

    /// How far the plan holds, and how far the next fits look: a little beyond. A plan that has
    /// fallen behind the window (after a break) recovers piece by piece.
    void catch_up(const View& v) noexcept {
        for (std::size_t i = 0; i < 2 * ahead_step && plan_.covers > 0 && plan_.covers < v.count;
             ++i) {
            const std::size_t k = plan_.covers;
            const float e =
                v.judge.error(value(v, v.samples.u[k]), v.samples.x[k], v.samples.witness[k]);
            if (!(e <= limit)) break;
            ++plan_.covers;
        }
        horizon_ = plan_.covers + reach_;
        if (horizon_ > v.count) horizon_ = v.count;
    }

    bool valid(const View& v, const KnotPlan& p) const noexcept {
        const std::int32_t first = v.free || v.low < 1 ? 1 : v.low;
        for (std::size_t i = 0; i < p.size; ++i) {
            if (p.knot[i] < (i ? p.knot[i - 1] + 1 : first)) return false;
            if (static_cast<float>(p.knot[i]) >= v.samples.u[v.count - 1]) return false;
        }
        return true;
    }

    bool begin(const View& v) noexcept {
        if (plan_.covers < v.count) {
            if (stuck_at_ == v.count) return false;
            trial_ = plan_;
            if (fit(v, hard_passes, trial_)) {
                retry();
                return accept(trial_);
            }
            if (trial_.size > 0)
                start_moves(trial_, trial_.size > 3 ? trial_.size - 3 : 0, 2, 30, Goal::repair);
            else
                start_insertion();
            return true;
        }
        if (age_ >= drop_period && plan_.size > 0) {
            start_drops(1);
            return true;
        }
        if (refitted_) return false;
        refitted_ = true;
        trial_ = plan_;
        if (fit(v, 0, trial_)) plan_ = trial_;
        return true;
    }

    /// No plan was found up to the horizon: look less far ahead before waiting for new samples.
    void give_up(const View& v) noexcept {
        if (reach_ > 1)
            reach_ /= 2;
        else
            stuck_at_ = v.count;
    }

    bool accept(const KnotPlan& p) noexcept {
        plan_ = p;
        stage_ = Stage::idle;
        return true;
    }

    // ---- coordinate search: knots one at a time, by shrinking steps
    void start_moves(const KnotPlan& from, std::size_t first, std::size_t rounds,
                     std::size_t budget, Goal goal) noexcept {
        current_ = from;
        first_ = first;
        rounds_ = rounds;
        budget_ = budget;
        goal_ = goal;
        scale_ = 0;
        knot_ = current_.size;
        forward_ = false;
        improved_ = false;
        stage_ = Stage::move;
    }

    bool move(const View& v) noexcept {
        static constexpr float steps[] = {0.08f, 0.03f, 0.01f};
        const float span = v.samples.u[v.count - 1] - v.samples.u[0];
        for (std::size_t tries = 0; tries < 4 * MaxKnots; ++tries) {  // to the next valid candidate
            if (!next_move()) return moves_failed(v);
            std::int32_t by = to_integer(steps[scale_] * span);
            if (by < 1) by = 1;
            trial_ = current_;
            trial_.knot[knot_] += forward_ ? by : -by;
            if (!valid(v, trial_)) continue;
            if (fit(v, current_.worst < 1.5f ? hard_passes : soft_passes, trial_))
                return moves_succeeded();
            if (trial_.worst < current_.worst - 1e-4f) {
                current_ = trial_;
                improved_ = true;
            }
            return true;
        }
        return true;
    }

    /// Steps through (scale, knot from last to first, direction); repeats while rounds improve.
    bool next_move() noexcept {
        if (budget_ == 0) return false;
        --budget_;
        if (!forward_ && knot_ < current_.size) {
            forward_ = true;
            return true;
        }
        forward_ = false;
        if (knot_ > first_) {
            --knot_;
            return true;
        }
        if (scale_ == 2) {
            if (!improved_ || --rounds_ == 0) return false;
            improved_ = false;
            scale_ = 0;
        } else {
            ++scale_;
        }
        knot_ = current_.size - 1;
        return current_.size > first_;
    }

    bool moves_succeeded() noexcept {
        plan_ = trial_;
        stage_ = Stage::idle;
        if (goal_ != Goal::repair) {
            if (rest_drops_ > 0) start_drops(rest_drops_);
        }
        return true;
    }

    bool moves_failed(const View& v) noexcept {
        stage_ = Stage::idle;
        if (goal_ == Goal::repair) start_insertion();
        if (goal_ == Goal::insertion) give_up(v);
        if (goal_ == Goal::removal && ++tried_ < 2) stage_ = Stage::drop_harder;
        return true;
    }

    // ---- insertion: one more knot on a coarse grid over the end of the window
    void start_insertion() noexcept {
        stage_ = Stage::insert;
        cell_ = 0;
        found_ = false;
        low_worst_ = 1e30f;
    }

    bool insert(const View& v) noexcept {
        if (plan_.size >= MaxKnots) {
            give_up(v);
            stage_ = Stage::idle;
            return false;
        }
        if (cell_ < grid) {
            const float lo = plan_.size >= 2 ? static_cast<float>(plan_.knot[plan_.size - 2])
                                             : static_cast<float>(v.free ? 1 : v.low);
            const float hi = v.samples.u[v.count - 1];
            trial_ = plan_;
            trial_.insert(to_integer(lo + (hi - lo) * (static_cast<float>(cell_) + 0.5f) / grid));
            ++cell_;
            if (!valid(v, trial_)) return true;
            if (fit(v, hard_passes, trial_)) {
                if (!found_ || trial_.objective < best_.objective) best_ = trial_;
                found_ = true;
            } else if (!found_ && trial_.worst < low_worst_) {
                low_worst_ = trial_.worst;
                best_ = trial_;
            }
            return true;
        }
        if (found_) {
            plan_ = best_;
            start_drops(3);
        } else if (low_worst_ < 1e29f) {
            rest_drops_ = 3;
            start_moves(best_, 0, 3, 60, Goal::insertion);
        } else {
            give_up(v);
            stage_ = Stage::idle;
        }
        return true;
    }

    // ---- removal: every knot in turn by a plain fit, then the two most promising with effort
    void start_drops(std::size_t times) noexcept {
        stage_ = plan_.size > 0 ? Stage::drop : Stage::idle;
        rest_drops_ = times - 1;
        cell_ = 0;
        tried_ = 0;
        age_ = 0;
    }

    bool drop_one(const View& v) noexcept {
        if (cell_ < plan_.size) {
            trial_ = plan_;
            trial_.erase(cell_);
            const bool ok = fit(v, 0, trial_);
            score_[cell_] = trial_.worst;
            ++cell_;
            if (ok) return dropped(trial_);
            return true;
        }
        stage_ = Stage::drop_harder;
        return drop_harder(v);
    }

    bool drop_harder(const View& v) noexcept {
        std::size_t best = 0;
        for (std::size_t i = 1; i < plan_.size && i < cell_; ++i)
            if (score_[i] < score_[best]) best = i;
        if (plan_.size == 0 || cell_ == 0 || score_[best] > 6) {
            stage_ = Stage::idle;
            return true;
        }
        trial_ = plan_;
        trial_.erase(best);
        score_[best] = 1e30f;
        if (fit(v, hard_passes, trial_)) return dropped(trial_);
        if (trial_.size == 0) {
            stage_ = ++tried_ < 2 ? Stage::drop_harder : Stage::idle;
            return true;
        }
        start_moves(trial_, 0, 3, 30, Goal::removal);
        return true;
    }

    bool dropped(const KnotPlan& p) noexcept {
        plan_ = p;
        stage_ = Stage::idle;
        if (rest_drops_ > 0) start_drops(rest_drops_);
        return true;
    }

    Fitter fitter_{};
    KnotPlan plan_{}, trial_{}, current_{}, best_{};
    std::array<float, MaxKnots> score_{};
    Stage stage_{Stage::idle};
    Goal goal_{Goal::repair};
    std::size_t first_{0}, rounds_{0}, budget_{0}, scale_{0}, knot_{0}, cell_{0}, tried_{0},
        rest_drops_{0};
    std::size_t stuck_at_{0};
    std::size_t horizon_{0}, reach_{ahead_step};
    std::uint32_t age_{0};
    float low_worst_{0};
    bool forward_{false}, improved_{false}, found_{false}, refitted_{false};
};

}  // namespace fairlead
