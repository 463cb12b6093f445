#pragma once
// Both curves of a stream at any time of the live window: where they are, and how they move there.
//
// A decoder tells of one polynomial after another. This one remembers the newest `Pieces` of each
// curve with the time up to which each is final, so that a display or a controller may ask for any
// time between the oldest of them and what is covered so far. What it answers is final: it never
// changes, and poses are bit for bit those that the encoder has held to the tolerance.
//
// Memory: sizeof, about 90 bytes a piece of position and 105 of orientation. Cost: push() as a
// Decoder's; a question looks through at most Pieces.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fairlead/base/ring.hpp"
#include "fairlead/reduce/evaluate.hpp"
#include "fairlead/wire/decoder.hpp"

namespace fairlead {

/// The newest pieces of one curve.
template <class Channel, std::size_t Pieces>
class LiveCurve {
  public:
    /// Follows a decoder's link after each of its updates.
    void take(const wire::Link<Channel>& link, const Decoder::Update& update,
              std::uint32_t tick_ns) noexcept {
        const std::int64_t t0_ns = link.curve.span.t0_ns;
        if (update.piece) {
            // one that goes on from the piece before takes over from it; others leave it as it was
            if (!update.begins && !update.rejoined && !pieces_.empty())
                pieces_[pieces_.size() - 1].until_ns = t0_ns;
            if (pieces_.full()) pieces_.pop();
            pieces_.push({link.curve, link.scale, tick_ns, t0_ns});
        }
        if (!pieces_.empty())
            pieces_[pieces_.size() - 1].until_ns = t0_ns + std::int64_t{link.cover_ticks} * tick_ns;
    }

    struct Piece {
        Curve<Channel> curve{};
        typename Channel::Scale scale{};
        std::uint32_t tick_ns{1};
        std::int64_t until_ns{0};  // final before this
    };
    /// The piece that speaks for a time, if one is known.
    const Piece* at(std::int64_t t_ns) const noexcept {
        for (std::size_t i = pieces_.size(); i-- > 0;) {
            const Piece& piece = pieces_[i];
            if (piece.curve.span.t0_ns > t_ns) continue;
            return t_ns < piece.until_ns ? &piece : nullptr;
        }
        return nullptr;
    }
    /// The curve is final before this; only while there is one.
    std::optional<std::int64_t> until_ns() const noexcept {
        if (pieces_.empty()) return std::nullopt;
        return pieces_.newest().until_ns;
    }

  private:
    Ring<Piece, Pieces> pieces_{};
};

template <std::size_t Pieces = 32>
class LiveDecoder {
  public:
    struct Motion {
        Vec3 p_w_m{}, velocity_m_s{}, acceleration_m_s2{};
    };
    struct Turning {
        Quat q_wb{};
        RotationRates rates{};  // body frame
    };

    /// @return true when a frame was found that told something new of a curve.
    bool push(std::uint8_t byte) noexcept { return decoder_.push(byte) && drain(); }

    std::optional<Motion> position(std::int64_t t_ns) const noexcept {
        const auto* piece = position_.at(t_ns);
        if (piece == nullptr) return std::nullopt;
        const auto p = value_at(piece->curve, piece->scale, piece->tick_ns, t_ns);
        const auto r = rates_at(piece->curve, piece->scale, piece->tick_ns, t_ns);
        const auto vec3 = [](const std::array<float, 3>& v) { return Vec3{v[0], v[1], v[2]}; };
        return Motion{vec3(p), vec3(r.velocity), vec3(r.acceleration)};
    }
    std::optional<Turning> orientation(std::int64_t t_ns) const noexcept {
        const auto* piece = orientation_.at(t_ns);
        if (piece == nullptr) return std::nullopt;
        return Turning{value_at(piece->curve, piece->scale, piece->tick_ns, t_ns),
                       rates_at(piece->curve, piece->scale, piece->tick_ns, t_ns)};
    }

    const LiveCurve<Decoder::Position, Pieces>& positions() const noexcept { return position_; }
    const LiveCurve<Decoder::Orientation, Pieces>& orientations() const noexcept {
        return orientation_;
    }
    const Decoder& decoder() const noexcept { return decoder_; }
    /// Discrete events; after push().
    bool next_event(Event& event) noexcept { return decoder_.next_event(event); }

  private:
    bool drain() noexcept {
        bool news = false;
        for (Decoder::Update update; decoder_.next(update); news = true) {
            if (update.channel == Decoder::Channel::position)
                position_.take(decoder_.position(), update, decoder_.tick_ns());
            else
                orientation_.take(decoder_.orientation(), update, decoder_.tick_ns());
        }
        return news;
    }

    Decoder decoder_{};
    LiveCurve<Decoder::Position, Pieces> position_{};
    LiveCurve<Decoder::Orientation, Pieces> orientation_{};
};

}  // namespace fairlead
