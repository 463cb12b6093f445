#pragma once
// The channels of a stream as tracks: an axis of a vector is a track of its own, a rotation is one.
// What a coder knows of them, where their curves are, and how a frame tells an absolute place.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/code/model.hpp"
#include "fairlead/code/range_coder.hpp"
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

/// The channels of a stream, as a coder of at most Axes axes and Rotations rotations holds them.
template <std::size_t Axes, std::size_t Rotations>
struct Tracks {
    static constexpr std::size_t channels_most =
        Axes + Rotations < channels_max ? Axes + Rotations : channels_max;
    std::uint8_t channels{0};
    std::array<TrackRange, channels_most> channel{};
    std::array<curve::Scale, Axes> scale{};
    std::array<curve::Scale, Rotations> turn{};

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
                if (!set_scale(rotates, first, c.step[i])) return false;
        }
        return true;
    }
    float step(std::size_t rotation) const noexcept {
        return turn[rotation].template step<float>();
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
    bool set_scale(bool rotates, std::size_t at, const curve::Scale& s) noexcept {
        if (at >= (rotates ? Rotations : Axes) || !curve::Scale::valid(s.m, s.e)) return false;
        if constexpr (Rotations > 0)
            if (rotates) {
                turn[at] = s;
                return curve::rotation_step_valid(s.template step<float>());
            }
        if constexpr (Axes > 0) scale[at] = s;
        return true;
    }
};

/// Where the curves are: all that the next frame's content depends on.
template <std::size_t Axes, std::size_t Rotations>
struct TrackStates {
    std::array<curve::State<1>, Axes> axis{};
    std::array<curve::RotationState, Rotations> rotation{};
    std::uint8_t live{0};    // a bit for each channel: its curve goes on
    std::uint8_t hidden{0};  // likewise: a reader joined, the slope at the curve's end is not known

    [[gnu::noinline]] TrackStates() noexcept {}  // one code for all that begin anew

    curve::StateView track(const TrackRange& range, std::size_t track) noexcept {
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
/// n numbers in lattice steps, |v| < 2^31: their common number of bits, then each with its sign.
template <class Io>
constexpr bool code_values(Io& io, std::int32_t* v, std::size_t n) noexcept {
    std::uint32_t all = 0;
    for (std::size_t i = 0; i < n; ++i) all |= static_cast<std::uint32_t>(v[i] < 0 ? -v[i] : v[i]);
    std::uint32_t width = code::bit_count(all);
    io.bits(width, 5);
    for (std::size_t i = 0; i < n; ++i) {
        auto size = static_cast<std::uint32_t>(v[i] < 0 ? -v[i] : v[i]);
        io.bits(size, width);
        bool minus = v[i] < 0;
        if (size != 0) io.flag(minus, 1, 1);
        v[i] = static_cast<std::int32_t>(size);
        if (size != 0 && minus) v[i] = -v[i];
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

template <class Io>
constexpr bool code_grid(Io& io, curve::GridQuat& g, float step) noexcept {
    const std::int32_t most = curve::grid_size(step);
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
