#pragma once
// Bytes in, whole frames out that a reader may believe (docs/stream.md, Reading).
//
// In step, the next frame must start where the last one ended, and its check must fit all that the
// reader knows. When it does not, the reader is out of step: each place that holds a complete frame
// is tried, as the frame that should follow, as the follower of a frame that was tried before, or
// as the first one behind a restart frame. Two fitting checks in a row put the reader in step
// again. No false head holds anything back, because places are tried when the bytes of their frame
// are complete, and not in the order in which they begin.
//
// One fitting check, 2^-16, is enough only while damage is rare: the reader has `trust_max` credits
// and gets one back for each 2^41 ns (37 min) of decoded curve; a loss of step takes one. Without a
// credit each frame waits until the check of the next one fits as well, 2^-32.
//
// Bounds: memory is sizeof. A push takes at most one frame, and out of step tries at most
// `tries_per_byte` ends of frames; each costs two walks over at most 250 bytes, and at most
// `restarts_tried` CRC-32 of at most 250 bytes.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/wire/frame_head.hpp"

namespace fairlead::wire {

/// CheckBits: bits of the check that count; fewer than 16 serve tests that count wrong frames.
template <unsigned CheckBits = 16>
class Receiver {
  public:
    static constexpr std::size_t tries_per_byte = 3, restarts_tried = 6, skips_max = 2;
    static constexpr std::uint8_t trust_max = 4;
    static constexpr std::uint64_t trust_ns = std::uint64_t{1} << 41;

    /// What a push found.
    enum class Found : std::uint8_t {
        nothing,
        header,  // frame() is a header frame with a right CRC-32
        events,  // frame() is an event frame with a right CRC-32
        data,    // frame() continues the stream
        chain,   // frames that agree with each other: ask chain_frame(), then accept() or refuse()
    };
    struct Frame {
        const std::uint8_t* data{nullptr};
        std::size_t size{0};
        std::int64_t before{0};  // what code_head() needs to read the head
        constexpr const std::uint8_t* payload() const noexcept { return data + 1; }
        constexpr std::size_t payload_size() const noexcept { return size - 1 - check_size; }
    };
    struct Counters {
        std::uint32_t frames{0};      // data frames that were believed
        std::uint32_t losses{0};      // of step: damage, missing frames, foreign frames
        std::uint32_t joins{0};       // in step again, or for the first time, by a restart frame
        std::uint64_t good_bytes{0};  // of frames that were believed, of whatever kind
    };

    void add(std::uint8_t byte) noexcept {
        release();
        if (size_ == bytes_.size()) make_room();
        bytes_[size_++] = byte;
    }
    /// No byte follows: a frame that waits for the next one's check is believed by its own.
    void end() noexcept { ended_ = true; }

    /// Goes on with the bytes that are there. Call with tries_per_byte after each add().
    Found find(std::size_t tries) noexcept {
        release();
        if (queued_) return next_of_queue();
        while (tries > 0) {
            Found found{};
            if (in_step_) {
                if (!follow(found) || found != Found::nothing) return found;
                if (!in_step_) --tries;
            } else {
                if (scan_end_ > size_) return Found::nothing;
                found = try_end(scan_end_);
                if (found != Found::nothing) return found;
                --tries;
                ++scan_end_;
            }
        }
        return Found::nothing;
    }

    const Frame& frame() const noexcept { return frame_; }

    /// The stream to follow from now on. begins: the run's first frame comes next.
    void follow_header(const FrameTiming& timing, std::uint32_t digest, std::int64_t end,
                       bool begins) noexcept {
        timing_ = timing;
        if (header_known_ && digest == link_.header && !begins && end >= near_) {
            // restart frames before this header may still be waiting for their followers: a time
            // that was passed long ago is good as long as the tries reach from there to now
            const std::int64_t reach = (unwraps / 2) * (sub_per_tick << timing.time_bits);
            if (!known_ || end - near_ > reach) near_ = end;
            return;
        }
        if (in_step_ && !begins) lose_step();
        forget_chains();
        link_ = {end, digest, 0};
        near_ = end;
        header_known_ = true;
        known_ = in_step_ = begins;
        held_ = 0;
        scan_from_ = front_;
        scan_end_ = static_cast<std::uint16_t>(front_ + smallest_frame);
    }

    /// The chain's frames, the oldest first. joins: the first one is a restart frame that a reader
    /// takes its state from; otherwise the first one follows the frames that were believed before.
    std::size_t chain_size() const noexcept { return chains_[found_].count; }
    bool chain_joins() const noexcept { return chains_[found_].joins; }
    Frame chain_frame(std::size_t i) const noexcept { return frame_at(chains_[found_].at[i]); }
    /// A time to read the first frame's head from: the one that it tells, or the end of the frame
    /// before.
    std::int64_t chain_base() const noexcept {
        return chains_[found_].joins ? chains_[found_].base : link_.end;
    }
    /// The chain is believed: its frames come one after another by find().
    void accept() noexcept {
        const Chain found = chains_[found_];
        forget_chains();
        chains_[0] = found;
        queued_ = true;
        queue_at_ = 0;
        counters_.joins += found.joins;
        known_ = true;
    }
    void refuse() noexcept { chains_[found_].count = 0; }
    /// The frame that find() gave is nonsense though its check fits.
    void refuse_frame() noexcept {
        held_ = 0;
        lose_step();
    }
    /// Whether the frame that find() gave is the restart frame at which the reader joins.
    bool joining() const noexcept { return joining_; }

    bool in_step() const noexcept { return in_step_; }
    bool trusted() const noexcept { return trust_ > 0; }
    const Counters& counters() const noexcept { return counters_; }
    std::uint32_t header_digest() const noexcept { return link_.header; }
    const FrameTiming& timing() const noexcept { return timing_; }

  private:
    static constexpr std::uint16_t check_mask = static_cast<std::uint16_t>((1u << CheckBits) - 1u);
    static constexpr std::size_t smallest_frame = 1 + 1 + check_size;
    static constexpr std::size_t room_made = 8, capacity = 3 * data_frame_max + room_made + 2;

    /// Frames of which each fits the one before, not yet believed.
    struct Chain {
        std::int64_t base{0};  // of a joining one: the end of its restart frame
        std::int64_t end{0};   // of its latest frame
        std::uint32_t previous{0};
        std::array<std::uint16_t, 3> at{};
        std::uint16_t expect{0};  // where the next frame should start
        std::uint8_t count{0}, checks{0}, skips{0};
        bool joins{false};
    };

    static bool fits(std::uint16_t a, std::uint16_t b) noexcept {
        return ((a ^ b) & check_mask) == 0;
    }
    std::size_t size_at(std::size_t at) const noexcept {
        return frame_size(bytes_[at], at + 1 < size_ ? bytes_[at + 1] : 0);
    }
    Frame frame_at(std::size_t at) const noexcept { return {&bytes_[at], size_at(at), 0}; }
    bool read_head(const Frame& frame, FrameHead& head, std::int64_t before,
                   bool joining) const noexcept {
        code::RangeDecoder io{frame.payload(), frame.payload_size()};
        return code_head(io, head, timing_, before, joining);
    }

    static Link link_behind(const Frame& frame, const FrameHead& head,
                            const Link& before) noexcept {
        return {head.end, before.header, digest_of(frame.data, frame.size, head.restart, before)};
    }
    Link link_of(const Chain& c) const noexcept { return {c.end, link_.header, c.previous}; }
    static void set_link(Chain& c, const Link& link) noexcept {
        c.end = link.end;
        c.previous = link.previous;
    }

    // ---- in step

    /// The frame at front_. @return false: its bytes are not complete.
    bool follow(Found& found) noexcept {
        const bool one = size_ == front_ + 1;
        const std::size_t size = size_ <= front_ ? smallest_frame
                                 : one && bytes_[front_] > payload_max
                                     ? frame_size(bytes_[front_], 1)
                                     : size_at(front_);
        if (size > 0 && size_ < front_ + size) {
            if (!ended_) return false;
            if (held_ > 0) return found = deliver_held(), true;
            if (size_ > front_) lose_step();
            return size_ > front_;
        }
        if (size > 0 && bytes_[front_] > payload_max) return follow_long(found, size);
        frame_ = frame_at(front_);
        const Link& link = held_ > 0 ? held_link_ : link_;
        FrameHead head;
        if (size == 0 || !fits(seed_of(frame_.data, size), seed(link)) ||
            !read_head(frame_, head, link.end, false)) {
            lose_step();
            return true;
        }
        const Link after = link_behind(frame_, head, link);
        const std::size_t at = front_;
        if (held_ > 0) {  // its check was the second one for the frame that waits
            found = deliver_held();
            hold(at, size, after);
        } else if (trusted() || ended_) {
            found = deliver(at, after);
        } else {
            hold(at, size, after);
        }
        return true;
    }
    bool follow_long(Found& found, std::size_t size) noexcept {
        const Found kind = long_frame(front_, size);
        if (kind == Found::nothing) {
            lose_step();
        } else if (kind == Found::header && held_ > 0 &&
                   (bytes_[front_ + size - crc_size - 1] & 1u) != 0) {
            found = deliver_held();  // a run that begins ends the one before: no check will follow
        } else {
            found = kind;
            front_ = static_cast<std::uint16_t>(front_ + size);
            if (held_ == 0) release_ = front_;
        }
        return true;
    }
    void hold(std::size_t at, std::size_t size, const Link& after) noexcept {
        held_at_ = static_cast<std::uint16_t>(at);
        held_ = static_cast<std::uint16_t>(size);
        held_link_ = after;
        front_ = static_cast<std::uint16_t>(at + size);
    }
    Found deliver(std::size_t at, const Link& after, bool joins = false) noexcept {
        frame_ = frame_at(at);
        joining_ = joins;
        frame_.before = joins ? chains_[0].base : link_.end;
        FrameHead head;
        read_head(frame_, head, frame_.before, joins);
        believe(after, head);
        front_ = static_cast<std::uint16_t>(std::max<std::size_t>(front_, at + frame_.size));
        release_ = static_cast<std::uint16_t>(at + frame_.size);
        return Found::data;
    }
    Found deliver_held() noexcept {
        held_ = 0;
        return deliver(held_at_, held_link_);
    }
    void believe(const Link& after, const FrameHead& head) noexcept {
        const auto lasted = static_cast<std::uint64_t>(head.end - head.start);
        if (trust_ < trust_max) trusted_ns_ += lasted * timing_.sub_ns;
        if (trusted_ns_ >= trust_ns) {
            trusted_ns_ = 0;
            ++trust_;
        }
        link_ = after;
        near_ = after.end;
        ++counters_.frames;
        counters_.good_bytes += frame_.size;
    }
    void lose_step() noexcept {
        in_step_ = false;
        ++counters_.losses;
        if (trust_ > 0) --trust_;
        trusted_ns_ = 0;
        forget_chains();
        if (held_ > 0) {  // one check fits, the next may still come
            Chain& c = chains_[0];
            set_link(c, held_link_);
            c.at[0] = held_at_;
            c.expect = front_;
            c.count = c.checks = 1;
        }
        held_ = 0;
        scan_from_ = front_;
        scan_end_ = static_cast<std::uint16_t>(front_ + smallest_frame);
    }

    // ---- out of step

    /// A header or event frame. @return nothing: its CRC-32 is wrong.
    Found long_frame(std::size_t at, std::size_t size) noexcept {
        const std::uint8_t* data = &bytes_[at];
        const bool header = data[0] == header_head;
        if (!header && !header_known_) return Found::nothing;
        const std::size_t sealed = size - crc_size;
        const std::uint32_t crc = crc32(data, sealed, header ? 0 : link_.header);
        for (std::size_t i = 0; i < crc_size; ++i)
            if (data[sealed + i] != static_cast<std::uint8_t>(crc >> (8 * i)))
                return Found::nothing;
        frame_ = {data, size, 0};
        counters_.good_bytes += size;
        return header ? Found::header : Found::events;
    }

    /// All places whose frame would be complete before `end`.
    Found try_end(std::size_t end) noexcept {
        const std::size_t low = end > data_frame_max ? end - data_frame_max : 0;
        for (std::size_t p = std::max<std::size_t>(scan_from_, low); p + 4 <= end; ++p) {
            if (bytes_[p] + 3u != end - p && bytes_[p] <= payload_max) continue;
            if (size_at(p) != end - p) continue;
            if (bytes_[p] > payload_max) {
                const Found found = long_frame(p, end - p);
                if (found == Found::nothing) continue;
                pass(end);
                ++scan_end_;
                if (found == Found::header) front_ = static_cast<std::uint16_t>(end);
                return found;
            }
            if (header_known_ && try_data(p)) return Found::chain;
        }
        pass(end);
        return Found::nothing;
    }

    /// Chains whose next frame ended without fitting look behind it, a few times.
    void pass(std::size_t end) noexcept {
        for (Chain& c : chains_) {
            if (c.count == 0 || c.expect + 2u > end) continue;  // its size is not known yet
            const std::size_t size = size_at(c.expect);
            if (size == 0 || c.skips == skips_max)
                c = {};
            else if (c.expect + size <= end) {
                c.expect = static_cast<std::uint16_t>(c.expect + size);
                ++c.skips;
            }
        }
    }

    /// @return true: the frame completes a chain; found_ tells which.
    bool try_data(std::size_t p) noexcept {
        const Frame frame = frame_at(p);
        FrameHead head;
        const std::uint16_t s = seed_of(frame.data, frame.size);
        for (std::size_t i = 0; i < chains_.size(); ++i) {
            const Chain& c = chains_[i];
            if (c.count == 0 || c.expect != p || !fits(s, seed(link_of(c)))) continue;
            if (!read_head(frame, head, c.end, false)) continue;
            if (!append(chains_[i], p, frame, head)) continue;
            found_ = static_cast<std::uint8_t>(i);
            return true;
        }
        if (known_ && fits(s, seed(link_)) && read_head(frame, head, link_.end, false)) {
            Chain& c = free_chain();
            set_link(c, link_);
            append(c, p, frame, head);
        }
        try_restarts(p, s);
        return false;
    }

    /// Restart frames before p, directly or with others between, that the seed of p agrees with.
    void try_restarts(std::size_t p, std::uint16_t s) noexcept {
        std::array<std::uint16_t, restarts_tried + 1> starts{};
        std::size_t known = 1, tried = 0, level_end = 1, level = 0;
        starts[0] = static_cast<std::uint16_t>(p);
        for (std::size_t i = 0; i < known; ++i) {
            if (i == level_end) {
                level_end = known;
                if (++level > skips_max) break;
            }
            const std::size_t q = starts[i];
            const std::size_t low = q > data_frame_max ? q - data_frame_max : 0;
            for (std::size_t r = std::max<std::size_t>(scan_from_, low); r + 4 <= q; ++r) {
                if (bytes_[r] + 3u != q - r && bytes_[r] <= payload_max) continue;
                if (size_at(r) != q - r || tried == restarts_tried) continue;
                ++tried;
                if (known < starts.size()) starts[known++] = static_cast<std::uint16_t>(r);
                if (bytes_[r] <= payload_max) try_restart(r, p, s);
            }
        }
    }
    void try_restart(std::size_t r, std::size_t p, std::uint16_t s) noexcept {
        const Frame restart = frame_at(r), frame = frame_at(p);
        FrameHead first, head;
        if (!read_head(restart, first, near_, true)) return;
        Link link = link_behind(restart, first, link_);
        const std::int64_t turn = sub_per_tick << timing_.time_bits;
        for (int i = 0; i < unwraps; ++i, link.end += turn)
            if (fits(s, seed(link)) && read_head(frame, head, link.end, false))
                return join(r, p, first.start + (link.end - first.end), link, frame, head);
    }
    void join(std::size_t r, std::size_t p, std::int64_t start, const Link& link,
              const Frame& frame, const FrameHead& head) noexcept {
        // a second restart frame would leave the first one with a single check
        if (head.restart && !timing_.independent) return;
        Chain& c = free_chain();
        c.joins = true;
        c.base = timing_.independent ? start : link.end;
        set_link(c, link);
        c.at[c.count++] = static_cast<std::uint16_t>(r);
        append(c, p, frame, head);
    }
    void forget_chains() noexcept {
        for (Chain& c : chains_) c.count = 0;
        queued_ = false;
    }
    Chain& free_chain() noexcept {
        Chain* best = &chains_[0];
        for (Chain& c : chains_)  // an empty one, or else the oldest
            if (best->count > 0 && (c.count == 0 || c.at[0] < best->at[0])) best = &c;
        *best = {};
        return *best;
    }
    /// @return true: two checks fit.
    bool append(Chain& c, std::size_t p, const Frame& frame, const FrameHead& head) noexcept {
        c.at[c.count++] = static_cast<std::uint16_t>(p);
        ++c.checks;
        set_link(c, link_behind(frame, head, link_of(c)));
        c.expect = static_cast<std::uint16_t>(p + frame.size);
        c.skips = 0;
        return c.checks >= 2;
    }

    /// The next frame of a chain that was accepted; the last one may have to wait.
    Found next_of_queue() noexcept {
        const Chain& queue = chains_[0];
        const bool joins = queue_at_ == 0 && queue.joins;
        const std::size_t at = queue.at[queue_at_++];
        frame_ = frame_at(at);
        FrameHead head;
        read_head(frame_, head, joins ? queue.base : link_.end, joins);
        const Link after = link_behind(frame_, head, link_);
        if (queue_at_ == queue.count) {
            queued_ = false;
            in_step_ = true;
            front_ = static_cast<std::uint16_t>(at + frame_.size);
            if (!trusted() && !ended_) {
                hold(at, frame_.size, after);
                return Found::nothing;
            }
        }
        return deliver(at, after, joins);
    }

    // ---- memory

    /// Forgets the bytes before release_.
    void release() noexcept {
        if (release_ > 0) drop(release_);
        release_ = 0;
    }
    /// Out of step only: in step, two frames are the most that is kept.
    void make_room() noexcept { drop(room_made); }
    void drop(std::size_t n) noexcept {
        const auto less = [n](std::uint16_t at) {
            return static_cast<std::uint16_t>(at > n ? at - n : 0);
        };
        for (Chain& c : chains_) {
            if (c.count == 0) continue;
            if (c.at[0] < n && !queued_) {
                c.count = 0;
                continue;
            }
            for (std::size_t i = 0; i < c.count; ++i) c.at[i] = less(c.at[i]);
            c.expect = less(c.expect);
        }
        held_at_ = less(held_at_);
        front_ = less(front_);
        scan_from_ = less(scan_from_);
        scan_end_ = less(scan_end_);
        std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(n), bytes_.begin() + size_,
                  bytes_.begin());
        size_ = static_cast<std::uint16_t>(size_ - n);
    }

    std::array<std::uint8_t, capacity> bytes_{};
    std::array<Chain, 4> chains_{};
    Frame frame_{};
    Link link_{}, held_link_{};
    std::int64_t near_{0};
    std::uint64_t trusted_ns_{0};
    Counters counters_{};
    FrameTiming timing_{};
    std::uint8_t found_{0}, queue_at_{0};  // chains_[0] is the one that was accepted, if queued_
    std::uint16_t size_{0}, front_{0}, held_at_{0}, held_{0}, release_{0};
    std::uint16_t scan_from_{0}, scan_end_{smallest_frame};
    std::uint8_t trust_{trust_max};
    bool in_step_{false}, known_{false}, header_known_{false}, ended_{false}, joining_{false};
    bool queued_{false};
};

}  // namespace fairlead::wire
