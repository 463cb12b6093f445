#pragma once
// Discrete channels beside the curves: buttons, triggers, taps. A channel is a list of changes of
// its value, each with its exact time [Balaguer & Gobbetti 1995, discrete tracks].
//
// Events travel in frames of their own, which need nothing but the stream's header: damage to a
// curve costs no event, a lost event frame costs no curve. Every event that is offered has a
// number; a hole in the numbers tells a reader how many are missing. After a restart frame the
// newest event of each channel is sent again: a reader that knows it passes over it.
//
// Times are 64-bit integers of ns: every one comes out exactly. docs/stream.md, Event frames.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/ring.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/code/model.hpp"
#include "fairlead/code/range_coder.hpp"
#include "fairlead/wire/check.hpp"

namespace fairlead::wire {

inline constexpr std::uint32_t event_number_mask = 0xffff;
// bits of an event: (1 + 16) number, 1 gap, (7 + 64) time, (5 + 16) channel, (5 + 16) value
inline constexpr std::size_t event_size_max = 17, event_frame_head = 2 + 4;
inline constexpr std::size_t events_max =
    (long_frame_max - event_frame_head - crc_size) / event_size_max;
static_assert(events_max < 32);

namespace detail {

/// A number by the number of its bits, and its bits behind the first.
template <class Io>
constexpr bool code_sized(Io& io, std::uint64_t& v, unsigned width_bits, unsigned most) noexcept {
    std::uint32_t width = 0;
    for (std::uint64_t rest = v; rest != 0; rest >>= 1) ++width;
    io.bits(width, width_bits);
    if (width > most) return false;
    auto high = static_cast<std::uint32_t>(v >> 32), low = static_cast<std::uint32_t>(v);
    const unsigned below = width > 0 ? width - 1 : 0;
    const std::uint64_t first = width > 0 ? std::uint64_t{1} << below : 0;
    if (below > 32) {
        high &= static_cast<std::uint32_t>((first - 1u) >> 32);
        io.bits(high, below - 32);
        io.bits(low, 32);
    } else {
        high = 0;
        low = static_cast<std::uint32_t>(low & (first == 0 ? 0u : first - 1u));
        io.bits(low, below);
    }
    v = first | std::uint64_t{high} << 32 | low;
    return true;
}
template <class Io>
constexpr bool code_short(Io& io, std::uint16_t& v) noexcept {
    std::uint64_t wide = v;
    const bool good = code_sized(io, wide, 5, 16);
    v = static_cast<std::uint16_t>(wide);
    return good;
}

/// An event, and how many numbers it stands before the next one that will be offered.
struct EventItem {
    Event event{};
    std::uint32_t back{0};
};
/// What an item is told against: the item before it.
struct EventTrace {
    std::uint32_t back{0};  // that a consecutive event would have
    std::int64_t t_ns{0};
};

template <class Io>
constexpr bool code_event(Io& io, EventItem& item, EventTrace& trace) noexcept {
    bool follows = item.back == trace.back;
    io.flag(follows, 3, 2);
    std::uint32_t back = item.back < event_number_mask ? item.back : event_number_mask;
    if (!follows) io.bits(back, 16);
    item.back = follows ? trace.back : back;
    bool gap = (item.event.flags & flag::gap_before) != 0;
    io.flag(gap, 1, 4);
    item.event.flags = gap ? flag::gap_before : 0;
    // differences wrap around: every time comes out exactly
    const auto from = static_cast<std::uint64_t>(trace.t_ns);
    const auto apart = static_cast<std::uint64_t>(item.event.t_ns) - from;
    std::uint64_t folded = apart >> 63 ? ~(apart << 1) : apart << 1;
    if (!code_sized(io, folded, 7, 64)) return false;
    const std::uint64_t unfolded = folded & 1u ? ~(folded >> 1) : folded >> 1;
    item.event.t_ns = static_cast<std::int64_t>(from + unfolded);
    if (!code_short(io, item.event.channel) || !code_short(io, item.event.value)) return false;
    trace = {item.back - 1, item.event.t_ns};
    return item.back > 0 && io.ok();
}

template <class Io>
constexpr bool code_event_head(Io& io, std::uint32_t& next, std::uint32_t& count) noexcept {
    io.bits(next, 16);
    io.bits(count, 5);
    return io.ok() && count > 0 && count <= events_max;
}

}  // namespace detail

/// The sending side: a queue of N events, and the newest one of up to N channels. What is accepted
/// is sent; what does not fit is refused, counted, and missing in the numbers. Memory: sizeof. N
/// may be 0.
template <std::size_t N>
class EventSender {
    static_assert(2 * N <= events_max, "a frame holds all events of the sender: at most 6");

  public:
    static constexpr std::size_t frame_max = event_frame_head + 2 * N * event_size_max + crc_size;

    /// @return false: the queue is full, and the event is not taken.
    bool push(const Event& event) noexcept {
        if (pending_.full()) {
            ++refused_;
            if (next_ - first_ < event_number_mask / 4) ++next_;  // "so many, or more"
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
    /// records or fills the queue: frame_max bytes at `out`. digest: of the stream's header;
    /// base_ns: of its run. @return its size; 0: none.
    std::size_t frame(std::uint8_t* out, std::uint32_t hold, std::uint32_t digest,
                      std::int64_t base_ns) noexcept {
        const bool due = !pending_.empty() && (waited_ >= hold || pending_.full());
        if (!due && !repeat_) {
            ++waited_;
            return 0;
        }
        code::RangeEncoder io{out + 2, frame_max - 2 - crc_size};
        const std::size_t again = repeat_ ? latest_size_ : 0;
        auto count = static_cast<std::uint32_t>(again + pending_.size());
        std::uint32_t next = next_ & event_number_mask;
        detail::code_event_head(io, next, count);
        detail::EventTrace trace{count, base_ns};
        for (std::size_t i = 0; i < again; ++i) put(io, latest_[i], number_[i], trace);
        for (std::size_t i = 0; i < pending_.size(); ++i)
            put(io, pending_[i], first_ + static_cast<std::uint32_t>(i), trace);
        for (std::size_t i = 0; i < pending_.size(); ++i)
            remember(pending_[i], first_ + static_cast<std::uint32_t>(i));
        pending_.clear();
        repeat_ = false;
        return seal(out, io.finish(), digest);
    }

    bool empty() const noexcept { return pending_.empty(); }
    std::uint32_t refused() const noexcept { return refused_; }

  private:
    void put(code::RangeEncoder& io, const Event& event, std::uint32_t number,
             detail::EventTrace& trace) noexcept {
        detail::EventItem item{event, next_ - number};
        detail::code_event(io, item, trace);
    }
    /// Keeps the newest event of each channel, oldest first; the oldest channel gives way.
    void remember(const Event& event, std::uint32_t number) noexcept {
        std::size_t at = 0;
        while (at < latest_size_ && latest_[at].channel != event.channel) ++at;
        if (at == N) at = 0;
        if (at == latest_size_) ++latest_size_;
        for (; at + 1 < latest_size_; ++at) {
            latest_[at] = latest_[at + 1];
            number_[at] = number_[at + 1];
        }
        latest_[latest_size_ - 1] = event;
        number_[latest_size_ - 1] = number;
    }
    static std::size_t seal(std::uint8_t* out, std::size_t n, std::uint32_t digest) noexcept {
        out[0] = event_head;
        out[1] = static_cast<std::uint8_t>(n);
        const std::uint32_t crc = crc32(out, 2 + n, digest);
        for (std::size_t i = 0; i < crc_size; ++i)
            out[2 + n + i] = static_cast<std::uint8_t>(crc >> (8 * i));
        return 2 + n + crc_size;
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
    static constexpr std::size_t frame_max = 0;
    bool push(const Event&) noexcept {
        ++refused_;
        return false;
    }
    static void repeat() noexcept {}
    static std::size_t frame(std::uint8_t*, std::uint32_t, std::uint32_t, std::int64_t) noexcept {
        return 0;
    }
    static bool empty() noexcept { return true; }
    std::uint32_t refused() const noexcept { return refused_; }

  private:
    std::uint32_t refused_{0};
};

struct EventCounters {
    std::uint32_t frames{0};
    std::uint32_t events{0};  // new ones
    std::uint32_t lost{0};    // missing in the numbers: refused by the sender, or lost
};

/// The reading side: the events of a frame that are new, in the order in which they were offered.
/// The bytes of the frame must stay until they were asked for, or the next frame is parsed.
class EventReader {
  public:
    using Counters = EventCounters;

    /// The payload of a frame whose CRC is right; base_ns: of its run. @return false: nonsense.
    bool parse(const std::uint8_t* payload, std::size_t size, std::int64_t base_ns) noexcept {
        walk_ = {};
        walk_.io = {payload, size};
        std::uint32_t next = 0, count = 0;
        if (!detail::code_event_head(walk_.io, next, count)) return false;
        const std::uint32_t ahead = (next - expected_) & event_number_mask;
        // numbers that go back are those of another run of the sender: all of it is new
        walk_.stranger = !known_ || ahead > event_number_mask / 2;
        walk_.due = static_cast<std::uint16_t>(walk_.stranger ? event_number_mask : ahead);
        walk_.next = next;
        walk_.trace = {count, base_ns};
        walk_.hole = hole_ && !walk_.stranger;
        walk_.left = static_cast<std::uint8_t>(count);
        Walk walk = walk_;  // to the end of the frame, before any event is told
        Event event;
        std::uint32_t fresh = 0;
        while (walk.step(event)) ++fresh;
        if (!walk.good || !walk.io.finished()) {
            close();
            return false;
        }
        if (!walk.stranger) counters_.lost += ahead - fresh;
        hole_ = walk.hole || walk.due > 0;
        known_ = true;
        expected_ = next;
        ++counters_.frames;
        counters_.events += fresh;
        return true;
    }
    /// The next new event of the frame. @return false when there is none left.
    bool next(Event& event) noexcept { return walk_.step(event); }
    /// The bytes of the frame go away.
    void close() noexcept { walk_.left = 0; }
    const Counters& counters() const noexcept { return counters_; }

  private:
    struct Walk {
        code::RangeDecoder io{};
        detail::EventTrace trace{};
        std::uint32_t next{0};
        std::uint16_t due{0};  // `back` of the event that would follow without a hole
        std::uint8_t left{0};
        bool hole{false}, stranger{false}, any{false}, good{true};

        bool step(Event& event) noexcept {
            while (left > 0) {
                --left;
                detail::EventItem item;
                good = detail::code_event(io, item, trace);
                if (!good) return left = 0, false;
                if (!stranger && item.back > due) continue;  // known already
                const bool first =
                    stranger && !any && ((next - item.back) & event_number_mask) == 0;
                if (hole || (item.back < due && !first)) item.event.flags |= flag::gap_before;
                hole = false;
                any = true;
                due = static_cast<std::uint16_t>(item.back - 1);
                event = item.event;
                return true;
            }
            return false;
        }
    };

    Walk walk_{};
    Counters counters_{};
    std::uint32_t expected_{0};  // number of the next event
    bool known_{false};
    bool hole_{false};  // events are missing before the next one
};

/// The reading side of a decoder that passes events over.
class NoEventReader {
  public:
    static bool parse(const std::uint8_t*, std::size_t, std::int64_t) noexcept { return false; }
    static bool next(Event&) noexcept { return false; }
    static void close() noexcept {}
    static const EventCounters& counters() noexcept { return none; }

  private:
    static constexpr EventCounters none{};
};

}  // namespace fairlead::wire
