#pragma once
// The search for few knots: a resumable state machine, one fit per step.
//
// A plan covers the whole look-ahead. While new samples fit it, knots are dropped on trial and
// moved to better places; when one does not fit, the knots near it are moved, else a knot is
// inserted, else the end is bent. Changes are local: what stands well before them stays as it is,
// which keeps fits short and a tight plan feasible. The plan is advice: what is emitted is checked
// on its own (reduce/reducer.hpp), so that stopping at any step is safe and more steps per sample
// only mean fewer knots.
#include <cstddef>
#include <cstdint>

#include "fairlead/reduce/fit.hpp"
#include "fairlead/reduce/land.hpp"

namespace fairlead {

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
class Search {
  public:
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    using Fitter = Fit<Channel, N, MaxKnots, Horizons>;
    using KnotPlan = typename Fitter::KnotPlan;
    using Walk = typename Fitter::Walk;
    using Land = Landing<Channel, MaxKnots>;

    /// What a step looks at; valid for that step only.
    struct View : Fitter::Problem {
        std::int32_t low;     // no knot before this tick: the curve is final up to there
        std::uint32_t delay;  // records that a sample may wait
        bool partial{false};  // more samples are there than the search looks at now
    };

    const KnotPlan& plan() const noexcept { return plan_; }

    void reset() noexcept {
        plan_ = {};
        stage_ = Stage::idle;
        stuck_at_ = 0;
        refitted_ = false;
        reach_ = reach;
        hints_ = 0;
    }

    /// A sample has joined the window: does the plan hold?
    void extend(const View& v) noexcept {
        ++age_;
        refitted_ = false;
        polished_ = 0;
        catch_up(v);
    }

    /// The first n samples left the window.
    void drop(std::size_t n) noexcept {
        for (KnotPlan* p : {&plan_, &base_, &current_, &best_}) {
            p->covers -= n < p->covers ? n : p->covers;
            p->worst_at -= n < p->worst_at ? n : p->worst_at;
        }
        horizon_ -= n < horizon_ ? n : horizon_;
        stuck_at_ = 0;
    }

    /// The first planned knot became final: what is left of the plan, in the new span's ticks.
    void froze(std::int32_t ticks) noexcept {
        plan_.erase(0);
        if (plan_.landing > plan_.size) plan_.landing = plan_.size;
        for (std::size_t i = 0; i < plan_.size; ++i) plan_.knot[i] -= ticks;
        for (std::size_t i = 0; i < hints_; ++i) hint_[i] -= ticks;
        stage_ = Stage::idle;
        stuck_at_ = 0;
    }

    /// Does the plan hold as it stands? Recounts the samples that it covers.
    bool holds(const View& v) noexcept {
        trial_ = plan_;
        const bool all = fitter_.check(v, limit, trial_);
        plan_.covers = trial_.covers;
        return all;
    }

    /// Fits the planned knots anew; keeps the plan as it is where that does not hold everywhere.
    bool refit(const View& v, std::size_t passes) noexcept {
        trial_ = plan_;
        if (!fit(v, 0, passes, trial_)) return false;
        return accept(trial_);
    }

    /// A curve must start now: the longest leading part that one polynomial serves, by halving.
    void start_over(const View& v) noexcept {
        reset();
        View part = v;
        part.free = true;
        for (; part.count > 0; part.count /= 2)
            if (fitter_(part, 0, soft_passes, limit, plan_)) return;
    }

    /// One bounded piece of work. @return false when there is nothing worth doing.
    bool step(const View& whole) noexcept {
        if (whole.count == 0) return false;
        if (stage_ == Stage::idle) set_horizon(whole);
        View v = whole;
        v.count = horizon_ < whole.count ? horizon_ : whole.count;
        v.partial = v.count < whole.count;
        switch (stage_) {
            case Stage::idle: return begin(v);
            case Stage::land: return land(v);
            case Stage::move: return move(v);
            case Stage::insert: return insert(v);
            case Stage::dense: return dense(v);
            case Stage::append: return append(v);
            case Stage::drop: return drop_one(v);
            case Stage::drop_harder: return drop_harder(v);
            case Stage::polish: return polish(v);
        }
        return false;
    }

    static constexpr float limit = 0.998f;  // planning keeps this much below the tolerance
    static constexpr std::size_t hard_passes = 12, soft_passes = 3;

  private:
    enum class Stage : std::uint8_t {
        idle,
        land,
        move,
        insert,
        dense,
        append,
        drop,
        drop_harder,
        polish
    };
    enum class Goal : std::uint8_t { repair, insertion, removal };
    static constexpr std::size_t grid = 12;          // places that an insertion tries
    static constexpr std::size_t bends = 5;          // places that a bend of the end tries
    static constexpr std::size_t tail = 4;           // free knots before a change
    static constexpr float hopeless = 3;             // errors beyond: moving knots will not do
    static constexpr std::uint32_t drop_period = 8;  // samples between two rounds of removal
    static constexpr std::size_t catch_up_max = 16;  // samples tested at once
    static constexpr std::size_t reach = 8;          // samples that a plan behind looks further

    bool fit(const View& v, std::size_t head, std::size_t passes, KnotPlan& plan) noexcept {
        const bool ok = v.partial ? fit_without_future(v, head, passes, plan)
                                  : fitter_(v, head, passes, limit, plan);
        // a plan that is behind takes whatever serves it longer
        if (!ok && plan.covers > plan_.covers + 1 && valid(v, plan)) plan_ = plan;
        return ok;
    }
    bool fit_without_future(const View& v, std::size_t head, std::size_t passes,
                            KnotPlan& plan) noexcept {
        const typename Fitter::Problem known{v.samples, v.count, none_, v.frozen, v.judge, v.free};
        return fitter_(known, head, passes, limit, plan);
    }

    /// Counts on over the samples that the plan serves as it stands.
    void catch_up(const View& v) noexcept {
        Walk walk{v.frozen, v.free, plan_};
        for (std::size_t i = 0; i < catch_up_max && plan_.covers < v.count; ++i) {
            const std::size_t k = plan_.covers;
            const auto y = walk.at(v.samples.u[k], plan_);
            if (!(v.judge.error(y, v.samples.x[k]) <= limit)) return;
            ++plan_.covers;
        }
    }

    /// A plan that has fallen behind the window catches up piece by piece; the knots that it had
    /// further on wait as hints.
    void set_horizon(const View& v) noexcept {
        catch_up(v);
        horizon_ = plan_.covers + (urgent_at(plan_.covers, v.delay) ? 4 * reach_ : reach_);
        if (horizon_ > v.count) horizon_ = v.count;
        const float end = v.samples.u[horizon_ - 1];
        if (horizon_ < v.count)
            while (plan_.size > 0 && static_cast<float>(plan_.knot[plan_.size - 1]) >= end)
                put_off(plan_.knot[--plan_.size]);
        while (hints_ > 0 && static_cast<float>(hint_[hints_ - 1]) < end) {
            const std::int32_t at = hint_[--hints_];
            const bool fits = plan_.size == 0 || plan_.knot[plan_.size - 1] < at;
            const bool later =
                plan_.covers == 0 || static_cast<float>(at) >= v.samples.u[plan_.covers - 1];
            if (fits && later && plan_.size < MaxKnots) plan_.insert(at);
        }
    }

    /// Keeps a knot as a hint, the earliest last.
    void put_off(std::int32_t at) noexcept {
        if (hints_ < MaxKnots) hint_[hints_++] = at;
    }

    bool valid(const View& v, const KnotPlan& p) const noexcept {
        const std::int32_t first = v.free || v.low < 1 ? 1 : v.low;
        for (std::size_t i = 0; i < p.size; ++i) {
            if (p.knot[i] < (i ? p.knot[i - 1] + 1 : first)) return false;
            if (static_cast<float>(p.knot[i]) >= v.samples.u[v.count - 1]) return false;
        }
        return true;
    }

    /// Knots before sample i.
    static std::size_t knots_before(const View& v, const KnotPlan& p, std::size_t i) noexcept {
        std::size_t n = 0;
        while (n < p.size && static_cast<float>(p.knot[n]) < v.samples.u[i]) ++n;
        return n;
    }
    /// The head that stays as it is when something `back` knots before knot i changes.
    static std::size_t head_before(std::size_t i, std::size_t back) noexcept {
        return i > back ? i - back : 0;
    }

    bool begin(const View& v) noexcept {
        if (plan_.covers < v.count) {
            if (stuck_at_ == v.count) return false;
            if (start_landing(v)) return true;
            return start_repair(v);
        }
        if (plan_.landing > 0) return false;  // at rest there is nothing to improve
        if (age_ >= drop_period && plan_.size > 0) {
            start_drops(1);
            return true;
        }
        if (!refitted_) {
            refitted_ = true;
            trial_ = plan_;
            if (fit(v, 0, 0, trial_)) plan_ = trial_;
            return true;
        }
        return start_polish();
    }

    bool accept(const KnotPlan& p) noexcept {
        reach_ = reach;
        plan_ = p;
        stage_ = Stage::idle;
        return true;
    }

    /// No plan was found: at least serve the next samples.
    bool give_up(const View& v) noexcept {
        stage_ = Stage::idle;
        if (v.partial && !urgent(v) && reach_ > 1) {
            reach_ /= 2;  // look less far first
            return true;
        }
        stage_ = urgent(v) ? Stage::dense : Stage::append;
        cell_ = 0;
        return true;
    }

    /// Behind, and soon due: no time to look for the fewest knots.
    static bool urgent_at(std::size_t covers, std::uint32_t delay) noexcept {
        return covers < delay / 4;
    }
    bool urgent(const View& v) const noexcept {
        return v.partial && urgent_at(plan_.covers, v.delay);
    }

    // ---- more knots than needed, evenly, beyond what is served; removal thins them out later
    bool dense(const View& v) noexcept {
        trial_ = plan_;
        const std::size_t kept = knots_before(v, plan_, plan_.covers);
        trial_.size = kept > 1 ? kept - 1 : 0;
        const std::size_t head = trial_.size;
        const std::int32_t first = v.free || v.low < 1 ? 1 : v.low;
        const std::int32_t from =
            head > 0 && trial_.knot[head - 1] >= first ? trial_.knot[head - 1] : first - 1;
        const auto until = static_cast<std::int32_t>(v.samples.u[v.count - 1]);
        const std::int32_t parts = 2 << cell_;
        ++cell_;
        const bool room =
            head + static_cast<std::size_t>(parts) <= MaxKnots && until - from > parts;
        if (!room) {
            stage_ = Stage::append;
            cell_ = 0;
            return true;
        }
        for (std::int32_t k = 0; k < parts; ++k)
            trial_.insert(from + 1 + (until - from - 1) * k / parts);
        if (!valid(v, trial_) || !fit(v, head, soft_passes, trial_)) return true;
        hints_ = 0;
        return accept(trial_);
    }

    // ---- repair: a sample is not served
    bool start_repair(const View& v) noexcept {
        level_ = 0;
        rest_drops_ = 0;
        trial_ = plan_;
        head_ = head_before(knots_before(v, plan_, plan_.covers), tail);
        if (fit(v, head_, hard_passes, trial_)) return accept(trial_);
        return repair(v, trial_, Goal::repair);
    }

    /// Moves the knots around the worst error, where that can help; else goes on to one more knot.
    bool repair(const View& v, const KnotPlan& from, Goal goal) noexcept {
        if (urgent(v) || (v.partial && level_ > 0)) return give_up(v);
        if (v.partial || from.size == 0 || from.worst > hopeless) return start_insertion(v, from);
        const std::size_t at = knots_before(v, from, from.worst_at);
        const bool all = goal == Goal::insertion;
        head_ = head_before(at, tail);
        const std::size_t first = all ? head_ : head_before(at, tail - 1);
        const std::size_t last = all || at + 1 >= from.size ? from.size : at + 1;
        start_moves(from, first, last, all ? 3 : 2, all ? 60 : 30, goal);
        return true;
    }

    // ---- landing: while the newest samples are at rest, end the plan on a constant
    bool start_landing(const View& v) noexcept {
        if (v.partial || plan_.landing > 0) return false;
        const std::size_t quiet = v.delay / 2 > 60 ? v.delay / 2 : 60;
        if (!Land::at_rest(v.samples, v.count, quiet, v.judge, mid_)) return false;
        stage_ = Stage::land;
        cell_ = 0;
        found_ = false;
        return true;
    }

    bool land(const View& v) noexcept {
        const std::size_t prefixes = plan_.size + 1;
        for (; cell_ < 2 * prefixes * Land::candidates; ++cell_) {
            const std::size_t count = Order - 1 + cell_ / (prefixes * Land::candidates);
            const std::size_t prefix = cell_ / Land::candidates % prefixes;
            if (found_ && prefix + count >= best_.size) continue;
            if (!Land::plan(plan_, v.frozen, v.free, prefix, count, cell_ % Land::candidates,
                            v.free || v.low < 1 ? 0 : v.low, v.samples.u[v.count - 1], mid_,
                            trial_))
                continue;
            ++cell_;
            if (valid(v, trial_) && fitter_.check(v, limit, trial_)) {
                trial_.landing = count;
                best_ = trial_;
                found_ = true;
            }
            return true;
        }
        if (found_ && valid(v, best_)) return accept(best_);
        return start_repair(v);
    }

    // ---- coordinate search: knots one at a time, by shrinking steps
    void start_moves(const KnotPlan& from, std::size_t first, std::size_t last, std::size_t rounds,
                     std::size_t budget, Goal goal) noexcept {
        current_ = from;
        first_ = first;
        last_ = last;
        rounds_ = rounds;
        budget_ = budget;
        goal_ = goal;
        scale_ = 0;
        knot_ = last_;
        forward_ = false;
        improved_ = false;
        stage_ = Stage::move;
    }

    bool move(const View& v) noexcept {
        static constexpr float steps[] = {0.08f, 0.03f, 0.01f};
        const float span = v.samples.u[v.count - 1] - v.samples.u[0];
        for (std::size_t tries = 0; tries < 4 * MaxKnots; ++tries) {  // to the next valid candidate
            if (budget_ == 0 || !next_move()) return moves_failed(v);
            std::int32_t by = to_integer(steps[scale_] * span);
            if (by < 1) by = 1;
            trial_ = current_;
            trial_.knot[knot_] += forward_ ? by : -by;
            if (!valid(v, trial_)) continue;
            --budget_;
            if (fit(v, head_, current_.worst < 1.5f ? hard_passes : soft_passes, trial_))
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
        if (!forward_ && knot_ < last_) {
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
        knot_ = last_ - 1;
        return last_ > first_;
    }

    bool moves_succeeded() noexcept {
        accept(trial_);
        if (goal_ != Goal::repair && rest_drops_ > 0) start_drops(rest_drops_);
        return true;
    }

    bool moves_failed(const View& v) noexcept {
        stage_ = Stage::idle;
        if (goal_ == Goal::removal) {
            if (++tried_ < 2) stage_ = Stage::drop_harder;
            return true;
        }
        return start_insertion(v, current_);
    }

    // ---- insertion: one more knot on a coarse grid around the worst error
    bool start_insertion(const View& v, const KnotPlan& base) noexcept {
        if (base.size >= MaxKnots || level_ >= MaxKnots) return give_up(v);
        ++level_;
        base_ = base;
        stage_ = Stage::insert;
        cell_ = 0;
        found_ = false;
        low_worst_ = 1e30f;
        const std::size_t at = knots_before(v, base, base.worst_at);
        head_ = head_before(at, tail);
        cell_low_ = at >= 2 ? static_cast<float>(base.knot[at - 2])
                            : static_cast<float>(v.free ? 0 : v.low);
        cell_high_ =
            at + 1 < base.size ? static_cast<float>(base.knot[at + 1]) : v.samples.u[v.count - 1];
        return true;
    }

    bool insert(const View& v) noexcept {
        if (cell_ < grid) {
            trial_ = base_;
            trial_.insert(to_integer(cell_low_ + (cell_high_ - cell_low_) *
                                                     (static_cast<float>(cell_) + 0.5f) / grid));
            ++cell_;
            if (!valid(v, trial_)) return true;
            const bool deep = base_.worst < hopeless;
            if (fit(v, head_, deep ? hard_passes : soft_passes, trial_)) {
                if (!found_ || trial_.objective < best_.objective) best_ = trial_;
                found_ = true;
            } else if (!found_ && trial_.worst < low_worst_) {
                low_worst_ = trial_.worst;
                best_ = trial_;
            }
            return true;
        }
        if (found_ && valid(v, best_)) {
            accept(best_);
            if (!v.partial) start_drops(3);
            return true;
        }
        if (found_ || low_worst_ > 1e29f) return give_up(v);
        rest_drops_ = 3;
        return repair(v, best_, Goal::insertion);
    }

    // ---- the last resort: leave the plan as it is and bend only its end, as early as that serves
    bool append(const View& v) noexcept {
        const bool possible = plan_.size < MaxKnots && plan_.covers > 0 && plan_.covers < v.count;
        const float newest = possible ? v.samples.u[plan_.covers - 1] : 0;
        const std::int32_t last = static_cast<std::int32_t>(newest) + (newest > 0 ? 1 : 0);
        std::int32_t first = v.free || v.low < 1 ? 1 : v.low;
        if (plan_.size > 0 && plan_.knot[plan_.size - 1] >= first)
            first = plan_.knot[plan_.size - 1] + 1;
        if (!possible || cell_ > bends || last < first) {
            stage_ = Stage::idle;
            if (reach_ > 1)
                reach_ /= 2;  // look less far first
            else
                stuck_at_ = v.count;
            return reach_ > 1;
        }
        trial_ = plan_;
        trial_.insert(first + (last - first) * static_cast<std::int32_t>(cell_) /
                                  static_cast<std::int32_t>(bends));
        ++cell_;
        if (!valid(v, trial_) || !fit(v, plan_.size, soft_passes, trial_)) return true;
        return accept(trial_);
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
            const bool ok = fit(v, head_before(cell_, tail - 1), 0, trial_);
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
        head_ = head_before(best, tail - 1);
        if (fit(v, head_, hard_passes, trial_)) return dropped(trial_);
        if (trial_.size == 0) {
            stage_ = ++tried_ < 2 ? Stage::drop_harder : Stage::idle;
            return true;
        }
        const std::size_t last = best + 2 < trial_.size ? best + 2 : trial_.size;
        start_moves(trial_, head_, last, 3, 30, Goal::removal);
        return true;
    }

    bool dropped(const KnotPlan& p) noexcept {
        accept(p);
        if (rest_drops_ > 0) start_drops(rest_drops_);
        return true;
    }

    // ---- polish: with time left, knots go where the fit (and the predicted future) is better
    bool start_polish() noexcept {
        if (plan_.size == 0 || polished_ >= plan_.size) return false;
        knot_ = polished_++;
        cell_ = 0;
        stage_ = Stage::polish;
        return true;
    }

    bool polish(const View& v) noexcept {
        static constexpr std::int32_t by[] = {0, 8, -8, 2, -2};
        if (cell_ >= 5 || knot_ >= plan_.size || plan_.covers < v.count) {
            stage_ = Stage::idle;
            return true;
        }
        trial_ = plan_;
        trial_.knot[knot_] += by[cell_];
        const bool first = cell_ == 0;
        ++cell_;
        if (!valid(v, trial_)) return true;
        const bool ok = fit(v, head_before(knot_, 2), soft_passes, trial_);
        if (first) {
            merit_ = ok ? trial_.objective : 1e30f;
            if (ok) plan_ = trial_;
        } else if (ok && trial_.objective < merit_ * 0.999f) {
            merit_ = trial_.objective;
            plan_ = trial_;
        }
        return true;
    }

    Fitter fitter_{};
    typename Fitter::Ahead none_{};
    KnotPlan plan_{}, trial_{}, base_{}, current_{}, best_{};
    std::array<float, MaxKnots> score_{};
    std::array<std::int32_t, MaxKnots> hint_{};
    std::array<float, D> mid_{};
    Stage stage_{Stage::idle};
    Goal goal_{Goal::repair};
    std::size_t head_{0}, first_{0}, last_{0}, rounds_{0}, budget_{0}, scale_{0}, knot_{0},
        cell_{0};
    std::size_t tried_{0}, rest_drops_{0}, level_{0}, polished_{0}, hints_{0};
    std::size_t stuck_at_{0}, horizon_{0}, reach_{reach};
    std::uint32_t age_{0};
    float low_worst_{0}, cell_low_{0}, cell_high_{0}, merit_{0};
    bool forward_{false}, improved_{false}, found_{false}, refitted_{false};
};

}  // namespace fairlead
