#pragma once
// A plan that misses a sample: a fit with the same knots, one knot more, or a bend at its end.
// Stages of the search: reduce/search.hpp.
#include "host_sim/study/baselines/earlier/reduce/search.hpp"

namespace fairlead::earlier {

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::start_repair(const View& v) noexcept {
    level_ = 0;
    trial_ = plan_;
    head_ = head_before(knots_before(v, plan_, plan_.covers), tail());
    stage_ = Stage::repair;
    fit(v, head_, hurried_ ? 1 : hard_passes);
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::move_all(const View& v) noexcept {
    if (partial_) return give_up();
    if (best_.worst > hopeless) return start_insertion(v, best_);
    head_ = head_before(knots_before(v, best_, best_.worst_at), tail());
    start_moves(best_, 2 * move_budget, Goal::insertion);
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::start_insertion(const View& v,
                                                             const KnotPlan& from) noexcept {
    if (from.size >= MaxKnots || level_ >= MaxKnots) return give_up();
    ++level_;
    if (&from != &current_) current_ = from;
    stage_ = Stage::insert;
    cell_ = 0;
    tried_ = 0;
    found_ = false;
    low_worst_ = 1e30f;
    places_ = hurried_ ? fewest_places : (partial_ ? few_places : grid);
    const std::size_t at = knots_before(v, current_, current_.worst_at);
    head_ = head_before(at, tail());
    cell_low_ = at >= 2 ? static_cast<float>(current_.knot[at - 2])
                        : static_cast<float>(v.free ? 0 : v.low);
    cell_high_ = at + 1 < current_.size ? static_cast<float>(current_.knot[at + 1])
                                        : v.samples[v.count - 1].u;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::propose_insertion(const View& v) noexcept {
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
        return insert_at(v, best,
                         current_.worst < hopeless && !hurried_ ? hard_passes : soft_passes);
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

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::insert_at(const View& v, std::size_t cell,
                                                       std::size_t passes) noexcept {
    trial_ = current_;
    trial_.insert(
        to_integer(cell_low_ + (cell_high_ - cell_low_) * (static_cast<float>(cell) + 0.5f) /
                                   static_cast<float>(places_)));
    return valid(v, trial_) ? fit(v, head_, passes) : true;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::inserted(bool ok) noexcept {
    if (tried_ == 0) score_[cell_ - 1] = trial_.worst;
    if (ok) {
        if (hurried_) return accept(trial_);  // the first that serves
        if (!found_ || trial_.objective < best_.objective) best_ = trial_;
        found_ = true;
    } else if (!found_ && trial_.worst < low_worst_) {
        low_worst_ = trial_.worst;
        best_ = trial_;
    }
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::propose_append(const View& v) noexcept {
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

}  // namespace fairlead::earlier
