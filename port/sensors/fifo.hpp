#pragma once
// The part of a FIFO read that all chips share: bursts of whole packets, then one time per sample.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "port/sensors/bus.hpp"
#include "port/sensors/imu.hpp"
#include "port/sensors/timeline.hpp"

namespace fairlead::port {

inline constexpr std::int64_t no_edge = INT64_MIN;
inline constexpr std::size_t burst_max = 504;  // bytes on the stack: 31 x 16, 24 x 21, 36 x 14

/// Reads `count` packets in as few bursts as the bus allows and hands each to parse(), which
/// answers false to stop: bad_data. Bursts: count * packet_size / min(504, read_max) rounded up, no
/// retries.
template <class Bus, class Parse>
Status read_packets(const Registers<Bus>& chip, std::uint8_t reg, std::size_t packet_size,
                    std::size_t count, Parse parse) noexcept {
    std::array<std::uint8_t, burst_max> bytes{};
    const std::size_t at_once = std::min(burst_max, chip.bus().read_max()) / packet_size;
    if (at_once == 0) return Status::not_supported;
    for (std::size_t done = 0; done < count;) {
        const std::size_t n = std::min(at_once, count - done);
        const Status s = chip.read(reg, bytes.data(), n * packet_size);
        if (s != Status::ok) return s;
        for (std::size_t i = 0; i < n; ++i)
            if (!parse(bytes.data() + i * packet_size)) return Status::bad_data;
        done += n;
    }
    return Status::ok;
}

/// While a batch is being read, t_ns of each sample holds the chip's tick; this puts times there.
/// The sample at `edge_index` was ready at edge_ns; without any anchor yet, the newest was at
/// now_ns.
inline void stamp(Batch& batch, Timeline& line, std::size_t edge_index, std::int64_t edge_ns,
                  std::int64_t now_ns) noexcept {
    if (batch.count == 0) return;
    if (edge_ns != no_edge && edge_index < batch.count)
        line.anchor(batch.samples[edge_index].t_ns, edge_ns);
    if (!line.anchored()) {
        line.anchor(batch.samples[batch.count - 1].t_ns, now_ns);
        if (batch.state == FifoState::streaming) batch.state = FifoState::resync;
    }
    for (std::size_t i = 0; i < batch.count; ++i) {
        Sample& s = batch.samples[i];
        const auto stamp = line.stamp(s.t_ns);
        s.t_ns = stamp.t_ns;
        batch.lost += stamp.lost;
        if (stamp.lost > 0) s.flags |= flag::gap_before;
    }
}

}  // namespace fairlead::port
