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

#include "fairlead/code/cubic_pieces.hpp"
#include "fairlead/code/cubic_tables.hpp"
#include "fairlead/code/pieces.hpp"
#include "fairlead/code/tables.hpp"
#include "fairlead/wire/frame_head.hpp"
#include "fairlead/wire/tracks.hpp"

namespace fairlead::wire {

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

/// Codes the content of one frame. Io: code::RangeEncoder, code::RangeDecoder or code::Counter.
/// Independent: false where no stream of independent frames is coded.
template <class Io, std::size_t Axes, std::size_t Rotations, class Kinds, bool Independent = true>
class Content {
  public:
    using Layout = Tracks<Axes, Rotations>;
    using States = TrackStates<Axes, Rotations, Kinds>;
    static constexpr std::size_t channels_most = Layout::channels_most;

    /// Where coding stands: the track whose piece comes next.
    struct Place {
        std::uint8_t channel{0}, track{0};  // of the channel's tracks
        bool rebased{false};                // the piece before was a rebase
        std::int32_t left{0};               // sub-ticks to the channel's end in this frame
    };

    // an encoder fills these before open()
    std::array<ChannelFrame, channels_most> channel{};
    // at the end, of a frame that tells it; of cubics in a run, the first control points of it
    Places<Axes, Rotations> told{};

    /// The part before the pieces. An encoder has set the states of channels that start to their
    /// first vertices. first: places at their start, of the rotations that tell them; a reader's
    /// are written. @return false: nonsense.
    bool open(Io& io, const Layout& layout, States& states, const FrameHead& head, bool independent,
              Reading reading, Places<Axes, Rotations>& first) noexcept {
        restart_ = head.restart && !independent;
        independent_ = Independent && independent;
        const auto ticks = static_cast<std::uint32_t>((head.end - head.start) / sub_per_tick);
        for (std::size_t c = 0; c < layout.channels; ++c)
            if (!open_ends(io, layout, states, c, reading, first)) return false;
        if (reading == Reading::joining) return io.ok();
        for (std::size_t c = 0; c < layout.channels; ++c)
            if (!open_times(io, layout, states, c, ticks, first)) return false;
        place_ = {};
        enter(layout);
        return io.ok();
    }

    /// Is there no piece left? place() tells whose is next.
    bool done(const Layout& layout) const noexcept { return place_.channel >= layout.channels; }
    const Place& place() const noexcept { return place_; }

    /// The next piece: code, duration and k for each component of its track. @return false:
    /// nonsense.
    bool piece(Io& io, const Layout& layout, States& states, std::uint8_t& c, std::uint16_t& subs,
               std::int32_t* k) noexcept {
        const TrackRange& range = layout.channel[place_.channel];
        if constexpr (Kinds::cubics && Axes > 0) {
            curve::CubicSpan<1> span;
            if (cubic(range)) return cubic_piece(io, layout, states, c, subs, k, span);
        }
        if constexpr (Kinds::quadratics)
            return quadratic_piece(io, layout, states, c, subs, k);
        else
            return false;
    }
    /// The next piece, of a track of cubics. k: of one component. span: how it is drawn.
    bool cubic_piece(Io& io, const Layout& layout, States& states, std::uint8_t& c,
                     std::uint16_t& subs, std::int32_t* k, curve::CubicSpan<1>& span) noexcept {
        const TrackRange& range = layout.channel[place_.channel];
        const std::size_t at = range.first + std::size_t{place_.track};
        curve::CubicState<1>& state = states.cubic[at];
        curve::Piece<1> piece{c, subs, {k[0]}};
        if (!Io::writes && state.run == 3) piece.k[0] = told.value[at];
        if (!code::code_cubic(io, code::cubic_costs<1>, state, piece, place_.left, span))
            return false;
        c = piece.code;
        subs = piece.subs;
        k[0] = piece.k[0];
        return leave(layout, subs);
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
            if (restart_ || lone())
                restart(states, range);
            else if (Layout::turns(range))
                move_chart(layout, states, range);
        }
    }

    /// Sets the states to those of a reader that joins at the end of this restart frame.
    void join(const Layout& layout, States& states) const noexcept {
        states = {};
        for (std::size_t c = 0; c < layout.channels; ++c) {
            const TrackRange& range = layout.channel[c];
            if (!channel[c].goes_on) continue;
            states.live = static_cast<std::uint8_t>(states.live | 1u << c);
            if constexpr (Kinds::cubics && Axes > 0) {
                for (std::size_t i = 0; cubic(range) && i < range.count; ++i)
                    states.cubic[range.first + i] = curve::CubicState<1>::join();
            }
            if (!cubic(range)) put(layout, states, range, told);
        }
        states.hidden = states.live;
    }

    /// Does the frame tell absolutely where this channel ends? Cubics tell the first control points
    /// of the next frame instead.
    bool ends_told(const Layout& layout, std::size_t c) const noexcept {
        const TrackRange& range = layout.channel[c];
        return (restart_ || (lone() && Layout::turns(range))) && channel[c].goes_on &&
               !cubic(range);
    }

  private:
    using PlacesType = Places<Axes, Rotations>;

    bool lone() const noexcept { return Independent && independent_; }
    static constexpr bool cubic(const TrackRange& range) noexcept {
        return Layout::template cubic<Kinds>(range);
    }

    bool quadratic_piece(Io& io, const Layout& layout, States& states, std::uint8_t& c,
                         std::uint16_t& subs, std::int32_t* k) noexcept {
        const TrackRange& range = layout.channel[place_.channel];
        const bool turns = Layout::turns(range), told_end = ends_told(layout, place_.channel);
        const curve::StateView state = states.track(range, place_.track);
        const std::int32_t* to = nullptr;
        if constexpr (Axes > 0)
            if (!turns) to = &told.value[range.first + std::size_t{place_.track}];
        if (!code::code_piece(io, costs(range, turns), state, c, subs, k, place_.left,
                              told_end ? code::End::told : code::End::coded, to))
            return false;
        if (c == curve::code::rebase && place_.rebased) return false;
        place_.rebased = c == curve::code::rebase;
        const bool ends = told_end && place_.left == subs && !place_.rebased;
        if constexpr (Rotations > 0) {
            if (turns) turn(layout, states.rotation[range.first], range.first, c, subs, ends);
        }
        if (place_.rebased) return true;
        if (ends && !turns && state.v[0] != *to) return false;
        return leave(layout, subs);
    }

    /// A reader may begin behind the frame: what predicts is forgotten.
    void restart(States& states, const TrackRange& range) const noexcept {
        for (std::size_t i = 0; i < range.count; ++i) {
            if constexpr (Kinds::cubics && Axes > 0)
                if (cubic(range)) states.cubic[range.first + i].restart();
            if constexpr (Kinds::quadratics)
                if (!cubic(range)) states.track(range, i).forget(restart_);
        }
    }
    static void move_chart(const Layout& layout, States& states, const TrackRange& range) noexcept {
        if constexpr (Rotations > 0)
            curve::rebase(states.rotation[range.first], layout.step(range.first));
    }
    static code::CostsView costs(const TrackRange& range, bool turns) noexcept {
        if constexpr (Rotations == 0)
            return Kinds::template costs<1>(range.kind);
        else if constexpr (Axes == 0)
            return Kinds::template costs<3>(range.kind);
        else
            return turns ? Kinds::template costs<3>(range.kind)
                         : Kinds::template costs<1>(range.kind);
    }
    /// What a piece does to a rotation beside its step.
    void turn(const Layout& layout, curve::RotationState& state, std::size_t rotation,
              std::uint8_t c, std::int32_t subs, bool ends) const noexcept {
        const float step = layout.step(rotation);
        if (c == curve::code::rebase) {
            curve::rebase(state, step);
        } else if (ends) {
            const Quat end = curve::from_grid(told.grid[rotation], step);
            curve::step_onto(state, c, subs, end, curve::place(state.anchor, end, step), step);
        }
    }

    // ---- absolute places

    static bool code_place(Io& io, const Layout& layout, const TrackRange& range,
                           PlacesType& at) noexcept {
        if (Layout::turns(range)) {
            if constexpr (Rotations > 0)
                return detail::code_grid(io, at.grid[range.first], layout.turn_origin[range.first],
                                         layout.step(range.first));
        } else if constexpr (Axes > 0) {
            return detail::code_values(io, &at.value[range.first], &layout.origin[range.first],
                                       range.count);
        }
        return false;
    }
    /// A curve begins there. @return false: out of bounds.
    static bool put(const Layout& layout, States& states, const TrackRange& range,
                    const PlacesType& at) noexcept {
        bool good = true;
        if (Layout::turns(range)) {
            if constexpr (Rotations > 0)
                states.rotation[range.first] = {
                    curve::from_grid(at.grid[range.first], layout.step(range.first)), {}};
        } else if constexpr (Axes > 0) {
            for (std::size_t i = range.first; i < range.first + std::size_t{range.count}; ++i) {
                good = good && inside(at.value[i], curve::vertex_max);
                if (good) set_value(states, range, i, at.value[i]);
            }
        }
        return good;
    }
    /// Are the curves there?
    static bool stand(const Layout& layout, const States& states, const TrackRange& range,
                      const PlacesType& at) noexcept {
        bool good = true;
        if (Layout::turns(range)) {
            if constexpr (Rotations > 0) {
                const auto& [a, chart] = states.rotation[range.first];
                const Quat q = curve::from_grid(at.grid[range.first], layout.step(range.first));
                good = curve::same(q, a) && (chart.v[0] | chart.v[1] | chart.v[2]) == 0;
            }
        } else if constexpr (Axes > 0) {
            for (std::size_t i = range.first; i < range.first + std::size_t{range.count}; ++i)
                good = good && value(states, range, i) == at.value[i];
        }
        return good;
    }
    static constexpr bool inside(std::int32_t x, std::int32_t most) noexcept {
        return x <= most && x >= -most;
    }
    /// The values that an encoder, or a reader in step, knows.
    static void know(const States& states, const TrackRange& range, PlacesType& at) noexcept {
        if constexpr (Axes > 0) {
            if (Layout::turns(range)) return;
            for (std::size_t i = range.first; i < range.first + std::size_t{range.count}; ++i)
                at.value[i] = value(states, range, i);
        }
    }
    /// Of an axis that stands on the lattice.
    static std::int32_t value(const States& states, const TrackRange& range,
                              std::size_t i) noexcept {
        if constexpr (Kinds::cubics)
            if (cubic(range)) return curve::lattice_near(states.cubic[i].at[0]);
        if constexpr (Kinds::quadratics) return states.axis[i].v[0];
        return 0;
    }
    /// An axis begins on the lattice.
    static void set_value(States& states, const TrackRange& range, std::size_t i,
                          std::int32_t v) noexcept {
        if constexpr (Kinds::cubics)
            if (cubic(range)) states.cubic[i] = curve::CubicState<1>::begin({v});
        if constexpr (Kinds::quadratics) {
            if (cubic(range)) return;
            states.axis[i] = {};
            states.axis[i].v[0] = v;
        }
    }

    // ---- what stands before the pieces

    bool open_ends(Io& io, const Layout& layout, States& states, std::size_t c, Reading reading,
                   PlacesType& first) noexcept {
        const TrackRange& range = layout.channel[c];
        const auto bit = static_cast<std::uint8_t>(1u << c);
        ChannelFrame& frame = channel[c];
        bool live = (states.live & bit) != 0;
        if (lone()) {
            bool lives = live && !frame.over;
            io.flag(lives, 15, 4);
            if (reading == Reading::in_step && lives && !live) return false;
            if (!Io::writes) frame.over = reading == Reading::in_step && live && !lives;
            live = lives;
            if (live && !start_told(io, layout, states, range, reading, first)) return false;
            if (reading == Reading::lone)
                states.live =
                    static_cast<std::uint8_t>(live ? states.live | bit : states.live & ~bit);
        }
        // likely as before; a reader that joins does not know what was before, and likely is `on`
        const bool usual = restart_ || live;
        bool as_usual = frame.goes_on == usual;
        io.flag(as_usual, 15, 4);
        frame.goes_on = as_usual == usual;
        return !ends_told(layout, c) || code_place(io, layout, range, told);
    }
    /// An independent frame tells the values and slopes at its start.
    bool start_told(Io& io, const Layout& layout, States& states, const TrackRange& range,
                    Reading reading, PlacesType& first) noexcept {
        if (cubic(range)) return false;
        const bool known = reading == Reading::in_step;
        know(states, range, first);
        if (!code_place(io, layout, range, first)) return false;
        if (known ? !stand(layout, states, range, first) : !put(layout, states, range, first))
            return false;
        std::array<std::int32_t, (Axes > 3 ? Axes : 3)> s{};
        std::size_t n = 0;
        for (std::size_t i = 0; i < range.count; ++i) {
            const curve::StateView state = states.track(range, i);
            for (std::size_t k = 0; k < state.n; ++k) s[n++] = state.s[k];
        }
        detail::code_values(io, s.data(), n);
        n = 0;
        bool good = true;
        for (std::size_t i = 0; i < range.count; ++i) {
            const curve::StateView state = states.track(range, i);
            if (!known) state.forget(false);
            for (std::size_t k = 0; k < state.n; ++k, ++n) {
                good = good && inside(s[n], curve::slope_max) && (!known || state.s[k] == s[n]);
                state.s[k] = s[n];
            }
        }
        return good;
    }

    bool open_times(Io& io, const Layout& layout, States& states, std::size_t c,
                    std::uint32_t ticks, PlacesType& first) noexcept {
        const TrackRange& range = layout.channel[c];
        ChannelFrame& frame = channel[c];
        bool live = (states.live >> c & 1u) != 0;
        if (live && !lone()) io.flag(frame.over, 1, 5);
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
        if (!live) {  // the first vertex: an encoder has set it as the state
            know(states, range, first);
            if (!code_place(io, layout, range, first) || !put(layout, states, range, first))
                return false;
        }
        if (cubic(range) && live && frame.start_tick < frame.end_tick &&
            !code_run(io, layout, states, range))
            return false;
        // without a piece the curve is already where the frame tells that it ends
        return frame.start_tick < frame.end_tick || !ends_told(layout, c) ||
               stand(layout, states, range, told);
    }

    /// The first control points of a run, of all axes.
    bool code_run(Io& io, const Layout& layout, const States& states,
                  const TrackRange& range) noexcept {
        if constexpr (Kinds::cubics && Axes > 0) {
            if (states.cubic[range.first].run != 3) return true;
            return code_place(io, layout, range, told);
        }
        return true;
    }

    // ---- from track to track

    /// Goes to the first track that has a piece, from place_ on.
    void enter(const Layout& layout) noexcept {
        for (; place_.channel < layout.channels; ++place_.channel, place_.track = 0) {
            const ChannelFrame& frame = channel[place_.channel];
            place_.left = (frame.end_tick - frame.start_tick) * static_cast<int>(sub_per_tick);
            if (frame.present && place_.left > 0 &&
                place_.track < layout.channel[place_.channel].count)
                return;
        }
    }
    bool leave(const Layout& layout, std::int32_t subs) noexcept {
        if (subs <= 0 || subs > place_.left) return false;
        place_.left -= subs;
        if (place_.left == 0) {
            ++place_.track;
            enter(layout);
        }
        return true;
    }

    Place place_{};
    bool restart_{false}, independent_{false};
};

}  // namespace fairlead::wire
