#pragma once
// Bytes in, pieces of curves out: the encoder's curves, bit for bit. Includes nothing of the
// encoder.
//
//     for each byte:
//         if (decoder.push(byte)) {
//             while (decoder.next(piece)) ...          // pieces of this frame, track by track
//             while (decoder.next_event(event)) ...
//         }
//     while (decoder.finish()) ...                     // as push: the input has ended
//
// A frame takes effect when it is parsed: a reader that does not ask for its pieces loses these
// pieces, and nothing else. The first bytes must hold a header frame, or the reader gives one that
// it kept (adopt). Work per byte is bounded (wire/receiver.hpp): beside the search for frames, a
// push parses a frame that is complete, or one frame of those that are found behind damage.
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "fairlead/wire/content.hpp"
#include "fairlead/wire/curve_piece.hpp"
#include "fairlead/wire/events.hpp"
#include "fairlead/wire/receiver.hpp"

namespace fairlead::wire {

/// What a decoder reads. What is off costs nothing.
struct Everything {
    static constexpr bool events = true;        // false: event frames are passed over
    static constexpr bool independent = true;   // false: a stream of independent frames is refused
    static constexpr unsigned check_bits = 16;  // see Receiver
};
struct CurvesAlone : Everything {
    static constexpr bool events = false, independent = false;
};

/// Axes, Rotations: the most that the stream's channels may hold together. Kinds: of their pieces.
/// Memory: sizeof.
template <std::size_t Axes = 3, std::size_t Rotations = 1, class Kinds = KindSet<curve::Smooth>,
          class Parts = Everything>
class Decoder {
    static_assert(Axes + Rotations <= 16 && Axes <= axes_max * channels_max);

  public:
    using Layout = Tracks<Axes, Rotations>;
    using States = TrackStates<Axes, Rotations, Kinds>;
    using Piece = BasicCurvePiece<Kinds::cubics>;  // what next() tells
    using Frames = Receiver<Parts::check_bits>;
    using Events = std::conditional_t<Parts::events, EventReader, NoEventReader>;
    static constexpr std::size_t finds_per_push = 8, finds_at_end = 4096;

    enum class Refused : std::uint8_t {
        nothing,
        version,  // a header of another version of the format
        content,  // a header that tells nonsense
        shape,    // more than this decoder holds, another kind, or independent frames
        foreign,  // a header of another stream than the one that is followed
    };
    struct Counters {
        std::uint32_t headers{0};   // of the stream that is followed
        std::uint32_t refused{0};   // headers that were not followed; refused() tells why
        std::uint32_t nonsense{0};  // frames whose checks fitted and whose content was nonsense
        std::uint32_t breaks{0};    // pieces that jump, as far as they were asked for
    };

    Decoder() noexcept {}  // at run time: no image of the memory stands in flash
    /// Follows this stream alone; otherwise the first one whose header comes.
    explicit Decoder(std::uint16_t stream_id) noexcept : chosen_{true}, stream_id_{stream_id} {}

    /// @return true: a frame was parsed, ask next() and next_event().
    bool push(std::uint8_t byte) noexcept {
        frames_.add(byte);
        return advance(finds_per_push);
    }
    /// The input has ended: as push(), for what is left. Call it until it returns false.
    bool finish() noexcept {
        frames_.end();
        return advance(finds_at_end);
    }
    /// A header frame that the reader kept from earlier: data can be decoded before the next one
    /// comes, from a restart frame on, if the stream is still the same. @return false: refused.
    bool adopt(const std::uint8_t* frame, std::size_t size) noexcept {
        return take_header(frame, size, false);
    }

    /// The next piece that the frame tells, track by track. @return false: none is left.
    bool next(Piece& piece) noexcept {
        for (;;) {
            if (step_ == Step::points && point(piece)) return true;
            if (step_ != Step::pieces || content_.done(layout_)) return false;
            if (step(piece)) return true;
        }
    }
    /// The next event that the frame tells, each only once. @return false: none is left.
    bool next_event(Event& event) noexcept { return events_.next(event); }

    bool in_step() const noexcept { return frames_.in_step(); }
    /// The stream that is followed. run_index counts runs from 1; 0: no header yet. Two runs may
    /// have the same number in the stream (a board that was reset), never the same index.
    std::uint16_t stream_id() const noexcept { return stream_id_; }
    std::uint16_t run() const noexcept { return run_; }
    std::uint32_t run_index() const noexcept { return run_index_; }
    const curve::Grid& grid() const noexcept { return grid_; }
    const Layout& layout() const noexcept { return layout_; }
    /// Tolerance over lattice step of a channel, as the stream tells it.
    float tolerance_steps(std::size_t channel) const noexcept {
        return static_cast<float>(layout_.channel[channel].tolerance) * (1.0f / 32768.0f);
    }
    /// Bytes of the latest frame's payload that next() has read: what the pieces told so far cost.
    std::size_t payload_read() const noexcept { return io_.taken(); }
    /// Where the latest frame ends, in sub-ticks.
    std::int64_t frame_end() const noexcept { return frame_start_ + frame_ticks_ * sub_per_tick; }
    /// The state at the end of the latest frame: equal in all readers that are in step.
    const States& states() const noexcept { return states_; }
    Refused refused() const noexcept { return refused_; }
    const Counters& counters() const noexcept { return counters_; }
    const typename Frames::Counters& frame_counters() const noexcept { return frames_.counters(); }
    const EventCounters& event_counters() const noexcept { return events_.counters(); }

  private:
    using Frame = typename Frames::Frame;
    using Found = typename Frames::Found;
    using Reader = Content<code::RangeDecoder, Axes, Rotations, Kinds, Parts::independent>;
    enum class Step : std::uint8_t { none, points, pieces };

    bool advance(std::size_t finds) noexcept {
        step_ = Step::none;
        events_.close();
        while (finds-- > 0) {
            const Found found = frames_.find();
            if (found == Found::nothing) return false;
            if (take(found)) return true;
        }
        return false;
    }
    /// @return true: there is something to tell.
    bool take(Found found) noexcept {
        const Frame& frame = frames_.frame();
        if (found == Found::data) return take_frame(frame);
        if (found == Found::events)
            return events_.parse(frame.data + 2, frame.size - 2 - crc_size, grid_.base_ns);
        if (found == Found::chain) {
            check_chain();
        } else {
            take_header(frame.data, frame.size, true);
        }
        return false;
    }

    /// may_begin: the header may begin a run.
    bool take_header(const std::uint8_t* frame, std::size_t size, bool may_begin) noexcept {
        Header header;
        const HeaderFault fault = read_header(frame, size, header);
        header.starts = header.starts && may_begin;
        const StreamShape& shape = header.shape;
        Layout layout;
        refused_ = fault == HeaderFault::unknown_version      ? Refused::version
                   : fault != HeaderFault::none               ? Refused::content
                   : chosen_ && shape.stream_id != stream_id_ ? Refused::foreign
                   : !fits(shape, layout)                     ? Refused::shape
                                                              : Refused::nothing;
        if (refused_ != Refused::nothing) {
            ++counters_.refused;
            return false;
        }
        ++counters_.headers;
        if (header.starts || run_index_ == 0 || header.digest != frames_.header_digest()) {
            ++run_index_;
            states_ = {};
        }
        chosen_ = true;
        stream_id_ = shape.stream_id;
        run_ = shape.run;
        grid_ = {shape.base_ns, shape.timing.sub_ns};
        layout_ = layout;
        checked_ = 0;
        frames_.follow_header(shape.timing, header.digest, header.end, header.starts);
        return true;
    }
    /// Can this decoder follow such a stream? Lays out its channels.
    bool fits(const StreamShape& shape, Layout& layout) const noexcept {
        bool good = layout.take(shape) && (Parts::independent || !shape.timing.independent);
        for (std::size_t c = 0; c < layout.channels; ++c) {
            const TrackRange& range = layout.channel[c];
            const bool alone = shape.timing.independent || range.rotates;
            good = good && Kinds::has(range.kind) && !(alone && range.kind == curve::Cubics::id);
        }
        return good;
    }

    /// Opens a frame, from the states before it: its pieces can be told. @return false: nonsense.
    bool open(const Frame& frame, bool joins, const States& from, FrameHead& head) noexcept {
        walk_ = from;
        if (joins) walk_ = {};
        content_ = {};
        io_ = {frame.payload(), frame.payload_size()};
        const Reading reading = !joins   ? Reading::in_step
                                : lone() ? Reading::lone
                                         : Reading::joining;
        Places<Axes, Rotations> first;
        return code_head(io_, head, frames_.timing(), frame.before, frame.since, joins) &&
               content_.open(io_, layout_, walk_, head, frames_.timing().independent, reading,
                             first);
    }
    /// Goes to the end of the frame, without a change of what will be told. @return false:
    /// nonsense.
    bool run(bool joins, States& states) const noexcept {
        if (joins && !lone()) {  // nothing can be drawn before the next frame
            content_.join(layout_, states);
            return true;
        }
        Reader reader = content_;
        code::RangeDecoder io = io_;
        curve::Piece<3> piece;
        states = walk_;
        while (!reader.done(layout_))
            if (!reader.piece(io, layout_, states, piece.code, piece.subs, piece.k.data()))
                return false;
        reader.close(layout_, states);
        return io.finished();
    }
    bool take_frame(const Frame& frame) noexcept {
        const bool joins = frames_.joining();
        States end;
        FrameHead head;
        if (!open(frame, joins, states_, head) || !run(joins, end)) {
            ++counters_.nonsense;
            frames_.refuse_frame();
            return false;
        }
        frame_start_ = head.start;
        frame_ticks_ = static_cast<std::uint8_t>((head.end - head.start) / sub_per_tick);
        states_ = end;
        point_ = 0;
        if (joins) pending_ = 0xffff;
        if (joins && !lone()) return true;
        begin_curves();
        step_ = Step::points;
        return true;
    }
    /// Does the next frame of the chain make sense behind those before it? With the last one, the
    /// chain is believed.
    void check_chain() noexcept {
        const auto& chain = frames_.chain();
        const Frame frame = frames_.chain_frame(checked_);
        const bool first = checked_ == 0, joins = first && chain.joins();
        States end;
        FrameHead head;
        const bool good = open(frame, joins, first ? states_ : walk_, head) && run(joins, end);
        frames_.spend(frame.size);
        counters_.nonsense += !good;
        walk_ = end;
        if (good && ++checked_ < chain.count) return;
        checked_ = 0;
        good ? frames_.accept() : frames_.refuse();
    }
    bool lone() const noexcept { return Parts::independent && frames_.timing().independent; }

    // ---- telling a frame again, piece by piece

    /// Where the track stands.
    void describe(Piece& piece, std::size_t channel, std::size_t track) noexcept {
        const TrackRange& range = layout_.channel[channel];
        piece = {};
        piece.channel = static_cast<std::uint8_t>(channel);
        piece.axis = static_cast<std::uint8_t>(track);
        piece.rotates = range.rotates;
        piece.scale = layout_.scale_of(range, track);
        if constexpr (Kinds::cubics && Axes > 0)
            if (cubic(range)) piece.v[0] = curve::lattice_near(cubic_state(range, track).at[0]);
        if constexpr (Kinds::quadratics)
            if (!cubic(range)) describe_quadratic(piece, range, track);
    }
    void describe_quadratic(Piece& piece, const TrackRange& range, std::size_t track) noexcept {
        const curve::StateView state = walk_.track(range, track);
        piece.fresh = state.history.fresh;
        for (std::size_t c = 0; c < state.n; ++c) {
            piece.v[c] = state.v[c];
            piece.s[c] = state.s[c];
        }
        if constexpr (Rotations > 0)
            if (Layout::turns(range)) piece.anchor = walk_.rotation[range.first].anchor;
    }
    /// Curves of a single vertex, and those that ended with the frame before, have no piece here:
    /// told as pieces without duration; of the latter only that they ended.
    bool point(Piece& piece) noexcept {
        constexpr std::size_t tracks = Axes + Rotations;
        while (point_ < 2 * tracks) {  // first the curves that ended, then those of this frame
            const bool over = point_ < tracks;
            std::size_t channel = 0, track = point_++ % tracks;
            while (channel < layout_.channels && track >= layout_.channel[channel].count)
                track -= layout_.channel[channel++].count;
            if (channel >= layout_.channels) continue;
            const ChannelFrame& frame = content_.channel[channel];
            const bool lone =
                !over && frame.present && !frame.goes_on && frame.start_tick == frame.end_tick;
            if (!lone && !(over && frame.over)) continue;
            piece = {};
            if (lone) describe(piece, channel, track);
            piece.channel = static_cast<std::uint8_t>(channel);
            piece.axis = static_cast<std::uint8_t>(track);
            piece.rotates = layout_.channel[channel].rotates;
            piece.code = curve::code::jump;
            piece.begins = lone && take_pending(channel, track);
            piece.ends = true;
            piece.start = frame_start_ + (lone ? frame.start_tick * sub_per_tick : 0);
            piece.end = piece.start;
            return true;
        }
        step_ = Step::pieces;
        return false;
    }
    /// @return false: the piece is not to be told: its slope is not known, or it takes no time.
    bool step(Piece& piece) noexcept {
        const typename Reader::Place place = content_.place();
        const TrackRange& range = layout_.channel[place.channel];
        describe(piece, place.channel, place.track);
        bool hidden = false;
        if constexpr (Kinds::cubics && Axes > 0)
            if (cubic(range)) hidden = !step_cubic(piece, place);
        if constexpr (Kinds::quadratics)
            if (!cubic(range)) hidden = !step_quadratic(piece, place);
        if (piece.jumps) ++counters_.breaks;
        if (!hidden) piece.begins = take_pending(place.channel, place.track);
        return !hidden;
    }
    static constexpr bool cubic(const TrackRange& range) noexcept {
        return Layout::template cubic<Kinds>(range);
    }
    auto& cubic_state(const TrackRange& range, std::size_t track) noexcept {
        return walk_.cubic[range.first + track];
    }
    /// When the piece is, by what remains of its channel before it.
    void set_time(Piece& piece, const typename Reader::Place& place, std::uint8_t code,
                  std::uint16_t subs) const noexcept {
        const ChannelFrame& frame = content_.channel[place.channel];
        const std::int64_t last = frame_start_ + frame.end_tick * sub_per_tick;
        piece.start = last - place.left;
        piece.end = piece.start + subs;
        piece.code = code;
        piece.jumps = code == curve::code::jump;
        piece.ends = !frame.goes_on && piece.end == last;
    }
    /// @return false: the state before is not known, and the piece cannot be drawn.
    bool step_cubic(Piece& piece, const typename Reader::Place& place) noexcept {
        curve::CubicState<1>& state = cubic_state(layout_.channel[place.channel], place.track);
        const bool known = state.known;
        curve::Piece<1> next;
        content_.cubic_piece(io_, layout_, walk_, next.code, next.subs, next.k.data(), piece.span);
        set_time(piece, place, next.code, next.subs);
        piece.cubic = !piece.jumps;
        const std::int32_t after = curve::lattice_near(state.at[0]);
        if (piece.jumps) {
            piece.s[0] = after - piece.v[0];
            piece.v[0] = after;
        } else {
            piece.rise[0] = static_cast<float>(after - piece.v[0]);
        }
        return known;
    }
    /// @return false: its slope is not known, or it takes no time.
    bool step_quadratic(Piece& piece, const typename Reader::Place& place) noexcept {
        const TrackRange& range = layout_.channel[place.channel];
        curve::Piece<3> next;
        content_.piece(io_, layout_, walk_, next.code, next.subs, next.k.data());
        if (next.code == curve::code::rebase) return false;
        set_time(piece, place, next.code, next.subs);
        const curve::StateView after = walk_.track(range, place.track);
        for (std::size_t c = 0; c < after.n; ++c) {
            if (piece.jumps) {  // the value holds after the jump, until the piece ends
                piece.s[c] = next.k[c];
                piece.v[c] += next.k[c];
            } else {
                piece.rise[c] = static_cast<float>(after.v[c] - piece.v[c]);
            }
        }
        if constexpr (Rotations > 0) {
            if (!piece.jumps && next.subs == place.left && Layout::turns(range) &&
                content_.ends_told(layout_, place.channel)) {
                const auto end = curve::place(piece.anchor, walk_.rotation[range.first].anchor,
                                              layout_.step(range.first));
                for (std::size_t c = 0; c < 3; ++c)
                    piece.rise[c] = end[c] - static_cast<float>(piece.v[c]);
            }
        }
        return (walk_.hidden >> place.channel & 1u) == 0 || !piece.fresh || piece.jumps;
    }
    /// Is the track's curve told for the first time?
    bool take_pending(std::size_t channel, std::size_t track) noexcept {
        const TrackRange& range = layout_.channel[channel];
        const std::size_t place = range.first + track + (range.rotates ? Axes : 0);
        const auto bit = static_cast<std::uint16_t>(1u << place);
        const bool pending = (pending_ & bit) != 0;
        pending_ = static_cast<std::uint16_t>(pending_ & ~bit);
        return pending;
    }
    void begin_curves() noexcept {
        for (std::size_t c = 0; c < layout_.channels; ++c) {
            const TrackRange& range = layout_.channel[c];
            if (!content_.channel[c].starts) continue;
            const auto tracks = ((1u << range.count) - 1u)
                                << (range.first + (range.rotates ? Axes : 0));
            pending_ = static_cast<std::uint16_t>(pending_ | tracks);
        }
    }

    std::int64_t frame_start_{0};  // of the latest frame
    std::uint8_t frame_ticks_{0}, point_{0};
    std::uint8_t checked_{0};  // frames of a chain that make sense
    Step step_{Step::none};
    Refused refused_{Refused::nothing};
    bool chosen_{false};
    std::uint16_t pending_{0};  // tracks whose next piece begins a curve, as far as it was told
    std::uint16_t stream_id_{0}, run_{0};
    std::uint32_t run_index_{0};
    curve::Grid grid_{};
    code::RangeDecoder io_{};
    Counters counters_{};
    Layout layout_{};
    Reader content_{};
    States states_{}, walk_{};
    Events events_{};
    Frames frames_{};
};

}  // namespace fairlead::wire
