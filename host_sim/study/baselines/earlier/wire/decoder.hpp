#pragma once
// Bytes in, curves out: finds frames, notices damage, and rebuilds the encoder's curves bit for
// bit.
//
// push() takes one byte; when it finds a good frame, next() gives what the frame says, one piece at
// a time, and next_event() the events. After damage or loss no curve is believed until the next
// restart frame; events need none.
//
// Bounded memory and work. Damage lets a decoder wait for the end of a frame that never was, and
// then all bytes since its false head have to be searched again. A push tries `tries_per_byte`
// places at most, each at a cost that does not depend on the frame's length (wire/backlog.hpp), and
// takes one frame at most; the next pushes go on. So frames that were held back come out while
// later bytes go in, at most max_frame / (tries_per_byte - 1) bytes late; undamaged ones with their
// last byte. Out of step, a second place that looks like a head is watched beside the first, by two
// tries more, so that one false head does not hold back the restart frame that ends the damage.
#include <array>
#include <cstddef>
#include <cstdint>

#include "host_sim/study/baselines/earlier/wire/backlog.hpp"
#include "host_sim/study/baselines/earlier/wire/events.hpp"
#include "host_sim/study/baselines/earlier/wire/layout.hpp"

namespace fairlead::earlier {

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

    static constexpr std::size_t tries_per_byte = 4;

    /// @return true when a good frame was found: call next() and next_event() until they are empty.
    bool push(std::uint8_t byte) noexcept {
        bytes_.push(byte);
        return find_frame(tries_per_byte);
    }
    /// The input has ended: looks for the next frame among the bytes that are left, also behind
    /// what looked like the head of a longer one. As push(); call it until it returns false.
    bool finish() noexcept {
        ended_ = true;
        return find_frame(wire::Backlog::live_max);
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

    /// What the first bytes of the backlog say of the frame that they would begin.
    struct Head {
        std::size_t size{1};     // of the head itself
        std::size_t payload{0};  // bytes that follow it, before the checksum
        std::uint16_t seed{0};
        bool event{false}, restart{false};

        std::size_t sealed() const noexcept { return size + payload; }
        std::size_t frame() const noexcept { return sealed() + 2; }
        bool possible() const noexcept { return payload > 0 && payload <= wire::max_payload; }
    };

    /// Looks for a frame at the front of the backlog; gives up bytes that cannot start one.
    bool find_frame(std::size_t tries) noexcept {
        for (; tries > 0 && bytes_.size() > 0; --tries) {
            if (may_begin(0)) {
                if (bytes_.size() == 1 && bytes_[0] >= 0x80 && !ended_) return false;
                const Head head = read_head(0);
                const bool whole = bytes_.size() >= head.frame();
                if (head.possible() && !whole && !ended_) {
                    if (!find_later()) return false;
                    continue;
                }
                if (head.possible() && whole && bytes_.sealed(0, head.sealed(), head.seed) &&
                    parse(head)) {
                    bytes_.drop(head.frame());
                    later_ = 0;
                    return true;
                }
            }
            give_up_byte();
        }
        return false;
    }

    /// What looks like a head waits for its rest. Out of step it may be none, so the next place
    /// that looks like one is watched, too: where a frame is sealed there, the bytes before it are
    /// given up. @return whether it stands at the front now.
    bool find_later() noexcept {
        if (in_step_) return false;
        for (std::size_t tries = 2; tries > 0; --tries, ++later_) {
            if (later_ + 3 > bytes_.size()) return false;
            if (later_ == 0 || !may_begin(later_)) continue;
            const Head head = read_head(later_);
            if (!head.possible()) continue;
            if (later_ + head.frame() > bytes_.size()) return false;
            if (!bytes_.sealed(later_, head.sealed(), head.seed)) continue;
            counters_.skipped_bytes += static_cast<std::uint32_t>(later_);
            bytes_.drop(later_);
            later_ = 0;
            return true;
        }
        return false;
    }

    /// Out of step only frames that need no step are looked for. They are believed from their
    /// version on: a stray byte must not hold back what follows until its length has come.
    bool may_begin(std::size_t at) const noexcept {
        const std::uint8_t first = bytes_[at];
        if (first < wire::stepless_head) return in_step_;
        const auto version = first >= wire::event_head ? wire::event_version : wire::version;
        return bytes_.size() < at + 3 || bytes_[at + 2] == version;
    }

    void give_up_byte() noexcept {
        if (in_step_) ++counters_.damaged;
        in_step_ = false;
        ++counters_.skipped_bytes;
        later_ -= later_ > 0;
        bytes_.drop(1);
    }

    Head read_head(std::size_t at) const noexcept {
        const std::uint8_t first = bytes_[at];
        Head head;
        head.event = first >= wire::event_head;
        head.restart = first >= wire::stepless_head && !head.event;
        head.seed = head.event     ? wire::event_seed
                    : head.restart ? wire::restart_seed
                                   : static_cast<std::uint16_t>(sequence_);
        head.payload = first;
        if (first >= 0x80) {
            head.size = 2;
            head.payload = (first & (head.event ? 0x1fu : 0x3fu)) * std::size_t{256};
            if (bytes_.size() > at + 1) head.payload += bytes_[at + 1];
        }
        return head;
    }

    bool parse(const Head& head) noexcept {
        BitReader io{bytes_.data() + head.size, head.payload};
        return head.event ? events_.parse(io, head.frame()) : parse_curves(io, head.restart);
    }

    bool parse_curves(BitReader& io, bool restart) noexcept {
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

    wire::Backlog bytes_{};
    std::size_t later_{0};  // a place behind the front that may hold a frame; 0: not yet looked
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

}  // namespace fairlead::earlier
