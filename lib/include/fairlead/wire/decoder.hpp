#pragma once
// Bytes in, curves out: finds frames, notices damage, and rebuilds the encoder's curves bit for
// bit.
//
// push() takes one byte; when it completes a good frame, next() gives what the frame says, one
// piece at a time, and next_event() the events. After damage or loss no curve is believed until the
// next restart frame; events need none. Bounded memory and work.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/wire/events.hpp"
#include "fairlead/wire/layout.hpp"

namespace fairlead {

class Decoder {
  public:
    using Position = VectorChannel<3>;
    using Orientation = OrientationChannel;

    struct Counters {
        std::uint32_t frames{0};    // good ones, of curves
        std::uint32_t restarts{0};  // of them, restart frames
        std::uint32_t damaged{0};   // losses of step: a bad checksum, a missing frame, nonsense
        std::uint32_t skipped_bytes{0};                       // passed over while out of step
        std::uint32_t lost_frames{0};                         // by sequence numbers, modulo 2^8
        std::uint64_t position_bits{0}, orientation_bits{0};  // of good frames, for each curve
    };

    enum class Channel : std::uint8_t { position, orientation };

    /// One step of a curve: look at position() or orientation() for its state after the step.
    struct Update {
        Channel channel{};
        bool piece{};     // a new polynomial took over at the curve's t0_ns
        bool begins{};    // ... and starts a curve: nothing joins it to what was before
        bool breaks{};    // ... in the middle of a motion, where the tolerance left no other way
        bool rejoined{};  // ... known from a restart frame; same curve as before if in step all
                          // along
    };

    /// @return true when the byte completed a good frame: call next() and next_event() until they
    /// are empty.
    bool push(std::uint8_t byte) noexcept {
        if (used_ == buffer_.size()) shift(1);
        buffer_[used_++] = byte;
        return find_frame();
    }
    /// More frames may wait among bytes that were searched again: ask when next() has run empty.
    bool more() noexcept { return find_frame(); }
    /// The input has ended: what looked like the head of a longer frame is searched, too. Then as
    /// more().
    bool finish() noexcept {
        ended_ = true;
        return find_frame();
    }

    /// The next step that the frame tells. @return false when there is none left.
    bool next(Update& update) noexcept {
        for (; turn_ < turns; ++turn_) {
            if (turn_ == 0 ? step(position_, position_batch_, Channel::position, update)
                           : step(orientation_, orientation_batch_, Channel::orientation, update))
                return true;
            step_ = 0;
        }
        return false;
    }

    /// The next event that the frame tells, each only once. flag::gap_before: events before it are
    /// missing. @return false when there is none left.
    bool next_event(Event& event) noexcept { return events_.next(event); }

    bool in_step() const noexcept { return in_step_; }
    const wire::Link<Position>& position() const noexcept { return position_; }
    const wire::Link<Orientation>& orientation() const noexcept { return orientation_; }
    std::uint32_t tick_ns() const noexcept { return header_.tick_ns; }
    /// The encoder's time, within a tick, when it made the latest restart frame.
    std::int64_t restart_ns() const noexcept { return header_.base_ns; }
    const Counters& counters() const noexcept { return counters_; }
    const EventReader::Counters& event_counters() const noexcept { return events_.counters(); }

  private:
    static constexpr std::size_t batch_knots = 8;
    static constexpr std::uint8_t turns = 2;

    /// Looks for a frame at the head of the buffer; gives up bytes that cannot start one.
    bool find_frame() noexcept {
        for (std::size_t tries = 0; tries <= wire::max_frame && used_ > 0; ++tries) {
            const std::uint8_t first = buffer_[0];
            const bool two = first >= 0x80, event = first >= wire::event_head;
            const bool restart = first >= 0xC0 && !event;
            const std::size_t head = two ? 2 : 1;
            if (used_ < head && !ended_) return false;
            const std::size_t n =
                two ? (first & (event ? 0x1fu : 0x3fu)) * 256u + buffer_[1] : first;
            // a stray byte must not hold back what follows until its length has come: frames that
            // need no step are believed from their version on
            const std::uint32_t version = event ? wire::event_version : wire::version;
            const bool stray = (restart || event) && used_ > head && buffer_[head] != version;
            const bool possible =
                n > 0 && n <= wire::max_payload && !stray && (in_step_ || restart || event);
            const bool whole = used_ >= head + n + 2;
            if (possible && !whole && !ended_) return false;  // wait for the rest
            const std::uint16_t seed =
                event ? wire::event_seed
                      : (restart ? wire::restart_seed : static_cast<std::uint16_t>(sequence_));
            if (possible && whole && good(head + n, seed) &&
                (event ? parse_events(head, n) : parse(head, n, restart))) {
                shift(head + n + 2);
                return true;
            }
            if (in_step_) ++counters_.damaged;
            in_step_ = false;
            ++counters_.skipped_bytes;
            shift(1);
        }
        return false;
    }

    bool good(std::size_t size, std::uint16_t seed) const noexcept {
        const std::uint16_t crc = crc16(buffer_.data(), size, seed);
        return buffer_[size] == crc >> 8 && buffer_[size + 1] == (crc & 0xffu);
    }

    bool parse_events(std::size_t head, std::size_t n) noexcept {
        BitReader io{buffer_.data() + head, n};
        return events_.parse(io, head + n + 2);
    }

    bool parse(std::size_t head, std::size_t n, bool restart) noexcept {
        BitReader io{buffer_.data() + head, n};
        rejoined_ = false;
        if (restart) {
            wire::Header h;
            wire::Link<Position> position;
            wire::Link<Orientation> orientation;
            if (!wire::header(io, h)) return false;
            wire::state(io, position, h.base_ns, h.tick_ns);
            wire::state(io, orientation, h.base_ns, h.tick_ns);
            if (!io.ok()) return false;
            if (known_) counters_.lost_frames += (h.sequence - sequence_) & wire::sequence_mask;
            rejoined_ = !in_step_;
            known_ = true;
            header_ = h;
            sequence_ = h.sequence;
            position_ = position;
            orientation_ = orientation;
        }
        position_batch_ = {};
        orientation_batch_ = {};
        const std::size_t head_bits = io.used_bits();
        if (!wire::content(io, position_, position_batch_, header_.base_ns, header_.tick_ns))
            return false;
        const std::size_t position_end = io.used_bits();
        if (!wire::content(io, orientation_, orientation_batch_, header_.base_ns, header_.tick_ns))
            return false;
        counters_.position_bits += position_end - head_bits;
        counters_.orientation_bits += io.used_bits() - position_end;
        in_step_ = true;
        sequence_ = (sequence_ + 1) & wire::sequence_mask;
        ++counters_.frames;
        counters_.restarts += restart;
        turn_ = 0;
        step_ = 0;
        return true;
    }

    template <class Link, class Frozen>
    bool step(Link& link, const Frozen& batch, Channel channel, Update& update) noexcept {
        update = {};
        update.channel = channel;
        if (step_ == 0) {  // what a decoder that was out of step has to take over
            ++step_;
            if (rejoined_ && link.active) {
                update.piece = update.rejoined = true;
                return true;
            }
        }
        if (step_ == 1) {
            ++step_;
            if (batch.begins) {
                wire::follow_start(link, batch);
                update.piece = update.begins = true;
                update.breaks = batch.breaks;
                return true;
            }
        }
        if (step_ < 2 + batch.size) {
            wire::follow_knot(link, batch, step_ - 2, header_.tick_ns);
            ++step_;
            update.piece = true;
            return true;
        }
        if (step_ == 2 + batch.size && batch.covers) {
            ++step_;
            link.cover_ticks = batch.cover_ticks;
            return true;
        }
        return false;
    }

    void shift(std::size_t n) noexcept {
        for (std::size_t i = n; i < used_; ++i) buffer_[i - n] = buffer_[i];
        used_ -= n;
    }

    std::array<std::uint8_t, wire::max_frame> buffer_{};
    std::size_t used_{0};
    wire::Header header_{};
    wire::Link<Position> position_{};
    wire::Link<Orientation> orientation_{};
    Batch<Position, batch_knots> position_batch_{};
    Batch<Orientation, batch_knots> orientation_batch_{};
    EventReader events_{};
    Counters counters_{};
    std::uint32_t sequence_{0};
    std::size_t step_{0};
    std::uint8_t turn_{turns};
    bool ended_{false}, in_step_{false}, known_{false}, rejoined_{false};
};

}  // namespace fairlead
