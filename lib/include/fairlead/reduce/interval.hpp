#pragma once
// The search of one axis: its samples are integers, its tolerance is an interval.
//
// The running bounds of a hypothesis are exact here: each rise between them holds every sample.
// Fresh pieces are cubics in a / h: their bounds run for each length apart.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/curve/scale.hpp"
#include "fairlead/math/approx.hpp"
#include "fairlead/reduce/beam.hpp"

namespace fairlead::reduce {

template <class AKind>
class Interval {
  public:
    using Kind = AKind;
    static constexpr std::size_t components = 1;
    /// In 1/1024 step against the window's origin.
    using Sample = std::array<std::int32_t, 1>;

  protected:
    using Open = Hypothesis<1>;
    /// The least that a hypothesis still pays at a column.
    static constexpr Cost step_cost_min = reduce::step_cost_min;

    void begin(std::int32_t guess) noexcept {
        guess_ = guess;
        low_.fill(-far_away);
        high_.fill(far_away);
    }
    void begin_column(int) noexcept {}
    static constexpr bool renew(int) noexcept { return false; }

    /// x - v in steps, rounded once.
    static float from(std::int32_t x, std::int32_t v) noexcept {
        return static_cast<float>(x - v * curve::fine) * (1.0f / curve::fine);
    }
    /// What the rounding of numbers as large as these leaves of the tolerance.
    static float room(float radius, float d, float ahead) noexcept {
        return radius - (approx::absolute(d) + approx::absolute(ahead)) * rounding;
    }

    /// The first piece after a restart: v + s a (1 - w)^2 + p w^2 (2 - w), w = a / h.
    bool bound_fresh(const Open& o, float age, const Sample& x, float radius) noexcept {
        const float d = from(x[0], o.v[0]);
        bool any = false;
        for (std::size_t i = 0; i < fresh_count; ++i) {
            const bool listed = i < curve::length_count;
            const float h =
                listed ? static_cast<float>(curve::lengths[i]) : static_cast<float>(guess_);
            if (h < age || low_[i] > high_[i]) continue;
            const float w = age * (listed ? inverse_length[i] : 1.0f / h), rest = 1.0f - w;
            const float inverse = 1.0f / (w * w * (2.0f - w)),
                        ahead = o.slope(0) * age * (rest * rest);
            const float e = room(radius, 4.0f * d, 4.0f * ahead);
            const float low = (d - ahead - e) * inverse, high = (d - ahead + e) * inverse;
            if (low > low_[i]) low_[i] = low;
            if (high < high_[i]) high_[i] = high;
            any = any || low_[i] <= high_[i];
        }
        return any;
    }

    /// Offers the four rises of the box that are nearest to the prediction.
    template <class Search, class Source>
    void offer(Search& search, const Open& o, const Ending<1>& ending, const Column<1>& at,
               const Source&) const noexcept {
        Range range;
        if (ending.before.fresh && !fresh_range(ending.h, range)) return;
        if (!search.box(o, ending, at, 0, range)) return;
        const std::int32_t predicted = ending.predicted[0];
        std::int32_t first = range.first(), last = range.last();
        if (first > last) return;
        if (last - first > 3) {
            const std::int32_t from = predicted - 1 < last - 3 ? predicted - 1 : last - 3;
            if (from > first) first = from;
            last = first + 3;
        }
        const auto& row = code::costs<Kind, 1>.value[code::value_row<Kind>(
            ending.before, ending.code, ending.h, 0, false)];
        for (std::int32_t p = first; p <= last; ++p) {
            Candidate<1> c{ending.base, {p}, {p - predicted}};
            if (at.told != nullptr) {  // k costs nothing
                const float off = static_cast<float>(o.v[0] + p) - (*at.told)[0];
                c.cost += static_cast<Cost>(seam_weight * approx::absolute(off) / search.radius());
            } else {
                c.cost += code::value_cost(row, c.k[0], o.sign[0]);
            }
            if (c.cost >= search.worst()) continue;
            const auto child = search.make(o, ending, c);
            if (search.bounded(child)) search.place(child);
        }
    }

  private:
    static constexpr std::size_t fresh_count = curve::length_count + 1;

    static constexpr std::array<float, curve::length_count> inverse_lengths() noexcept {
        std::array<float, curve::length_count> inverse{};
        for (std::size_t i = 0; i < inverse.size(); ++i)
            inverse[i] = 1.0f / static_cast<float>(curve::lengths[i]);
        return inverse;
    }
    static constexpr auto inverse_length = inverse_lengths();

    /// Bounds of a fresh piece of h ticks; false where none of this length was followed.
    bool fresh_range(std::int32_t h, Range& range) const noexcept {
        const std::uint8_t index = curve::index_of(h);
        if (index == curve::code::none && h != guess_) return false;
        const std::size_t i = index != curve::code::none ? index : curve::length_count;
        range = {low_[i], high_[i]};
        return true;
    }

    std::array<float, fresh_count> low_{}, high_{};
    std::int32_t guess_{};
};

}  // namespace fairlead::reduce
