#pragma once
// Motion fairing of a whole buffer [Lee & Shin 1996]: rounds of rho_2 or rho_3, each sample a
// little (damping) towards the value at which its difference vanishes, until the cap on rounds or a
// bound on the distance to the measurement is met. Streaming: smooth/fairing_window.hpp.
//
// Deviations from the paper's figure 1:
//   - its loop tests the bound and then changes the data once more; here the RETURNED motion keeps
//     every bound: a round that would break one is not taken (OnBound::stop), or the single sample
//     that would break it stays where it is for this round (OnBound::hold);
//   - positions and orientations have bounds of their own and stop apart;
//   - rounds are capped: E_2 without a data term straightens everything in the end.
//
// In:   records in order, even spacing, neighbours closer than pi. A record in which a channel is
//       invalid, or which a gap flag precedes, ends the channel's segment; segments are faired
//       apart.
// Out:  each valid sample within its bound of the measurement; unit q_wb; everything else as it
// was. Cost: n x rounds x (the operator), no memory but the caller's three buffers.
#include <cstddef>
#include <cstdint>
#include <limits>

#include "fairlead/base/check.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/smooth/fairing_operator.hpp"

namespace fairlead {

enum class OnBound : std::uint8_t {
    stop,  // the channel's segment keeps its last round that was within the bound everywhere
    hold,  // samples at their bound wait, the others go on: what the streaming version does
};

struct FairingParams {
    float damping_p{0.5f};  // part of the way to the target per round, positions
    float damping_q{0.1f};  // the same, orientations
    float bound_m{std::numeric_limits<float>::infinity()};
    float bound_rad{std::numeric_limits<float>::infinity()};  // rotation angle
    bool alternate{false};  // mirror rho_3 in every second round: no shift in time

    template <class Params, class Visit>
    static constexpr void each(Params& p, Visit&& visit) noexcept {
        constexpr float unbounded = std::numeric_limits<float>::infinity();
        visit("damping_p", p.damping_p, 0.0f, 1.0f);
        visit("damping_q", p.damping_q, 0.0f, 1.0f);
        visit("bound_m", p.bound_m, 0.0f, unbounded);
        visit("bound_rad", p.bound_rad, 0.0f, unbounded);
    }
};
constexpr Check check(const FairingParams& params) noexcept { return detail::check_ranges(params); }

struct FairingReport {
    std::size_t rounds_p{};  // the fewest rounds that a segment of positions went
    std::size_t rounds_q{};
};

namespace detail {

/// Samples of one channel that belong together: [first, last).
template <class Channel>
struct FairingSegment {
    std::size_t first{}, last{};

    /// The next segment at or after `from`; empty at the end.
    static FairingSegment next(const Pose* raw, std::size_t n, std::size_t from) noexcept {
        std::size_t i = from;
        while (i < n && !(raw[i].flags & Channel::valid)) ++i;
        const std::size_t first = i;
        if (i < n) ++i;
        while (i < n && (raw[i].flags & Channel::valid) && !(raw[i].flags & Channel::gap)) ++i;
        return {first, i};
    }
};

/// The rounds of one segment. Returns how many were taken; the result is in `now`.
template <class Channel, int Order>
inline std::size_t fair_segment(const Pose* raw, Pose* now, Pose* next,
                                const FairingSegment<Channel>& segment, std::size_t rounds,
                                float damping, float bound_value, bool alternate,
                                OnBound on_bound) noexcept {
    const FairingBound<Channel> bound{bound_value};
    Pose* from = now;
    Pose* to = next;
    std::size_t taken = 0;
    for (; taken < rounds; ++taken) {
        bool broken = false;
        for (std::size_t i = segment.first; i < segment.last && !broken; ++i) {
            const auto at = [ from, i ](int j) -> const auto& {
                return Channel::of(from[i + static_cast<std::size_t>(j)]);
            };
            const FairingPlace place{i - segment.first, segment.last - 1 - i,
                                     alternate && taken % 2 == 1};
            auto value = faired<Channel, Order>(at, place, damping);
            if (!bound.kept(Channel::of(raw[i]), value)) {
                if (on_bound == OnBound::stop) broken = true;
                value = at(0);
            }
            Channel::of(to[i]) = value;
        }
        if (broken) break;
        Pose* const other = from;
        from = to;
        to = other;
    }
    if (from != now) {
        for (std::size_t i = segment.first; i < segment.last; ++i)
            Channel::of(now[i]) = Channel::of(from[i]);
    }
    return taken;
}

template <class Channel, int Order>
inline std::size_t fair_channel(const Pose* raw, Pose* now, Pose* next, std::size_t n,
                                std::size_t rounds, float damping, float bound, bool alternate,
                                OnBound on_bound) noexcept {
    using Segment = FairingSegment<Channel>;
    std::size_t fewest = rounds;
    for (auto s = Segment::next(raw, n, 0); s.first < n; s = Segment::next(raw, n, s.last)) {
        const std::size_t taken = fair_segment<Channel, Order>(raw, now, next, s, rounds, damping,
                                                               bound, alternate, on_bound);
        if (taken < fewest) fewest = taken;
    }
    return fewest;
}

}  // namespace detail

/// Fairs n records of `raw` into `out`. `raw`, `out` and `scratch` hold n records each and do not
/// overlap. params must pass check(): asserted.
template <int Order = 3>
inline FairingReport fair(const Pose* raw, Pose* out, Pose* scratch, std::size_t n,
                          std::size_t rounds, const FairingParams& params = {},
                          OnBound on_bound = OnBound::stop) noexcept {
    FAIRLEAD_ASSERT(check(params));
    for (std::size_t i = 0; i < n; ++i) out[i] = scratch[i] = raw[i];
    return {detail::fair_channel<detail::FairPosition<float>, Order>(
                raw, out, scratch, n, rounds, params.damping_p, params.bound_m, params.alternate,
                on_bound),
            detail::fair_channel<detail::FairOrientation<float>, Order>(
                raw, out, scratch, n, rounds, params.damping_q, params.bound_rad, params.alternate,
                on_bound)};
}

}  // namespace fairlead
