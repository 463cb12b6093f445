#pragma once
// The far end of the wire, on the host: takes the bytes of a stream in any portions, keeps every
// piece of curve that the decoder tells, and evaluates the curves, in double, at any time that is
// covered so far. And every event.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fairlead/base/types.hpp"
#include "fairlead/curve/grid.hpp"
#include "fairlead/wire/decoder.hpp"
#include "fairlead/wire/follow.hpp"

namespace fairlead::sim {

/// Both curves at a time; the flags tell which of them there are.
struct CurvePoint {
    BasicVec3<double> p_m{};
    BasicQuat<double> q{};
    std::uint32_t flags{};

    static CurvePoint of(const Pose& pose);
    Pose rounded(std::int64_t t_ns) const;  // to float: half an ulp of the coordinate is lost
};

/// The pieces of one axis, or of one rotation, in time.
class CurveTrack {
  public:
    struct Piece {
        wire::BasicCurvePiece<true> of{};
        std::int64_t start_ns{}, end_ns{};
        double tick_ns{1};

        /// From the piece's start.
        double ticks(std::int64_t t_ns) const {
            return static_cast<double>(t_ns - start_ns) / tick_ns;
        }
    };

    void add(const wire::BasicCurvePiece<true>& piece, const curve::Grid& grid);
    /// The piece in charge at a time; null: there is no curve.
    const Piece* at(std::int64_t t_ns) const;
    const std::vector<Piece>& pieces() const { return pieces_; }
    std::size_t curves() const;
    std::size_t breaks() const;  // jumps within a curve

  private:
    std::vector<Piece> pieces_;
};

/// A channel of a stream: a track for each axis of a vector, one for a rotation.
struct StoredChannel {
    bool rotates{false};
    std::size_t order{3};  // of the pieces: 3 of quadratics, 4 of cubics
    double tolerance{};    // of the encoder, as the header tells it: in the channel's unit, or rad
    std::vector<CurveTrack> tracks;

    bool empty() const;
    bool covers(std::int64_t t_ns) const;
    std::vector<double> value(std::int64_t t_ns) const;  // of a vector; covers(t_ns)
    BasicQuat<double> rotation(std::int64_t t_ns) const;
    std::size_t curves() const;  // each begins after a gap, or with the stream
    std::size_t breaks() const;  // sum of the tracks
    std::size_t pieces() const;  // sum of the tracks
    /// Interior knots with multiplicity, as many as the order at a jump, as a mean of the tracks: a
    /// knot counts as one where all axes have it. Rounded up.
    std::size_t knots() const;
    std::size_t control_points() const { return order * curves() + knots(); }
    std::int64_t begin_ns() const;  // INT64_MAX: no curve
    std::int64_t end_ns() const;    // INT64_MIN: no curve
};

/// The curves of one run: between two leaps of the board's clock.
struct CurveRun {
    std::uint32_t index{1};  // of the stream, from 1
    std::uint16_t number{};  // as the board counts them
    std::int64_t tick_ns{};
    std::vector<StoredChannel> channels;

    const StoredChannel& position() const;     // the first vector of three axes; else an empty one
    const StoredChannel& orientation() const;  // the first rotation; else an empty one
    CurvePoint point_at(std::int64_t t_ns) const;
    Pose at(std::int64_t t_ns) const;
    bool empty() const;
    std::int64_t begin_ns() const;
    std::int64_t end_ns() const;
};

/// Bytes of a stream, by the kind of their frame.
struct StreamBytes {
    std::size_t data{}, headers{}, events{};
    std::size_t frames{};        // data frames
    bool whole{true};            // false: a place begins no frame, or the last one is not complete
    std::size_t counted{};       // up to where frames follow frames
    std::optional<int> version;  // of the first header
    bool earlier_format{false};  // it begins as streams before version 4 did
};
StreamBytes stream_bytes(std::string_view stream);

class CurveStore {
  public:
    /// All that a stream may hold: more than the channels of any board.
    using Decoder = wire::Decoder<12, 4, wire::KindSet<curve::Smooth, curve::Cubics>>;

    void push(std::string_view bytes);
    void finish();  // the input has ended

    /// At least one; the last is the present one.
    const std::vector<CurveRun>& runs() const { return runs_; }
    /// The run with this index; null: it holds no curve.
    const CurveRun* run(std::uint32_t index) const;
    const StoredChannel& position() const { return runs_.back().position(); }
    const StoredChannel& orientation() const { return runs_.back().orientation(); }

    /// Both curves at a time, of the last run that covers it.
    Pose at(std::int64_t t_ns) const;
    /// Both curves of a run at a time.
    CurvePoint point_at(std::uint32_t run_index, std::int64_t t_ns) const;

    /// The discrete events, in the order in which they were sent.
    const std::vector<Event>& events() const { return events_; }
    const wire::EventReader::Counters& event_counters() const { return decoder_.event_counters(); }
    const Decoder::Counters& counters() const { return decoder_.counters(); }
    const Decoder::Frames::Counters& frame_counters() const { return decoder_.frame_counters(); }
    std::uint16_t stream_id() const { return decoder_.stream_id(); }
    std::size_t bytes() const { return byte_count_; }
    /// Bits of the payloads that the channel's pieces took, to a byte.
    std::size_t piece_bytes(std::size_t channel) const;
    /// Nothing in the stream was understood.
    bool empty() const {
        return counters().headers + frame_counters().frames + event_counters().frames == 0;
    }
    /// Empty, or what is wrong with the stream and near which byte it was first noticed.
    std::string damage() const;

  private:
    void take_frame();
    void note_damage();
    void begin_run();
    std::string why_empty() const;

    Decoder decoder_{};
    wire::PieceFollower follow_{};
    bool run_begins_{false};  // with the next piece
    std::vector<CurveRun> runs_{1};
    std::vector<Event> events_;
    std::vector<std::size_t> piece_bytes_;
    std::string head_;  // the first bytes: they tell the format
    std::size_t byte_count_{0};
    std::optional<std::size_t> damaged_at_;
    bool finished_{false};
};

}  // namespace fairlead::sim
