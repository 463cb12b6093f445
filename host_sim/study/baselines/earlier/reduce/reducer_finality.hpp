#pragma once
// What becomes final, and when: coverage, knots with their rounding, the start of a curve.
// Part of reduce/reducer.hpp.
#include "host_sim/study/baselines/earlier/reduce/reducer.hpp"

namespace fairlead::earlier {

template <class Channel, std::size_t N>
bool Reducer<Channel, N>::finalise(bool forced, std::uint32_t goal) noexcept {
    if (samples_.empty()) return false;
    // whatever the search says: no knot where the curve is final already
    if (active_ && search_.plan().size > 0 && search_.plan().knot[0] < first_knot_tick())
        search_.reset();
    const bool wanted = since(samples_.oldest().record) >= goal;
    // a plan that is unsettled or behind keeps half of the room that it has
    const bool steady = search_.steady(own_);
    if (!forced && !(wanted && steady)) return false;
    if (!active_) {
        if (pending() || (!forced && search_.plan().covers == 0)) return false;
        begin_curve(false);
        return true;
    }
    if (cover(steady ? goal : half_way(goal))) return true;
    if (search_.plan().size > 0 && !before_knot(0)) {
        if (out_.size == batch_knots) return false;
        if (!forced && since(samples_[0].record) < knot_age(goal)) return false;
        freeze();
        return true;
    }
    if (!forced || pending()) return false;
    break_curve();
    return true;
}

template <class Channel, std::size_t N>
std::uint32_t Reducer<Channel, N>::half_way(std::uint32_t goal) const noexcept {
    const std::size_t covers = search_.plan().covers;
    const std::uint32_t age = since(samples_[(covers < own_ ? covers : own_) / 2].record);
    return age > goal ? age : goal;
}

template <class Channel, std::size_t N>
void Reducer<Channel, N>::begin_curve(bool breaks) noexcept {
    const auto& plan = search_.plan();
    Polynomial<D, Order> start = frozen_;
    if (plan.covers > 0) start.c = plan.start;
    const std::size_t last = plan.covers > 0 ? plan.covers - 1 : 0;
    emit_start(start, plan.size ? static_cast<float>(plan.knot[0]) : samples_[last].u, breaks);
}

template <class Channel, std::size_t N>
void Reducer<Channel, N>::break_curve() noexcept {
    samples_[0].starts_curve = true;
    ++counters_.breaks;
    prepare_curve();
    search_.start_over(view(), credit_);
    begin_curve(true);
}

template <class Channel, std::size_t N>
void Reducer<Channel, N>::emit_start(const Polynomial<D, Order>& start, float reach,
                                     bool breaks) noexcept {
    note_pending();
    ++counters_.curves;
    const Polynomial<D, Order> constant = frozen_;
    out_.coarse = static_cast<std::uint8_t>(reach > 1 ? floor_log2(reach) + 1 : 0);
    round_start(start);
    if (!accepted(samples_[0])) {
        out_.coarse = 0;
        round_start(constant);
        // beyond the range of the coefficients, or with arithmetic other than IEEE 754, even a
        // constant through the sample misses it: the break takes it, so that the window drains
        unserved_ = !accepted(samples_[0]);
        if (unserved_) ++counters_.unserved;
    }
    active_ = true;
    samples_[0].starts_curve = false;
    out_.begins = true;
    out_.breaks = breaks;
    out_.start = curve_;
    search_.rounded();
    credit_ -= freeze_cost;
}

template <class Channel, std::size_t N>
void Reducer<Channel, N>::round_start(const Polynomial<D, Order>& start) noexcept {
    for (std::size_t m = 0; m < Order; ++m)
        for (std::size_t d = 0; d < D; ++d) {
            const int shift = start_shift(m, out_.coarse);
            const float places = power_of_two(fraction_bits(m) - shift);
            const std::int64_t step = std::int64_t{1} << shift;
            const std::int32_t kept = clamped_sum(to_integer(start.c[m][d] * places) * step, 0);
            curve_.span.c[m][d] = static_cast<std::int32_t>(kept / step * step);
        }
    frozen_ = Polynomial<D, Order>{curve_.span};
}

template <class Channel, std::size_t N>
bool Reducer<Channel, N>::before_knot(std::size_t i) const noexcept {
    const std::int64_t knot = search_.plan().knot[0];
    return samples_[i].t_ns - curve_.span.t0_ns < knot * static_cast<std::int64_t>(params_.tick_ns);
}

template <class Channel, std::size_t N>
bool Reducer<Channel, N>::accepted(const Waiting<Channel>& sample) const noexcept {
    // after so long a rest the curve starts anew: ticks are counted in 32 bits
    if (sample.t_ns - curve_.span.t0_ns >= std::int64_t{params_.tick_ns} << 30) return false;
    const float u = ticks_between(curve_.span.t0_ns, sample.t_ns, params_.tick_ns);
    return judge_.accepts(Channel::value(frozen_(u), scale_), sample.value);
}

template <class Channel, std::size_t N>
bool Reducer<Channel, N>::cover(std::uint32_t goal) noexcept {
    const auto& plan = search_.plan();
    const bool rests = resting();
    std::size_t k = 0;
    while (k < own_ && k < cover_max && (plan.size == 0 || before_knot(k)) &&
           ((k == 0 && unserved_) || accepted(samples_[k]))) {
        ++k;
        // only what is needed is made final: a later start of the next knot is open
        if (!rests && since(samples_[k - 1].record) <= goal) break;
    }
    credit_ -= accept_cost * static_cast<Credit>(k + 1);
    if (k == 0) return false;
    unserved_ = false;
    // the next tick after the last sample taken: samples stand at least a tick apart, so that
    // the next one is not before it, and a knot may stand on it
    const std::int64_t past = samples_[k - 1].t_ns - curve_.span.t0_ns;
    note_pending();
    out_.covers = true;
    out_.cover_ticks = cover_ticks_ = static_cast<std::uint32_t>(past / params_.tick_ns) + 1;
    samples_.pop(k);
    own_ -= k;
    search_.drop(k);
    if (own_ == 0 && !samples_.empty()) prepare_curve();
    return true;
}

template <class Channel, std::size_t N>
bool Reducer<Channel, N>::comes_to_rest(std::int32_t ticks) const noexcept {
    const auto at = carried(curve_.span, static_cast<std::uint32_t>(ticks), params_.tick_ns);
    for (std::size_t m = 1; m + 1 < Order; ++m)
        for (const std::int32_t c : at.c[m])
            if (c > rest_places || c < -rest_places) return false;
    return true;
}

template <class Channel, std::size_t N>
bool Reducer<Channel, N>::resting() const noexcept {
    for (std::size_t m = 1; m < Order; ++m)
        for (std::size_t d = 0; d < D; ++d)
            if (curve_.span.c[m][d] != 0) return false;
    return true;
}

template <class Channel, std::size_t N>
void Reducer<Channel, N>::freeze() noexcept {
    const auto& plan = search_.plan();
    const std::int32_t ticks = plan.knot[0];
    const bool lands = plan.landing > 0 && plan.size <= plan.landing;
    auto& knot = out_.knot[out_.size];
    knot.ticks = static_cast<std::uint32_t>(ticks);
    if (lands && plan.size == 1 && comes_to_rest(ticks)) {
        knot.shift = stop_shift;
        knot.jump = {};
        curve_.stop(knot.ticks, params_.tick_ns);
    } else {
        round_jump(knot, lands);
    }
    frozen_ = Polynomial<D, Order>{curve_.span};
    note_pending();
    out_.covers = false;
    ++out_.size;
    ++counters_.knots;
    cover_ticks_ = 0;
    shift_times(ticks);
    search_.froze(ticks);
    credit_ -= freeze_cost;
}

template <class Channel, std::size_t N>
void Reducer<Channel, N>::round_jump(typename Frozen::Knot& knot, bool lands) noexcept {
    const Curve<Channel> before = curve_;
    const auto& plan = search_.plan();
    const auto begin = static_cast<float>(plan.knot[0]);
    const float end = plan.size > 1 ? static_cast<float>(plan.knot[1]) : samples_[own_ - 1].u;
    const bool settled = lands || plan.settled >= 0, many = !settled && plan.size > Order;
    const int coarse = settled ? (lands ? 0 : plan.settled)
                               : jump_shift<Order>((many ? end : planned_end(end)) - begin);
    const auto sent = Channel::to_wire(plan.jump[0], frozen_(begin));
    for (std::size_t finer = 0;; ++finer) {
        const int left = finer < finer_places.size() ? coarse - finer_places[finer] : 0;
        const int shift = left > 0 ? left : 0;
        curve_ = before;
        const float places = power_of_two(fraction_bits(Order - 1) - shift);
        for (std::size_t d = 0; d < D; ++d) knot.jump[d] = to_integer(sent[d] * places);
        knot.shift = static_cast<std::uint8_t>(shift);
        curve_.advance(knot.ticks, knot.jump, knot.shift, params_.tick_ns);
        credit_ -= rounding_cost;
        if (settled) return;
        const Polynomial<D, Order> p{curve_.span};
        typename KnotPlan::Absorption taken_up{};
        if (many) {
            std::array<float, D> change;
            for (std::size_t d = 0; d < D; ++d)
                change[d] = p.c[Order - 1][d] - frozen_.c[Order - 1][d] - plan.jump[0][d];
            taken_up = plan.absorption(change);
        }
        if (shift == 0 || serves(p, taken_up, many ? Order : 1)) {
            if (many) search_.absorb(taken_up);
            return;
        }
    }
}

template <class Channel, std::size_t N>
float Reducer<Channel, N>::planned_end(float at_least) const noexcept {
    const std::size_t covers = search_.plan().covers;
    const std::size_t n = covers < own_ ? covers : own_;
    const float end = n > 0 ? samples_[n - 1].u : 0;
    return end > at_least ? end : at_least;
}

template <class Channel, std::size_t N>
bool Reducer<Channel, N>::serves(Polynomial<D, Order> p,
                                 const typename KnotPlan::Absorption& changes,
                                 std::size_t intervals) noexcept {
    const auto& plan = search_.plan();
    auto origin = static_cast<float>(plan.knot[0]);
    std::size_t knot = 1;
    std::size_t n = plan.covers < own_ ? plan.covers : own_;
    if (intervals < plan.size)
        n = samples_until(samples_, n, static_cast<float>(plan.knot[intervals]));
    // where they are many, some of them
    const std::size_t stride = n / rounding_max + 1;
    for (std::size_t i = 0; i < n; i += stride) {
        const auto& sample = samples_[i];
        for (; knot < plan.size && static_cast<float>(plan.knot[knot]) < sample.u; ++knot) {
            const auto at = static_cast<float>(plan.knot[knot]);
            p = p.shifted(at - origin);
            origin = at;
            for (std::size_t d = 0; d < D; ++d)
                p.c[Order - 1][d] += plan.jump[knot][d] + changes[knot - 1][d];
        }
        credit_ -= Knots::Fitter::test_cost;
        for (const float e : judge_.errors(p(sample.u - origin), sample.value))
            if (e > Knots::kept) return false;
    }
    return true;
}

}  // namespace fairlead::earlier
