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

CurveSpan span_of(const wire::Link<Decoder::Position>& link, std::uint32_t tick_ns) noexcept {
    CurveSpan out;
    out.channel = CurveChannel::position;
    out.t0_ns = link.curve.span.t0_ns;
    out.tick_ns = tick_ns;
    out.cover_ticks = link.cover_ticks;
    const auto c = Polynomial<3, 4>{link.curve.span}.c;
    for (std::size_t m = 0; m < c.size(); ++m) {
        for (std::size_t d = 0; d < 3; ++d) out.c[m][d + 1] = c[m][d] * link.scale.unit(d);
    }
    return out;
}

CurveSpan span_of(const wire::Link<Decoder::Orientation>& link, std::uint32_t tick_ns) noexcept {
    CurveSpan out;
    out.channel = CurveChannel::orientation;
    out.t0_ns = link.curve.span.t0_ns;
    out.tick_ns = tick_ns;
    out.cover_ticks = link.cover_ticks;
    out.c = Polynomial<4, 4>{link.curve.span}.c;
    for (auto& power : out.c) {
        for (float& component : power) component *= link.scale.unit();
    }
    return out;
}

bool same_polynomial(const CurveSpan& a, const CurveSpan& b) noexcept {
    return a.t0_ns == b.t0_ns && a.c == b.c;
}

}  // namespace

std::uint32_t new_epoch() noexcept {
    std::uint32_t epoch = 0;
    const bool random = getrandom(&epoch, sizeof epoch, 0) == sizeof epoch;
    if (!random) epoch = static_cast<std::uint32_t>(port::now_ns());
    return epoch == 0 ? 1 : epoch;
}

const CurveSpan* OpenCurve::covering(std::int64_t t_ns) const noexcept {
    for (std::size_t i = spans_.size(); i-- > 0;) {
        if (spans_[i].t0_ns <= t_ns) return spans_[i].covers(t_ns) ? &spans_[i] : nullptr;
    }
    return nullptr;
}

bool CurveFollower::take(const std::uint8_t* bytes, std::size_t size) noexcept {
    const std::uint32_t frames = decoder_.counters().frames;
    const std::uint32_t restarts = decoder_.counters().restarts;
    for (std::size_t i = 0; i < size; ++i) {
        if (decoder_.push(bytes[i])) follow();
    }
    state_.bytes += static_cast<std::uint32_t>(size);
    restarted_ = decoder_.counters().restarts != restarts;
    if (decoder_.in_step()) {
        state_.status = static_cast<std::uint16_t>(state_.status & ~status_bit::out_of_step);
    } else {
        state_.status |= status_bit::out_of_step;
    }
    state_.frames = decoder_.counters().frames;
    state_.frames_damaged = decoder_.counters().damaged;
    state_.frames_lost = decoder_.counters().lost_frames;
    state_.bytes_skipped = decoder_.counters().skipped_bytes;
    state_.events_lost = decoder_.event_counters().lost + state_.events_dropped;
    return decoder_.counters().frames != frames;
}

void CurveFollower::follow() noexcept {
    Decoder::Update update;
    while (decoder_.next(update)) apply(update);
    send_newest(orientation_);
    send_newest(position_);
    Event event;
    while (decoder_.next_event(event)) {
        const EventItem item{event.t_ns, event.channel, event.value};
        if (!feed_.events.push(item)) ++state_.events_dropped;
    }
}

void CurveFollower::apply(const Decoder::Update& update) noexcept {
    const bool is_position = update.channel == Decoder::Channel::position;
    OpenCurve& curve = is_position ? position_ : orientation_;
    CurveSpan span = is_position ? span_of(decoder_.position(), decoder_.tick_ns())
                                 : span_of(decoder_.orientation(), decoder_.tick_ns());
    // a restart frame tells again what a decoder that missed nothing of this curve already has
    const bool known = curve.has_any() && same_polynomial(curve.newest(), span);
    if (update.piece && !(update.rejoined && known)) {
        span.begins = update.begins || update.rejoined;
        if (update.rejoined) ++state_.resyncs;
        const bool gap = span.begins && !update.breaks && curve.has_any();
        if (gap) ++state_.gaps;
        open(curve, span);
        curve.in_gap_ = gap || (curve.in_gap_ && !span.begins);
    } else if (curve.has_any()) {
        curve.changed_ = curve.changed_ || span.cover_ticks != curve.newest().cover_ticks;
        curve.spans_[curve.spans_.size() - 1].cover_ticks = span.cover_ticks;
        curve.covers_ = true;
    }
}

void CurveFollower::open(OpenCurve& curve, const CurveSpan& span) noexcept {
    if (curve.has_any() && span.t0_ns < curve.newest().t0_ns) restart();  // the clock began anew
    if (curve.has_any()) {
        CurveSpan& last = curve.spans_[curve.spans_.size() - 1];
        if (!span.begins) {  // final up to the knot where the next one takes over
            last.cover_ticks =
                static_cast<std::uint32_t>((span.t0_ns - last.t0_ns) / std::int64_t{last.tick_ns});
            curve.covers_ = curve.changed_ = true;
            send_newest(curve);
        }
    }
    if (curve.spans_.full()) curve.spans_.pop();
    curve.spans_.push(span);
    curve.sent_ = false;
    curve.covers_ = span.begins || span.cover_ticks > 0;
}

void CurveFollower::restart() noexcept {
    orientation_ = OpenCurve{CurveChannel::orientation};
    position_ = OpenCurve{CurveChannel::position};
    state_.epoch = new_epoch();
    state_.sequence = 0;
    send({{}, SpanKind::restart, state_.epoch});
}

void CurveFollower::send_newest(OpenCurve& curve) noexcept {
    if (!curve.has_any() || (curve.sent_ && !curve.changed_)) return;
    // a knot alone covers nothing: what follows may continue there or begin anew
    if (!curve.covers_) return;
    send({curve.newest(), curve.sent_ ? SpanKind::extend : SpanKind::append, state_.epoch});
    curve.sent_ = true;
    curve.changed_ = false;
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
    const auto end = [](const OpenCurve& c) {  // the last tick that is final
        return c.has_any() ? c.newest().t1_ns() - std::int64_t{c.newest().tick_ns} : INT64_MIN;
    };
    const std::int64_t newest = std::max(end(orientation_), end(position_));
    if (newest == INT64_MIN) return;
    std::int64_t t_ns = newest;
    for (const OpenCurve* curve : {&orientation_, &position_}) {
        if (curve->has_any() && newest - end(*curve) < channel_gone_ns) {
            t_ns = std::min(t_ns, end(*curve));
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
        if (orientation_.in_gap_) state_.status |= status_bit::gap;
    }
    if (const CurveSpan* span = position_.covering(t_ns)) {
        state_.p_w_m = port::curve::position(*span, t_ns);
        state_.v_w_m_s = port::curve::velocity_m_s(*span, t_ns);
        state_.status |= status_bit::valid_position;
        if (position_.in_gap_) state_.status |= status_bit::gap;
    }
}

}  // namespace fairlead::gateway
