#pragma once
// Discrete channels beside the curves: buttons, triggers, taps. A channel is a list of changes of
// its value, each with its exact time [Balaguer & Gobbetti 1995, discrete tracks].
//
// Events travel in frames of their own kind, which need nothing of what was sent before: damage to
// a curve costs no event, a lost event frame costs no curve, and a late joiner reads the first one
// that comes. Every event that is offered has a number. A hole in the numbers tells a reader how
// many are missing, whether a full queue refused them or the wire lost them. After a restart point
// the newest event of each channel is sent again: who knows it passes over it, who does not learns
// the channel's value.
//
//   event frame   2 bytes, top bits 111, payload size; payload; CRC-16 with a seed of its own
//   payload       version, number of the next event (its low 16 bits), count, then per event:
//                 number, gap before it?, time, channel, value
//
// Times are 64-bit integers, sent as differences that wrap around: every one comes out exactly.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/ring.hpp"
#include "fairlead/base/types.hpp"
#include "host_sim/study/baselines/earlier/wire/layout.hpp"

namespace fairlead::earlier {
namespace wire {

inline constexpr std::uint32_t event_version = 0xE1;
inline constexpr std::uint16_t event_seed = 0xE7E5;
inline constexpr std::uint8_t event_head = 0xE0;
inline constexpr std::uint32_t number_mask = 0xffff;

// bits of an event: (1 + 5 + 16) number, 1 gap, (7 + 64) time, (5 + 16) channel, (5 + 16) value
inline constexpr std::size_t event_size_max = 17;
inline constexpr std::size_t event_header_size = 4;  // 8 version, 16 number, 5 count
inline constexpr std::size_t max_events = (max_payload - event_header_size) / event_size_max;
constexpr std::size_t event_frame_size(std::size_t count) noexcept {
    return 2 + event_header_size + count * event_size_max + 2;
}
static_assert(max_events < 32);

/// An event in a frame. back: how many numbers it stands before the next event's.
struct EventItem {
    Event event{};
    std::uint32_t back{};
};
/// What an item is told against: the one before it.
struct EventTrace {
    std::uint32_t back{};  // that a consecutive event would have
    std::uint64_t t_ns{};
};

template <class Io>
bool event_header(Io& io, std::uint32_t& next, std::uint32_t& count) noexcept {
    std::uint32_t v = event_version;
    io.bits(v, 8);
    io.bits(next, 16);
    io.bits(count, 5);
    return io.ok() && v == event_version && count > 0 && count <= max_events;
}

template <class Io>
void small_number(Io& io, std::uint16_t& v, bool& good) noexcept {
    std::uint64_t wide = v;
    unsigned_number(io, wide, 5);
    good = good && wide <= 0xffff;
    v = static_cast<std::uint16_t>(wide);
}

template <class Io>
bool event_item(Io& io, EventItem& item, EventTrace& trace) noexcept {
    bool good = true;
    if (flag(io, item.back == trace.back)) {
        item.back = trace.back;
    } else {
        auto back = static_cast<std::uint16_t>(item.back < number_mask ? item.back : number_mask);
        small_number(io, back, good);
        item.back = back;
    }
    const bool gap = flag(io, (item.event.flags & fairlead::flag::gap_before) != 0);
    item.event.flags = gap ? fairlead::flag::gap_before : 0;
    const auto t_ns = static_cast<std::uint64_t>(item.event.t_ns);
    std::uint64_t apart = zigzag64(static_cast<std::int64_t>(t_ns - trace.t_ns));
    unsigned_number(io, apart, 7);
    trace.t_ns += static_cast<std::uint64_t>(unzigzag64(apart));
    item.event.t_ns = static_cast<std::int64_t>(trace.t_ns);
    small_number(io, item.event.channel, good);
    small_number(io, item.event.value, good);
    trace.back = item.back - 1;
    return good && item.back > 0 && io.ok();
}

}  // namespace wire

/// The sending side: a queue of N events, and the newest one of up to N channels. What is accepted
/// is sent; what does not fit is refused, counted, and missing in the numbers. Memory: sizeof. N
/// may be 0.
template <std::size_t N>
class EventSender {
    static_assert(N > 0 && 2 * N <= wire::max_events, "a frame holds all events of the sender");

  public:
    static constexpr std::size_t frame_size_max = wire::event_frame_size(2 * N);

    /// @return false: the queue is full, and the event is not taken.
    bool push(const Event& event) noexcept {
        if (pending_.full()) {
            ++refused_;
            if (next_ - first_ < wire::number_mask / 4) ++next_;  // "so many, or more"
            return false;
        }
        if (pending_.empty()) {
            first_ = next_;
            waited_ = 0;
        }
        ++next_;
        pending_.push(event);
        return true;
    }
    /// The next frame tells the newest event of each channel again.
    void repeat() noexcept { repeat_ = latest_size_ > 0; }

    /// Called once a record. Writes the frame with all that waits, once it has waited for `hold`
    /// records or fills the queue. @return its size; 0: none.
    std::size_t frame(std::uint8_t* out, std::uint32_t hold) noexcept {
        const bool due = !pending_.empty() && (waited_ >= hold || pending_.full());
        if (!due && !repeat_) {
            ++waited_;
            return 0;
        }
        BitWriter io{out + 2, wire::max_payload};
        const std::size_t again = repeat_ ? latest_size_ : 0;
        auto count = static_cast<std::uint32_t>(again + pending_.size());
        std::uint32_t next = next_ & wire::number_mask;
        wire::event_header(io, next, count);
        wire::EventTrace trace{count, 0};
        for (std::size_t i = 0; i < again; ++i) put(io, latest_[i], number_[i], trace);
        for (std::size_t i = 0; i < pending_.size(); ++i)
            put(io, pending_[i], first_ + static_cast<std::uint32_t>(i), trace);
        for (std::size_t i = 0; i < pending_.size(); ++i)
            remember(pending_[i], first_ + static_cast<std::uint32_t>(i));
        pending_.clear();
        repeat_ = false;
        FAIRLEAD_ASSERT(io.ok());
        return seal(out, io.size());
    }

    bool empty() const noexcept { return pending_.empty(); }
    std::uint32_t refused() const noexcept { return refused_; }

  private:
    void put(BitWriter& io, const Event& event, std::uint32_t number,
             wire::EventTrace& trace) noexcept {
        wire::EventItem item{event, next_ - number};
        wire::event_item(io, item, trace);
    }

    /// Keeps the newest event of each channel, oldest first; the oldest channel gives way.
    void remember(const Event& event, std::uint32_t number) noexcept {
        std::size_t at = 0;
        while (at < latest_size_ && latest_[at].channel != event.channel) ++at;
        if (at == N) at = 0;
        if (at == latest_size_) {
            ++latest_size_;
        } else {
            for (; at + 1 < latest_size_; ++at) {
                latest_[at] = latest_[at + 1];
                number_[at] = number_[at + 1];
            }
        }
        latest_[latest_size_ - 1] = event;
        number_[latest_size_ - 1] = number;
    }

    static std::size_t seal(std::uint8_t* out, std::size_t n) noexcept {
        out[0] = static_cast<std::uint8_t>(wire::event_head | (n >> 8));
        out[1] = static_cast<std::uint8_t>(n & 0xffu);
        return append_crc16(out, 2 + n, wire::event_seed);
    }

    Ring<Event, N> pending_{};
    std::array<Event, N> latest_{};
    std::array<std::uint32_t, N> number_{};  // of latest_
    std::size_t latest_size_{0};
    std::uint32_t next_{0};   // number of the next event that is offered
    std::uint32_t first_{0};  // of the oldest that waits; those behind it follow one by one
    std::uint32_t waited_{0};
    std::uint32_t refused_{0};
    bool repeat_{false};
};

/// A sender without events: takes none, and next to no memory.
template <>
class EventSender<0> {
  public:
    static constexpr std::size_t frame_size_max = 0;

    bool push(const Event&) noexcept {
        ++refused_;
        return false;
    }
    static void repeat() noexcept {}
    static std::size_t frame(std::uint8_t*, std::uint32_t) noexcept { return 0; }
    static bool empty() noexcept { return true; }
    std::uint32_t refused() const noexcept { return refused_; }

  private:
    std::uint32_t refused_{0};
};

/// The reading side: the events of a frame that are new, in the order in which they were offered.
class EventReader {
  public:
    struct Counters {
        std::uint32_t frames{0};
        std::uint32_t events{0};  // new ones
        std::uint64_t bytes{0};   // of the frames
        std::uint32_t lost{0};    // missing in the numbers: refused by the sender, or lost
    };

    /// The payload of a frame whose checksum is right. @return false where it is nonsense.
    bool parse(BitReader& io, std::size_t frame_size) noexcept {
        size_ = turn_ = 0;
        std::uint32_t next = 0, count = 0;
        if (!wire::event_header(io, next, count)) return false;
        std::uint32_t ahead = (next - expected_) & wire::number_mask;
        // numbers that go back are those of another run of the sender: all of it is new
        const bool stranger = !known_ || ahead > wire::number_mask / 2;
        if (stranger) ahead = wire::number_mask;
        wire::EventTrace trace{count, 0};
        wire::EventItem item;
        std::uint32_t due = ahead;  // `back` of the event that would follow without a hole
        bool hole = hole_ && !stranger;
        for (std::uint32_t i = 0; i < count; ++i) {
            if (!wire::event_item(io, item, trace)) return refuse();
            if (!stranger && item.back > due) continue;  // known already
            const bool first =
                stranger && size_ == 0 && ((next - item.back) & wire::number_mask) == 0;
            if (hole || (item.back < due && !first)) item.event.flags |= flag::gap_before;
            hole = false;
            due = item.back - 1;
            events_[size_++] = item.event;
        }
        if (io.left() > 0) return refuse();
        if (!stranger) counters_.lost += ahead - static_cast<std::uint32_t>(size_);
        hole_ = hole || due > 0;
        known_ = true;
        expected_ = next;
        ++counters_.frames;
        counters_.bytes += frame_size;
        counters_.events += static_cast<std::uint32_t>(size_);
        return true;
    }
    /// The next new event of the frame. @return false when there is none left.
    bool next(Event& event) noexcept {
        if (turn_ == size_) return false;
        event = events_[turn_++];
        return true;
    }

    const Counters& counters() const noexcept { return counters_; }

  private:
    bool refuse() noexcept {
        size_ = 0;
        return false;
    }

    std::array<Event, wire::max_events> events_{};
    std::size_t size_{0}, turn_{0};
    Counters counters_{};
    std::uint32_t expected_{0};  // number of the next event
    bool known_{false};
    bool hole_{false};  // events are missing before the next one
};

}  // namespace fairlead::earlier
