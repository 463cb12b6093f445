#pragma once
// A span as the history carries it: the polynomials of a channel between two vertices of its curve,
// in seconds and SI units, so that a reader needs a sum of powers and, for a rotation, one
// exponential.
//
// Axes of a position have vertices of their own; a span goes from one vertex of any axis to the
// next of any. Its numbers are floats: against the decoder's curve in double they are off by half a
// unit in the last place of the coordinate, and by 1e-6 of a rotation at most.
#include <array>
#include <cstdint>

#include "fairlead/base/types.hpp"
#include "fairlead/math/quat.hpp"
#include "fairlead/math/rotation_rates.hpp"
#include "port/linux/registers.hpp"

namespace fairlead::port {

enum class CurveChannel : std::uint8_t { orientation = 0, position = 1 };

struct CurveSpan {
    CurveChannel channel{};
    bool begins{};  // nothing joins it to the span before it
    std::int64_t t0_ns{};
    std::uint32_t sub_ns{1};      // unit of `cover`: a sub-tick of the stream
    std::uint32_t cover{};        // holds for 0 < t - t0_ns <= cover * sub_ns, in ns
    Quat anchor{};                // of an orientation
    std::array<Vec3, 4> power{};  // of u = (t - t0_ns) in seconds: position, or rotation vector

    std::int64_t t1_ns() const noexcept { return t0_ns + std::int64_t{cover} * sub_ns; }
    /// Behind its start up to its end; one that begins also at its start.
    bool covers(std::int64_t t_ns) const noexcept {
        return t_ns <= t1_ns() && (begins ? t_ns >= t0_ns : t_ns > t0_ns);
    }
};

namespace curve {

inline float seconds(const CurveSpan& span, std::int64_t t_ns) noexcept {
    return static_cast<float>(t_ns - span.t0_ns) * 1e-9f;
}
/// The polynomial and its two derivatives.
inline std::array<Vec3, 3> polynomial(const CurveSpan& span, std::int64_t t_ns) noexcept {
    const float u = seconds(span, t_ns);
    const auto& c = span.power;
    return {c[0] + u * (c[1] + u * (c[2] + u * c[3])), c[1] + u * (2.0f * c[2] + 3.0f * u * c[3]),
            2.0f * c[2] + 6.0f * u * c[3]};
}
inline Vec3 position(const CurveSpan& span, std::int64_t t_ns) noexcept {
    return polynomial(span, t_ns)[0];
}
inline Vec3 velocity_m_s(const CurveSpan& span, std::int64_t t_ns) noexcept {
    return polynomial(span, t_ns)[1];
}
inline Quat orientation(const CurveSpan& span, std::int64_t t_ns) noexcept {
    return normalised(span.anchor * from_rotation_vector(polynomial(span, t_ns)[0]));
}
/// Angular rate of the body.
inline Vec3 rate_rad_s(const CurveSpan& span, std::int64_t t_ns) noexcept {
    const auto theta = polynomial(span, t_ns);
    return rotation_motion(theta[0], theta[1], theta[2]).velocity;
}

}  // namespace curve

namespace registers {

/// What every page begins with, and where it belongs.
struct PageHeader {
    std::uint32_t epoch{};
    std::uint32_t first{};
    std::uint16_t count{};
    std::uint16_t channel{};
    std::uint32_t sub_ns{};
};

namespace detail {

template <std::size_t Power, float Vec3::*Part>
float coefficient(const CurveSpan& span) noexcept {
    return span.power[Power].*Part;
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
    row<Type::u32, &PageHeader::sub_ns>(6, "sub_ns", "ns", "unit of the spans' cover"),
});

/// With u = (t - t0_ns) in seconds and y = c0 + c1 u + c2 u^2 + c3 u^3: a position is y; an
/// orientation is anchor * exp(y), where exp turns by |y| rad about y.
inline constexpr auto span_fields = rows({
    row<Type::i64, &CurveSpan::t0_ns>(0, "t0_ns", "ns", "its start, on the source's clock"),
    row<Type::u32, &CurveSpan::cover>(4, "cover", "sub_ns",
                                      "valid for 0 < t - t0_ns <= cover * sub_ns"),
    row<Type::f32, &CurveSpan::anchor, &Quat::w>(
        6, "anchor_w", "1", "unit quaternion of an orientation; 1 0 0 0 for a position"),
    row<Type::f32, &CurveSpan::anchor, &Quat::x>(8, "anchor_x", "1", ""),
    row<Type::f32, &CurveSpan::anchor, &Quat::y>(10, "anchor_y", "1", ""),
    row<Type::f32, &CurveSpan::anchor, &Quat::z>(12, "anchor_z", "1", ""),
    row<Type::f32, detail::coefficient<0, &Vec3::x>>(14, "c0_x", "m or rad", "value at the start"),
    row<Type::f32, detail::coefficient<0, &Vec3::y>>(16, "c0_y", "m or rad", ""),
    row<Type::f32, detail::coefficient<0, &Vec3::z>>(18, "c0_z", "m or rad", ""),
    row<Type::f32, detail::coefficient<1, &Vec3::x>>(20, "c1_x", "m/s or rad/s",
                                                     "first derivative"),
    row<Type::f32, detail::coefficient<1, &Vec3::y>>(22, "c1_y", "m/s or rad/s", ""),
    row<Type::f32, detail::coefficient<1, &Vec3::z>>(24, "c1_z", "m/s or rad/s", ""),
    row<Type::f32, detail::coefficient<2, &Vec3::x>>(26, "c2_x", "m/s^2 or rad/s^2",
                                                     "half of the second derivative"),
    row<Type::f32, detail::coefficient<2, &Vec3::y>>(28, "c2_y", "m/s^2 or rad/s^2", ""),
    row<Type::f32, detail::coefficient<2, &Vec3::z>>(30, "c2_z", "m/s^2 or rad/s^2", ""),
    row<Type::f32, detail::coefficient<3, &Vec3::x>>(32, "c3_x", "m/s^3 or rad/s^3",
                                                     "a sixth of the third derivative"),
    row<Type::f32, detail::coefficient<3, &Vec3::y>>(34, "c3_y", "m/s^3 or rad/s^3", ""),
    row<Type::f32, detail::coefficient<3, &Vec3::z>>(36, "c3_z", "m/s^3 or rad/s^3", ""),
    row<Type::u16, detail::span_flags>(38, "flags", "bits",
                                       "1: joins no span before it, and is valid at t0_ns too"),
});
static_assert(in_order(page_fields, page_header));
static_assert(in_order(span_fields, span_size));

inline void put_span(std::uint16_t* at, const CurveSpan& span) noexcept {
    put_rows(span_fields, span, at);
}

inline CurveSpan get_span(const std::uint16_t* at, CurveChannel channel,
                          std::uint32_t sub_ns) noexcept {
    constexpr const Field& t0_ns = find(span_fields, "t0_ns");
    constexpr const Field& cover = find(span_fields, "cover");
    constexpr const Field& anchor = find(span_fields, "anchor_w");
    constexpr const Field& first = find(span_fields, "c0_x");
    constexpr const Field& last = find(span_fields, "c3_z");
    constexpr const Field& flags = find(span_fields, "flags");
    constexpr std::uint16_t wide = width_of(Type::f32);
    static_assert(first.address == anchor.address + 4 * wide);
    static_assert(last.address == first.address + 11 * wide);  // in order of power
    CurveSpan span;
    span.channel = channel;
    span.sub_ns = sub_ns;
    span.t0_ns = static_cast<std::int64_t>(get_word(at, t0_ns));
    span.cover = static_cast<std::uint32_t>(get_word(at, cover));
    const auto number = [at](unsigned address) { return get_f32(at + address); };
    span.anchor = {number(anchor.address), number(anchor.address + wide),
                   number(anchor.address + 2u * wide), number(anchor.address + 3u * wide)};
    for (unsigned k = 0; k < 4; ++k) {
        const unsigned from = first.address + 3u * k * wide;
        span.power[k] = {number(from), number(from + wide), number(from + 2u * wide)};
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
    constexpr const Field& sub_ns = find(page_fields, "sub_ns");
    return {u32(epoch), u32(first), u16(count), u16(channel), u32(sub_ns)};
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
