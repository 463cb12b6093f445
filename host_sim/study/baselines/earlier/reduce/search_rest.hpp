#pragma once
// Plans that come to rest, and stay there (reduce/land.hpp).
// Stages of the search: reduce/search.hpp.
#include "host_sim/study/baselines/earlier/reduce/search.hpp"

namespace fairlead::earlier {

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::start_landing(const View& v, Credit& credit) noexcept {
    if (partial_ || plan_.landing > 0 || !rests(v, quiet(v.delay), credit)) return false;
    stage_ = Stage::land;
    cell_ = 0;
    found_ = false;
    return true;
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::rests(const View& v, std::size_t n,
                                                   Credit& credit) noexcept {
    if (partial_ || v.count < quiet(v.delay)) return false;
    credit -= static_cast<Credit>(n) * rest_cost;
    return Land::at_rest(v.samples, v.count, n, v.judge, mid_);
}

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
bool Search<Channel, N, MaxKnots, Horizons>::propose_landing(const View& v,
                                                             Credit& credit) noexcept {
    const std::size_t prefixes = plan_.size + 1;
    for (; credit > 0 && cell_ < 2 * prefixes * Land::candidates; ++cell_) {
        const std::size_t count = Order - 1 + cell_ / (prefixes * Land::candidates);
        const std::size_t prefix = cell_ / Land::candidates % prefixes;
        credit -= step_cost;
        if (found_ && prefix + count >= best_.size) continue;
        credit -= landing_cost;
        if (!Land::plan(plan_, v.frozen, v.free, prefix, count, cell_ % Land::candidates,
                        v.free || v.low < 1 ? 0 : v.low, v.samples[v.count - 1].u, mid_, trial_) ||
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

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
void Search<Channel, N, MaxKnots, Horizons>::landed(bool ok) noexcept {
    if (!ok) return;
    best_ = trial_;
    found_ = true;
}

}  // namespace fairlead::earlier
