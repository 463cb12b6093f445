#pragma once
// Fewer knots and better places: moves by Gauss and Newton, removal on trial, polish.
// Stages of the search: reduce/search.hpp.
#include "host_sim/study/baselines/earlier/reduce/search.hpp"

namespace fairlead::earlier {

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::start_moves(const KnotPlan& from, std::size_t budget,
                                                         Goal goal) noexcept {
    current_ = from;
    budget_ = budget;
    goal_ = goal;
    fresh_ = true;
    stage_ = Stage::move;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::propose_move(const View& v) noexcept {
    if (budget_ == 0 || current_.size <= head_ || Order < 3) {
        moves_failed(v);
        return true;
    }
    --budget_;
    trial_ = current_;
    if (fresh_) return seek(v, head_);
    if (!shift_knots(v)) {
        moves_failed(v);
        return true;
    }
    return fit(v, head_, current_.worst < 1.5f ? move_passes : soft_passes);
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::seek(const View& v, std::size_t head) noexcept {
    seeking_ = true;
    fitting_ = true;
    const std::size_t most = Fitter::shifts_max;
    sought_ = trial_.size > head + most ? trial_.size - most : head;
    fitter_.start_shifts(v, sought_, trial_);
    damping_ = 1;
    return true;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::shift_knots(const View& v) noexcept {
    const auto last = static_cast<std::int32_t>(v.samples[v.count - 1].u) - 1;
    bool any = false;
    std::int32_t before = first_place(v) - 1;
    if (sought_ > 0 && trial_.knot[sought_ - 1] > before) before = trial_.knot[sought_ - 1];
    for (std::size_t i = sought_; i < trial_.size; ++i) {
        const std::int32_t old = trial_.knot[i];
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

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::moved(bool ok) noexcept {
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

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::moves_failed(const View& v) noexcept {
    idle();
    if (goal_ != Goal::removal) return start_insertion(v, current_);
    if (++tried_ < 2) stage_ = Stage::drop_harder;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::start_drops() noexcept {
    first_ = plan_.settled >= 0 ? 1 : 0;
    stage_ = plan_.size > first_ ? Stage::drop : Stage::idle;
    cell_ = first_;
    tried_ = 0;
    age_ = 0;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::propose_drop(const View& v) noexcept {
    if (cell_ >= plan_.size) {
        stage_ = Stage::drop_harder;
        return true;
    }
    trial_ = plan_;
    trial_.erase(cell_);
    return fit(v, loose(head_before(cell_, tail() - 1)), 0);
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::dropped(bool ok) noexcept {
    score_[cell_++] = trial_.worst;
    if (ok) accept(trial_);
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::propose_hard_drop(const View& v) noexcept {
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

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::hard_dropped(bool ok) noexcept {
    if (ok) return accept(trial_);
    if (trial_.size == 0) {
        if (++tried_ >= 2) idle();
        return;
    }
    start_moves(trial_, move_budget, Goal::removal);
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::start_polish() noexcept {
    if (polished_ == 0 && plan_.settled >= 0) polished_ = 1;
    if (polished_ >= plan_.size) return false;
    knot_ = polished_++;
    cell_ = 0;
    stage_ = Stage::polish;
    return true;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::propose_polish(const View& v) noexcept {
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

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::polished(bool ok) noexcept {
    if (cell_ == 1) {
        merit_ = ok ? trial_.objective : 1e30f;
        if (ok) plan_ = trial_;
    } else if (ok && trial_.objective < merit_ * 0.999f) {
        merit_ = trial_.objective;
        plan_ = trial_;
    }
}

}  // namespace fairlead::earlier
