#pragma once
// The step that always exists: a chain of constants that holds any accepted samples.
//
// From a vertex at a whole tick to a later one, each part holds one lattice value over as many
// samples as its tolerance allows; between two samples that contradict each other it is cut.
// Samples keep 20 sub-ticks apart, so that a cut 10 sub-ticks behind a sample, or a whole tick
// between the two, is always behind the one and before the other. The chain ends on a target, where
// the curve goes on: where the last samples do not allow it, a last cut follows them. The same walk
// counts the cost in the search and gives the pieces to the coder: it depends on samples, vertex
// and target.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/curve/state.hpp"

namespace fairlead::reduce {

template <std::size_t N>
class JumpWalk {
  public:
    JumpWalk() = default;
    /// Over samples [first, last), which lie behind tick `from` and not behind tick `to`. v() tells
    /// afterwards whether the target was reached.
    JumpWalk(const std::array<std::int32_t, N>& v, const std::array<std::int32_t, N>& target,
             std::int32_t from, std::int32_t to, std::size_t first, std::size_t last) noexcept
        : v_{v},
          target_{target},
          from_{from * curve::subs_per_tick},
          until_{from_},
          end_{to * curve::subs_per_tick},
          sample_{first},
          last_{last} {}

    /// The next part. Source: Fit fit(); Moment when(i). Fit: bool add(source, i), true for the
    /// first; value(), a lattice value that holds all that were added; bool holds(v), whether v
    /// does.
    template <class Source>
    bool next(const Source& source, curve::Piece<N>& piece) noexcept {
        if (from_ >= end_) return false;
        piece = {};
        piece.code = curve::code::jump;
        if (from_ >= until_) {
            auto fit = source.fit();
            std::size_t i = sample_;
            while (i < last_ && fit.add(source, i)) ++i;
            const bool all = i >= last_, free = i == sample_;
            const auto v = free || (all && fit.holds(target_)) ? target_ : fit.value();
            until_ = !all ? cut(source.when(i - 1), source.when(i)) : end_;
            if (all && v != target_)
                until_ = cut(source.when(i - 1), {end_ / curve::subs_per_tick});
            if (until_ > end_ || until_ <= from_) until_ = end_;
            for (std::size_t c = 0; c < N; ++c) piece.k[c] = v[c] - v_[c];
            v_ = v;
            sample_ = i;
        }
        const std::int32_t here = from_ / curve::subs_per_tick + 1;
        const std::int32_t tick = here * curve::subs_per_tick;
        std::int32_t to = until_;
        if (to >= tick) {
            const std::int32_t whole = to / curve::subs_per_tick;
            const std::int32_t most = here + curve::gap_ticks_max;
            to = (whole < most ? whole : most) * curve::subs_per_tick;
        }
        piece.subs = static_cast<std::uint16_t>(to - from_);
        from_ = to;
        return true;
    }
    const std::array<std::int32_t, N>& v() const noexcept { return v_; }

  private:
    static std::int32_t cut(const curve::Moment& a, const curve::Moment& b) noexcept {
        const std::int32_t tick = b.part > 0.0f ? b.tick : b.tick - 1;
        if (tick > a.tick || (tick == a.tick && !(a.part > 0.0f)))
            return tick * curve::subs_per_tick;
        return a.tick * curve::subs_per_tick +
               static_cast<std::int32_t>(a.part * static_cast<float>(curve::subs_per_tick)) +
               curve::spacing_subs_min / 2;
    }

    std::array<std::int32_t, N> v_{}, target_{};
    std::int32_t from_{0}, until_{0}, end_{0};
    std::size_t sample_{0}, last_{0};
};

}  // namespace fairlead::reduce
