#pragma once
// What stands in a frame, written down once for both directions. docs/formats.md tells it in prose.
//
//   data frame     length (1 byte, or 2 with the top bits 10), payload, CRC-16 seeded with the
//                  sequence number
//   restart frame  length (2 bytes, top bits 110), payload that starts with the whole state, CRC-16
//   payload        [restart: header, one state per channel], then per channel of the stream:
//                  begin?, knots, cover
//
// The sequence number of a data frame is not sent: it seeds the CRC, so that a lost or repeated
// frame is noticed like a damaged one. Restart frames carry it. Only there a decoder that is out of
// step gets in.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/wire/crc.hpp"
#include "host_sim/study/baselines/earlier/reduce/reducer.hpp"
#include "host_sim/study/baselines/earlier/wire/knots.hpp"

namespace fairlead::earlier::wire {

inline constexpr std::uint32_t version = 0xF2;
inline constexpr std::size_t max_payload = 480;
inline constexpr std::size_t max_frame = max_payload + 4;
inline constexpr std::uint32_t usual_value_width = 18, usual_width = 10;  // of a curve's integers
inline constexpr std::uint16_t restart_seed = 0xFA1E;
inline constexpr std::uint32_t sequence_mask = 0xff;  // frames are numbered modulo 256
inline constexpr std::uint8_t stepless_head = 0xC0;   // first byte from which no step is needed

/// A power of two: mostly one of those of lengths in metres and angles in radians.
template <class Io>
void exponent(Io& io, std::int8_t& e) noexcept {
    auto biased = static_cast<std::uint32_t>(e + 27);
    if (flag(io, biased < 32)) {
        io.bits(biased, 5);
    } else {
        biased = static_cast<std::uint8_t>(e);
        io.bits(biased, 8);
        biased += 27;
    }
    e = static_cast<std::int8_t>(static_cast<std::uint8_t>(biased - 27));
}
template <class Io, std::size_t D, std::size_t Order>
void scale(Io& io, typename VectorChannel<D, Order>::Scale& s, VectorChannel<D, Order>) noexcept {
    bool same = true;
    for (const auto e : s.exponent) same = same && e == s.exponent[0];
    same = flag(io, same);
    for (std::size_t d = 0; d < D; ++d) {
        if (d == 0 || !same) exponent(io, s.exponent[d]);
        if (same) s.exponent[d] = s.exponent[0];
    }
}
template <class Io>
void scale(Io& io, OrientationChannel::Scale& s, OrientationChannel) noexcept {
    exponent(io, s.exponent);
}

/// Both ends' picture of one channel: what has been sent of its curve.
template <class Channel>
struct Link {
    typename Channel::Scale scale{};
    bool enabled{true};  // the stream has this channel
    bool active{false};  // a curve has begun
    Curve<Channel> curve{};
    std::uint32_t cover_ticks{0};  // final before this, after the curve's last knot
    std::uint32_t stride{0};  // by which the latest frame moved that; 0: not known since a restart
    Models models{};
};

/// Some ticks before a time; what a reader is told may be nonsense, and then wraps around.
inline std::int64_t earlier(std::int64_t t_ns, std::int64_t ticks, std::uint32_t tick_ns) noexcept {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(t_ns) -
                                     static_cast<std::uint64_t>(ticks) * tick_ns);
}

/// What a late joiner is told of the adaptive codes; for the others, too, the rest begins anew.
template <class Channel, class Io>
void state(Io& io, Models& models) noexcept {
    constexpr std::size_t jumps = Channel::model(0) == Channel::model(1) ? 1 : 2;
    Models fresh;
    const auto tell = [&](const RiceModel& from, RiceModel& to) {
        std::uint32_t v = from.summary() < 15 ? from.summary() : 15;
        io.bits(v, 4);
        to.restore(v);
    };
    for (std::size_t i = 0; i < jumps; ++i) tell(models.jump[i], fresh.jump[i]);
    fresh.last_reach = models.last_reach;
    io.bits(fresh.last_reach, 5);
    fresh.ticks.mean16 = mean16_of_reach<Channel>(fresh.last_reach);
    models = fresh;
}

/// Everything that a late joiner needs of a channel. The time goes back from base_ns.
template <class Io, class Channel>
void state(Io& io, Link<Channel>& link, std::int64_t base_ns, std::uint32_t tick_ns) noexcept {
    link.enabled = flag(io, link.enabled);
    if (!link.enabled) return;
    scale(io, link.scale, Channel{});
    link.active = flag(io, link.active);
    link.stride = 0;
    if (!link.active) {
        link.models = {};
        return;
    }
    state<Channel>(io, link.models);
    // what is covered ends some time before now, and began at a knot some time before that
    const std::int64_t t0_ns = link.curve.span.t0_ns;
    auto open = static_cast<std::uint32_t>((base_ns - t0_ns) / tick_ns) + 1 - link.cover_ticks;
    mostly_small(io, open, 6);
    mostly_small(io, link.cover_ticks, 6);
    if constexpr (!Io::writes) {
        const std::int64_t back = std::int64_t{open} + link.cover_ticks - 1;
        link.curve.span.t0_ns = earlier(base_ns, back, tick_ns);
    }
    auto& c = link.curve.span.c;
    row(io, c[0], usual_value_width);
    std::uint32_t width = usual_width;
    for (std::size_t m = 1; m < Channel::order; ++m) width = row(io, c[m], width);
}

/// The start of a curve: its polynomial, rounded as `coarse` says.
template <class Io, class Channel>
void begin(Io& io, const Link<Channel>& link, std::uint8_t& coarse_out, Curve<Channel>& curve,
           std::int64_t base_ns, std::uint32_t tick_ns) noexcept {
    std::uint32_t coarse = coarse_out;
    io.bits(coarse, 5);
    coarse_out = static_cast<std::uint8_t>(coarse);
    const std::int64_t before_ns = link.active ? link.curve.span.t0_ns : base_ns;
    const std::int64_t apart = (curve.span.t0_ns - before_ns) / tick_ns;
    std::uint64_t ticks = zigzag64(apart);
    unsigned_number(io, ticks, 6);
    if constexpr (!Io::writes) curve.span.t0_ns = earlier(before_ns, -unzigzag64(ticks), tick_ns);
    std::uint32_t width = usual_width;
    for (std::size_t m = 0; m < Channel::order; ++m) {
        const int shift = start_shift(m, static_cast<int>(coarse));
        auto values = curve.span.c[m];
        for (auto& v : values) v >>= shift;
        width = row(io, values, width);
        if constexpr (!Io::writes)
            for (std::size_t d = 0; d < Channel::dimension; ++d)
                curve.span.c[m][d] =
                    static_cast<std::int32_t>(static_cast<std::uint32_t>(values[d]) << shift);
    }
}

/// How far the curve is final now: about as much further as the frame before said.
template <class Io, class Channel, std::size_t MaxKnots>
void cover(Io& io, Link<Channel>& link, Batch<Channel, MaxKnots>& batch,
           std::uint32_t covered) noexcept {
    std::uint32_t moved = 0;
    for (std::size_t i = 0; i < batch.size; ++i) moved += batch.knot[i].ticks;
    std::uint32_t stride = moved + batch.cover_ticks - covered;
    near_expected(io, stride, link.stride, link.stride > 0 ? 1 : 6);
    batch.cover_ticks = stride + covered - moved;
    link.stride = stride;
}

/// The knots of a frame, by which `curve` moves on. @return false where a reader met nonsense.
template <class Io, class Channel, std::size_t MaxKnots>
bool knots(Io& io, Curve<Channel>& curve, Batch<Channel, MaxKnots>& batch, std::uint32_t covered,
           std::uint32_t tick_ns, Models& models) noexcept {
    std::size_t n = 0;
    for (; flag(io, n < batch.size); ++n) {
        if (n == MaxKnots || !io.ok()) return false;
        auto& k = batch.knot[n];
        const std::uint32_t nearest = covered > 0 ? covered : 1;  // no knot in what is final
        std::uint32_t ticks = k.ticks - nearest;
        io.rice(ticks, models.ticks);
        k.ticks = ticks + nearest;
        covered = 0;
        curve.span = carried(curve.span, k.ticks, tick_ns);
        jump<Channel>(io, k, curve.span, models);
        if (k.shift == stop_shift)
            curve.halt();
        else
            curve.turn(k.jump, k.shift);
    }
    batch.size = n;
    return true;
}

/// What one frame says of one channel. @return false where a reader met nonsense.
template <class Io, class Channel, std::size_t MaxKnots>
bool content(Io& io, Link<Channel>& link, Batch<Channel, MaxKnots>& batch, std::int64_t base_ns,
             std::uint32_t tick_ns) noexcept {
    if constexpr (!Io::writes) {  // not `= {}`: clearing all knots costs more than a small frame
        batch.begins = batch.breaks = batch.covers = false;
        batch.size = 0;
    }
    // a payload starts with a zero: a reader that looks for a head will not take it for one
    const bool nothing = !(batch.begins || batch.size || batch.covers);
    if (!link.enabled || flag(io, nothing)) return io.ok();
    Curve<Channel> curve = link.curve;
    std::uint32_t covered = link.cover_ticks;
    if (flag(io, !batch.begins && batch.covers)) {  // as nearly always: one bit
        batch.covers = true;
    } else {
        batch.covers = flag(io, batch.covers);
        batch.begins = flag(io, batch.begins);
    }
    if (batch.begins) {
        batch.breaks = flag(io, batch.breaks);
        begin(io, link, batch.coarse, batch.start, base_ns, tick_ns);
        curve = batch.start;
        covered = 0;
    } else if (!link.active) {
        return false;
    }
    if (!knots(io, curve, batch, covered, tick_ns, link.models)) return false;
    if (batch.covers) cover(io, link, batch, covered);
    return io.ok();
}

/// Lets a link follow a batch: its start (step 0), then knot by knot. Both ends call it.
template <class Channel, std::size_t MaxKnots>
void follow_start(Link<Channel>& link, const Batch<Channel, MaxKnots>& batch) noexcept {
    if (!batch.begins) return;
    link.active = true;
    link.curve = batch.start;
    link.cover_ticks = 0;
}
template <class Channel, std::size_t MaxKnots>
void follow_knot(Link<Channel>& link, const Batch<Channel, MaxKnots>& batch, std::size_t i,
                 std::uint32_t tick_ns) noexcept {
    const auto& k = batch.knot[i];
    link.cover_ticks = 0;
    if (k.shift == stop_shift) return link.curve.stop(k.ticks, tick_ns);
    link.curve.advance(k.ticks, k.jump, k.shift, tick_ns);
}

/// Stream-wide facts at the head of a restart frame.
struct Header {
    std::uint32_t sequence{0};  // of it, what the mask leaves
    std::uint32_t tick_ns{0};
    std::int64_t base_ns{0};  // a tick of the grid of knots
};

template <class Io>
bool header(Io& io, Header& h) noexcept {
    std::uint32_t v = version;
    io.bits(v, 8);
    if (v != version) return false;
    std::uint32_t sequence = h.sequence & sequence_mask;
    io.bits(sequence, 8);
    duration(io, h.tick_ns);
    instant(io, h.base_ns);
    if constexpr (!Io::writes) h.sequence = sequence;
    return io.ok() && h.tick_ns > 0;
}

}  // namespace fairlead::earlier::wire
