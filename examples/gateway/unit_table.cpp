#include "examples/gateway/unit_table.hpp"

#include <algorithm>
#include <cmath>

#include "examples/gateway/version.hpp"
#include "fairlead/math/euler.hpp"

namespace fairlead::gateway {
namespace {

namespace reg = register_map;
using port::CurveChannel;

struct Angles {
    float roll{}, pitch{}, yaw{};
};

/// Degrees, z then y then x.
Angles angles_deg(const Quat& q) noexcept {
    constexpr float degrees = 57.29577951f;
    const EulerAngles<float> e = euler_angles(q);
    return {e.roll * degrees, e.pitch * degrees, e.yaw * degrees};
}

}  // namespace

void UnitTable::begin(std::uint8_t id, std::string_view name, SourceKind kind, std::uint32_t epoch,
                      std::int64_t stale_ns) noexcept {
    stale_ns_ = stale_ns;
    name_ = name;
    view_.version = version;
    view_.name = name_;
    view_.id = id;
    view_.source = static_cast<std::uint16_t>(kind);
    view_.state = &state_;
    restart(epoch);
}

/// All that was known of the run before is gone.
void UnitTable::restart(std::uint32_t epoch) noexcept {
    std::fill(registers_.begin() + reg::events_begin, registers_.end(), std::uint16_t{0});
    spans_ = {};
    events_ = 0;
    view_.epoch = epoch;
    state_ = {};
}

void UnitTable::collect(UnitFeed& feed) noexcept {
    SpanItem span;
    while (feed.spans.pop(span)) append(span);
    FeedEvent event;
    while (feed.events.pop(event)) append(event);
    feed.state.refresh();
    if (feed.state.value().epoch == view_.epoch) state_ = feed.state.value();
}

void UnitTable::append(const SpanItem& item) noexcept {
    if (item.kind == SpanKind::restart) return restart(item.epoch);
    const std::uint32_t n = spans_[static_cast<std::size_t>(item.span.channel)]++;
    const std::uint32_t place = n % reg::spans_per_page;
    std::uint16_t* page = registers() + reg::page_address(reg::history_begin(item.span.channel), n,
                                                          reg::spans_per_page, reg::history_pages);
    if (place == 0) std::fill_n(page, reg::page_size, std::uint16_t{0});
    reg::put_page_header(page, {view_.epoch, n - place, static_cast<std::uint16_t>(place + 1),
                                static_cast<std::uint16_t>(item.span.channel), item.span.sub_ns});
    reg::put_span(page + reg::page_header + place * reg::span_size, item.span);
}

void UnitTable::append(const FeedEvent& item) noexcept {
    const std::uint32_t n = events_++;
    const std::uint32_t place = n % reg::events_per_page;
    std::uint16_t* page = registers() + reg::page_address(reg::events_begin, n,
                                                          reg::events_per_page, reg::event_pages);
    if (place == 0) std::fill_n(page, reg::page_size, std::uint16_t{0});
    reg::put_page_header(page,
                         {view_.epoch, n - place, static_cast<std::uint16_t>(place + 1), 2, 0});
    reg::put_rows(reg::event_fields, item, page + reg::page_header + place * reg::event_size);
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
    view_.server = &server;
    view_.status = status;
    view_.age_ms = static_cast<std::uint16_t>(age_ms);
    view_.uptime_s = static_cast<std::uint32_t>((now_ns - server.started_ns) / 1'000'000'000);
    view_.roll_deg = angles.roll;
    view_.pitch_deg = angles.pitch;
    view_.yaw_deg = angles.yaw;
    view_.orientation_next = spans_[0];
    view_.position_next = spans_[1];
    view_.events_next = events_;
    reg::put_rows(reg::fields, view_, registers());
}

}  // namespace fairlead::gateway
