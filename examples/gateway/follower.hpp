#pragma once
// From the codec's bytes to spans in a unit's feed: the same for a board's line and for a replay,
// which decodes what its own pipeline encodes and so publishes the very curve a remote reader has.
#include <array>
#include <cstddef>
#include <cstdint>

#include "examples/gateway/feed.hpp"
#include "fairlead/base/ring.hpp"
#include "fairlead/wire/decoder.hpp"

namespace fairlead::gateway {

/// A number that no other run has, but for one chance in four thousand million; never 0.
std::uint32_t new_epoch() noexcept;

/// One channel's newest spans: what is still open, and a few before it for the live pose.
class OpenCurve {
  public:
    explicit OpenCurve(port::CurveChannel channel) noexcept : channel_{channel} {}

    bool has_any() const noexcept { return !spans_.empty(); }
    const port::CurveSpan& newest() const noexcept { return spans_.newest(); }
    /// The span that covers t, newest first; null when none does.
    const port::CurveSpan* covering(std::int64_t t_ns) const noexcept;

    port::CurveChannel channel_;
    Ring<port::CurveSpan, 8> spans_{};
    bool in_gap_{};   // ... began after a gap in the motion
    bool covers_{};   // ... is known to cover its knot
    bool sent_{};     // the newest is in the feed
    bool changed_{};  // ... or has more cover than there
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

    /// A new run of the source: nothing joins it to what was before.
    void restart() noexcept;

    /// A restart frame is among the frames of the last take().
    bool restarted() const noexcept { return restarted_; }
    const Decoder& decoder() const noexcept { return decoder_; }

  private:
    void follow() noexcept;
    void apply(const Decoder::Update& update) noexcept;
    void open(OpenCurve& curve, const port::CurveSpan& span) noexcept;
    void send_newest(OpenCurve& curve) noexcept;
    void send(const SpanItem& item) noexcept;

    UnitFeed& feed_;
    UnitState& state_;
    WhenFull when_full_;
    Decoder decoder_{};
    OpenCurve orientation_{port::CurveChannel::orientation};
    OpenCurve position_{port::CurveChannel::position};
    bool restarted_{};
};

}  // namespace fairlead::gateway
