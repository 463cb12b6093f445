#pragma once
// How a fit is judged: the errors of its polynomials, and which part of it is weighted anew.
// Part of reduce/fit.hpp.
#include "host_sim/study/baselines/earlier/reduce/fit.hpp"

namespace fairlead::earlier {

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Fit<Channel, N, MaxKnots, Horizons>::start_check(KnotPlan& plan) noexcept {
    plan.worst = 0;
    plan.worst_at = first_;
    plan.covers = count_;
    plan.objective = 0;
    squares_ = 0;
    missed_ = 0;
    part_ = 0;
    if constexpr (parts == 1) return start_part();
    walk_ = base_;
    cursor_ = first_;
    phase_ = Phase::check;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Fit<Channel, N, MaxKnots, Horizons>::check(const Problem& problem, KnotPlan& plan,
                                                Credit& credit) noexcept {
    float squares = squares_, worst = plan.worst > limit_ ? plan.worst : limit_;
    std::size_t i = cursor_;
    Credit left = credit;
    while (i < count_ && left > 0) {  // interval by interval
        auto* sample = &problem.samples[i];
        walk_.to(sample->u, plan);
        const Polynomial<D, Order> p = walk_.p;
        const float origin = walk_.origin, end = walk_.end(plan);
        if (!p.representable()) miss(plan, i, (1u << parts) - 1, worst, unrepresentable);
        for (; i < count_ && left > 0; ++i, sample = problem.samples.after(sample)) {
            if (sample->u > end) break;
            const auto e = problem.judge.errors(p(sample->u - origin), sample->value);
            float most = 0;
            each<parts>([&](std::size_t k) FAIRLEAD_INLINE {
                squares += e[k] * e[k];
                most = e[k] > most ? e[k] : most;
            });
            left -= test_cost;
            if (most <= limit_) continue;
            unsigned which = 0;
            each<parts>([&](std::size_t k)
                            FAIRLEAD_INLINE { which |= e[k] <= limit_ ? 0u : 1u << k; });
            miss(plan, i, which, worst, most);
        }
        left -= interval_cost;
    }
    credit = left;
    squares_ = squares;
    plan.worst = worst;
    cursor_ = i;
    if (cursor_ < count_) return;
    plan.objective = squares_ + misfit(problem);
    credit -= test_cost * static_cast<Credit>(problem.ahead.size);
    if (missed_ != 0 && passes_ > 0 && plan.worst <= hopeless) {
        lone_ = true;
        plan.worst = limit_;
        plan.covers = count_;
        return next_part();
    }
    succeeded_ = missed_ == 0;
    phase_ = Phase::done;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Fit<Channel, N, MaxKnots, Horizons>::miss(KnotPlan& plan, std::size_t i, unsigned which,
                                               float& worst, float e) noexcept {
    missed_ |= which;
    plan.covers = i < plan.covers ? i : plan.covers;
    if (e <= worst) return;
    worst = e;
    plan.worst_at = i;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Fit<Channel, N, MaxKnots, Horizons>::check_part(const Problem& problem, KnotPlan& plan,
                                                     Credit& credit) noexcept {
    Tally tally = tally_;
    float worst = worst_;
    std::size_t i = cursor_, worst_at = worst_at_;
    const std::size_t at = part_ * Width;
    const bool even = pass_ == 0;
    Credit left = credit;
    while (i < count_ && left > 0) {  // interval by interval
        auto* sample = &problem.samples[i];
        walk_.to(sample->u, plan);
        const auto p = walk_.p.template components<Width>(at);
        const float origin = walk_.origin, end = walk_.end(plan);
        if (!p.representable()) {
            covers_ = i < covers_ ? i : covers_;
            worst = worst > unrepresentable ? worst : unrepresentable;
        }
        for (; i < count_ && left > 0; ++i, sample = problem.samples.after(sample)) {
            if (sample->u > end) break;
            const float e = problem.judge.error(part_, p(sample->u - origin), sample->value);
            const float we = even ? e : sample->weight * e;
            sample->error = e;
            tally.leaning += we;
            tally.weighted += we * e;
            left -= part_cost;
            if (e <= worst) continue;
            worst = e;
            worst_at = i;
            if (!(e <= limit_) && covers_ == count_) covers_ = i;
        }
        left -= interval_cost;
    }
    credit = left;
    worst_ = worst;
    worst_at_ = worst_at;
    tally_ = tally;
    cursor_ = i;
    if (cursor_ < count_) return;
    if (parts == 1 && pass_ == 0) {
        plan.objective = tally_.weighted + misfit(problem);
        credit -= test_cost * static_cast<Credit>(problem.ahead.size);
    }
    decide(problem, plan);
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Fit<Channel, N, MaxKnots, Horizons>::decide(const Problem& problem, KnotPlan& plan) noexcept {
    const bool served = covers_ == count_;
    best_ = worst_ < best_ ? worst_ : best_;
    const float n = static_cast<float>(count_ - first_);
    // the weighted mean square is a lower bound of the squared minimax error
    const bool over = served || pass_ >= passes_ || worst_ > hopeless ||
                      (pass_ >= 2 && tally_.weighted > n * limit_ * limit_) ||
                      (pass_ >= 3 && best_ > 1 + 2.0f / static_cast<float>(pass_));
    if (over) return judged(problem, plan, served);
    ++pass_;
    future_ *= 0.3f;
    lean_ = 1 / worst_;
    scale_ = n / (0.02f * n + tally_.leaning * lean_);
    start_pass();
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Fit<Channel, N, MaxKnots, Horizons>::judged(const Problem& problem, KnotPlan& plan,
                                                 bool served) noexcept {
    const float worst = served ? worst_ : best_;
    if (!(worst <= plan.worst)) {
        plan.worst = worst;
        plan.worst_at = worst_at_;
    }
    plan.covers = covers_ < plan.covers ? covers_ : plan.covers;
    if (!served) {
        if (plan.covers <= problem.wanted && passes_ > 0) missed_ = 0;
        passes_ = 0;  // it fails, but how far does it serve?
    }
    missed_ &= ~(1u << part_);
    if (missed_ != 0) return next_part();
    succeeded_ = plan.covers == count_;
    phase_ = Phase::done;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Fit<Channel, N, MaxKnots, Horizons>::next_part() noexcept {
    part_ = 0;
    while (part_ + 1 < parts && (missed_ >> part_ & 1u) == 0) ++part_;
    pass_ = 0;
    scale_ = 0;
    future_ = 1;
    start_part();
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
float Fit<Channel, N, MaxKnots, Horizons>::misfit(const Problem& problem) const noexcept {
    float sum = 0;
    for (std::size_t i = 0; i < problem.ahead.size; ++i) {
        const Vector y = walk_.p(problem.ahead.u[i] - walk_.origin);
        for (std::size_t d = 0; d < D; ++d) {
            const float e = (problem.ahead.x[i][d] - y[d]) * problem.judge.per_limit[d];
            sum += problem.ahead.weight[i] * e * e;
        }
    }
    return sum;
}

}  // namespace fairlead::earlier
