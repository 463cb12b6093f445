#pragma once
// The search for few knots: a resumable state machine that proposes plans and judges their fits.
//
// A plan covers the look-ahead. While new samples fit it, knots are dropped on trial and moved to
// better places; when some do not, the same knots are fitted anew, else a knot is inserted, else
// knots are moved, too, else the end is bent. Changes are local: what stands well before them stays
// as it is, which keeps fits short and a tight plan feasible. The plan is advice: what is emitted
// is checked on its own (reduce/reducer.hpp), so that stopping anywhere is safe and more work per
// sample only means fewer knots. This file holds the machine; its stages are in search_*.hpp.
#include <cstddef>
#include <cstdint>

#include "host_sim/study/baselines/earlier/reduce/fit.hpp"
#include "host_sim/study/baselines/earlier/reduce/land.hpp"

namespace fairlead::earlier {

/// Places by which a jump is rounded when its first interval is `length` ticks.
template <std::size_t Order>
int jump_shift(float length) noexcept {
    float power = 1;
    for (std::size_t m = 1; m < Order; ++m) power *= length > 1 ? length : 1;
    const int shift = fraction_bits(Order - 1) - rounding_places - floor_log2(power);
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
        return !doubted_ && stage_ != Stage::verify && stage_ != Stage::refit &&
               plan_.covers + 5 * reach >= count;
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
            hurried_ = partial_ && plan_.covers < close_by;
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
        const typename Fitter::Problem problem{v.samples, v.count, ahead_,  v.frozen,
                                               v.judge,   v.free,  v.wanted};
        fitter_.run(problem, trial_, credit);
        if (!fitter_.busy()) conclude(v, fitter_.succeeded());
        return true;
    }

    /// What carrying a state over a knot may cost: half a last place of every component.
    static constexpr float carrying =
        power_of_two(-1 - fraction_bits(0)) * (Channel::Judge::parts < D ? 2 : 1);
    static constexpr float limit = 1 - 2 * carrying;  // planning keeps below the tolerance,
    static constexpr float kept = 1 - carrying;       // and rounding a jump may use up half of it
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
    static constexpr std::size_t grid = 12;          // places that an insertion tries,
    static constexpr std::size_t few_places = 4;     // where the plan must catch up,
    static constexpr std::size_t fewest_places = 3;  // and where that is urgent
    static constexpr std::size_t finalists = 3;      // of which it tries with effort
    static constexpr std::size_t move_budget = 16;   // moves tried before a knot is given up
    static constexpr std::size_t bends = 5;          // places that a bend of the end tries
    static constexpr float hopeless = 3;             // errors beyond: moving knots will not do
    static constexpr std::uint32_t drop_period = 4;  // samples between two rounds of removal
    static constexpr std::size_t catch_up_max = 16;  // samples tested at once
    static constexpr std::size_t close_by = 24;      // samples before which a plan hurries
    static constexpr std::size_t patience = 5;       // samples that a plan may lack for a while
    static constexpr std::size_t reach = 8;          // samples that a plan behind looks further,
    static constexpr std::size_t step_near = 4;      // where it hurries
    static constexpr std::size_t start_max = 12;     // samples of a curve that must start at once

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
            case Stage::renew:
            default: break;
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
            case Stage::repair: return ok ? accept(trial_) : start_insertion(v, trial_);
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
            case Stage::idle:
            default: return;
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
            fitter_.start_test(v, kept, trial_);
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
        if (plan_.size > 0 && plan_.size <= Order && plan_.settled < 0 &&
            static_cast<float>(plan_.knot[0]) < v.soon) {
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
    bool propose_settling(const View& v) noexcept;
    /// A head that leaves a settled knot as it is.
    std::size_t loose(std::size_t head) const noexcept {
        return head == 0 && plan_.settled >= 0 ? 1 : head;
    }
    void verified() noexcept;
    /// The rounding of a knot was a little too much: the others make up for it, all at once.
    bool propose_refit(const View& v) noexcept;
    // ---- how far to look
    /// Counts on over the samples that the plan serves as it stands.
    void catch_up(const View& v) noexcept;
    /// A plan that has fallen behind the window catches up piece by piece; the knots that it had
    /// further on wait as hints.
    void set_horizon(const View& v) noexcept;
    /// Keeps a knot as a hint, the earliest last.
    void put_off(std::int32_t at) noexcept {
        if (hints_ < MaxKnots) hint_[hints_++] = at;
    }
    bool valid(const View& v, const KnotPlan& p) const noexcept;
    /// The first tick at which a knot may stand.
    static std::int32_t first_place(const View& v) noexcept {
        return v.free || v.low < 1 ? 1 : v.low;
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
    void give_up() noexcept;
    /// Free knots before a change: fewer where the plan must catch up.
    std::size_t tail() const noexcept { return partial_ ? 3 : 4; }

    // ---- repair: a sample is not served
    void start_repair(const View& v) noexcept;
    /// No single knot is enough: moves those around the worst error, too.
    void move_all(const View& v) noexcept;
    // ---- insertion: one more knot on a coarse grid around the worst error
    void start_insertion(const View& v, const KnotPlan& from) noexcept;
    bool propose_insertion(const View& v) noexcept;
    bool insert_at(const View& v, std::size_t cell, std::size_t passes) noexcept;
    void inserted(bool ok) noexcept;
    // ---- the last resort: leave the plan as it is and bend only its end, as early as that serves
    bool propose_append(const View& v) noexcept;

    // ---- landing: while the newest samples are at rest, end the plan on a constant
    bool start_landing(const View& v, Credit& credit) noexcept;
    /// So many samples without motion are a rest.
    static std::size_t quiet(std::uint32_t delay) noexcept {
        const std::size_t most = delay * 3 / 4 < 60 ? delay * 3 / 4 : 60;
        return delay / 2 > most ? delay / 2 : most;
    }
    /// Are the newest n samples, and enough of them, at rest?
    bool rests(const View& v, std::size_t n, Credit& credit) noexcept;
    bool propose_landing(const View& v, Credit& credit) noexcept;
    void landed(bool ok) noexcept;

    // ---- moves: all free knots at once, by damped steps of Gauss and Newton
    void start_moves(const KnotPlan& from, std::size_t budget, Goal goal) noexcept;
    bool propose_move(const View& v) noexcept;
    /// Has the fitter look for better places of the trial's knots.
    bool seek(const View& v, std::size_t head) noexcept;
    /// Moves the trial's knots to where they want to be. @return whether any moves.
    bool shift_knots(const View& v) noexcept;
    void moved(bool ok) noexcept;
    void moves_failed(const View& v) noexcept;
    // ---- removal: every knot in turn by a plain fit, then the two most promising with effort
    void start_drops() noexcept;
    bool propose_drop(const View& v) noexcept;
    void dropped(bool ok) noexcept;
    bool propose_hard_drop(const View& v) noexcept;
    void hard_dropped(bool ok) noexcept;
    // ---- polish: with time left, knots go where the fit (and the predicted future) is better
    bool start_polish() noexcept;
    bool propose_polish(const View& v) noexcept;
    void polished(bool ok) noexcept;

    Fitter fitter_{};
    typename Fitter::Ahead ahead_{};  // as it was when the search began
    KnotPlan plan_{}, trial_{}, current_{}, best_{};
    std::array<float, MaxKnots> score_{};
    std::array<std::int32_t, MaxKnots> hint_{};
    std::array<float, D> mid_{};
    Stage stage_{Stage::idle};
    Goal goal_{Goal::insertion};
    std::size_t head_{0}, first_{0}, budget_{0}, knot_{0}, cell_{0};
    std::size_t places_{0}, tried_{0}, level_{0}, polished_{0}, hints_{0}, sought_{0};
    std::size_t stuck_at_{0}, horizon_{0}, reach_{reach};
    std::uint32_t age_{0};
    float low_worst_{0}, cell_low_{0}, cell_high_{0}, merit_{0}, damping_{1};
    bool fresh_{false}, seeking_{false}, found_{false}, refitted_{false};
    bool hurried_{false};  // what is not served will be due soon
    bool waits_{false};    // a few samples more before the plan is mended
    bool fitting_{false}, partial_{false}, doubted_{false}, flat_start_{true};
};

}  // namespace fairlead::earlier

#include "host_sim/study/baselines/earlier/reduce/search_horizon.hpp"
#include "host_sim/study/baselines/earlier/reduce/search_removal.hpp"
#include "host_sim/study/baselines/earlier/reduce/search_repair.hpp"
#include "host_sim/study/baselines/earlier/reduce/search_rest.hpp"
