#pragma once
// The search for few knots: a resumable state machine that proposes plans and judges their fits.
//
// A plan covers the whole look-ahead. While new samples fit it, knots are dropped on trial and
// moved to better places; when one does not fit, the knots near it are moved, else a knot is
// inserted, else the end is bent. Changes are local: what stands well before them stays as it is,
// which keeps fits short and a tight plan feasible. The plan is advice: what is emitted is checked
// on its own (reduce/reducer.hpp), so that stopping anywhere is safe and more work per sample only
// means fewer knots.
#include <cstddef>
#include <cstdint>

#include "fairlead/reduce/fit.hpp"
#include "fairlead/reduce/land.hpp"

namespace fairlead {

/// Places by which a jump is rounded when its first interval is `length` ticks: to 2^-4 of a unit
/// at the interval's end.
template <std::size_t Order>
int jump_shift(float length) noexcept {
    float power = 1;
    for (std::size_t m = 1; m < Order; ++m) power *= length > 1 ? length : 1;
    const int shift = fraction_bits(Order - 1) - 4 - floor_log2(power);
    return shift < 0 ? 0 : (shift < 28 ? shift : 28);
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
class Search {
  public:
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    using Fitter = Fit<Channel, N, MaxKnots, Horizons>;
    using KnotPlan = typename Fitter::KnotPlan;
    using Walk = typename Fitter::Walk;
    using Land = Landing<Channel, MaxKnots>;
    using Vector = std::array<float, D>;

    /// What a step looks at; valid for that step only.
    struct View : Fitter::Problem {
        std::int32_t low;     // no knot before this tick: the curve is final up to there
        std::uint32_t delay;  // records that a sample may wait
        float soon;           // a knot before this tick will be final soon
    };

    const KnotPlan& plan() const noexcept { return plan_; }
    /// Has the plan been tested since a knot was rounded, and does it serve nearly all samples?
    bool steady(std::size_t count) const noexcept {
        return !doubted_ && stage_ != Stage::verify && stage_ != Stage::refit && plan_.covers + 3*reach >= count;
    }

    void reset() noexcept {
        plan_ = {};
        fitter_.cancel();
        stage_ = Stage::idle;
        stuck_at_ = 0;
        refitted_ = false;
        flat_start_ = true;
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
        for (KnotPlan* p : {&plan_, &current_, &best_, &trial_}) p->drop(n);
        fitter_.drop(n);
        horizon_ -= n < horizon_ ? n : horizon_;
        stuck_at_ = 0;
        if (horizon_ == 0) idle();
    }

    /// The first jump will not be quite as planned: those after it make up for that.
    void absorb(const typename KnotPlan::Absorption& changes) noexcept { plan_.absorb(changes); }

    /// The first planned knot became final, its jump rounded: what is left of the plan, in the new
    /// span's ticks, must be tested again.
    void froze(std::int32_t ticks) noexcept {
        plan_.erase(0);
        plan_.settled = -1;
        if (plan_.landing > plan_.size) plan_.landing = plan_.size;
        for (std::size_t i = 0; i < plan_.size; ++i) plan_.knot[i] -= ticks;
        for (std::size_t i = 0; i < hints_; ++i) hint_[i] -= ticks;
        rounded();
    }

    /// The frozen polynomial is not quite what was planned.
    void rounded() noexcept {
        idle();
        doubted_ = true;
        stuck_at_ = 0;
    }

    /// A curve must start now: the longest leading part that one polynomial serves, by halving.
    void start_over(const View& v, Credit& credit) noexcept {
        reset();
        ahead_.size = 0;
        typename Fitter::Problem part{v.samples, v.count, ahead_, v.frozen, v.judge, true, v.count};
        if (part.count > start_max) part.count = start_max;
        for (; part.count > 0; part.count /= 2) {
            trial_ = {};
            fitter_.start(part, 0, 0, limit, trial_);
            Credit ample = 1 << 30;
            fitter_.run(part, trial_, ample);
            credit -= Fitter::start_cost + (1 << 30) - ample;
            if (fitter_.succeeded()) break;
            trial_ = {};
        }
        plan_ = trial_;
    }

    /// Goes on with the search. @return false when there is nothing worth doing.
    bool step(const View& whole, Credit& credit) noexcept {
        if (whole.count == 0) return false;
        credit -= step_cost;
        if (stage_ == Stage::idle) {
            set_horizon(whole);
            partial_ = horizon_ < whole.count && !waits_;
            hurried_ = partial_ && plan_.covers < near;
            ahead_.size = 0;
            if (!partial_) ahead_ = whole.ahead;
            credit -= horizon_cost + Fitter::pass_cost * static_cast<Credit>(plan_.size);
        }
        View v = whole;
        v.wanted = plan_.covers + 1;
        v.count = horizon_ < whole.count ? horizon_ : whole.count;
        if (!fitter_.busy()) {
            fitting_ = false;
            if (!propose(v, credit)) return false;
            if (!fitting_) return true;
            credit -= Fitter::start_cost + Fitter::pass_cost * static_cast<Credit>(trial_.size);
        }
        const typename Fitter::Problem problem{v.samples, v.count, ahead_, v.frozen,
                                               v.judge,   v.free,  v.wanted};
        fitter_.run(problem, trial_, credit);
        if (!fitter_.busy()) conclude(v, fitter_.succeeded());
        return true;
    }

    static constexpr float limit = 0.998f;  // planning keeps this much below the tolerance
    static constexpr Credit step_cost = 300 + 20 * static_cast<Credit>(MaxKnots);
    static constexpr Credit horizon_cost = 500 + 4 * Fitter::test_cost;
    static constexpr Credit landing_cost = 1500 + 1300 * D, rest_cost = 15 + 12 * D;

  private:
    enum class Stage : std::uint8_t {
        idle,
        verify,
        refit,
        repair,
        settle,
        renew,
        land,
        move,
        insert,
        append,
        drop,
        drop_harder,
        polish
    };
    enum class Goal : std::uint8_t { insertion, removal };
    static constexpr std::size_t hard_passes = 5, move_passes = 4, soft_passes = 3;
    static constexpr std::size_t grid = 12;          // places that an insertion tries
    static constexpr std::size_t finalists = 3;      // of which it tries with effort
    static constexpr std::size_t move_budget = 16;   // moves tried before a knot is given up
    static constexpr std::size_t bends = 5;          // places that a bend of the end tries
    static constexpr float hopeless = 3;             // errors beyond: moving knots will not do
    static constexpr std::uint32_t drop_period = 4;  // samples between two rounds of removal
    static constexpr std::size_t catch_up_max = 16;  // samples tested at once
    static constexpr std::size_t near = 24;          // samples before which a plan hurries
    static constexpr std::size_t patience = 8;       // samples that a plan may lack for a while
    static constexpr std::size_t reach = 8;          // samples that a plan behind looks further
    static constexpr std::size_t fit_lasts = 8;      // records that a fit may take
    static constexpr std::size_t start_max = 16;     // samples of a curve that must start at once

    // ---- the frame of every stage: propose a trial and have it fitted, then judge it
    bool propose(const View& v, Credit& credit) noexcept {
        switch (stage_) {
            case Stage::idle: return begin(v, credit);
            case Stage::land: return propose_landing(v, credit);
            case Stage::move: return propose_move(v);
            case Stage::insert: return propose_insertion(v);
            case Stage::append: return propose_append(v);
            case Stage::drop: return propose_drop(v);
            case Stage::drop_harder: return propose_hard_drop(v);
            case Stage::polish: return propose_polish(v);
            case Stage::settle: return propose_settling(v);
            case Stage::refit: return propose_refit(v);
            case Stage::verify:
            case Stage::repair:
            case Stage::renew: break;
        }
        idle();  // its fit was cut off
        return true;
    }

    void conclude(const View& v, bool ok) noexcept {
        if (seeking_) {
            seeking_ = fresh_ = false;
            return;
        }
        // a plan that is behind takes whatever serves it longer
        if (!ok && stage_ != Stage::verify && trial_.covers > plan_.covers + 1 && valid(v, trial_))
            plan_ = trial_;
        if (ok && !valid(v, trial_)) ok = false;
        switch (stage_) {
            case Stage::verify: return verified();
            case Stage::refit: return ok ? accept(trial_) : idle();
            case Stage::repair: return ok ? accept(trial_) : repair(v);
            case Stage::settle: return ok ? accept(trial_) : void();
            case Stage::renew:
                if (ok) plan_ = trial_;
                return idle();
            case Stage::land: return landed(ok);
            case Stage::move: return moved(ok);
            case Stage::insert: return inserted(ok);
            case Stage::append: return ok ? accept(trial_) : void();
            case Stage::drop: return dropped(ok);
            case Stage::drop_harder: return hard_dropped(ok);
            case Stage::polish: return polished(ok);
            case Stage::idle: return;
        }
    }

    /// Has trial_ fitted behind its first `head` knots.
    bool fit(const View& v, std::size_t head, std::size_t passes) noexcept {
        fitting_ = true;
        fitter_.start(v, head, passes, limit, trial_);
        return true;
    }

    void idle() noexcept {
        fitter_.cancel();
        seeking_ = false;
        stage_ = Stage::idle;
    }

    void accept(const KnotPlan& p) noexcept {
        reach_ = reach;
        plan_ = p;
        idle();
    }

    bool begin(const View& v, Credit& credit) noexcept {
        if (doubted_) {
            doubted_ = false;
            stage_ = Stage::verify;
            trial_ = plan_;
            fitting_ = true;
            fitter_.start_test(v, limit, trial_);
            return true;
        }
        if (v.free && flat_start_ && plan_.landing == 0 && rests(v, v.count, credit)) {
            plan_ = {};  // a curve that starts at rest is a constant
            plan_.start[0] = mid_;
            plan_.landing = 1;
            plan_.covers = v.count;
            doubted_ = true;
            return true;
        }
        if (plan_.covers < v.count) {
            if (stuck_at_ == v.count) return false;
            if (!start_landing(v, credit)) start_repair(v);
            return true;
        }
        if (plan_.landing > 0) return false;  // at rest there is nothing to improve
        if (plan_.size > 0 && plan_.size <= Order && plan_.settled < 0 && static_cast<float>(plan_.knot[0]) < v.soon) {
            stage_ = Stage::settle;
            cell_ = 0;
            return true;
        }
        if (age_ >= drop_period && plan_.size > 0) {
            start_drops();
            return true;
        }
        if (!refitted_) {
            refitted_ = true;
            stage_ = Stage::renew;
            trial_ = plan_;
            return fit(v, loose(0), 0);
        }
        return start_polish();
    }

    // ---- settling: the first knot will be final soon; the others adapt to its rounded jump
    bool propose_settling(const View& v) noexcept {
        static constexpr int finer[] = {0, 3, 6, 10};
        if (cell_ >= 4 || plan_.size == 0) {
            idle();
            return true;
        }
        trial_ = plan_;
        const float until =
            plan_.size > 1 ? static_cast<float>(plan_.knot[1]) : v.samples[v.count - 1].u;
        const int coarse =
            jump_shift<Order>(until - static_cast<float>(plan_.knot[0])) - finer[cell_];
        trial_.settled = static_cast<std::int8_t>(coarse > 0 ? coarse : 0);
        const Vector at = v.frozen(static_cast<float>(plan_.knot[0]));
        Vector sent = Channel::to_wire(plan_.jump[0], at);
        const float places = power_of_two(fraction_bits(Order - 1) - trial_.settled);
        for (std::size_t d = 0; d < D; ++d)
            sent[d] = static_cast<float>(to_integer(sent[d] * places)) / places;
        trial_.jump[0] = Channel::from_wire(sent, at);
        ++cell_;
        return fit(v, 1, soft_passes);
    }
    /// A head that leaves a settled knot as it is.
    std::size_t loose(std::size_t head) const noexcept {
        return head == 0 && plan_.settled >= 0 ? 1 : head;
    }

    void verified() noexcept {
        const bool was_ahead = plan_.covers > trial_.covers;
        if (was_ahead) plan_.covers = trial_.covers;
        if (plan_.landing > 0 && plan_.size == 0 && trial_.covers < horizon_) flat_start_ = false;
        if (was_ahead && plan_.size > 0 && plan_.landing == 0) {
            stage_ = Stage::refit;
            cell_ = 0;
            return;
        }
        idle();
    }

    /// The rounding of a knot was a little too much: the others make up for it, all at once.
    bool propose_refit(const View& v) noexcept {
        if (cell_++ > 0) {
            idle();
            return true;
        }
        trial_ = plan_;
        return fit(v, loose(0), hard_passes);
    }

    // ---- how far to look
    /// Counts on over the samples that the plan serves as it stands.
    void catch_up(const View& v) noexcept {
        Walk walk{v.frozen, v.free, plan_};
        for (std::size_t i = 0; i < catch_up_max && plan_.covers < v.count; ++i) {
            const auto& sample = v.samples[plan_.covers];
            const auto y = walk.at(sample.u, plan_);
            for (const float e : v.judge.errors(y, sample.value))
                if (!(e <= limit)) return;
            ++plan_.covers;
        }
    }

    /// A plan that has fallen behind the window catches up piece by piece; the knots that it had
    /// further on wait as hints.
    void set_horizon(const View& v) noexcept {
        if (plan_.covers > v.count) plan_.covers = v.count;
        catch_up(v);
        horizon_ = plan_.covers + reach_;
        if (horizon_ > v.count) horizon_ = v.count;
        const std::size_t behind = v.count - plan_.covers;
        const bool full = plan_.size + 2 > MaxKnots;
        if ((behind < patience || full) && plan_.covers > near && plan_.landing == 0) {
            horizon_ = plan_.covers;
            waits_ = behind > 0;
            return;
        }
        waits_ = false;
        const float end = v.samples[horizon_ - 1].u;
        if (horizon_ < v.count)
            while (plan_.size > 0 && static_cast<float>(plan_.knot[plan_.size - 1]) >= end)
                put_off(plan_.knot[--plan_.size]);
        while (hints_ > 0 && static_cast<float>(hint_[hints_ - 1]) < end) {
            const std::int32_t at = hint_[--hints_];
            const bool fits = plan_.size == 0 || plan_.knot[plan_.size - 1] < at;
            const bool later =
                plan_.covers == 0 || static_cast<float>(at) >= v.samples[plan_.covers - 1].u;
            if (fits && later && plan_.size < MaxKnots) plan_.insert(at);
        }
    }

    /// Keeps a knot as a hint, the earliest last.
    void put_off(std::int32_t at) noexcept {
        if (hints_ < MaxKnots) hint_[hints_++] = at;
    }

    bool valid(const View& v, const KnotPlan& p) const noexcept {
        const std::int32_t first = first_place(v);
        for (std::size_t i = 0; i < p.size; ++i) {
            if (p.knot[i] < (i ? p.knot[i - 1] + 1 : first)) return false;
            if (static_cast<float>(p.knot[i]) >= v.samples[v.count - 1].u) return false;
        }
        return true;
    }

    /// The first tick at which a knot may stand.
    static std::int32_t first_place(const View& v) noexcept {
        return v.free || v.low < 1 ? 1 : v.low;
    }
    /// The same a few records later: coverage goes on while a fit is under way.
    std::int32_t first_lasting_place(const View& v) const noexcept {
        const std::size_t i = plan_.covers < 2 * fit_lasts ? 0 : fit_lasts;
        const auto later = static_cast<std::int32_t>(v.samples[i < v.count ? i : v.count - 1].u);
        const std::int32_t first = first_place(v);
        return later > first ? later : first;
    }
    /// Knots before sample i.
    static std::size_t knots_before(const View& v, const KnotPlan& p, std::size_t i) noexcept {
        return i < v.count ? p.knots_before(v.samples[i].u) : p.size;
    }
    /// The head that stays as it is when something `back` knots before knot i changes.
    static std::size_t head_before(std::size_t i, std::size_t back) noexcept {
        return i > back ? i - back : 0;
    }

    /// No plan was found: at least serve the next samples.
    void give_up() noexcept {
        idle();
        if (partial_ && reach_ > 1) {
            reach_ /= 2;  // look less far first
            return;
        }
        stage_ = Stage::append;
        cell_ = 0;
    }

    /// Free knots before a change: fewer where the plan must catch up.
    std::size_t tail() const noexcept { return partial_ ? 3 : 4; }

    // ---- repair: a sample is not served
    void start_repair(const View& v) noexcept {
        level_ = 0;
        trial_ = plan_;
        head_ = head_before(knots_before(v, plan_, plan_.covers), tail());
        stage_ = Stage::repair;
        fit(v, head_, hard_passes);
    }

    /// One more knot.
    void repair(const View& v) noexcept {
        start_insertion(v, trial_);
    }

    /// No single knot is enough: moves those around the worst error, too.
    void move_all(const View& v) noexcept {
        if (partial_) return give_up();
        if (best_.worst > hopeless) return start_insertion(v, best_);
        head_ = head_before(knots_before(v, best_, best_.worst_at), tail());
        start_moves(best_, 2 * move_budget, Goal::insertion);
    }

    // ---- landing: while the newest samples are at rest, end the plan on a constant
    bool start_landing(const View& v, Credit& credit) noexcept {
        if (partial_ || plan_.landing > 0 || !rests(v, quiet(v.delay), credit)) return false;
        stage_ = Stage::land;
        cell_ = 0;
        found_ = false;
        return true;
    }

    /// So many samples without motion are a rest.
    static std::size_t quiet(std::uint32_t delay) noexcept {
        const std::size_t most = delay * 3 / 4 < 60 ? delay * 3 / 4 : 60;
        return delay / 2 > most ? delay / 2 : most;
    }
    /// Are the newest n samples, and enough of them, at rest?
    bool rests(const View& v, std::size_t n, Credit& credit) noexcept {
        if (partial_ || v.count < quiet(v.delay)) return false;
        credit -= static_cast<Credit>(n) * rest_cost;
        return Land::at_rest(v.samples, v.count, n, v.judge, mid_);
    }

    bool propose_landing(const View& v, Credit& credit) noexcept {
        const std::size_t prefixes = plan_.size + 1;
        for (; credit > 0 && cell_ < 2 * prefixes * Land::candidates; ++cell_) {
            const std::size_t count = Order - 1 + cell_ / (prefixes * Land::candidates);
            const std::size_t prefix = cell_ / Land::candidates % prefixes;
            credit -= step_cost;
            if (found_ && prefix + count >= best_.size) continue;
            credit -= landing_cost;
            if (!Land::plan(plan_, v.frozen, v.free, prefix, count, cell_ % Land::candidates,
                            v.free || v.low < 1 ? 0 : v.low, v.samples[v.count - 1].u, mid_,
                            trial_) ||
                !valid(v, trial_))
                continue;
            ++cell_;
            trial_.landing = count;
            fitting_ = true;
            fitter_.start_test(v, limit, trial_);
            return true;
        }
        if (cell_ < 2 * prefixes * Land::candidates) return true;
        if (found_ && valid(v, best_))
            accept(best_);
        else
            start_repair(v);
        return true;
    }

    void landed(bool ok) noexcept {
        if (!ok) return;
        best_ = trial_;
        found_ = true;
    }

    // ---- moves: all free knots at once, by damped steps of Gauss and Newton
    void start_moves(const KnotPlan& from, std::size_t budget, Goal goal) noexcept {
        current_ = from;
        budget_ = budget;
        goal_ = goal;
        fresh_ = true;
        stage_ = Stage::move;
    }

    bool propose_move(const View& v) noexcept {
        if (budget_ == 0 || current_.size <= head_ || Order < 3) {
            moves_failed(v);
            return true;
        }
        --budget_;
        trial_ = current_;
        if (fresh_) return seek(v, head_);
        if (!shift_knots(v, head_)) {
            moves_failed(v);
            return true;
        }
        return fit(v, head_, current_.worst < 1.5f ? move_passes : soft_passes);
    }

    /// Has the fitter look for better places of the trial's knots.
    bool seek(const View& v, std::size_t head) noexcept {
        seeking_ = true;
        fitting_ = true;
        const std::size_t most = Fitter::shifts_max;
        sought_ = trial_.size > head + most ? trial_.size - most : head;
        fitter_.start_shifts(v, sought_, trial_);
        damping_ = 1;
        return true;
    }

    /// Moves the trial's knots to where they want to be. @return whether any moves.
    bool shift_knots(const View& v, std::size_t head) noexcept {
        const auto last = static_cast<std::int32_t>(v.samples[v.count - 1].u) - 1;
        bool any = false;
        const KnotPlan& from = trial_;
        std::int32_t before = head > 0 ? from.knot[head - 1] : first_place(v) - 1;
        if (head > 0 && before < first_place(v) - 1) before = first_place(v) - 1;
        for (std::size_t i = sought_; i < trial_.size; ++i) {
            const std::int32_t old = trial_.knot[i];
            if (i > head && i == sought_) before = trial_.knot[i - 1];
            const float room_below = static_cast<float>(old - before) * 0.6f;
            const std::int32_t next = i + 1 < trial_.size ? trial_.knot[i + 1] : last;
            const float room_above = static_cast<float>(next - old) * 0.6f;
            float by = fitter_.shift(i) * damping_;
            if (by < -room_below) by = -room_below;
            if (by > room_above) by = room_above;
            std::int32_t at = old + to_integer(by);
            if (at <= before) at = before + 1;
            before = old;
            if (i > sought_ && at <= trial_.knot[i - 1]) at = trial_.knot[i - 1] + 1;
            any = any || at != old;
            trial_.knot[i] = at;
        }
        return any && valid(v, trial_);
    }

    void moved(bool ok) noexcept {
        if (ok) {
            accept(trial_);
        } else if (trial_.worst < current_.worst - 1e-4f) {
            current_ = trial_;
            fresh_ = true;
        } else {
            damping_ *= 0.35f;
            if (damping_ < 0.1f) budget_ = 0;
        }
    }

    void moves_failed(const View& v) noexcept {
        idle();
        if (goal_ != Goal::removal) return start_insertion(v, current_);
        if (++tried_ < 2) stage_ = Stage::drop_harder;
    }

    // ---- insertion: one more knot on a coarse grid around the worst error
    void start_insertion(const View& v, const KnotPlan& from) noexcept {
        if (from.size >= MaxKnots || level_ >= MaxKnots) return give_up();
        ++level_;
        if (&from != &current_) current_ = from;
        stage_ = Stage::insert;
        cell_ = 0;
        tried_ = 0;
        found_ = false;
        low_worst_ = 1e30f;
        places_ = hurried_ ? grid / 3 : (partial_ ? grid / 2 : grid);
        const std::size_t at = knots_before(v, current_, current_.worst_at);
        head_ = head_before(at, tail());
        cell_low_ = at >= 2 ? static_cast<float>(current_.knot[at - 2])
                            : static_cast<float>(v.free ? 0 : v.low);
        cell_high_ = at + 1 < current_.size ? static_cast<float>(current_.knot[at + 1])
                                            : v.samples[v.count - 1].u;
    }

    bool propose_insertion(const View& v) noexcept {
        if (cell_ < places_) {  // every place by a quick fit
            score_[cell_] = 1e30f;
            return insert_at(v, cell_++, 0);
        }
        while (tried_ < (partial_ ? 1 : finalists)) {  // the best of them with effort
            ++tried_;
            std::size_t best = 0;
            for (std::size_t i = 1; i < places_; ++i)
                if (score_[i] < score_[best]) best = i;
            if (score_[best] > 1e29f) break;
            score_[best] = 1e30f;
            return insert_at(v, best, current_.worst < hopeless && !hurried_ ? hard_passes : soft_passes);
        }
        if (found_ && valid(v, best_)) {
            accept(best_);
            if (!partial_) start_drops();
        } else if (found_ || low_worst_ > 1e29f) {
            give_up();
        } else {
            move_all(v);
        }
        return true;
    }

    bool insert_at(const View& v, std::size_t cell, std::size_t passes) noexcept {
        trial_ = current_;
        trial_.insert(
            to_integer(cell_low_ + (cell_high_ - cell_low_) * (static_cast<float>(cell) + 0.5f) /
                                       static_cast<float>(places_)));
        return valid(v, trial_) ? fit(v, head_, passes) : true;
    }

    void inserted(bool ok) noexcept {
        if (tried_ == 0) score_[cell_ - 1] = trial_.worst;
        if (ok) {
            if (!found_ || trial_.objective < best_.objective) best_ = trial_;
            found_ = true;
        } else if (!found_ && trial_.worst < low_worst_) {
            low_worst_ = trial_.worst;
            best_ = trial_;
        }
    }

    // ---- the last resort: leave the plan as it is and bend only its end, as early as that serves
    bool propose_append(const View& v) noexcept {
        const bool possible = plan_.size < MaxKnots && plan_.covers > 0 && plan_.covers < v.count;
        const float newest = possible ? v.samples[plan_.covers - 1].u : 0;
        const std::int32_t last = static_cast<std::int32_t>(newest) + (newest > 0 ? 1 : 0);
        std::int32_t first = first_place(v);
        if (plan_.size > 0 && plan_.knot[plan_.size - 1] >= first)
            first = plan_.knot[plan_.size - 1] + 1;
        if (!possible || cell_ > bends || last < first) {
            idle();
            if (reach_ > 1) {
                reach_ /= 2;  // look less far first
                return true;
            }
            stuck_at_ = v.count;
            return false;
        }
        trial_ = plan_;
        trial_.insert(first + (last - first) * static_cast<std::int32_t>(cell_) /
                                  static_cast<std::int32_t>(bends));
        ++cell_;
        return valid(v, trial_) ? fit(v, plan_.size, soft_passes) : true;
    }

    // ---- removal: every knot in turn by a plain fit, then the two most promising with effort
    void start_drops() noexcept {
        first_ = plan_.settled >= 0 ? 1 : 0;
        stage_ = plan_.size > first_ ? Stage::drop : Stage::idle;
        cell_ = first_;
        tried_ = 0;
        age_ = 0;
    }

    bool propose_drop(const View& v) noexcept {
        if (cell_ >= plan_.size) {
            stage_ = Stage::drop_harder;
            return true;
        }
        trial_ = plan_;
        trial_.erase(cell_);
        return fit(v, loose(head_before(cell_, tail() - 1)), 0);
    }

    void dropped(bool ok) noexcept {
        score_[cell_++] = trial_.worst;
        if (ok) accept(trial_);
    }

    bool propose_hard_drop(const View& v) noexcept {
        std::size_t best = plan_.settled >= 0 ? 1 : 0;
        const bool any = best < plan_.size && best < cell_;
        for (std::size_t i = best + 1; i < plan_.size && i < cell_; ++i)
            if (score_[i] < score_[best]) best = i;
        if (!any || score_[best] > 6) {
            idle();
            return true;
        }
        trial_ = plan_;
        trial_.erase(best);
        score_[best] = 1e30f;
        knot_ = best;
        head_ = loose(head_before(best, tail() - 1));
        return fit(v, head_, hard_passes);
    }

    void hard_dropped(bool ok) noexcept {
        if (ok) return accept(trial_);
        if (trial_.size == 0) {
            if (++tried_ >= 2) idle();
            return;
        }
        start_moves(trial_, move_budget, Goal::removal);
    }

    // ---- polish: with time left, knots go where the fit (and the predicted future) is better
    bool start_polish() noexcept {
        if (polished_ == 0 && plan_.settled >= 0) polished_ = 1;
        if (polished_ >= plan_.size) return false;
        knot_ = polished_++;
        cell_ = 0;
        stage_ = Stage::polish;
        return true;
    }

    bool propose_polish(const View& v) noexcept {
        static constexpr std::int32_t by[] = {0, 8, -8, 2, -2};
        if (cell_ >= 5 || knot_ >= plan_.size || plan_.covers < v.count) {
            idle();
            return true;
        }
        trial_ = plan_;
        trial_.knot[knot_] += by[cell_];
        ++cell_;
        return valid(v, trial_) ? fit(v, loose(head_before(knot_, 2)), soft_passes) : true;
    }

    void polished(bool ok) noexcept {
        if (cell_ == 1) {
            merit_ = ok ? trial_.objective : 1e30f;
            if (ok) plan_ = trial_;
        } else if (ok && trial_.objective < merit_ * 0.999f) {
            merit_ = trial_.objective;
            plan_ = trial_;
        }
    }

    Fitter fitter_{};
    typename Fitter::Ahead ahead_{};  // as it was when the search began
    KnotPlan plan_{}, trial_{}, current_{}, best_{};
    std::array<float, MaxKnots> score_{};
    std::array<std::int32_t, MaxKnots> hint_{};
    std::array<float, D> mid_{};
    Stage stage_{Stage::idle};
    Goal goal_{Goal::insertion};
    std::size_t head_{0}, first_{0}, last_{0}, rounds_{0}, budget_{0}, scale_{0}, knot_{0},
        cell_{0};
    std::size_t places_{0}, tried_{0}, level_{0}, polished_{0}, hints_{0};
    std::size_t stuck_at_{0}, horizon_{0}, reach_{reach};
    std::uint32_t age_{0};
    float low_worst_{0}, cell_low_{0}, cell_high_{0}, merit_{0};
    float damping_{1};
    std::size_t sought_{0};
    bool fresh_{false}, seeking_{false}, found_{false}, refitted_{false};
    bool hurried_{false};  // what is not served will be due soon
    bool waits_{false};    // a few samples more before the plan is mended
    bool fitting_{false}, partial_{false}, doubted_{false}, flat_start_{true};
};

}  // namespace fairlead
