#pragma once
// What a user may set of the stream that leaves a board: tolerance, delay, restarts, identity.
// Default, range and effect of each field: docs/parameters.md.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "fairlead/base/check.hpp"
#include "fairlead/base/per_axis.hpp"
#include "fairlead/board.hpp"
#include "fairlead/sense/intake_limits.hpp"

namespace fairlead {

/// Largest distance of the decoded curve from any accepted record: an axis of a vector each by
/// itself, an orientation by its whole rotation angle.
template <class AChannels>
struct Tolerance;

namespace detail {

inline constexpr float position_tolerance_m = 0.001f, rotation_tolerance_rad = 0.0043633f;

/// Ranges of the tolerances of a channel.
template <class Channel>
inline constexpr float tolerance_min = 1e-6f;
template <class Channel>
inline constexpr float tolerance_max = 1e6f;
template <>
inline constexpr float tolerance_min<Orientation> = 1.2e-4f;
template <>
inline constexpr float tolerance_max<Orientation> = 0.5f;

template <std::size_t D, class Visit>
constexpr void visit_axes(const char* name, const PerAxis<D>& axes, Visit& visit) noexcept {
    for (std::size_t i = 0; i < D; ++i)
        visit(name, axes[i], tolerance_min<Vector<D>>, tolerance_max<Vector<D>>);
}

template <std::size_t D>
constexpr float smallest(const PerAxis<D>& axes) noexcept {
    float least = axes[0];
    for (std::size_t i = 1; i < D; ++i)
        if (axes[i] < least) least = axes[i];
    return least;
}

}  // namespace detail

template <>
struct Tolerance<Channels<Position>> {
    PerAxis<3> position_m{detail::position_tolerance_m};
    template <class Visit>
    constexpr void each(Visit& visit) const noexcept {
        detail::visit_axes("tolerance.position_m", position_m, visit);
    }
};

template <>
struct Tolerance<Channels<Orientation>> {
    float orientation_rad{detail::rotation_tolerance_rad};  // 0.25 degrees
    template <class Visit>
    constexpr void each(Visit& visit) const noexcept {
        visit("tolerance.orientation_rad", orientation_rad, detail::tolerance_min<Orientation>,
              detail::tolerance_max<Orientation>);
    }
};

template <>
struct Tolerance<Channels<Position, Orientation>> : Tolerance<Channels<Position>>,
                                                    Tolerance<Channels<Orientation>> {
    template <class Visit>
    constexpr void each(Visit& visit) const noexcept {
        Tolerance<Channels<Position>>::each(visit);
        Tolerance<Channels<Orientation>>::each(visit);
    }
};

template <std::size_t D>
struct Tolerance<Channels<Vector<D>>> {
    PerAxis<D> value{0.001f};
    template <class Visit>
    constexpr void each(Visit& visit) const noexcept {
        detail::visit_axes("tolerance.value", value, visit);
    }
};

/// restart_interval_ns or header_interval_ns for which there is no such interval.
inline constexpr std::int64_t never_ns = (std::numeric_limits<std::int64_t>::max)();

/// DelayMax: what the board has memory for, and the default.
template <class AChannels, std::size_t DelayMax>
struct StreamParams {
    std::int64_t sample_period_ns{0};  // 0: measured from the first records
    Tolerance<AChannels> tolerance{};
    std::uint32_t delay_records{DelayMax};            // from a record to the bytes that cover it
    std::int64_t restart_interval_ns{2'000'000'000};  // 0: with every frame; never_ns
    std::int64_t header_interval_ns{60'000'000'000};  // never_ns: with runs alone
    std::uint16_t stream_id{0};                       // tells devices on one line apart
    std::uint32_t event_delay_records{0};             // that an event may wait for company

    template <class Params, class Visit>
    static constexpr void each(Params& p, Visit&& visit) noexcept {
        visit("sample_period_ns", p.sample_period_ns, std::int64_t{0}, sample_period_max_ns);
        p.tolerance.each(visit);
        visit("delay_records", p.delay_records, std::uint32_t{16},
              static_cast<std::uint32_t>(DelayMax));
        visit("restart_interval_ns", p.restart_interval_ns, std::int64_t{0}, never_ns);
        visit("header_interval_ns", p.header_interval_ns, std::int64_t{1'000'000'000}, never_ns);
        visit("event_delay_records", p.event_delay_records, std::uint32_t{0},
              std::uint32_t{1000000});
    }
};

template <class AChannels, std::size_t DelayMax>
constexpr Check check(const StreamParams<AChannels, DelayMax>& params) noexcept {
    const Check ranges = detail::check_ranges(params);
    if (!ranges) return ranges;
    if (params.sample_period_ns != 0 && params.sample_period_ns < sample_period_min_ns)
        return {Status::bad_argument, "sample_period_ns"};
    return {};
}

}  // namespace fairlead
