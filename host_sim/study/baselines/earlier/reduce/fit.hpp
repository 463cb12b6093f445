#pragma once
// Fits a plan's jumps to the samples, reweighted towards the largest error, in small portions.
//
// The knots of a plan's head stay as they are; beyond, the curve is a C^(Order - 2) continuation
// (reduce/spline_system.hpp). Errors are those of the polynomials that would be frozen, at every
// sample. Weights after Lawson: multiplied by the error, so that the fit leans towards the smallest
// largest error. What is judged apart is weighted apart: a vector is fitted as a whole first, then
// those of its components that miss their tolerance, one by one. A fit may be left after any sample
// and any row; what it has used up is counted in instructions of a Cortex-M4F, about. RAM: sizeof;
// no loop runs further than window and knots.
#include <array>
#include <cstddef>
#include <cstdint>

#include "host_sim/study/baselines/earlier/reduce/plan.hpp"
#include "host_sim/study/baselines/earlier/reduce/spline_system.hpp"
#include "host_sim/study/baselines/earlier/reduce/window.hpp"

namespace fairlead::earlier {

/// Work that may still be done in this push, in instructions of a Cortex-M4F, about.
using Credit = std::int32_t;

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
class Fit {
  public:
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    using Samples = Window<Channel, N>;
    using KnotPlan = Plan<Channel, MaxKnots>;
    using Walk = PlanWalk<Channel, MaxKnots>;
    using Ahead = Future<Channel, Horizons>;
    using Vector = std::array<float, D>;
    // what is judged on its own: every component, or all together
    static constexpr std::size_t parts = Channel::Judge::parts, Width = D / parts;

    struct Problem {
        Samples& samples;   // weights and errors are noted there
        std::size_t count;  // samples to serve, from the front
        const Ahead& ahead;
        const Polynomial<D, Order>& frozen;
        const typename Channel::Judge& judge;
        bool free;           // nothing is frozen yet: the fit may leave `frozen` from u = 0 on
        std::size_t wanted;  // a plan that fails is of use if it serves more samples than these
    };

    bool busy() const noexcept { return phase_ != Phase::done; }
    /// Is every sample within the limit?
    bool succeeded() const noexcept { return succeeded_; }
    void cancel() noexcept { phase_ = Phase::done; }

    /// Begins to fit the jumps of the knots after the first `head`, which stay as they are; fills
    /// the rest of the plan. The samples that the head serves are taken as served.
    void start(const Problem& problem, std::size_t head, std::size_t passes, float limit,
               KnotPlan& plan) noexcept {
        plan.landing = 0;
        if (head == 0) plan.settled = -1;
        open(problem, head, passes, limit, plan);
        if (leaves_ && plan.size == head) {
            passes_ = 0;
            return start_check(plan);
        }
        lay_knots(problem, plan, leaves_ ? Order - 1 : 0);
        start_pass();
    }

    /// Begins to test a plan as it stands.
    void start_test(const Problem& problem, float limit, KnotPlan& plan) noexcept {
        open(problem, 0, 0, limit, plan);
        if (problem.free) base_.p.c = plan.start;
        start_check(plan);
    }

    /// Begins to look for better places of the knots after the first `head`, at most shifts_max: a
    /// plain fit in which each of them is double, so that the curve may bend there, too.
    void start_shifts(const Problem& problem, std::size_t head, KnotPlan& plan) noexcept {
        open(problem, head, 0, 1, plan);
        doubled_ = true;
        lay_knots(problem, plan, leaves_ ? Order - 2 : 0);
        start_pass();
    }
    static constexpr std::size_t shifts_max = MaxKnots / 2;
    /// Then: by how much knot i should move, by the step of Gauss and Newton.
    float shift(std::size_t i) const noexcept { return shift_[i]; }

    /// Goes on with what was begun, until it is done or the credit is used up.
    void run(const Problem& problem, KnotPlan& plan, Credit& credit) noexcept {
        while (busy() && credit > 0) {
            switch (phase_) {
                case Phase::assemble: assemble(problem, credit); break;
                case Phase::factor: factor(credit); break;
                case Phase::substitute: substitute(problem, plan, credit); break;
                case Phase::check: check(problem, plan, credit); break;
                case Phase::check_part: check_part(problem, plan, credit); break;
                case Phase::done:
                default: break;
            }
        }
    }

    /// The first n samples left the window.
    void drop(std::size_t n) noexcept {
        for (std::size_t* i : {&count_, &first_, &begin_, &cursor_, &covers_, &worst_at_})
            *i -= n < *i ? n : *i;
        if (count_ == 0) cancel();
    }

    // what a portion costs, in instructions of a Cortex-M4F, about
    static constexpr Credit visit_cost = 40 + 11 * D, lone_visit_cost = 52 + 11 * Width,
                            test_cost = 26 + 18 * D, part_cost = 30 + 18 * Width,
                            span_cost = 850 + 75 * D, interval_cost = 60 + 70 * D,
                            factor_cost = 60 + 22 * D, substitute_cost = 50 + 15 * D,
                            jump_cost = 100 + 20 * D, pass_cost = 60 + 40 * D,
                            start_cost = 1100 + 100 * D;

  private:
    static constexpr float unrepresentable = 10;  // stands for the error of such a polynomial
    static constexpr float hopeless = 3;          // reweighting will not mend such an error
    enum class Phase : std::uint8_t { done, assemble, factor, substitute, check, check_part };
    using System = SplineSystem<D, Order, MaxKnots>;

    void open(const Problem& problem, std::size_t head, std::size_t passes, float limit,
              const KnotPlan& plan) noexcept {
        leaves_ = !(problem.free && head == 0);
        head_ = head;
        passes_ = passes;
        limit_ = limit;
        count_ = problem.count;
        pass_ = 0;
        succeeded_ = lone_ = doubled_ = false;
        scale_ = 0;
        future_ = 1;
        base_ = Walk{problem.frozen, problem.free && head > 0, plan};
        for (std::size_t q = 0; q < head; ++q) base_.pass_knot(plan);
        first_ = head > 0 ? samples_until(problem.samples, count_, base_.origin) : 0;
    }

    // ---- the system
    void lay_knots(const Problem& problem, const KnotPlan& plan, std::size_t fixed) noexcept {
        // the first knot of a continued curve is the boundary
        const float begin = leaves_ ? static_cast<float>(plan.knot[head_]) : 0.0f;
        // ahead of the samples the last polynomial goes on: basis functions made for the samples'
        // range keep the system well conditioned in float
        const float last = problem.samples[count_ - 1].u;
        system_.open(begin, fixed, problem.frozen.c[0]);
        for (std::size_t q = head_ + (leaves_ ? 1 : 0); q < plan.size; ++q)
            for (int times = doubled_ ? 2 : 1; times > 0; --times)
                system_.add_knot(static_cast<float>(plan.knot[q]));
        system_.close((last > begin ? last : begin) + 2);
        begin_ = leaves_ ? samples_until(problem.samples, count_, begin) : first_;
        if (!leaves_) return;
        const auto at = base_.p.shifted(begin - base_.origin);
        system_.give(at);
        before_ = at.c[doubled_ ? Order - 2 : Order - 1];
    }

    void start_pass() noexcept {
        system_.clear();
        span_ = System::first_span;
        cursor_ = begin_;
        phase_ = Phase::assemble;
    }

    /// The components that are being solved for are Width from here, or all.
    std::size_t from() const noexcept { return lone_ ? part_ * Width : 0; }

    void assemble(const Problem& problem, Credit& credit) noexcept {
        if constexpr (parts > 1)
            if (lone_) return assemble<Width>(problem, credit, lone_visit_cost);
        assemble<D>(problem, credit, visit_cost);
    }

    template <std::size_t W>
    void assemble(const Problem& problem, Credit& credit, Credit visit) noexcept {
        const std::size_t last = system_.last_span(), at = W == D ? 0 : from();
        std::array<float, W> anchor;
        each<W>([&](std::size_t d) FAIRLEAD_INLINE { anchor[d] = system_.anchor()[at + d]; });
        const bool even = pass_ == 0, again = pass_ > 1;
        const float scale = scale_, lean = lean_;
        while (credit > 0) {
            const auto b = system_.basis(span_);
            typename System::template Moments<W> sums;
            const float end = system_.span_end(span_);
            std::size_t i = cursor_;
            Credit left = credit;
            auto* sample = i < count_ ? &problem.samples[i] : nullptr;
            for (; i < count_ && left > 0; ++i, sample = problem.samples.after(sample)) {
                if (sample->u >= end) break;
                float weight = 1;
                if (!even) {
                    weight = scale * (0.02f + sample->error * lean);
                    if (again) weight *= sample->weight;
                    sample->weight = weight;
                }
                std::array<float, W> x = problem.judge.template coordinates<W>(sample->value, at);
                each<W>([&](std::size_t d) FAIRLEAD_INLINE { x[d] -= anchor[d]; });
                sums.add(b, sample->u, weight, x);
                left -= visit;
            }
            cursor_ = i;
            credit = left - span_cost;
            const bool over = cursor_ == count_ && span_ == last;
            if (over) look_ahead<W>(problem, b, sums);
            system_.template gather<W>(sums, b, span_, at);
            if (over) {
                credit -= visit * static_cast<Credit>(problem.ahead.size);
                system_.start_factor();
                cursor_ = 0;
                phase_ = Phase::factor;
                return;
            }
            if (cursor_ == count_ || problem.samples[cursor_].u >= end) ++span_;
        }
    }

    template <std::size_t W>
    void look_ahead(const Problem& problem, const typename System::Basis& b,
                    typename System::template Moments<W>& sums) const noexcept {
        const std::size_t at = W == D ? 0 : from();
        for (std::size_t i = 0; i < problem.ahead.size; ++i) {
            const float w = problem.ahead.weight[i] * future_;
            std::array<float, W> x;
            for (std::size_t d = 0; d < W; ++d)
                x[d] = problem.ahead.x[i][at + d] - system_.anchor()[at + d];
            sums.add(b, problem.ahead.u[i], w > 1e-6f ? w : 1e-6f, x);
        }
    }

    void factor(Credit& credit) noexcept {
        const std::size_t rows = system_.rows(), at = from();
        for (; cursor_ < rows && credit > 0; ++cursor_) {
            if (lone_)
                system_.template factor<Width>(cursor_, at);
            else
                system_.template factor<D>(cursor_, 0);
            credit -= factor_cost;
        }
        if (cursor_ == rows) phase_ = Phase::substitute;
    }

    void substitute(const Problem& problem, KnotPlan& plan, Credit& credit) noexcept {
        const std::size_t at = from();
        for (; cursor_ > 0 && credit > 0; --cursor_) {
            if (lone_)
                system_.template substitute<Width>(cursor_ - 1, at);
            else
                system_.template substitute<D>(cursor_ - 1, 0);
            credit -= substitute_cost;
        }
        if (cursor_ > 0) return;
        credit -= jump_cost * static_cast<Credit>(system_.rows());
        if (doubled_) {
            to_shifts(problem, plan);
            phase_ = Phase::done;
        } else if (lone_) {
            to_jumps<Width>(plan);
            start_part();
        } else {
            to_jumps<D>(plan);
            start_check(plan);
        }
    }

    /// Control points -> jumps of the highest coefficient (and the free start), by differencing.
    template <std::size_t W>
    void to_jumps(KnotPlan& plan) noexcept {
        const std::size_t at = W == D ? 0 : from();
        const auto start = [&](std::size_t k, float per) {
            const Vector& c = system_.point(k);
            for (std::size_t d = at; d < at + W; ++d)
                plan.start[k][d] = c[d] * per + (k == 0 ? system_.anchor()[d] : 0);
        };
        if (!leaves_) start(0, 1);
        float factorial = 1;
        for (std::size_t k = 1; k < Order; ++k) {
            system_.template differentiate<W>(k, at);
            factorial *= static_cast<float>(k);
            if (!leaves_) start(k, 1 / factorial);
        }
        if (!leaves_) base_.p.c = plan.start;
        const float per = 1 / factorial;
        std::size_t j = leaves_ ? Order - 1 : Order;
        for (std::size_t q = head_; q < plan.size; ++q, ++j) {
            const Vector &c = system_.point(j), &b = system_.point(j - 1);
            const bool first = j == Order - 1;
            for (std::size_t d = at; d < at + W; ++d)
                plan.jump[q][d] = c[d] * per - (first ? before_[d] : b[d] * per);
        }
    }

    /// Where the curve wants to bend at a knot, it should be moved: J (u - t - s)^n, less
    /// J (u - t)^n, is -n s J (u - t)^(n - 1) to first order.
    void to_shifts(const Problem& problem, const KnotPlan& plan) noexcept {
        float factorial = 1;
        for (std::size_t k = 1; k + 1 < Order; ++k) {
            system_.template differentiate<D>(k, 0);
            factorial *= static_cast<float>(k);
        }
        const float per = 1 / factorial;
        std::size_t j = leaves_ ? Order - 2 : Order;
        for (std::size_t q = head_; q < plan.size; ++q, j += 2) {
            const Vector &c = system_.point(j), &b = system_.point(j - 1);
            const bool first = j == Order - 2;
            float bend = 0, jump = 1e-12f;
            for (std::size_t d = 0; d < D; ++d) {
                const float p = problem.judge.per_limit[d] * problem.judge.per_limit[d];
                const float a = c[d] * per - (first ? before_[d] : b[d] * per);
                bend += p * a * plan.jump[q][d];
                jump += p * plan.jump[q][d] * plan.jump[q][d];
            }
            shift_[q] = -bend / (static_cast<float>(Order - 1) * jump);
        }
    }

    // ---- its errors: the very polynomials that would be frozen, over the samples beyond the head
    void start_check(KnotPlan& plan) noexcept;
    /// All parts at once: which of them miss the limit?
    void check(const Problem& problem, KnotPlan& plan, Credit& credit) noexcept;
    /// Sample i is not served.
    void miss(KnotPlan& plan, std::size_t i, unsigned which, float& worst, float e) noexcept;
    /// Sums over the tested samples of one part: w e, w e^2.
    struct Tally {
        float leaning{0}, weighted{0};
    };

    void start_part() noexcept {
        walk_ = base_;
        if (pass_ == 0) best_ = 1e30f;
        worst_ = 0;
        worst_at_ = first_;
        covers_ = count_;
        tally_ = {};
        cursor_ = first_;
        phase_ = Phase::check_part;
    }
    void check_part(const Problem& problem, KnotPlan& plan, Credit& credit) noexcept;
    /// Another pass over this part?
    void decide(const Problem& problem, KnotPlan& plan) noexcept;
    /// On to the next part, unless it is plain that the plan is of no use.
    void judged(const Problem& problem, KnotPlan& plan, bool served) noexcept;
    void next_part() noexcept;
    /// How far the last polynomial passes the future.
    float misfit(const Problem& problem) const noexcept;

    System system_{};
    std::array<float, MaxKnots> shift_{};
    Vector before_{};
    Walk base_{}, walk_{};
    float limit_{0}, future_{1}, lean_{0}, scale_{0}, best_{0}, worst_{0}, squares_{0};
    Tally tally_{};
    std::size_t count_{0}, first_{0}, begin_{0}, cursor_{0}, head_{0}, span_{0}, passes_{0},
        pass_{0};
    std::size_t part_{0}, worst_at_{0}, covers_{0};
    unsigned missed_{0};  // a bit a part
    Phase phase_{Phase::done};
    bool succeeded_{false};
    bool leaves_{false};   // the spline leaves a given polynomial
    bool doubled_{false};  // every knot is double
    bool lone_{false};     // only one part is being solved for
};

}  // namespace fairlead::earlier

#include "host_sim/study/baselines/earlier/reduce/fit_judging.hpp"
