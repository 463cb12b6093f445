#pragma once
// The curves of a stream at any time of the live window: where they are, and how they move there.
//
// A decoder tells of one piece after another. This one remembers the newest `Pieces` of each track,
// so that a display or a controller may ask for any time between the oldest of them and what is
// covered so far. What it answers is final: it never changes.
//
// Memory: sizeof, about 120 bytes a piece and track. Cost: push() as a Decoder's; a question looks
// through at most Pieces of each track. A new run (the sender's clock leapt) forgets the one
// before.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fairlead/base/ring.hpp"
#include "fairlead/math/rotation_rates.hpp"
#include "fairlead/wire/decoder.hpp"
#include "fairlead/wire/follow.hpp"

namespace fairlead::wire {

/// Ticks from the start of a piece to t_ns.
template <class Real, bool Cubics>
constexpr Real ticks_after_start(const BasicCurvePiece<Cubics>& piece, const curve::Grid& grid,
                                 std::int64_t t_ns) noexcept {
    return static_cast<Real>(t_ns - grid.time_ns(piece.start)) / static_cast<Real>(grid.tick_ns());
}

/// The same of a piece on its grid (follow.hpp).
template <bool Cubics>
constexpr bool holds_at(const BasicCurvePiece<Cubics>& piece, const curve::Grid& grid,
                        std::int64_t t_ns) noexcept {
    return holds_at(piece.begins, grid.time_ns(piece.start), grid.time_ns(piece.end), t_ns);
}

/// One axis: value, and velocity and acceleration per second.
template <class Real>
struct AxisMotion {
    Real value{}, velocity{}, acceleration{};
};
template <class Real = float, bool Cubics>
AxisMotion<Real> axis_motion(const BasicCurvePiece<Cubics>& piece, const curve::Grid& grid,
                             std::int64_t t_ns) noexcept {
    const Real u = ticks_after_start<Real>(piece, grid, t_ns);
    const Real step = piece.scale.template step<Real>();
    const Real per_s = static_cast<Real>(1e9) / static_cast<Real>(grid.tick_ns());
    return {step * piece.steps_at(u), step * per_s * piece.rate_at(u),
            step * per_s * per_s * piece.bend_at(u)};
}

/// A rotation, and its angular velocity and acceleration in the body frame, rad/s and rad/s^2.
template <class Real>
struct OrientationMotion {
    BasicQuat<Real> q_wb{};
    RotationMotion<Real> rates{};
};
template <class Real = float, bool Cubics>
OrientationMotion<Real> orientation_motion(const BasicCurvePiece<Cubics>& piece,
                                           const curve::Grid& grid, std::int64_t t_ns) noexcept {
    const Real u = ticks_after_start<Real>(piece, grid, t_ns);
    const Real step = piece.scale.template step<Real>();
    const Real per_s = static_cast<Real>(1e9) / static_cast<Real>(grid.tick_ns());
    std::array<BasicVec3<Real>, 3> theta;  // theta and its derivatives
    theta[0] = {step * piece.steps_at(u, 0), step * piece.steps_at(u, 1),
                step * piece.steps_at(u, 2)};
    theta[1] = step * per_s *
               BasicVec3<Real>{piece.rate_at(u, 0), piece.rate_at(u, 1), piece.rate_at(u, 2)};
    theta[2] = step * per_s * per_s *
               BasicVec3<Real>{piece.bend_at(u, 0), piece.bend_at(u, 1), piece.bend_at(u, 2)};
    return {rotation_at(piece, u), rotation_motion(theta[0], theta[1], theta[2])};
}

/// The newest pieces of one track.
template <std::size_t Pieces, class Piece = CurvePiece>
class LiveTrack {
  public:
    struct Held {
        Piece piece{};
        curve::Grid grid{};
    };
    void take(const Piece& piece, const curve::Grid& grid) noexcept {
        if (piece.start == piece.end && !piece.begins) return;  // tells only that a curve ended
        if (pieces_.full()) pieces_.pop();
        pieces_.push({piece, grid});
    }
    void clear() noexcept { pieces_.clear(); }
    /// The piece that holds at this time. @return null: none is known.
    const Held* at(std::int64_t t_ns) const noexcept {
        for (std::size_t i = pieces_.size(); i-- > 0;)
            if (holds_at(pieces_[i].piece, pieces_[i].grid, t_ns)) return &pieces_[i];
        return nullptr;
    }
    /// The curve is final up to here; only while there is one.
    std::optional<std::int64_t> until_ns() const noexcept {
        if (pieces_.empty()) return std::nullopt;
        return pieces_.newest().grid.time_ns(pieces_.newest().piece.end);
    }

  private:
    Ring<Held, Pieces> pieces_{};
};

/// Axes, Rotations, Kinds: the most that the stream's channels may hold together, as of Decoder.
/// position() speaks of the first channel with three axes, orientation() of the first rotation.
template <std::size_t Pieces = 32, std::size_t Axes = 3, std::size_t Rotations = 1,
          class Kinds = KindSet<curve::Smooth>>
class LiveDecoder {
  public:
    using Stream = Decoder<Axes, Rotations, Kinds>;
    using Piece = typename Stream::Piece;
    struct Motion {
        Vec3 p_w_m{}, velocity_m_s{}, acceleration_m_s2{};
    };

    /// @return true when a frame told something new of a curve.
    bool push(std::uint8_t byte) noexcept { return decoder_.push(byte) && drain(); }
    /// The input has ended: call it until it returns false.
    bool finish() noexcept {
        if (!decoder_.finish()) return false;
        drain();
        return true;
    }

    /// One axis of a channel that is a vector.
    std::optional<AxisMotion<float>> axis(std::size_t channel, std::size_t axis,
                                          std::int64_t t_ns) const noexcept {
        const auto* held = at(channel, axis, false, t_ns);
        if (held == nullptr) return std::nullopt;
        return axis_motion(held->piece, held->grid, t_ns);
    }
    std::optional<Motion> position(std::int64_t t_ns) const noexcept {
        const auto channel = find(false);
        if (!channel) return std::nullopt;
        const auto x = axis(*channel, 0, t_ns), y = axis(*channel, 1, t_ns),
                   z = axis(*channel, 2, t_ns);
        if (!x || !y || !z) return std::nullopt;
        return Motion{{x->value, y->value, z->value},
                      {x->velocity, y->velocity, z->velocity},
                      {x->acceleration, y->acceleration, z->acceleration}};
    }
    std::optional<OrientationMotion<float>> orientation(std::int64_t t_ns) const noexcept {
        const auto channel = find(true);
        const auto* held = channel ? at(*channel, 0, true, t_ns) : nullptr;
        if (held == nullptr) return std::nullopt;
        return orientation_motion(held->piece, held->grid, t_ns);
    }
    /// Position and orientation are final up to these times.
    std::optional<std::int64_t> position_until_ns() const noexcept { return until(find(false)); }
    std::optional<std::int64_t> orientation_until_ns() const noexcept { return until(find(true)); }

    const Stream& decoder() const noexcept { return decoder_; }
    /// Discrete events; after push().
    bool next_event(Event& event) noexcept { return decoder_.next_event(event); }

  private:
    using Track = LiveTrack<Pieces, Piece>;

    bool drain() noexcept {
        const auto forget = [this](bool) noexcept {
            for (Track& track : tracks_) track.clear();
        };
        const auto keep = [this](const Piece& piece) noexcept {
            tracks_[place(piece.channel, piece.axis)].take(piece, decoder_.grid());
        };
        return follow_(decoder_, forget, keep);
    }
    /// Rotations stand behind the axes.
    std::size_t place(std::size_t channel, std::size_t axis) const noexcept {
        const auto& range = decoder_.layout().channel[channel];
        return (range.rotates ? Axes : 0) + range.first + axis;
    }
    const typename Track::Held* at(std::size_t channel, std::size_t axis, bool rotates,
                                   std::int64_t t_ns) const noexcept {
        const auto& layout = decoder_.layout();
        if (channel >= layout.channels || layout.channel[channel].rotates != rotates ||
            axis >= layout.channel[channel].count)
            return nullptr;
        return tracks_[place(channel, axis)].at(t_ns);
    }
    std::optional<std::size_t> find(bool rotates) const noexcept {
        const auto& layout = decoder_.layout();
        for (std::size_t c = 0; c < layout.channels; ++c)
            if (layout.channel[c].rotates == rotates &&
                layout.channel[c].count == (rotates ? 1 : 3))
                return c;
        return std::nullopt;
    }
    std::optional<std::int64_t> until(std::optional<std::size_t> channel) const noexcept {
        if (!channel) return std::nullopt;
        std::optional<std::int64_t> least;
        for (std::size_t a = 0; a < decoder_.layout().channel[*channel].count; ++a) {
            const auto end = tracks_[place(*channel, a)].until_ns();
            if (!end) return std::nullopt;
            if (!least || *end < *least) least = end;
        }
        return least;
    }

    Stream decoder_{};
    std::array<Track, Axes + Rotations> tracks_{};
    PieceFollower follow_{};
};

}  // namespace fairlead::wire
