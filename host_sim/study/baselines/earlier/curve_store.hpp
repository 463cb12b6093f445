#pragma once
// A reader of the streams of the earlier search (format versions 1 to 3): keeps every piece of
// curve that its decoder tells, and evaluates them at any time that is covered so far. And every
// event.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/study/baselines/earlier/reduce/evaluate.hpp"
#include "host_sim/study/baselines/earlier/wire/decoder.hpp"

namespace fairlead::sim::earlier {

using namespace fairlead::earlier;

/// The pieces of one channel, in time.
template <class Channel>
class CurveList {
  public:
    using Value = typename Channel::Value;

    struct Piece {
        Curve<Channel> curve{};
        typename Channel::Scale scale{};
        std::uint32_t tick_ns{1};
        bool begins{}, breaks{};
        bool joins{};                 // goes on from the piece before it
        std::uint32_t cover_ticks{};  // final before this, after its own knot
        std::uint32_t next_ticks{};   // knot at which the next piece joins; 0: none yet
        std::size_t multiplicity{};   // of its own knot, where it joins

        std::int64_t t0_ns() const { return curve.span.t0_ns; }
        /// The piece is final, and in charge, from its knot to before this time.
        std::int64_t end_ns() const {
            return t0_ns() + std::int64_t{std::max(cover_ticks, next_ticks)} * tick_ns;
        }
    };

    void add(Piece piece) {
        while (!pieces_.empty() && pieces_.back().t0_ns() >= piece.t0_ns()) {
            piece.joins = false;  // a decoder that lost its step has come back to what it knew
            pieces_.pop_back();
        }
        piece.joins = piece.joins && !pieces_.empty();
        if (piece.joins) {
            const std::int64_t apart_ns = piece.t0_ns() - pieces_.back().t0_ns();
            pieces_.back().next_ticks = static_cast<std::uint32_t>(apart_ns / piece.tick_ns);
            piece.multiplicity = multiplicity(pieces_.back(), piece);
        }
        pieces_.push_back(piece);
    }
    /// The piece does not go on from these, nor repeat one of the last, as a decoder does that lost
    /// its step: the clock of the encoder has started anew.
    bool starts_anew(const Piece& piece) const {
        if (pieces_.empty() || piece.t0_ns() >= pieces_.back().t0_ns()) return false;
        constexpr std::size_t repeated_most = 4;
        const std::size_t n = std::min(repeated_most, pieces_.size());
        return std::none_of(pieces_.rbegin(), pieces_.rbegin() + static_cast<std::ptrdiff_t>(n),
                            [&](const Piece& p) { return p.t0_ns() == piece.t0_ns(); });
    }

    void cover(std::uint32_t ticks) {
        if (pieces_.empty()) return;
        pieces_.back().cover_ticks = ticks;
    }

    std::optional<Value> at(std::int64_t t_ns) const {
        const auto later = [](std::int64_t t, const Piece& p) { return t < p.t0_ns(); };
        const auto next = std::upper_bound(pieces_.begin(), pieces_.end(), t_ns, later);
        if (next == pieces_.begin()) return {};
        const Piece& piece = *(next - 1);
        if (t_ns >= piece.end_ns()) return {};
        return value_at(piece.curve, piece.scale, piece.tick_ns, t_ns);
    }

    const std::vector<Piece>& pieces() const { return pieces_; }

    /// Starts after a gap or at the beginning; a restart inside a motion is a knot.
    std::size_t curves() const {
        return count([](const Piece& p) { return p.begins && !p.breaks; });
    }
    std::size_t breaks() const {
        return count([](const Piece& p) { return p.breaks; });
    }
    /// Interior knots with multiplicity: a break has that of the order.
    std::size_t knots() const {
        std::size_t sum = Channel::order * breaks();
        for (const Piece& piece : pieces_) sum += piece.multiplicity;
        return sum;
    }
    std::size_t control_points() const { return Channel::order * curves() + knots(); }

  private:
    /// One, but where derivatives below the highest jump as well.
    static std::size_t multiplicity(const Piece& before, const Piece& piece) {
        const auto moved = carried(before.curve.span, before.next_ticks, before.tick_ns);
        for (std::size_t m = 1; m + 1 < Channel::order; ++m)
            if (moved.c[m] != piece.curve.span.c[m]) return Channel::order - m;
        return 1;
    }

    template <class Predicate>
    std::size_t count(Predicate predicate) const {
        return static_cast<std::size_t>(std::count_if(pieces_.begin(), pieces_.end(), predicate));
    }

    std::vector<Piece> pieces_;
};

/// The curves between two starts of the encoder's clock.
struct CurveRun {
    CurveList<Decoder::Position> position;
    CurveList<Decoder::Orientation> orientation;

    /// Both curves at a time; the flags tell which of them there are.
    Pose at(std::int64_t t_ns) const;
    bool empty() const { return position.pieces().empty() && orientation.pieces().empty(); }
    std::int64_t begin_ns() const;
    std::int64_t end_ns() const;
};

class CurveStore {
  public:
    using Positions = CurveList<Decoder::Position>;
    using Orientations = CurveList<Decoder::Orientation>;

    void push(std::string_view bytes);
    void finish();  // the input has ended

    /// A log in which the board's clock has started anew holds several; at least one, the last is
    /// the present one.
    const std::vector<CurveRun>& runs() const { return runs_; }
    const Positions& position() const { return runs_.back().position; }
    const Orientations& orientation() const { return runs_.back().orientation; }

    /// Both curves at a time, of the last run that covers it.
    Pose at(std::int64_t t_ns) const;

    /// The discrete events, in the order in which they were sent.
    const std::vector<Event>& events() const { return events_; }
    const EventReader::Counters& event_counters() const { return decoder_.event_counters(); }
    const Decoder::Counters& counters() const { return decoder_.counters(); }
    /// Nothing in the stream was understood.
    bool empty() const { return counters().frames + event_counters().frames == 0; }
    /// Empty, or what is wrong with the stream and near which byte it was first noticed.
    std::string damage() const;

  private:
    void take_frame();
    void note_damage();

    Decoder decoder_{};
    std::vector<CurveRun> runs_{1};
    std::vector<Event> events_;
    std::size_t byte_count_{0};
    std::optional<std::size_t> damaged_at_;
};

}  // namespace fairlead::sim::earlier
