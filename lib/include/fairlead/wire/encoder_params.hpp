#pragma once
// What a user chooses of an encoder when a program starts, and which of it is refused.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "fairlead/base/check.hpp"
#include "fairlead/base/per_axis.hpp"
#include "fairlead/sense/intake_limits.hpp"

namespace fairlead::wire {

/// Never: no restart frames, or no header frames but the first.
inline constexpr std::int64_t never_ns = (std::numeric_limits<std::int64_t>::max)();
/// A reader that lost so much of a stream finds its time at the next restart frame; one that lost
/// more, at the next header.
inline constexpr std::int64_t join_ns_max = 30'000'000'000;
/// A stream with one header only: a reader that lost so much of it finds its time again.
inline constexpr std::int64_t lost_ns_max = 480'000'000'000;
/// Restart interval of a stream whose frames all decode alone.
inline constexpr std::int64_t every_frame_ns = 0;

/// Axes: the most of a channel.
template <std::size_t Channels, std::size_t Axes>
struct EncoderParams {
    /// From sample to sample; a tick. 125 us (8 kHz) to 1 s. Real times may be uneven.
    std::int64_t sample_period_ns{8'333'333};
    /// Largest error of the decoded curve at each sample, for each channel in the order of the
    /// type: of a vector in its unit (1e-6 to 1e6), one for all axes or one for each; of a
    /// rotation in rad (1.2e-4 to 0.5). Higher: fewer bytes, and a curve less true.
    std::array<PerAxis<Axes>, Channels> tolerance{};
    /// A sample is in the bytes at most so many records later: 8 to the encoder's Records. Higher:
    /// fewer bytes, and later ones.
    std::uint32_t delay_records{60};
    /// How long a reader that joins, or lost a frame, waits for a curve: 0 (every frame decodes
    /// alone) to never_ns. Lower: more bytes.
    std::int64_t restart_interval_ns{2'000'000'000};
    /// How long a reader that knows nothing waits for the header: 1 s to never_ns.
    std::int64_t header_interval_ns{60'000'000'000};
    /// A longer pause of a channel ends its curve, and the next sample starts a new one: up to 64
    /// sample periods. 0: default_gap_ns().
    std::int64_t gap_ns{0};
    /// Tells this stream from others on the same line.
    std::uint16_t stream_id{0};
    /// Number of the first run; a run is what lies between two leaps of the clock. A board that
    /// counts its starts gives the count.
    std::uint16_t run{0};
    /// Records that an event may wait for company.
    std::uint32_t event_delay_records{0};

    template <class Visit>
    static constexpr void each(const EncoderParams& p, Visit& visit) noexcept {
        visit("sample_period_ns", p.sample_period_ns, sample_period_min_ns, sample_period_max_ns);
        visit("delay_records", p.delay_records, std::uint32_t{8}, std::uint32_t{246});
        visit("restart_interval_ns", p.restart_interval_ns, every_frame_ns, never_ns);
        visit("header_interval_ns", p.header_interval_ns, std::int64_t{1'000'000'000}, never_ns);
        visit("gap_ns", p.gap_ns, std::int64_t{0}, 64 * p.sample_period_ns);
    }
};

}  // namespace fairlead::wire
