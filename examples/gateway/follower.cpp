#include "examples/gateway/follower.hpp"

#include <sys/random.h>

#include <algorithm>

#include "port/linux/clock.hpp"

namespace fairlead::gateway {
namespace {

using port::CurveChannel;
using port::CurveSpan;
namespace status_bit = port::registers::status_bit;

constexpr std::int64_t channel_gone_ns = 1'000'000'000;  // a channel so far behind has ended
constexpr std::int64_t patience_ns = 2'000'000'000;      // how long a replay waits for the server

}  // namespace

std::uint32_t new_epoch() noexcept {
    std::uint32_t epoch = 0;
    const bool random = getrandom(&epoch, sizeof epoch, 0) == sizeof epoch;
    if (!random) epoch = static_cast<std::uint32_t>(port::now_ns());
    return epoch == 0 ? 1 : epoch;
}

const CurveSpan* ChannelSpans::covering(std::int64_t t_ns) const noexcept {
    for (std::size_t i = spans_.size(); i-- > 0;)
        if (spans_[i].covers(t_ns)) return &spans_[i];
    return nullptr;
}

bool ChannelSpans::next(const curve::Grid& grid, std::uint32_t joins, CurveSpan& span) noexcept {
    if (!maker_.next(grid, span)) return false;
    if (span.begins) {
        in_gap_ = has_any() && joins_ == joins;
        joins_ = joins;
    }
    if (spans_.full()) spans_.pop();
    spans_.push(span);
    return true;
}

void ChannelSpans::clear() noexcept {
    maker_.clear();
    spans_.clear();
    joins_ = 0;
    in_gap_ = false;
}

bool CurveFollower::take(const std::uint8_t* bytes, std::size_t size) noexcept {
    const std::uint32_t frames = decoder_.frame_counters().frames;
    for (std::size_t i = 0; i < size; ++i) {
        ++received_;
        if (decoder_.push(bytes[i])) follow();
    }
    state_.bytes += static_cast<std::uint32_t>(size);
    tell_health();
    return decoder_.frame_counters().frames != frames;
}

void CurveFollower::finish() noexcept {
    while (decoder_.finish()) follow();
    tell_health();
}

void CurveFollower::tell_health() noexcept {
    const auto& frames = decoder_.frame_counters();
    state_.status = static_cast<std::uint16_t>(state_.status & ~status_bit::out_of_step);
    if (!decoder_.in_step()) state_.status |= status_bit::out_of_step;
    state_.frames = frames.frames;
    state_.frames_damaged = frames.losses;
    state_.resyncs = frames.joins;
    state_.breaks = decoder_.counters().breaks;
    state_.headers_refused = decoder_.counters().refused;
    state_.stream_id = decoder_.stream_id();
    state_.events_lost = decoder_.event_counters().lost + state_.events_dropped;
}

void CurveFollower::follow() noexcept {
    const auto new_run = [this](bool first) noexcept {
        if (!first) restart();  // the clock began anew
    };
    const auto take = [this](const wire::CurvePiece& piece) noexcept {
        (piece.rotates ? orientation_ : position_).take(piece);
    };
    follow_(decoder_, new_run, take);
    append(orientation_);
    append(position_);
    Event event;
    while (decoder_.next_event(event)) {
        const FeedEvent item{event.t_ns, event.channel, event.value};
        if (!feed_.events.push(item)) ++state_.events_dropped;
    }
    // between frames nothing is pending: what was received and not believed was passed over
    state_.bytes_skipped =
        static_cast<std::uint32_t>(received_ - decoder_.frame_counters().good_bytes);
}

void CurveFollower::append(ChannelSpans& channel) noexcept {
    const std::uint32_t joins = decoder_.frame_counters().joins;
    for (CurveSpan span; channel.next(decoder_.grid(), joins, span);) {
        if (span.begins && channel.in_gap()) ++state_.gaps;
        send({span, SpanKind::append, state_.epoch});
    }
}

void CurveFollower::restart() noexcept {
    orientation_.clear();
    position_.clear();
    state_.epoch = new_epoch();
    state_.sequence = 0;
    send({{}, SpanKind::restart, state_.epoch});
}

void CurveFollower::send(const SpanItem& item) noexcept {
    if (feed_.spans.push(item)) return;
    const std::int64_t until_ns = port::now_ns() + patience_ns;
    while (when_full_ == WhenFull::wait && port::now_ns() < until_ns) {
        port::sleep_until(port::now_ns() + port::ms);
        if (feed_.spans.push(item)) return;
    }
    ++state_.spans_dropped;
}

void CurveFollower::evaluate() noexcept {
    const auto end = [](const ChannelSpans& c) {
        return c.has_any() ? c.newest().t1_ns() : INT64_MIN;
    };
    const std::int64_t newest = std::max(end(orientation_), end(position_));
    if (newest == INT64_MIN) return;
    std::int64_t t_ns = newest;
    for (const ChannelSpans* channel : {&orientation_, &position_}) {
        if (channel->has_any() && newest - end(*channel) < channel_gone_ns) {
            t_ns = std::min(t_ns, end(*channel));
        }
    }
    constexpr unsigned validity =
        status_bit::valid_orientation | status_bit::valid_position | status_bit::gap;
    state_.status = static_cast<std::uint16_t>(state_.status & ~validity);
    state_.source_ns = t_ns;
    if (const CurveSpan* span = orientation_.covering(t_ns)) {
        state_.q_wb = port::curve::orientation(*span, t_ns);
        state_.rate_rad_s = port::curve::rate_rad_s(*span, t_ns);
        state_.status |= status_bit::valid_orientation;
        if (orientation_.in_gap()) state_.status |= status_bit::gap;
    }
    if (const CurveSpan* span = position_.covering(t_ns)) {
        state_.p_w_m = port::curve::position(*span, t_ns);
        state_.v_w_m_s = port::curve::velocity_m_s(*span, t_ns);
        state_.status |= status_bit::valid_position;
        if (position_.in_gap()) state_.status |= status_bit::gap;
    }
}

}  // namespace fairlead::gateway
