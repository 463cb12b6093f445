#pragma once
// The time of curves: a grid of ticks, counted exactly in sub-ticks from the base of a run.
//
// A tick is the sample period, rounded to a multiple of 64 ns; a sub-tick is 1/64 of it. Vertices
// of curves lie on ticks (after a jump also on sub-ticks); samples lie anywhere between and bound
// the curve at their true times.
#include <cstdint>

#include "fairlead/curve/lengths.hpp"

namespace fairlead::curve {

/// A place in time against the start of a frame: whole ticks, and the part of a tick in [0, 1).
/// The two stand apart so that a difference to a vertex keeps its precision: the error is below
/// 2^-24 (ticks + 1).
struct Moment {
    std::int32_t tick{};
    float part{};
};

/// Time base of a run. A curve's time n sub-ticks is base_ns + n * sub_ns.
struct Grid {
    std::int64_t base_ns{};
    std::uint32_t sub_ns{1};

    /// The grid whose tick is nearest to a sample period; period_ns in [64, 2^37], else it is
    /// clamped.
    static constexpr Grid of_period(std::int64_t base_ns, std::int64_t period_ns) noexcept {
        const std::int64_t longest = std::int64_t{1} << 37;
        const std::int64_t p = period_ns < 64 ? 64 : period_ns > longest ? longest : period_ns;
        return {base_ns, static_cast<std::uint32_t>((p + 32) / 64)};
    }
    constexpr std::int64_t tick_ns() const noexcept { return std::int64_t{sub_ns} * subs_per_tick; }
    /// Time of n sub-ticks in ns; where a curve ends behind the last time that there is, that time.
    /// |n| beyond a run gives some time, and no overflow.
    constexpr std::int64_t time_ns(std::int64_t n) const noexcept {
        constexpr std::int64_t most = INT64_MAX, least = INT64_MIN;
        const auto after = static_cast<std::int64_t>(static_cast<std::uint64_t>(n) * sub_ns);
        if (after > 0 && base_ns > most - after) return most;
        if (after < 0 && base_ns < least - after) return least;
        return base_ns + after;
    }

    /// Sub-ticks from the base to the last one at or before t_ns; t_ns >= base_ns.
    constexpr std::int64_t subs(std::int64_t t_ns) const noexcept {
        return (t_ns - base_ns) / sub_ns;
    }
    /// t_ns against the frame that starts at `start` sub-ticks; t_ns must not be before it, and at
    /// most 2^31 ticks behind it. Cost: one division of 64 bits.
    constexpr Moment moment(std::int64_t t_ns, std::int64_t start) const noexcept {
        const std::int64_t after = t_ns - time_ns(start);
        const std::int64_t tick = after / tick_ns();
        const float part = rounded(after - tick * tick_ns()) / rounded(tick_ns());
        return {static_cast<std::int32_t>(tick), part < 1.0f ? part : 0x1.fffffep-1f};
    }
    /// The newest tick that a sample at t_ns lets the search place a vertex on: the last one before
    /// t_ns + tick / 8, counted from `start`. Samples keep 5/16 tick apart, so every later one is
    /// behind this tick.
    constexpr std::int32_t column(std::int64_t t_ns, std::int64_t start) const noexcept {
        const std::int64_t after = t_ns - time_ns(start) + 8 * std::int64_t{sub_ns} - 1;
        return static_cast<std::int32_t>(after / tick_ns());
    }

  private:
    /// The nearest float to n, 0 <= n < 2^40: each half is exact, so that their sum is rounded
    /// once.
    static constexpr float rounded(std::int64_t n) noexcept {
        const auto high = static_cast<std::int32_t>(n >> 16),
                   low = static_cast<std::int32_t>(n & 0xffff);
        return static_cast<float>(high) * 65536.0f + static_cast<float>(low);
    }
};

/// Accepted samples keep at least this many sub-ticks apart. Closer ones would need more jumps
/// between two ticks than a frame holds.
inline constexpr std::int32_t spacing_subs_min = 20;
/// A longer pause, in ticks, ends a curve.
inline constexpr std::int32_t gap_ticks_max = 64;

}  // namespace fairlead::curve
