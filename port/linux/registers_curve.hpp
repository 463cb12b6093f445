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

inline void put_span(std::uint16_t* at, const CurveSpan& span) noexcept {
    Writer writer{at, span_fields};
    writer.i64(span.t0_ns).u32(span.cover_ticks);
    for (const auto& power : span.c) writer.f32(power[0]).f32(power[1]).f32(power[2]).f32(power[3]);
    writer.u16(span.begins ? 1u : 0u);
}

inline CurveSpan get_span(const std::uint16_t* at, CurveChannel channel,
                          std::uint32_t tick_ns) noexcept {
    CurveSpan span;
    span.channel = channel;
    span.tick_ns = tick_ns;
    span.t0_ns = static_cast<std::int64_t>(get(at, 4));
    span.cover_ticks = static_cast<std::uint32_t>(get(at + 4, 2));
    const std::uint16_t* value = at + 6;
    for (auto& power : span.c) {
        for (float& component : power) {
            component = get_f32(value);
            value += 2;
        }
    }
    span.begins = (value[0] & 1u) != 0;
    return span;
}

struct PageHeader {
    std::uint32_t epoch{};
    std::uint32_t first{};
    std::uint16_t count{};
    std::uint16_t channel{};
    std::uint32_t tick_ns{};
};
inline void put_page_header(std::uint16_t* at, const PageHeader& h) noexcept {
    Writer{at, page_fields}.u32(h.epoch).u32(h.first).u16(h.count).u16(h.channel).u32(h.tick_ns);
}
inline PageHeader get_page_header(const std::uint16_t* at) noexcept {
    return {static_cast<std::uint32_t>(get(at, 2)), static_cast<std::uint32_t>(get(at + 2, 2)),
            at[4], at[5], static_cast<std::uint32_t>(get(at + 6, 2))};
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
