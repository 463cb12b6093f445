#pragma once
// Bytes in, whole frames out that a reader may believe (docs/stream.md, Reading).
//
// In step, the next frame must start where the last one ended, and its check must fit all that the
// reader knows. When it does not, the reader is out of step, and searches: for each byte, the
// places whose frame ends there are tried, as the frame that should follow the last one, as the
// follower of a frame that was tried before, or as the first one behind a restart frame. Two
// fitting checks in a row put the reader in step again; behind a restart frame whose time is none
// of the first tries, three. A false head holds nothing back, because places are tried when the
// bytes of their frame are complete, and not in the order in which they begin.
//
// One fitting check, 2^-16, is enough only while damage is rare: the reader has `trust_max` credits
// and gets one back for each 2^41 ns (37 min) of decoded curve; a loss of step takes one. Without a
// credit each frame waits until the check of the next one fits as well, 2^-32.
//
// Bounds: memory is sizeof. Out of step, each byte that comes allows `work_per_byte` units of work,
// a unit is about what the CRC of a byte costs; the search for the ends of frames waits where it
// has used more, so that a line that is damaged, or made to cost most, costs a constant for each
// byte. A byte's search overdraws at most `overdraft` units and one frame. What waits too long is
// not searched: the reader is in step later, and believes nothing else.
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
    static constexpr std::int32_t work_per_byte = 240, overdraft = 1600;
    static constexpr unsigned places_tried = 8;
    static constexpr std::size_t restarts_tried = 6, skips_max = 2;
    static constexpr std::uint8_t trust_max = 4;
    // 2^41 ns in units of 2^10 ns
    static constexpr unsigned trust_unit_bits = 10;
    static constexpr std::uint32_t trust_units = std::uint32_t{1} << 31;

    /// What find() found.
    enum class Found : std::uint8_t {
        nothing,
        header,  // frame() is a header frame with a right CRC-32
        events,  // frame() is an event frame with a right CRC-32
        data,    // frame() continues the stream
        chain,   // frames that agree with each other: ask chain(), then accept() or refuse()
    };
    struct Frame {
        const std::uint8_t* data{nullptr};
        std::uint16_t size{0};
        std::uint8_t since{0};  // what code_head() needs to read the head, as `before`
        std::int64_t before{0};
        constexpr const std::uint8_t* payload() const noexcept { return data + 1; }
        constexpr std::size_t payload_size() const noexcept { return size - 1u - check_size; }
    };
    /// How a chain begins.
    enum class Start : std::uint8_t {
        follows,       // with the frame behind the latest that was believed
        restart,       // with a restart frame that a reader takes its state from
        late_restart,  // likewise, and its time is one of the later tries: a third check must fit
    };
    /// Frames of which each fits the one before, not yet believed.
    struct Chain {
        Link link{};           // behind the newest
        std::int64_t base{0};  // of one that joins: the end of its restart frame, or what tells it
        std::array<std::uint16_t, 3> at{};
        std::uint8_t count{0};
        Start start{Start::follows};

        constexpr bool joins() const noexcept { return start != Start::follows; }
        /// Checks that fit: of all frames but the one at which a reader joins.
        constexpr int checks() const noexcept { return count - joins(); }
        constexpr bool complete() const noexcept {
            return checks() >= 2 && start != Start::late_restart;
        }
    };
    struct Counters {
        std::uint32_t frames{0};      // data frames that were believed
        std::uint32_t losses{0};      // of step: damage, missing frames, foreign frames
        std::uint32_t joins{0};       // in step again, or for the first time, by a restart frame
        std::uint64_t good_bytes{0};  // of frames that were believed, of whatever kind
    };

    void add(std::uint8_t byte) noexcept {
        release();
        if (size_ == bytes_.size()) drop(room_made);
        bytes_[size_++] = byte;
        work_ = (std::min)(work_ + work_per_byte, work_per_byte);
    }
    /// No byte follows: a frame that waits for the next one's check is believed by its own, and
    /// find() works until nothing is left.
    void end() noexcept { ended_ = true; }

    /// Goes on with the bytes that are there. Call it until it finds nothing.
    Found find() noexcept {
        release();
        for (;;) {  // each turn takes a frame, loses step or passes a byte, or is the last one
            if (ended_) work_ = work_per_byte;
            const bool spent = work_ <= 0, full = size_ == bytes_.size();
            if (in_step_) {
                const std::size_t kept = trusted() || ended_ ? 0 : 1;
                if (queue().count > kept)
                    return spent && !full && joined_ > 0 ? Found::nothing : deliver();
                const std::uint16_t front = front_;
                const Found found = follow();
                if (found != Found::nothing || (in_step_ && front == front_)) return found;
            } else {
                if (chain_found_ && (full || !spent)) return Found::chain;
                if (chain_found_ || spent || scan_end_ > size_) return Found::nothing;
                const Found found = search(scan_end_++);
                if (found != Found::nothing) return found;
            }
        }
    }

    const Frame& frame() const noexcept { return frame_; }
    /// Whether the frame that find() gave is the restart frame at which the reader joins.
    bool joining() const noexcept { return joining_; }
    /// The reader has parsed a frame of so many bytes to see whether a chain makes sense.
    void spend(std::size_t bytes) noexcept { spend_units(bytes * units_parsed); }

    /// The stream to follow from now on. begins: the run's first frame comes next.
    void follow_header(const FrameTiming& timing, std::uint32_t digest, std::int64_t end,
                       bool begins) noexcept {
        timing_ = timing;
        if (header_known_ && digest == header_ && !begins && end >= near_) {
            // restart frames before this header may still be waiting for their followers: a time
            // that was passed long ago is good as long as the tries reach from there to now
            const std::int64_t reach = (unwraps / 2) * (sub_per_tick << timing.time_bits);
            if (!known_ || end - near_ > reach) near_ = end;
            return;
        }
        if (in_step_ && !begins) lose_step();
        header_ = digest;
        link_ = {end, 0, 0};
        near_ = end;
        for (std::size_t i = 0; i < turned_.size(); ++i) {
            const std::int64_t turns = (std::int64_t{2} << i) - 1;
            turned_[i] =
                static_cast<std::uint16_t>(seed(digest, {turns * turn(), 0, 0}) ^ seed(digest, {}));
        }
        header_known_ = true;
        known_ = in_step_ = begins;
        start_search();
        queue() = {};
        queue().link = link_;
    }

    const Chain& chain() const noexcept { return chains_[found_]; }
    /// Frame i of the chain.
    Frame chain_frame(std::size_t i) const noexcept {
        Frame frame = frame_at(chain().at[0]);
        frame.before = chain().joins() ? chain().base : link_.end;
        frame.since = link_.since;
        for (std::size_t k = 1; k <= i && k < chain().at.size(); ++k) {
            FrameHead head;
            read_head(frame, head, k == 1 && chain().joins());
            const std::uint8_t since = since_behind(frame.since, head.restart);
            frame = frame_at(chain().at[k]);
            frame.before = head.end;
            frame.since = since;
        }
        return frame;
    }
    /// The chain is believed: its frames come one after another by find().
    void accept() noexcept {
        queue() = Chain{chain()};
        const std::size_t last = queue().at[queue().count - 1u];
        front_ = static_cast<std::uint16_t>(last + size_at(last));
        joined_ = queue().count;
        counters_.joins += queue().joins();
        known_ = in_step_ = true;
        chain_found_ = false;
    }
    void refuse() noexcept {
        chains_[found_] = {};
        chain_found_ = false;
    }
    /// The frame that find() gave is nonsense though its check fits.
    void refuse_frame() noexcept {
        lose_step();
        queue() = {};
    }

    bool in_step() const noexcept { return in_step_; }
    bool trusted() const noexcept { return trust_ > 0; }
    const Counters& counters() const noexcept { return counters_; }
    std::uint32_t header_digest() const noexcept { return header_; }
    const FrameTiming& timing() const noexcept { return timing_; }

  private:
    static constexpr std::uint16_t check_mask = static_cast<std::uint16_t>((1u << CheckBits) - 1u);
    static constexpr std::size_t smallest_frame = 1 + 1 + check_size;
    static constexpr std::uint8_t version_max = 15;  // of a header that is noticed and refused
    static constexpr std::size_t room_made = 8, capacity = 3 * data_frame_max + room_made + 2;
    // what work costs, in units: a place behind its CRC, a restart frame that is tried, a byte of a
    // frame that is parsed
    static constexpr std::int32_t units_place = 16, units_restart = 110, units_parsed = 32;

    static bool fits(std::uint16_t a, std::uint16_t b) noexcept {
        return ((a ^ b) & check_mask) == 0;
    }
    std::size_t size_at(std::size_t at) const noexcept {
        return frame_size(bytes_[at], at + 1 < size_ ? bytes_[at + 1] : 0);
    }
    Frame frame_at(std::size_t at) const noexcept {
        return {&bytes_[at], static_cast<std::uint16_t>(size_at(at)), 0, 0};
    }
    bool read_head(const Frame& frame, FrameHead& head, bool joining) const noexcept {
        code::RangeDecoder io{frame.payload(), frame.payload_size()};
        return code_head(io, head, timing_, frame.before, frame.since, joining);
    }
    Link link_behind(const Frame& frame, const FrameHead& head, const Link& before) const noexcept {
        return {head.end, digest_of(frame.data, frame.size, head.restart, header_, before),
                since_behind(before.since, head.restart)};
    }
    /// Sub-ticks after which a time has the same low bits again.
    std::int64_t turn() const noexcept { return sub_per_tick << timing_.time_bits; }
    void spend_units(std::size_t units) noexcept { work_ -= static_cast<std::int32_t>(units); }

    /// The frames that are believed next: as they are delivered, chains_[0] loses them.
    Chain& queue() noexcept { return chains_[0]; }

    /// Does the data frame at p, whose check has the start value s, follow the chain? Then it is
    /// its newest.
    bool append(Chain& c, std::size_t p, std::uint16_t s) noexcept {
        return fits(s, seed(header_, c.link)) && extend(c, p);
    }
    /// The same where the check is known to fit.
    bool extend(Chain& c, std::size_t p) noexcept {
        Frame frame = frame_at(p);
        FrameHead head;
        frame.before = c.link.end;
        frame.since = c.link.since;
        if (!read_head(frame, head, false)) return false;
        // a second restart frame would leave the first one with a single check
        if (c.joins() && c.checks() == 0 && head.restart && !timing_.independent) return false;
        if (c.count == c.at.size()) {  // its check was asked for: the frame itself comes later
            c.start = Start::restart;
            return true;
        }
        c.at[c.count++] = static_cast<std::uint16_t>(p);
        c.link = link_behind(frame, head, c.link);
        return true;
    }

    // ---- in step

    /// The frame at front_, when its bytes are complete.
    Found follow() noexcept {
        const std::size_t left = size_ - std::size_t{front_};
        const std::size_t size = left < 2 ? smallest_frame : size_at(front_);
        if (left < size) {
            if (ended_ && left > 0) lose_step();
            return Found::nothing;
        }
        if (size > 0 && bytes_[front_] > payload_max) {
            const Found kind = long_frame(front_, size);
            if (kind == Found::header && queue().count > 0 && begins_run(front_, size))
                return deliver();  // the run before ends: no check will follow
            if (kind != Found::nothing) {
                front_ = static_cast<std::uint16_t>(front_ + size);
                if (queue().count == 0) release_ = front_;
                return kind;
            }
        } else if (size > 0 && append(queue(), front_, seed_of(&bytes_[front_], size))) {
            front_ = static_cast<std::uint16_t>(front_ + size);
            return Found::nothing;
        }
        lose_step();
        return Found::nothing;
    }
    bool begins_run(std::size_t at, std::size_t size) const noexcept {
        return (bytes_[at + size - crc_size - 1] & 1u) != 0;
    }
    /// The oldest frame of the queue is believed.
    Found deliver() noexcept {
        Chain& c = queue();
        frame_ = frame_at(c.at[0]);
        joining_ = c.joins();
        frame_.before = joining_ ? c.base : link_.end;
        frame_.since = link_.since;
        FrameHead head;
        read_head(frame_, head, joining_);
        release_ = static_cast<std::uint16_t>(c.at[0] + frame_.size);
        c.at = {c.at[1], c.at[2], 0};
        c.start = Start::follows;
        --c.count;
        if (joined_ > 0) {
            --joined_;
            spend(2 * frame_.size);
        }
        const auto lasted = static_cast<std::uint64_t>(head.end - head.start);
        if (trust_ < trust_max)
            trusted_ += static_cast<std::uint32_t>(
                (std::min)(lasted * timing_.sub_ns >> trust_unit_bits, std::uint64_t{trust_units}));
        if (trusted_ >= trust_units) {
            trusted_ = 0;
            ++trust_;
        }
        link_ = link_behind(frame_, head, link_);
        near_ = link_.end;
        ++counters_.frames;
        counters_.good_bytes += frame_.size;
        return Found::data;
    }
    void lose_step() noexcept {
        in_step_ = false;
        ++counters_.losses;
        if (trust_ > 0) --trust_;
        trusted_ = 0;
        start_search();  // of a frame that waits one check fits, the next may come
    }
    /// Looks for frames from front_ on.
    void start_search() noexcept {
        for (std::size_t i = 1; i < chains_.size(); ++i) chains_[i] = {};
        chain_found_ = false;
        joined_ = 0;
        scan_from_ = front_;
        scan_end_ = static_cast<std::uint16_t>(front_ + 2);
        heads_ = {};
        passed_end_ = 0;
    }

    // ---- out of step

    /// A header or event frame. @return nothing: its CRC-32 is wrong.
    Found long_frame(std::size_t at, std::size_t size) noexcept {
        const std::uint8_t* data = &bytes_[at];
        const bool header = data[0] == header_head;
        if (!header && !header_known_) return Found::nothing;
        const std::size_t sealed = size - crc_size;
        if (four(data + sealed) != crc32(data, sealed, header ? 0 : header_)) return Found::nothing;
        frame_ = {data, static_cast<std::uint16_t>(size), 0, 0};
        counters_.good_bytes += size;
        return header ? Found::header : Found::events;
    }

    /// The nearest place before `from` whose data frame ends at `end`, among what may still be
    /// searched; `from` itself where there is none.
    std::size_t place_before(std::size_t from, std::size_t end) noexcept {
        const std::size_t far_off = end > data_frame_max ? end - data_frame_max : 0;
        const std::size_t low = (std::max)(std::size_t{scan_from_}, far_off);
        std::size_t p = (std::min)(from, end - (smallest_frame - 1));
        while (p > low) {
            // four at a time; `sizes` are what they must be: sizes of frames that end at `end`
            auto sizes = static_cast<std::uint32_t>(end + 1 - p) * 0x01010101u - 0x03020100u;
            for (; p >= low + 4; p -= 4, sizes += 0x04040404u) {
                const std::uint32_t differ = four(&bytes_[p - 4]) ^ sizes;
                if (((differ - 0x01010101u) & ~differ & 0x80808080u) != 0) break;
            }
            for (const std::size_t last = p > low + 4 ? p - 4 : low; p > last;) {
                --p;
                if (bytes_[p] + 3u != end - p) continue;
                spend_units((from - p) / 4);
                return p;
            }
        }
        spend_units((from - low) / 4);
        return from;
    }
    static std::uint32_t four(const std::uint8_t* b) noexcept {
        return std::uint32_t{b[0]} | std::uint32_t{b[1]} << 8 | std::uint32_t{b[2]} << 16 |
               std::uint32_t{b[3]} << 24;
    }

    /// What ends at `end`: a header or event frame, or data frames, the nearest place first.
    Found search(std::size_t end) noexcept {
        const Found found = search_long(end);
        if (found != Found::nothing) return found;
        std::size_t at = end - check_size;
        std::uint16_t s = check_at(at);  // the start value that makes the check of [at, end) right
        for (unsigned i = 0; header_known_ && i < places_tried && work_ > -overdraft; ++i) {
            const std::size_t p = place_before(at, end);
            if (p == at) break;
            spend_units(units_place + at - p);
            for (; at > p; --at) s = crc16_before(bytes_[at - 1], s);
            if (!try_data(p, s)) continue;
            chain_found_ = true;
            return Found::chain;
        }
        return Found::nothing;
    }
    /// Heads of header and event frames wait in a list until their frames are complete. A head that
    /// waits keeps its room: what looks like one within its frame must not take it.
    Found search_long(std::size_t end) noexcept {
        if (end >= scan_from_ + std::size_t{3} && may_be_long(end - 3)) {
            const auto room = std::find(heads_.begin(), heads_.end(), std::uint16_t{0});
            if (room != heads_.end()) *room = static_cast<std::uint16_t>(end - 3 + 1);
        }
        for (std::uint16_t& head : heads_) {
            if (head == 0 || head - 1u + size_at(head - 1u) != end) continue;
            const std::size_t at = head - 1u;
            head = 0;
            spend_units(end - at);
            const Found found = long_frame(at, end - at);
            if (found == Found::nothing) continue;
            if (passed_end_ != at) passed_from_ = static_cast<std::uint16_t>(at);
            passed_end_ = static_cast<std::uint16_t>(end);
            if (found == Found::header) front_ = passed_end_;
            return found;
        }
        return Found::nothing;
    }
    /// Is there the head of a header or event frame? Behind that of a header stands its version.
    bool may_be_long(std::size_t at) const noexcept {
        if (bytes_[at] <= payload_max || size_at(at) == 0) return false;
        return bytes_[at] != header_head || bytes_[at + 2] <= version_max;
    }
    std::uint16_t check_at(std::size_t at) const noexcept {
        return static_cast<std::uint16_t>(bytes_[at] << 8 | bytes_[at + 1]);
    }

    /// Does the frame at p stand behind the one at `before`, with at most skips_max others between?
    bool behind(std::size_t p, std::size_t before) const noexcept {
        for (std::size_t i = 0; i <= skips_max && before < p; ++i) {
            const std::size_t size = size_at(before);
            if (size == 0) return false;
            before += size;
            if (before == p) return true;
        }
        return false;
    }
    /// The frame at p is complete; s makes its check right. @return true: it completes a chain;
    /// found_ tells which.
    bool try_data(std::size_t p, std::uint16_t s) noexcept {
        for (Chain& c : chains_) {
            if (c.count == 0 || !behind(p, c.at[c.count - 1u]) || !append(c, p, s)) continue;
            if (!c.complete()) continue;
            found_ = static_cast<std::uint8_t>(&c - chains_.data());
            return true;
        }
        if (known_) {
            Chain c;
            c.link = link_;
            if (append(c, p, s)) free_chain() = c;
        }
        try_restarts(p, s);
        return false;
    }

    /// Restart frames before p, directly or with others between, that the seed of p agrees with.
    void try_restarts(std::size_t p, std::uint16_t s) noexcept {
        std::array<std::uint16_t, restarts_tried + 1> ends{static_cast<std::uint16_t>(p)};
        std::size_t known = 1, next = 0;
        for (std::size_t skips = 0; skips <= skips_max; ++skips) {
            const std::int32_t least = skips == 0 ? -overdraft : 0;
            for (const std::size_t level = known; next < level; ++next) {
                if (passed_end_ > 0 && ends[next] == passed_end_) ends[next] = passed_from_;
                std::size_t from = ends[next];
                while (known < ends.size() && work_ > least) {
                    const std::size_t r = place_before(from, ends[next]);
                    if (r == from) break;
                    ends[known++] = static_cast<std::uint16_t>(from = r);
                    try_restart(r, p, s);
                }
            }
        }
    }
    /// Every frame may be a restart frame. The start values of its follower's check at the times
    /// that it may mean follow from each other: the check is linear.
    void try_restart(std::size_t r, std::size_t p, std::uint16_t s) noexcept {
        Frame restart = frame_at(r);
        restart.before = near_;
        FrameHead head;
        spend_units(units_restart + restart.size);
        if (!read_head(restart, head, true)) return;
        const Link link = link_behind(restart, head, link_);
        auto turns = static_cast<std::uint32_t>(link.end >> (6u + timing_.time_bits));
        unsigned differ = unsigned{s} ^ seed(header_, link);
        for (int i = 0; i < unwraps; ++i) {
            if ((differ & check_mask) == 0 && start_chain(r, p, head, i)) return;
            std::size_t ones = 0;  // which one more turn makes zeros, and the bit above them a one
            while (ones < turned_.size() && (turns >> ones & 1u) != 0) ++ones;
            ++turns;
            if (ones < turned_.size())
                differ ^= turned_[ones];
            else
                differ = unsigned{s} ^ seed(header_, behind_turns(link, i + 1));
        }
    }
    Link behind_turns(const Link& link, int turns) const noexcept {
        return {link.end + turns * turn(), link.previous, link.since};
    }
    /// A chain of the restart frame at r and the frame at p, at the time that is so many turns
    /// later. @return false: nonsense.
    bool start_chain(std::size_t r, std::size_t p, const FrameHead& head, int turns) noexcept {
        Chain c;
        c.link = behind_turns(link_behind(frame_at(r), head, link_), turns);
        c.base = (timing_.independent ? head.start : head.end) + turns * turn();
        c.start = turns < unwraps_near ? Start::restart : Start::late_restart;
        c.at[c.count++] = static_cast<std::uint16_t>(r);
        if (!extend(c, p)) return false;
        free_chain() = c;
        return true;
    }
    Chain& free_chain() noexcept {
        Chain* best = &chains_[0];
        for (Chain& c : chains_)  // an empty one, or else the oldest
            if (best->count > 0 && (c.count == 0 || c.at[0] < best->at[0])) best = &c;
        return *best;
    }

    // ---- memory

    /// Forgets the bytes before release_.
    void release() noexcept {
        if (release_ > 0) drop(release_);
        release_ = 0;
    }
    void drop(std::size_t n) noexcept {
        const auto less = [n](std::uint16_t at) {
            return static_cast<std::uint16_t>(at > n ? at - n : 0);
        };
        for (Chain& c : chains_) {
            if (c.count > 0 && c.at[0] < n) c = {};
            for (auto& at : c.at) at = less(at);
        }
        front_ = less(front_);
        scan_from_ = less(scan_from_);
        scan_end_ = (std::max)(less(scan_end_), std::uint16_t{2});
        for (auto& head : heads_) head = less(head);
        passed_from_ = less(passed_from_);
        passed_end_ = less(passed_end_);
        size_ = static_cast<std::uint16_t>(size_ - n);
        for (std::size_t i = 0; i < size_; ++i) bytes_[i] = bytes_[i + n];
    }

    // what is used most stands first, the bytes last: near members take shorter instructions
    std::uint16_t size_{0}, front_{0}, release_{0};
    std::uint16_t scan_from_{0}, scan_end_{2};
    std::uint8_t found_{0}, trust_{trust_max};
    std::uint8_t joined_{0};  // frames of the queue that came as a chain
    bool in_step_{false}, known_{false}, header_known_{false}, ended_{false}, joining_{false};
    bool chain_found_{false};
    std::uint16_t passed_from_{0}, passed_end_{0};  // the latest of heads_ that were right
    std::int32_t work_{0};
    std::uint32_t header_{0};  // digest of the header that is followed
    Frame frame_{};
    FrameTiming timing_{};
    Link link_{};  // behind the latest frame that was delivered
    std::int64_t near_{0};
    std::uint32_t trusted_{0};
    Counters counters_{};
    // what becomes of the start value of a check when the time that it holds, in turns, ends with
    // i ones and one turn is added
    std::array<std::uint16_t, 6> turned_{};
    std::array<std::uint16_t, 4> heads_{};  // where header or event frames may begin, plus 1
    std::array<Chain, 3> chains_{};
    std::array<std::uint8_t, capacity> bytes_{};
};

}  // namespace fairlead::wire
