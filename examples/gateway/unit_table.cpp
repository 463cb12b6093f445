#include "examples/gateway/unit_table.hpp"

#include <algorithm>
#include <cmath>

#include "examples/gateway/version.hpp"

namespace fairlead::gateway {
namespace {

namespace reg = port::registers;
using port::CurveChannel;

struct Angles {
    float roll{}, pitch{}, yaw{};
};

/// Degrees, z then y then x: for displays only, so libm will do.
Angles angles_deg(const Quat& q) noexcept {
    constexpr float degrees = 57.29577951f;
    const float sine = std::clamp(2 * (q.w * q.y - q.z * q.x), -1.0f, 1.0f);
    return {std::atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x * q.x + q.y * q.y)) * degrees,
            std::asin(sine) * degrees,
            std::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z)) * degrees};
}

}  // namespace

void UnitTable::begin(std::uint8_t id, std::string_view name, SourceKind kind, std::uint32_t epoch,
                      std::int64_t stale_ns) noexcept {
    stale_ns_ = stale_ns;
    restart(epoch);
    reg::Writer{registers(), reg::fields}
        .u32(reg::magic)
        .u16(reg::map_version)
        .u16(reg::map_length)
        .text(version)
        .text(name)
        .f32(1)
        .u32(0x0102'0304)
        .u64(0x0102'0304'0506'0708)
        .u16(id)
        .u16(static_cast<std::uint16_t>(kind));
}

/// All that was known of the run before is gone.
void UnitTable::restart(std::uint32_t epoch) noexcept {
    std::fill(registers_.begin() + reg::events_begin, registers_.end(), std::uint16_t{0});
    spans_ = {};
    events_ = 0;
    epoch_ = epoch;
    state_ = {};
    reg::Writer{registers(), reg::fields, "unit.epoch"}.u32(epoch);
}

void UnitTable::collect(UnitFeed& feed) noexcept {
    SpanItem span;
    while (feed.spans.pop(span)) append(span);
    EventItem event;
    while (feed.events.pop(event)) append(event);
    feed.state.refresh();
    if (feed.state.value().epoch == epoch_) state_ = feed.state.value();
}

void UnitTable::append(const SpanItem& item) noexcept {
    if (item.kind == SpanKind::restart) return restart(item.epoch);
    std::uint32_t& next = spans_[static_cast<std::size_t>(item.span.channel)];
    if (item.kind == SpanKind::append || next == 0) ++next;
    const std::uint32_t n = next - 1;
    const std::uint32_t place = n % reg::spans_per_page;
    std::uint16_t* page = registers() + reg::page_address(reg::history_begin(item.span.channel), n,
                                                          reg::spans_per_page, reg::history_pages);
    if (place == 0) std::fill_n(page, reg::page_size, std::uint16_t{0});
    reg::put_page_header(page, {epoch_, n - place, static_cast<std::uint16_t>(place + 1),
                                static_cast<std::uint16_t>(item.span.channel), item.span.tick_ns});
    reg::put_span(page + reg::page_header + place * reg::span_size, item.span);
}

void UnitTable::append(const EventItem& item) noexcept {
    const std::uint32_t n = events_++;
    const std::uint32_t place = n % reg::events_per_page;
    std::uint16_t* page = registers() + reg::page_address(reg::events_begin, n,
                                                          reg::events_per_page, reg::event_pages);
    if (place == 0) std::fill_n(page, reg::page_size, std::uint16_t{0});
    reg::put_page_header(page, {epoch_, n - place, static_cast<std::uint16_t>(place + 1), 2, 0});
    reg::Writer{page + reg::page_header + place * reg::event_size, reg::event_fields}
        .i64(item.t_ns)
        .u16(item.channel)
        .u16(item.value);
}

void UnitTable::refresh(const ServerState& server, std::int64_t now_ns) noexcept {
    const UnitState& s = state_;
    std::uint16_t status = s.status;
    const std::int64_t age_ns = now_ns - s.t_ns;
    if (s.sequence == 0) status |= reg::status_bit::no_data;
    if (s.sequence == 0 || now_ns - s.arrival_ns > stale_ns_) status |= reg::status_bit::stale;
    const std::int64_t age_ms =
        s.sequence == 0 ? 65535 : std::clamp<std::int64_t>(age_ns / 1'000'000, 0, 65535);
    const Angles angles = angles_deg(s.q_wb);
    reg::Writer{registers(), reg::fields, "live.seq_begin"}
        .u32(s.sequence)
        .u32(epoch_)
        .i64(s.t_ns)
        .f32(s.q_wb.w)
        .f32(s.q_wb.x)
        .f32(s.q_wb.y)
        .f32(s.q_wb.z)
        .f32(s.p_w_m.x)
        .f32(s.p_w_m.y)
        .f32(s.p_w_m.z)
        .f32(s.rate_rad_s.x)
        .f32(s.rate_rad_s.y)
        .f32(s.rate_rad_s.z)
        .f32(s.v_w_m_s.x)
        .f32(s.v_w_m_s.y)
        .f32(s.v_w_m_s.z)
        .f32(angles.roll)
        .f32(angles.pitch)
        .f32(angles.yaw)
        .u16(status)
        .u16(static_cast<std::uint64_t>(age_ms))
        .u32(s.sequence)
        .u32(spans_[0])
        .u32(spans_[1])
        .u32(events_)
        .i64(s.source_ns)
        .i64(s.t_ns - s.source_ns)
        .u32(s.clock_error_ns)
        .u32(s.spans_dropped)
        .u16(reg::history_pages)
        .u16(reg::spans_per_page)
        .u32(s.publications)
        .u32(s.samples)
        .u32(s.sample_faults)
        .u32(s.gaps)
        .u32(s.bytes)
        .u32(s.frames)
        .u32(s.frames_damaged)
        .u32(s.resyncs)
        .u32(s.opened)
        .u32(s.lost)
        .u32(s.period_us)
        .u32(s.publish_us)
        .u32(s.publish_max_us)
        .u32(s.deadline_misses)
        .u32(s.frames_lost)
        .u32(s.bytes_skipped);
    const port::ModbusCounters& c = *server.counters;
    reg::Writer{registers(), reg::fields, "server.uptime_s"}
        .u32(static_cast<std::uint64_t>((now_ns - server.started_ns) / 1'000'000'000))
        .u32(server.clients)
        .u32(c.requests)
        .u32(c.illegal_function)
        .u32(c.illegal_address)
        .u32(c.illegal_value)
        .u32(c.unknown_unit)
        .u32(c.accepted)
        .u32(c.refused_network)
        .u32(c.refused_full)
        .u32(c.closed_protocol)
        .u32(c.closed_deadline)
        .u32(c.closed_idle)
        .u32(c.closed_slow_reader)
        .u32(c.rtu_damaged)
        .u32(c.rtu_foreign)
        .u32(c.rtu_lost_line)
        .u32(server.turn_max_us)
        .u32(s.events_lost)
        .u32(s.sensor.lost)
        .u32(s.sensor.missed_edges)
        .u32(s.sensor.bus_errors)
        .u32(s.sensor.overruns)
        .u32(s.sensor.resets)
        .u32(s.sensor.clock_jumps);
}

}  // namespace fairlead::gateway
