#pragma once
// The channels of a stream as tracks: an axis of a vector is a track of its own, a rotation is one.
// What a coder knows of them, where their curves are, and how a frame tells an absolute place.
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "fairlead/code/model.hpp"
#include "fairlead/code/range_coder.hpp"
#include "fairlead/code/tables.hpp"
#include "fairlead/curve/cubic_state.hpp"
#include "fairlead/curve/rotation.hpp"
#include "fairlead/curve/scale.hpp"
#include "fairlead/wire/header.hpp"

namespace fairlead::wire {

/// A channel as its tracks: an axis is a track of its own, a rotation is one track.
struct TrackRange {
    bool rotates{false};
    std::uint8_t first{0}, count{0};  // axes, or one rotation
    std::uint8_t kind{0};
    std::uint16_t tolerance{0};  // over the step, in 1/32768
};

/// The origin of an orientation, from its numbers in the header. @return false: not on the grid.
constexpr bool origin_of(const ChannelShape& c, curve::GridQuat& g, std::int32_t most) noexcept {
    bool good = true;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::int32_t n = i == 0 ? c.origin[0] >> 2 : c.origin[i];
        good = good && n <= most && n >= -most;
        g.n[i] = static_cast<std::int16_t>(good ? n : 0);
    }
    g.largest = static_cast<std::uint8_t>(c.origin[0] & 3);
    return good;
}
/// The way back.
constexpr void put_origin(ChannelShape& c, const curve::GridQuat& g) noexcept {
    c.origin[0] = 4 * g.n[0] + g.largest;
    c.origin[1] = g.n[1];
    c.origin[2] = g.n[2];
}

/// The channels of a stream, as a coder of at most Axes axes and Rotations rotations holds them.
template <std::size_t Axes, std::size_t Rotations>
struct Tracks {
    static constexpr std::size_t channels_most =
        Axes + Rotations < channels_max ? Axes + Rotations : channels_max;
    std::uint8_t channels{0};
    std::array<TrackRange, channels_most> channel{};
    std::array<curve::Scale, Axes> scale{};
    std::array<curve::Scale, Rotations> turn{};
    // what absolute values are told against
    std::array<std::int32_t, Axes> origin{};
    std::array<curve::GridQuat, Rotations> turn_origin{};

    /// Lays out the channels of a stream. @return false: there are more than fit, or a step is out
    /// of range.
    bool take(const StreamShape& shape) noexcept {
        *this = {};
        if (shape.channels > channels_most) return false;
        std::size_t axes = 0, rotations = 0;
        for (; channels < shape.channels; ++channels) {
            const ChannelShape& c = shape.channel[channels];
            const bool rotates = c.type == ChannelType::orientation;
            const std::size_t count = rotates ? 1 : c.axes;
            std::size_t& first = rotates ? rotations : axes;
            channel[channels] = {rotates, static_cast<std::uint8_t>(first),
                                 static_cast<std::uint8_t>(count), c.kind, c.tolerance};
            for (std::size_t i = 0; i < count; ++i, ++first)
                if (!set(rotates, first, i, c)) return false;
        }
        return true;
    }
    float step(std::size_t rotation) const noexcept {
        return turn[rotation].template step<float>();
    }
    /// Are its pieces cubics? Known when compiled where only one kind exists.
    template <class Kinds>
    static constexpr bool cubic(const TrackRange& range) noexcept {
        if constexpr (!Kinds::cubics || Axes == 0)
            return false;
        else if constexpr (!Kinds::quadratics)
            return !turns(range);
        else
            return !turns(range) && range.kind == curve::Cubics::id;
    }
    /// range.rotates, known when compiled where only one sort of tracks exists.
    static constexpr bool turns(const TrackRange& range) noexcept {
        return Rotations > 0 && (Axes == 0 || range.rotates);
    }
    const curve::Scale& scale_of(const TrackRange& range, std::size_t track) const noexcept {
        if constexpr (Rotations == 0)
            return scale[range.first + track];
        else if constexpr (Axes == 0)
            return turn[range.first];
        else
            return range.rotates ? turn[range.first] : scale[range.first + track];
    }

  private:
    /// One axis, or the rotation, of a channel: its step and its origin.
    bool set(bool rotates, std::size_t at, std::size_t i, const ChannelShape& c) noexcept {
        const curve::Scale& s = c.step[i];
        if (at >= (rotates ? Rotations : Axes) || !curve::Scale::valid(s.m, s.e)) return false;
        if constexpr (Rotations > 0)
            if (rotates) {
                turn[at] = s;
                const float size = step(at);
                return curve::rotation_step_valid(size) &&
                       origin_of(c, turn_origin[at], curve::grid_size(size));
            }
        if constexpr (Axes > 0) {
            scale[at] = s;
            origin[at] = c.origin[i];
        }
        return true;
    }
};

/// The kinds of pieces that a coder knows. What it does not know costs nothing.
template <class... Kinds>
struct KindSet {
    static constexpr bool cubics = (Kinds::cubic || ...), quadratics = (!Kinds::cubic || ...);
    static constexpr bool has(std::uint8_t id) noexcept { return ((Kinds::id == id) || ...); }

    /// The tables of a kind of quadratics that has() knows.
    template <std::size_t N>
    static constexpr code::CostsView costs(std::uint8_t id) noexcept {
        code::CostsView view{code::costs<typename FirstQuadratic<Kinds...>::Type, N>};
        (choose<Kinds, N>(id, view), ...);
        return view;
    }

  private:
    template <class Kind, class... Others>
    struct FirstQuadratic {
        using Type = typename std::conditional_t<Kind::cubic, FirstQuadratic<Others...>,
                                                 FirstQuadratic<Kind>>::Type;
    };
    template <class Kind>
    struct FirstQuadratic<Kind> {
        using Type = Kind;
    };
    template <class Kind, std::size_t N>
    static constexpr void choose(std::uint8_t id, code::CostsView& view) noexcept {
        if constexpr (!Kind::cubic)
            if (Kind::id == id) view = code::CostsView{code::costs<Kind, N>};
    }
};

namespace detail {
template <std::size_t Axes>
struct CubicAxes {
    std::array<curve::CubicState<1>, Axes> cubic{};  // of an axis of cubics
};
template <>
struct CubicAxes<0> {};
}  // namespace detail

/// Where the curves are: all that the next frame's content depends on.
template <std::size_t Axes, std::size_t Rotations, class Kinds>
struct TrackStates : detail::CubicAxes<Kinds::cubics ? Axes : 0> {
    std::array<curve::State<1>, Kinds::quadratics ? Axes : 0> axis{};
    std::array<curve::RotationState, Rotations> rotation{};
    std::uint8_t live{0};    // a bit for each channel: its curve goes on
    std::uint8_t hidden{0};  // likewise: a reader joined, the slope at the curve's end is not known

    [[gnu::noinline]] TrackStates() noexcept {}  // one code for all that begin anew

    /// Of a track of quadratics.
    FAIRLEAD_SMALL curve::StateView track(const TrackRange& range, std::size_t track) noexcept {
        if constexpr (Rotations == 0)
            return axis[range.first + track].view();
        else if constexpr (Axes == 0)
            return rotation[range.first].chart.view();
        else
            return range.rotates ? rotation[range.first].chart.view()
                                 : axis[range.first + track].view();
    }
};

/// Absolute places of curves as a frame tells them, channel by channel: the values of a vector, a
/// rotation on the grid.
template <std::size_t Axes, std::size_t Rotations>
struct Places {
    std::array<std::int32_t, Axes> value{};
    std::array<curve::GridQuat, Rotations> grid{};
};

namespace detail {
/// Common number of bits of n numbers, |v| < 2^31.
constexpr std::uint32_t width_of(const std::int32_t* v, std::size_t n) noexcept {
    std::uint32_t all = 0;
    for (std::size_t i = 0; i < n; ++i) all |= static_cast<std::uint32_t>(v[i] < 0 ? -v[i] : v[i]);
    return code::bit_count(all);
}
/// A number of bits, 0 to 31: often 0, rarely above 15.
template <class Io>
constexpr void code_width(Io& io, std::uint32_t& width) noexcept {
    bool some = width != 0;
    io.flag(some, 1, 1);
    if (!some) {
        width = 0;
        return;
    }
    std::uint32_t low = width < 16 ? width - 1 : 15, high = width - 16;
    io.bits(low, 4);
    if (low == 15) io.bits(high, 4);
    width = low == 15 ? 16 + high : low + 1;
}
/// n numbers in lattice steps, |v| < 2^31: their common number of bits, then each with its sign.
template <class Io>
constexpr void code_values(Io& io, std::int32_t* v, std::size_t n) noexcept {
    std::uint32_t width = Io::writes ? width_of(v, n) : 0;
    code_width(io, width);
    for (std::size_t i = 0; i < n; ++i) {
        auto size = static_cast<std::uint32_t>(v[i] < 0 ? -v[i] : v[i]);
        io.bits(size, width);
        bool minus = v[i] < 0;
        if (size != 0) io.flag(minus, 1, 1);
        v[i] = static_cast<std::int32_t>(size);
        if (size != 0 && minus) v[i] = -v[i];
    }
}
/// The same, told against an origin. @return false: beyond vertex_max.
template <class Io>
constexpr bool code_values(Io& io, std::int32_t* v, const std::int32_t* origin,
                           std::size_t n) noexcept {
    for (std::size_t i = 0; Io::writes && i < n; ++i) v[i] -= origin[i];
    code_values(io, v, n);
    for (std::size_t i = 0; i < n; ++i) {
        const std::int64_t sum = std::int64_t{v[i]} + origin[i];
        if (sum > curve::vertex_max || sum < -curve::vertex_max) return false;
        v[i] = static_cast<std::int32_t>(sum);
    }
    return true;
}

/// v of n equally likely numbers; 0 < n <= 2^20. @return false where the bytes tell none of them.
template <class Io>
constexpr bool code_uniform(Io& io, std::uint32_t& v, std::uint32_t n) noexcept {
    std::uint32_t low = v & 0xffu, high = n > 4096 ? v >> 8 : v;
    const std::uint32_t highs = n > 4096 ? (n + 255u) >> 8 : n;
    const std::uint32_t width = (1u << code::total_bits_max) / highs;
    if constexpr (Io::writes) {
        if (high >= highs) return false;
        io.put(high * width, width, code::total_bits_max);
    } else {
        high = io.peek(code::total_bits_max) / width;
        if (high >= highs) return false;
        io.take(high * width, width, code::total_bits_max);
    }
    if (n > 4096) io.bits(low, 8);
    v = n > 4096 ? high << 8 | low : high;
    return v < n;
}

/// A place on the grid: near the origin by the differences, elsewhere as it is.
template <class Io>
constexpr bool code_grid(Io& io, curve::GridQuat& g, const curve::GridQuat& origin,
                         float step) noexcept {
    const std::int32_t most = curve::grid_size(step);
    std::int32_t apart[3]{};
    bool elsewhere = false;
    if constexpr (Io::writes) {
        for (std::size_t i = 0; i < 3; ++i) apart[i] = g.n[i] - origin.n[i];
        elsewhere = g.largest != origin.largest ||
                    width_of(apart, 3) + 2 > code::bit_count(static_cast<std::uint32_t>(most));
    }
    io.flag(elsewhere, 1, 1);
    if (!elsewhere) {
        code_values(io, apart, 3);
        g.largest = origin.largest;
        bool inside = true;
        for (std::size_t i = 0; i < 3; ++i) {
            inside = inside && apart[i] <= 2 * most && apart[i] >= -2 * most;
            const std::int32_t n = inside ? origin.n[i] + apart[i] : 0;
            inside = inside && n <= most && n >= -most;
            g.n[i] = static_cast<std::int16_t>(inside ? n : 0);
        }
        return inside;
    }
    std::uint32_t largest = g.largest;
    io.bits(largest, 2);
    g.largest = static_cast<std::uint8_t>(largest);
    for (auto& n : g.n) {
        auto v = static_cast<std::uint32_t>(n + most);
        if (!code_uniform(io, v, static_cast<std::uint32_t>(2 * most + 1))) return false;
        n = static_cast<std::int16_t>(static_cast<std::int32_t>(v) - most);
    }
    return true;
}

template <class Io>
constexpr bool code_tick(Io& io, std::uint8_t& tick, std::uint32_t from,
                         std::uint32_t to) noexcept {
    auto v = static_cast<std::uint32_t>(tick - from);
    if (!code_uniform(io, v, to - from + 1)) return false;
    tick = static_cast<std::uint8_t>(from + v);
    return true;
}
}  // namespace detail

}  // namespace fairlead::wire
