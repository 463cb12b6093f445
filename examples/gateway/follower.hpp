#pragma once
// From the stream's bytes to spans in a unit's feed: the same for a board's line and for a replay,
// which decodes what its own pipeline encodes and so publishes the very curve a remote reader has.
#include <array>
#include <cstddef>
#include <cstdint>

#include "examples/gateway/feed.hpp"
#include "examples/gateway/span_maker.hpp"
#include "fairlead/base/ring.hpp"
#include "fairlead/wire/decoder.hpp"
#include "fairlead/wire/follow.hpp"

namespace fairlead::gateway {

/// A number that no other run has, but for one chance in four thousand million; never 0.
std::uint32_t new_epoch() noexcept;

/// One channel: how its pieces become spans, and the newest of these, for the live pose.
class ChannelSpans {
  public:
    explicit ChannelSpans(port::CurveChannel channel) noexcept : maker_{channel} {}

    void take(const wire::CurvePiece& piece) noexcept { maker_.take(piece); }
    /// The next span that the pieces complete. joins: of the decoder, how often it came into step.
    /// @return false: none is complete.
    bool next(const curve::Grid& grid, std::uint32_t joins, port::CurveSpan& span) noexcept;
    void clear() noexcept;

    bool has_any() const noexcept { return !spans_.empty(); }
    const port::CurveSpan& newest() const noexcept { return spans_.newest(); }
    /// The span that holds at t, newest first; null when none does.
    const port::CurveSpan* covering(std::int64_t t_ns) const noexcept;
    /// The newest curve began after a gap in the motion.
    bool in_gap() const noexcept { return in_gap_; }

  private:
    SpanMaker maker_;
    Ring<port::CurveSpan, 64> spans_{};
    std::uint32_t joins_{};  // of the decoder, when the newest curve began
    bool in_gap_{};
};

class CurveFollower {
  public:
    enum class WhenFull : std::uint8_t { wait, drop };

    CurveFollower(UnitFeed& feed, UnitState& state, WhenFull when_full) noexcept
        : feed_{feed}, state_{state}, when_full_{when_full} {}

    /// Bytes as they come. @return true when the curves went on.
    bool take(const std::uint8_t* bytes, std::size_t size) noexcept;
    /// The state's pose: the newest time that every channel still alive covers.
    void evaluate() noexcept;

    /// No byte follows: what waits for a frame to confirm it.
    void finish() noexcept;

    /// A new run of the source: nothing joins it to what was before.
    void restart() noexcept;

    using Stream = wire::Decoder<3, 1>;
    const Stream& decoder() const noexcept { return decoder_; }

  private:
    void follow() noexcept;
    void tell_health() noexcept;
    void append(ChannelSpans& channel) noexcept;
    void send(const SpanItem& item) noexcept;

    UnitFeed& feed_;
    UnitState& state_;
    WhenFull when_full_;
    Stream decoder_{};
    wire::PieceFollower follow_{};
    ChannelSpans orientation_{port::CurveChannel::orientation};
    ChannelSpans position_{port::CurveChannel::position};
    std::uint64_t received_{0};
};

}  // namespace fairlead::gateway
