#pragma once
// What a data frame says behind its head: which channels are live, absolute values where a reader
// may start, and the pieces of each curve. One description for both directions, a piece at a time,
// so that an encoder can spread its work over pushes and a decoder can stop between pieces.
//
//   for each channel   [independent: live at the start? values and slopes there]  live at the end?
//                      [restart: values at the end]
//   for each channel   [its curve ended with the frame before?] [it ends early: its last tick]
//                      [it starts: first tick, values]
//   for each channel, for each axis   pieces until the channel's end
//
// docs/stream.md, Content.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/code/pieces.hpp"
#include "fairlead/code/tables.hpp"
#include "fairlead/curve/rotation.hpp"
#include "fairlead/curve/scale.hpp"
#include "fairlead/wire2/frame_head.hpp"

namespace fairlead::wire2 {

/// A channel as its tracks: an axis is a track of its own, a rotation is one track.
struct TrackRange {
    bool rotates{false};
    std::uint8_t first{0}, count{0};  // axes, or one rotation
    std::uint8_t kind{0};
};

/// The step of a scale as a float, exact, without double arithmetic.
inline float step_of(const curve::Scale& scale) noexcept {
    const auto exponent = static_cast<std::uint32_t>(scale.e + 127) << 23;
    return static_cast<float>(scale.m) * approx::detail::bit_cast<float>(exponent);
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

    float step(std::size_t rotation) const noexcept { return step_of(turn[rotation]); }
};

/// Where the curves are: all that the next frame's content depends on.
template <std::size_t Axes, std::size_t Rotations>
struct TrackStates {
    std::array<curve::State<1>, Axes> axis{};
    std::array<curve::RotationState, Rotations> rotation{};
    std::uint8_t live{0};    // a bit for each channel: its curve goes on
    std::uint8_t hidden{0};  // likewise: a reader joined, the slope at the curve's end is not known
};

/// What a frame says of one channel. Ticks count from the start of the frame.
struct ChannelFrame {
    bool goes_on{false};  // its curve is live at the end of the frame
    bool starts{false};   // its curve starts in the frame
    bool present{false};  // part of the frame belongs to a curve
    bool over{false};     // the curve that was live ended with the frame before
    std::uint8_t start_tick{0}, end_tick{0};
};

/// How a reader stands to a frame.
enum class Reading : std::uint8_t {
    in_step,  // knows the state at its start; also what an encoder does
    lone,     // an independent frame: takes the state at its start from the frame
    joining,  // a restart frame: takes the state at its end, and can read no more than that
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

/// The pieces of all kinds that a coder knows. One kind costs the tables of that kind alone.
template <class... Kinds>
struct KindSet {
    static constexpr bool has(std::uint8_t id) noexcept { return ((Kinds::id == id) || ...); }

    template <class Io, std::size_t N>
    static constexpr bool piece(std::uint8_t id, Io& io, curve::State<N>& state,
                                curve::Piece<N>& piece, std::int32_t left, code::End end,
                                const std::int32_t* told) noexcept {
        bool good = false;
        static_cast<void>(
            ((Kinds::id == id && (good = code::code_piece<Kinds>(io, code::costs<Kinds, N>, state,
                                                                 piece, left, end, told),
                                  true)) ||
             ...));
        return good;
    }
};

/// Codes the content of one frame. Io: code::RangeEncoder, code::RangeDecoder or code::Counter.
template <class Io, std::size_t Axes, std::size_t Rotations, class Kinds>
class Content {
  public:
    using Layout = Tracks<Axes, Rotations>;
    using States = TrackStates<Axes, Rotations>;
    static constexpr std::size_t channels_most = Layout::channels_most;

    /// Where coding stands: the track whose piece comes next.
    struct Place {
        std::uint8_t channel{0}, track{0};  // of the channel's tracks
        std::int32_t left{0};               // sub-ticks to the channel's end in this frame
        bool rebased{false};                // the piece before was a rebase
    };

    std::array<ChannelFrame, channels_most> channel{};  // an encoder fills these two first
    std::array<std::int32_t, Axes> told{};              // values at the end, of a restart frame
    std::array<curve::GridQuat, Rotations> told_grid{};
    std::array<curve::GridQuat, Rotations> first_grid{};  // of a curve that starts, or a lone start

    /// The part before the pieces. An encoder has set the states of channels that start to their
    /// first vertices. @return false: nonsense.
    bool open(Io& io, const Layout& layout, States& states, const FrameHead& head, bool independent,
              Reading reading) noexcept {
        restart_ = head.restart && !independent;
        independent_ = independent;
        const auto ticks = static_cast<std::uint32_t>((head.end - head.start) / sub_per_tick);
        for (std::size_t c = 0; c < layout.channels; ++c)
            if (!open_ends(io, layout, states, c, reading)) return false;
        if (reading == Reading::joining) return io.ok();
        for (std::size_t c = 0; c < layout.channels; ++c)
            if (!open_times(io, layout, states, c, ticks)) return false;
        place_ = {};
        enter(layout);
        return io.ok();
    }

    /// Is there no piece left? place() tells whose is next.
    bool done(const Layout& layout) const noexcept { return place_.channel >= layout.channels; }
    const Place& place() const noexcept { return place_; }

    /// The next piece of an axis. @return false: nonsense.
    bool piece(Io& io, const Layout& layout, States& states, curve::Piece<1>& piece) noexcept {
        const TrackRange& range = layout.channel[place_.channel];
        const std::size_t a = range.first + place_.track;
        if (!Kinds::piece(range.kind, io, states.axis[a], piece, place_.left, end_of(), &told[a]))
            return false;
        if (place_.left == piece.subs && end_of() == code::End::told &&
            states.axis[a].v[0] != told[a])
            return false;
        return leave(layout, piece.subs);
    }
    /// The next piece of a rotation; before: the state before it, changed as the piece says.
    bool piece(Io& io, const Layout& layout, States& states, curve::Piece<3>& piece) noexcept {
        const TrackRange& range = layout.channel[place_.channel];
        curve::RotationState& state = states.rotation[range.first];
        const float step = layout.step(range.first);
        if (!Kinds::piece(range.kind, io, state.chart, piece, place_.left, end_of(), nullptr))
            return false;
        if (piece.code == curve::code::rebase) {
            if (place_.rebased) return false;
            curve::rebase(state, step);
            place_.rebased = true;
            return true;
        }
        place_.rebased = false;
        if (place_.left == piece.subs && end_of() == code::End::told) {
            const Quat end = curve::from_grid(told_grid[range.first], step);
            curve::step_onto(state, piece, end, curve::place(state.anchor, end, step), step);
        }
        return leave(layout, piece.subs);
    }

    /// After the last piece: the seam to the next frame.
    void close(const Layout& layout, States& states) const noexcept {
        for (std::size_t c = 0; c < layout.channels; ++c) {
            const auto bit = static_cast<std::uint8_t>(1u << c);
            const TrackRange& range = layout.channel[c];
            states.live = static_cast<std::uint8_t>(states.live & ~bit);
            if (channel[c].present && channel[c].end_tick > channel[c].start_tick)
                states.hidden = static_cast<std::uint8_t>(states.hidden & ~bit);
            if (!channel[c].goes_on) continue;
            states.live = static_cast<std::uint8_t>(states.live | bit);
            for (std::size_t i = 0; i < range.count; ++i) {
                const std::size_t t = range.first + i;
                if (turns(range)) {
                    if constexpr (Rotations > 0) hand_over(states.rotation[t], layout.step(t));
                } else if constexpr (Axes > 0) {
                    if (restart_ || independent_) states.axis[t].forget(restart_);
                }
            }
        }
    }

    /// Sets the states to those of a reader that joins at the end of this restart frame.
    void join(const Layout& layout, States& states) const noexcept {
        states = {};
        for (std::size_t c = 0; c < layout.channels; ++c) {
            if (!channel[c].goes_on) continue;
            states.live = static_cast<std::uint8_t>(states.live | 1u << c);
            const TrackRange& range = layout.channel[c];
            for (std::size_t i = 0; i < range.count; ++i) {
                const std::size_t t = range.first + i;
                if (turns(range)) {
                    if constexpr (Rotations > 0)
                        states.rotation[t].anchor = curve::from_grid(told_grid[t], layout.step(t));
                } else if constexpr (Axes > 0) {
                    states.axis[t].v[0] = told[t];
                }
            }
        }
        states.hidden = states.live;
    }

    /// Does the frame tell absolutely where this channel ends?
    bool ends_told(std::size_t c, bool rotates) const noexcept {
        return (restart_ || (independent_ && rotates)) && channel[c].goes_on;
    }

  private:
    /// range.rotates, known when compiled where only one sort of tracks exists.
    static constexpr bool turns(const TrackRange& range) noexcept {
        return Rotations > 0 && (Axes == 0 || range.rotates);
    }
    void hand_over(curve::RotationState& state, float step) const noexcept {
        if (!restart_ && !independent_)
            curve::rebase(state, step);
        else
            state.chart.forget(restart_);
    }
    code::End end_of() const noexcept {
        return ends_told(place_.channel, rotates_) ? code::End::told : code::End::coded;
    }

    bool open_ends(Io& io, const Layout& layout, States& states, std::size_t c,
                   Reading reading) noexcept {
        const TrackRange& range = layout.channel[c];
        const auto bit = static_cast<std::uint8_t>(1u << c);
        ChannelFrame& frame = channel[c];
        bool live = (states.live & bit) != 0;
        if (independent_) {
            bool lives = live && !frame.over;
            io.flag(lives, 15, 4);
            if (reading == Reading::in_step && lives && !live) return false;
            if (!Io::writes) frame.over = reading == Reading::in_step && live && !lives;
            live = lives;
            if (live && !start_told(io, layout, states, range, reading)) return false;
            if (reading == Reading::lone)
                states.live =
                    static_cast<std::uint8_t>(live ? states.live | bit : states.live & ~bit);
        }
        // likely as before; a reader that joins does not know what was before, and likely is `on`
        const bool usual = restart_ || live;
        bool as_usual = frame.goes_on == usual;
        io.flag(as_usual, 15, 4);
        frame.goes_on = as_usual == usual;
        if (!ends_told(c, turns(range))) return true;
        if (turns(range)) {
            if constexpr (Rotations > 0)
                return detail::code_grid(io, told_grid[range.first], layout.step(range.first));
        } else if constexpr (Axes > 0) {
            return detail::code_values(io, &told[range.first], range.count);
        }
        return false;
    }
    /// An independent frame tells the values and slopes at its start.
    bool start_told(Io& io, const Layout& layout, States& states, const TrackRange& range,
                    Reading reading) noexcept {
        const bool known = reading == Reading::in_step;
        if (turns(range)) {
            if constexpr (Rotations > 0)
                return start_rotation(io, states.rotation[range.first], first_grid[range.first],
                                      layout.step(range.first), known);
        } else if constexpr (Axes > 0) {
            return start_vector(io, &states.axis[range.first], range.count, known);
        }
        return false;
    }
    bool start_vector(Io& io, curve::State<1>* axes, std::size_t n, bool known) noexcept {
        std::array<std::int32_t, Axes> v{}, s{};
        for (std::size_t i = 0; i < n; ++i) {
            v[i] = axes[i].v[0];
            s[i] = axes[i].s[0];
        }
        if (!detail::code_values(io, v.data(), n) || !detail::code_values(io, s.data(), n))
            return false;
        for (std::size_t i = 0; i < n; ++i) {
            if (out_of_bounds(v[i], s[i])) return false;
            if (known && (axes[i].v[0] != v[i] || axes[i].s[0] != s[i])) return false;
            if (!known) axes[i].forget(false);
            axes[i].v[0] = v[i];
            axes[i].s[0] = s[i];
        }
        return true;
    }
    static bool start_rotation(Io& io, curve::RotationState& state, curve::GridQuat& grid,
                               float step, bool known) noexcept {
        std::array<std::int32_t, 3> s = state.chart.s;
        if (!detail::code_grid(io, grid, step) || !detail::code_values(io, s.data(), 3))
            return false;
        for (const std::int32_t one : s)
            if (out_of_bounds(0, one)) return false;
        if (known) return s == state.chart.s && stands_on(state, grid, step);
        state.anchor = curve::from_grid(grid, step);
        state.chart = {};
        state.chart.forget(false);
        state.chart.s = s;
        return true;
    }
    static bool out_of_bounds(std::int32_t v, std::int32_t s) noexcept {
        return v > curve::vertex_max || v < -curve::vertex_max || s > curve::slope_max ||
               s < -curve::slope_max;
    }

    bool open_times(Io& io, const Layout& layout, States& states, std::size_t c,
                    std::uint32_t ticks) noexcept {
        const TrackRange& range = layout.channel[c];
        ChannelFrame& frame = channel[c];
        bool live = (states.live >> c & 1u) != 0;
        if (live && !independent_) io.flag(frame.over, 1, 5);
        live = live && !frame.over;
        if (!live && !frame.goes_on) {  // rarely a curve that starts and ends in the frame
            io.flag(frame.present, 1, 4);
            if (!frame.present) return true;
        }
        frame.present = true;
        if (!Io::writes) frame.starts = !live;
        if (frame.starts == live) return false;
        if (!Io::writes && live) frame.start_tick = 0;
        if (!live && !detail::code_tick(io, frame.start_tick, 0, ticks)) return false;
        if (!Io::writes) frame.end_tick = static_cast<std::uint8_t>(ticks);
        if (!frame.goes_on && !detail::code_tick(io, frame.end_tick, frame.start_tick, ticks))
            return false;
        if (!live && !start_curve(io, layout, states, range)) return false;
        return frame.start_tick < frame.end_tick || !frame.goes_on ||
               ends_as_told(layout, states, c);
    }
    /// Without a piece the curve is already where the frame tells that it ends.
    bool ends_as_told(const Layout& layout, const States& states, std::size_t c) const noexcept {
        const TrackRange& range = layout.channel[c];
        if (!ends_told(c, turns(range))) return true;
        bool good = true;
        if (turns(range)) {
            if constexpr (Rotations > 0)
                good = stands_on(states.rotation[range.first], told_grid[range.first],
                                 layout.step(range.first));
        } else if constexpr (Axes > 0) {
            for (std::size_t i = 0; i < range.count; ++i)
                good = good && states.axis[range.first + i].v[0] == told[range.first + i];
        }
        return good;
    }
    static bool stands_on(const curve::RotationState& state, const curve::GridQuat& grid,
                          float step) noexcept {
        const Quat q = curve::from_grid(grid, step);
        const std::array<std::int32_t, 3> zero{};
        const Quat& a = state.anchor;
        return approx::same(q.w, a.w) && approx::same(q.x, a.x) && approx::same(q.y, a.y) &&
               approx::same(q.z, a.z) && state.chart.v == zero;
    }
    /// The first vertex of a curve. An encoder has set it as the state.
    bool start_curve(Io& io, const Layout& layout, States& states,
                     const TrackRange& range) noexcept {
        if (turns(range)) {
            if constexpr (Rotations > 0) {
                curve::RotationState& state = states.rotation[range.first];
                const float step = layout.step(range.first);
                curve::GridQuat& grid = first_grid[range.first];
                if (!detail::code_grid(io, grid, step)) return false;
                state.chart = {};
                state.anchor = curve::from_grid(grid, step);
            }
        } else if constexpr (Axes > 0) {
            std::array<std::int32_t, Axes> v{};
            for (std::size_t i = 0; i < range.count; ++i) v[i] = states.axis[range.first + i].v[0];
            if (!detail::code_values(io, v.data(), range.count)) return false;
            for (std::size_t i = 0; i < range.count; ++i) {
                if (out_of_bounds(v[i], 0)) return false;
                states.axis[range.first + i] = {};
                states.axis[range.first + i].v[0] = v[i];
            }
        }
        return true;
    }

    /// Goes to the first track that has a piece, from place_ on.
    void enter(const Layout& layout) noexcept {
        for (; place_.channel < layout.channels; ++place_.channel, place_.track = 0) {
            const ChannelFrame& frame = channel[place_.channel];
            const TrackRange& range = layout.channel[place_.channel];
            rotates_ = turns(range);
            place_.left = (frame.end_tick - frame.start_tick) * static_cast<int>(sub_per_tick);
            if (frame.present && place_.left > 0 && place_.track < range.count) return;
        }
    }
    bool leave(const Layout& layout, std::int32_t subs) noexcept {
        if (subs <= 0 || subs > place_.left) return false;
        place_.left -= subs;
        if (place_.left == 0) {
            ++place_.track;
            place_.rebased = false;
            enter(layout);
        }
        return true;
    }

    Place place_{};
    bool restart_{false}, independent_{false}, rotates_{false};
};

}  // namespace fairlead::wire2
