#pragma once
// How far a plan is to look, and what becomes of it when its first knot is rounded.
// Stages of the search: reduce/search.hpp.
#include "host_sim/study/baselines/earlier/reduce/search.hpp"

namespace fairlead::earlier {

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::propose_settling(const View& v) noexcept {
    if (cell_ >= finer_places.size() || plan_.size == 0) {
        idle();
        return true;
    }
    trial_ = plan_;
    const float until =
        plan_.size > 1 ? static_cast<float>(plan_.knot[1]) : v.samples[v.count - 1].u;
    const int coarse =
        jump_shift<Order>(until - static_cast<float>(plan_.knot[0])) - finer_places[cell_];
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

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::verified() noexcept {
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

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::propose_refit(const View& v) noexcept {
    if (cell_++ > 0) {
        idle();
        return true;
    }
    trial_ = plan_;
    return fit(v, loose(0), hard_passes);
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::catch_up(const View& v) noexcept {
    Walk walk{v.frozen, v.free, plan_};
    for (std::size_t i = 0; i < catch_up_max && plan_.covers < v.count; ++i) {
        const auto& sample = v.samples[plan_.covers];
        const auto y = walk.at(sample.u, plan_);
        for (const float e : v.judge.errors(y, sample.value))
            if (!(e <= limit)) return;
        ++plan_.covers;
    }
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::set_horizon(const View& v) noexcept {
    if (plan_.covers > v.count) plan_.covers = v.count;
    catch_up(v);
    const std::size_t most = plan_.covers < close_by ? step_near : reach;
    horizon_ = plan_.covers + (reach_ < most ? reach_ : most);
    if (horizon_ > v.count) horizon_ = v.count;
    const std::size_t behind = v.count - plan_.covers;
    const bool full = plan_.size + 2 > MaxKnots;
    if ((behind < patience || full) && plan_.covers > close_by && plan_.landing == 0) {
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
            at >= first_place(v) &&
            (plan_.covers == 0 || static_cast<float>(at) >= v.samples[plan_.covers - 1].u);
        if (fits && later && plan_.size < MaxKnots) plan_.insert(at);
    }
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::valid(const View& v,
                                                   const KnotPlan& p) const noexcept {
    const std::int32_t first = first_place(v);
    for (std::size_t i = 0; i < p.size; ++i) {
        if (p.knot[i] < (i ? p.knot[i - 1] + 1 : first)) return false;
        if (static_cast<float>(p.knot[i]) >= v.samples[v.count - 1].u) return false;
    }
    return true;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::give_up() noexcept {
    idle();
    if (partial_ && reach_ > 1) {
        reach_ /= 2;  // look less far first
        return;
    }
    stage_ = Stage::append;
    cell_ = 0;
}

}  // namespace fairlead::earlier
