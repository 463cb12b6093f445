#pragma once
// What stands in a frame, written down once for both directions. docs/formats.md tells it in prose.
//
//   data frame     length (1 byte, or 2 with the top bits 10), payload, CRC-16 seeded with the
//   sequence number restart frame  length (2 bytes, top bits 11), payload that starts with the
//   whole state, CRC-16 payload        [restart: header, one state per channel], then per channel:
//   begin?, knots, cover
//
// The sequence number of a data frame is not sent: it seeds the CRC, so that a lost or repeated
// frame is noticed like a damaged one. Restart frames carry it. Only there a decoder that is out of
// step gets in.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/reduce/reducer.hpp"
#include "fairlead/wire/bits.hpp"
#include "fairlead/wire/crc.hpp"

namespace fairlead::wire {

inline constexpr std::uint32_t version = 0xF1;
inline constexpr std::size_t max_payload = 480;
inline constexpr std::size_t max_frame = max_payload + 4;
inline constexpr std::uint16_t restart_seed = 0xFA1E;

/// Adaptive codes of one channel; reset to a few bits of themselves at restart points.
struct Models {
    RiceModel ticks{}, shift{}, cover{};
    std::array<RiceModel, 2> jump{};
    std::int32_t last_shift{12};
};

template <class Io>
bool flag(Io& io, bool value) noexcept {
    std::uint32_t v = value;
    io.bits(v, 1);
    return v != 0;
}

template <class Io>
void unsigned_number(Io& io, std::uint64_t& v, unsigned length_bits) noexcept {
    std::uint32_t width = bit_width(v);
    io.bits(width, length_bits);
    std::uint64_t out = 0;
    for (std::uint32_t done = 0; done < width && done < 64;) {
        const std::uint32_t part = width - done < 32 ? width - done : 32;
        auto piece = static_cast<std::uint32_t>(v >> (width - done - part));
        io.bits(piece, part);
        out = (out << part) | (part < 32 ? piece & ((1u << part) - 1u) : piece);
        done += part;
    }
    if constexpr (!Io::writes) v = out;
}

/// A row of signed numbers of one common width.
template <class Io, std::size_t D>
void row(Io& io, std::array<std::int32_t, D>& values) noexcept {
    std::uint32_t width = 0;
    if constexpr (Io::writes)
        for (const auto v : values) {
            const std::uint32_t w = bit_width(zigzag(v));
            width = w > width ? w : width;
        }
    io.bits(width, 6);
    if (width > 32) width = 32;
    for (auto& v : values) {
        std::uint32_t z = zigzag(v);
        io.bits(z, width);
        if constexpr (!Io::writes) v = unzigzag(z);
    }
}

template <class Io, std::size_t D, std::size_t Order>
void scale(Io& io, typename VectorChannel<D, Order>::Scale& s, VectorChannel<D, Order>) noexcept {
    for (auto& e : s.exponent) {
        auto biased = static_cast<std::uint32_t>(e + 64);
        io.bits(biased, 7);
        if constexpr (!Io::writes)
            e = static_cast<std::int8_t>(static_cast<std::int32_t>(biased) - 64);
    }
}
template <class Io>
void scale(Io& io, OrientationChannel::Scale& s, OrientationChannel) noexcept {
    auto biased = static_cast<std::uint32_t>(s.exponent + 64);
    io.bits(biased, 7);
    if constexpr (!Io::writes)
        s.exponent = static_cast<std::int8_t>(static_cast<std::int32_t>(biased) - 64);
}

/// Both ends' picture of one channel: what has been sent of its curve.
template <class Channel>
struct Link {
    typename Channel::Scale scale{};
    bool active{false};  // a curve has begun
    Curve<Channel> curve{};
    std::uint32_t cover_ticks{0};  // final before this, after the curve's last knot
    Models models{};
};

/// Everything that a late joiner needs of a channel. The time goes back from base_ns.
template <class Io, class Channel>
void state(Io& io, Link<Channel>& link, std::int64_t base_ns, std::uint32_t tick_ns) noexcept {
    scale(io, link.scale, Channel{});
    link.active = flag(io, link.active);
    Models& models = link.models;
    for (RiceModel* m :
         {&models.ticks, &models.shift, &models.cover, &models.jump[0], &models.jump[1]}) {
        std::uint32_t v = m->summary();
        io.bits(v, 5);
        m->restore(v);
    }
    auto shift = static_cast<std::uint32_t>(models.last_shift);
    io.bits(shift, 5);
    models.last_shift = static_cast<std::int32_t>(shift);
    if (!link.active) return;
    auto back = static_cast<std::uint64_t>((base_ns - link.curve.span.t0_ns) / tick_ns);
    unsigned_number(io, back, 6);
    if constexpr (!Io::writes)
        link.curve.span.t0_ns = base_ns - static_cast<std::int64_t>(back * tick_ns);
    std::uint64_t cover = link.cover_ticks;
    unsigned_number(io, cover, 6);
    link.cover_ticks = static_cast<std::uint32_t>(cover);
    for (auto& c : link.curve.span.c) row(io, c);
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
    if constexpr (!Io::writes) curve.span.t0_ns = before_ns + unzigzag64(ticks) * tick_ns;
    for (std::size_t m = 0; m < Channel::order; ++m) {
        const int shift = start_shift(m, static_cast<int>(coarse));
        auto values = curve.span.c[m];
        for (auto& v : values) v >>= shift;
        row(io, values);
        if constexpr (!Io::writes)
            for (std::size_t d = 0; d < Channel::dimension; ++d)
                curve.span.c[m][d] =
                    static_cast<std::int32_t>(static_cast<std::uint32_t>(values[d]) << shift);
    }
}

template <class Channel, class Io, class Knot>
void knot(Io& io, Knot& k, Models& models) noexcept {
    std::uint32_t ticks = k.ticks - 1;
    io.rice(ticks, models.ticks);
    k.ticks = ticks + 1;
    const std::int32_t before = models.last_shift;
    std::uint32_t change = zigzag(static_cast<std::int32_t>(k.shift) - before);
    io.rice(change, models.shift);
    models.last_shift = (models.last_shift + unzigzag(change)) & 31;
    k.shift = static_cast<std::uint8_t>(models.last_shift);
    if (k.shift == stop_shift) {
        models.last_shift = before;
        return;
    }
    for (std::size_t d = 0; d < Channel::dimension; ++d) {
        std::uint32_t z = zigzag(k.jump[d]);
        io.rice(z, models.jump[Channel::model(d)]);
        k.jump[d] = unzigzag(z);
    }
}

/// What one frame says of one channel. @return false where a reader met nonsense.
template <class Io, class Channel, std::size_t MaxKnots>
bool content(Io& io, Link<Channel>& link, Batch<Channel, MaxKnots>& batch, std::int64_t base_ns,
             std::uint32_t tick_ns) noexcept {
    if (!flag(io, batch.begins || batch.size || batch.covers)) return io.ok();
    batch.begins = flag(io, batch.begins);
    if (batch.begins) {
        batch.breaks = flag(io, batch.breaks);
        begin(io, link, batch.coarse, batch.start, base_ns, tick_ns);
    } else if (!link.active) {
        return false;
    }
    std::size_t n = 0;
    while (flag(io, n < batch.size)) {
        if (n == MaxKnots || !io.ok()) return false;
        knot<Channel>(io, batch.knot[n], link.models);
        ++n;
    }
    batch.size = n;
    batch.covers = flag(io, batch.covers);
    if (batch.covers) {
        const std::uint32_t from = batch.begins || batch.size ? 0 : link.cover_ticks;
        std::uint32_t more = batch.cover_ticks - from;
        io.rice(more, link.models.cover);
        batch.cover_ticks = from + more;
    }
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
    std::uint32_t sequence{0};  // low 16 bits are sent
    std::uint32_t tick_ns{0};
    std::int64_t base_ns{0};  // a tick of the grid of knots
};

template <class Io>
bool header(Io& io, Header& h) noexcept {
    std::uint32_t v = version;
    io.bits(v, 8);
    if (v != version) return false;
    std::uint32_t sequence = h.sequence & 0xffffu;
    io.bits(sequence, 16);
    std::uint64_t tick = h.tick_ns, base = zigzag64(h.base_ns);
    unsigned_number(io, tick, 6);
    unsigned_number(io, base, 7);
    if constexpr (!Io::writes) {
        h.sequence = sequence;
        h.tick_ns = static_cast<std::uint32_t>(tick);
        h.base_ns = unzigzag64(base);
    }
    return io.ok() && h.tick_ns > 0;
}

}  // namespace fairlead::wire
