#pragma once
// The other side: rebuilds a unit's curves from polled registers, span by span, with the numbers
// that the gateway itself evaluates.
//
// Nothing is assumed about two requests: a page says by itself to which run and where it belongs.
// A poll that comes too late for the ring knows how many spans it lost; a new epoch ends the run.
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "examples/gateway/feed.hpp"
#include "port/linux/registers_curve.hpp"

namespace fairlead::gateway {

/// Reads `count` registers from `address`; false when there was no answer.
using ReadRegisters =
    std::function<bool(std::uint16_t address, std::uint16_t count, std::uint16_t* out)>;

enum class PollResult : std::uint8_t {
    ok,
    no_answer,
    not_a_gateway,  // other registers than this map's, or another byte order
    new_run,        // the source began anew: what was read so far is complete, call begin_run()
};

class CurveReader {
  public:
    struct Counters {
        std::uint64_t requests{};
        std::uint64_t registers{};
        std::uint64_t spans{};
        std::uint64_t lost_spans{};
        std::uint64_t lost_events{};
    };

    explicit CurveReader(ReadRegisters read) : read_{std::move(read)} {}

    /// Checks the map's magic, version and byte-order probes.
    PollResult identify();
    /// Takes over everything that is new.
    PollResult poll();
    /// Forgets the old run.
    void begin_run();

    std::uint32_t epoch() const noexcept { return epoch_; }
    std::uint16_t status() const noexcept { return status_; }
    const Counters& counters() const noexcept { return counters_; }

    /// The events of this run so far, oldest first.
    const std::vector<FeedEvent>& events() const noexcept { return events_; }

    /// Spans by number; all are final. drop_before() forgets what is not needed.
    using Spans = std::map<std::uint32_t, port::CurveSpan>;
    const Spans& spans(port::CurveChannel channel) const noexcept { return of(channel).spans; }
    /// The span that covers t, or null.
    const port::CurveSpan* covering(port::CurveChannel channel, std::int64_t t_ns) const noexcept;
    /// The curve is final up to and with this time.
    std::int64_t covered_until_ns(port::CurveChannel channel) const noexcept;
    void drop_before(std::int64_t t_ns);

  private:
    struct Channel {
        Spans spans;
        std::uint32_t wanted{};  // first span that is not read
    };
    const Channel& of(port::CurveChannel c) const noexcept {
        return channels_[static_cast<std::size_t>(c)];
    }
    bool ask(std::uint16_t address, std::uint16_t count, std::uint16_t* out);
    PollResult poll_channel(port::CurveChannel channel, std::uint32_t next);
    PollResult poll_events(std::uint32_t next);

    ReadRegisters read_;
    std::array<Channel, 2> channels_{};
    std::vector<FeedEvent> events_{};
    std::uint32_t next_event_{};
    std::uint32_t epoch_{};
    std::uint16_t status_{};
    Counters counters_{};
};

}  // namespace fairlead::gateway
