#pragma once
// A span as the history carries it: the polynomial with which the decoder itself evaluates, so that
// a reader has the same curve bit for bit. Scaling by the channel's unit, a power of two, is exact.
#include <array>
#include <cstdint>

#include "fairlead/base/types.hpp"
#include "fairlead/reduce/evaluate.hpp"
#include "port/linux/registers.hpp"

namespace fairlead::port {

enum class CurveChannel : std::uint8_t { orientation = 0, position = 1 };

struct CurveSpan {
    CurveChannel channel{};
    bool begins{};  // nothing joins it to the span before it
    std::int64_t t0_ns{};
    std::uint32_t tick_ns{1};
    std::uint32_t cover_ticks{};
    std::array<std::array<float, 4>, 4> c{};  // w x y z of each power; a position has no w

    std::int64_t t1_ns() const noexcept {
        return t0_ns + std::int64_t{cover_ticks} * std::int64_t{tick_ns};
    }
    bool covers(std::int64_t t_ns) const noexcept { return t_ns >= t0_ns && t_ns < t1_ns(); }
};

namespace curve {

using Polynomial = fairlead::Polynomial<4, 4>;

inline Polynomial polynomial(const CurveSpan& span) noexcept {
    Polynomial p;
    p.c = span.c;
    return p;
}
inline float ticks(const CurveSpan& span, std::int64_t t_ns) noexcept {
    return ticks_between(span.t0_ns, t_ns, span.tick_ns);
}
inline Vec3 position(const CurveSpan& span, std::int64_t t_ns) noexcept {
    const auto y = polynomial(span)(ticks(span, t_ns));
    return {y[1], y[2], y[3]};
}
inline Vec3 velocity_m_s(const CurveSpan& span, std::int64_t t_ns) noexcept {
    const auto y = polynomial(span).derivative(ticks(span, t_ns), 1);
    const float per_second = 1e9f / static_cast<float>(span.tick_ns);
    return per_second * Vec3{y[1], y[2], y[3]};
}
inline Quat orientation(const CurveSpan& span, std::int64_t t_ns) noexcept {
    return OrientationChannel::value(polynomial(span)(ticks(span, t_ns)), {});
}
/// Body rate 2 vec(conj(p) dp/dt) / p.p of a quaternion polynomial p.
inline Vec3 rate_rad_s(const CurveSpan& span, std::int64_t t_ns) noexcept {
    const float u = ticks(span, t_ns);
    const Polynomial polynomial_of_span = polynomial(span);
    const auto y = polynomial_of_span(u);
    const auto y1 = polynomial_of_span.derivative(u, 1);
    const Quat p{y[0], y[1], y[2], y[3]}, p1{y1[0], y1[1], y1[2], y1[3]};
    const float square = dot(p, p);
    if (!(square > 0)) return {};
    return 2e9f / (static_cast<float>(span.tick_ns) * square) * vec(conj(p) * p1);
}

}  // namespace curve

namespace registers {

/// What every page begins with, and where it belongs.
struct PageHeader {
    std::uint32_t epoch{};
    std::uint32_t first{};
    std::uint16_t count{};
    std::uint16_t channel{};
    std::uint32_t tick_ns{};
};

namespace detail {

template <std::size_t Power, std::size_t Part>
float coefficient(const CurveSpan& span) noexcept {
    return span.c[Power][Part];
}
inline std::uint16_t span_flags(const CurveSpan& span) noexcept { return span.begins ? 1 : 0; }

}  // namespace detail

// ---- pages: a header, then records. Page k of a channel stands at its begin + 125 k, and span n
// in page (n / 3) mod 128. A page is read in one request and says itself where it belongs.
inline constexpr auto page_fields = rows({
    row<Type::u32, &PageHeader::epoch>(0, "epoch", "",
                                       "as unit.epoch; 0: the page was never written"),
    row<Type::u32, &PageHeader::first>(
        2, "first", "", "number of its first record, a multiple of the records per page"),
    row<Type::u16, &PageHeader::count>(4, "count", "",
                                       "records in it; fewer than full: the newest page"),
    row<Type::u16, &PageHeader::channel>(5, "channel", "", "0 orientation, 1 position, 2 events"),
    row<Type::u32, &PageHeader::tick_ns>(6, "tick_ns", "ns", "unit of time of the polynomials"),
});

/// With u = (t - t0_ns) / tick_ns and y = c0 + c1 u + c2 u^2 + c3 u^3:
/// position: x y z of y; orientation: y at unit length.
inline constexpr auto span_fields = rows({
    row<Type::i64, &CurveSpan::t0_ns>(0, "t0_ns", "ns", "its knot, on the source's clock"),
    row<Type::u32, &CurveSpan::cover_ticks>(
        4, "cover_ticks", "", "valid for 0 <= u < cover_ticks; grows while it is the newest"),
    row<Type::f32, detail::coefficient<0, 0>>(6, "c0_w", "m or 1",
                                              "value at the knot; 0 for a position"),
    row<Type::f32, detail::coefficient<0, 1>>(8, "c0_x", "m or 1", ""),
    row<Type::f32, detail::coefficient<0, 2>>(10, "c0_y", "m or 1", ""),
    row<Type::f32, detail::coefficient<0, 3>>(12, "c0_z", "m or 1", ""),
    row<Type::f32, detail::coefficient<1, 0>>(14, "c1_w", "per tick",
                                              "first Taylor coefficient; 0 for a position"),
    row<Type::f32, detail::coefficient<1, 1>>(16, "c1_x", "per tick", ""),
    row<Type::f32, detail::coefficient<1, 2>>(18, "c1_y", "per tick", ""),
    row<Type::f32, detail::coefficient<1, 3>>(20, "c1_z", "per tick", ""),
    row<Type::f32, detail::coefficient<2, 0>>(22, "c2_w", "per tick^2",
                                              "second Taylor coefficient; 0 for a position"),
    row<Type::f32, detail::coefficient<2, 1>>(24, "c2_x", "per tick^2", ""),
    row<Type::f32, detail::coefficient<2, 2>>(26, "c2_y", "per tick^2", ""),
    row<Type::f32, detail::coefficient<2, 3>>(28, "c2_z", "per tick^2", ""),
    row<Type::f32, detail::coefficient<3, 0>>(30, "c3_w", "per tick^3",
                                              "third Taylor coefficient; 0 for a position"),
    row<Type::f32, detail::coefficient<3, 1>>(32, "c3_x", "per tick^3", ""),
    row<Type::f32, detail::coefficient<3, 2>>(34, "c3_y", "per tick^3", ""),
    row<Type::f32, detail::coefficient<3, 3>>(36, "c3_z", "per tick^3", ""),
    row<Type::u16, detail::span_flags>(38, "flags", "bits", "1: joins no span before it"),
});
static_assert(in_order(page_fields, page_header));
static_assert(in_order(span_fields, span_size));

inline void put_span(std::uint16_t* at, const CurveSpan& span) noexcept {
    put_rows(span_fields, span, at);
}

inline CurveSpan get_span(const std::uint16_t* at, CurveChannel channel,
                          std::uint32_t tick_ns) noexcept {
    constexpr const Field& t0_ns = find(span_fields, "t0_ns");
    constexpr const Field& cover = find(span_fields, "cover_ticks");
    constexpr const Field& first = find(span_fields, "c0_w");
    constexpr const Field& last = find(span_fields, "c3_z");
    constexpr const Field& flags = find(span_fields, "flags");
    static_assert(last.address == first.address + 15 * width_of(Type::f32));  // in order of power
    CurveSpan span;
    span.channel = channel;
    span.tick_ns = tick_ns;
    span.t0_ns = static_cast<std::int64_t>(get_word(at, t0_ns));
    span.cover_ticks = static_cast<std::uint32_t>(get_word(at, cover));
    const std::uint16_t* value = at + first.address;
    for (auto& power : span.c) {
        for (float& component : power) {
            component = get_f32(value);
            value += width_of(Type::f32);
        }
    }
    span.begins = (get_word(at, flags) & 1u) != 0;
    return span;
}

inline void put_page_header(std::uint16_t* at, const PageHeader& header) noexcept {
    put_rows(page_fields, header, at);
}
inline PageHeader get_page_header(const std::uint16_t* at) noexcept {
    const auto u32 = [at](const Field& row) {
        return static_cast<std::uint32_t>(get_word(at, row));
    };
    const auto u16 = [at](const Field& row) {
        return static_cast<std::uint16_t>(get_word(at, row));
    };
    constexpr const Field& epoch = find(page_fields, "epoch");
    constexpr const Field& first = find(page_fields, "first");
    constexpr const Field& count = find(page_fields, "count");
    constexpr const Field& channel = find(page_fields, "channel");
    constexpr const Field& tick_ns = find(page_fields, "tick_ns");
    return {u32(epoch), u32(first), u16(count), u16(channel), u32(tick_ns)};
}

constexpr std::uint16_t history_begin(CurveChannel channel) noexcept {
    return channel == CurveChannel::orientation ? orientation_begin : position_begin;
}
/// Where the page stands that holds record n, and where in it the record stands.
constexpr std::uint16_t page_address(std::uint16_t begin, std::uint32_t n, std::uint16_t per_page,
                                     std::uint16_t pages) noexcept {
    return static_cast<std::uint16_t>(begin + (n / per_page) % pages * page_size);
}

}  // namespace registers
}  // namespace fairlead::port
