#pragma once
// Motion fairing on a stream, with a fixed lag: Rounds rounds of rho_2 or rho_3, one behind the
// other, each a few records behind the round before it.
//
// The result is fair()'s with OnBound::hold, bit for bit: with inactive bounds the paper's rounds;
// with active ones a sample whose next value would break its bound is held for that round. (The
// paper's rule, stop everything, needs the whole recording.) Segments end where a channel is
// invalid, where a gap flag says so, and at flush(); their end rules are the whole-buffer ones.
//
// Latency: in records, in the type. rho_2: Rounds + 1; rho_3: 2 Rounds + 1; alternating rho_3 about
// 3/2 Rounds. One in, one out; every record leaves with its own time and flags. Cost per push: at
// most 2 Rounds operators per channel, Rounds in the steady state; flush() of a stream shorter than
// the latency pays for the rounds that are still missing. RAM: Rounds x 8 values a
// channel, and 2 x latency records.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fairlead/base/ring.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/smooth/fairing.hpp"
#include "fairlead/smooth/fairing_operator.hpp"

namespace fairlead {

namespace detail {

/// How far a round looks ahead of sample i of a long segment.
constexpr std::size_t fairing_reach(int order, bool mirrored, std::size_t i) noexcept {
    if (i == 0) return order == 2 ? 2 : 3;
    if (order == 2) return 1;
    if (mirrored) return i == 1 ? 2 : 1;
    return 2;
}

/// The newest measurement that sample i waits for after all rounds, less i; the worst i.
constexpr std::size_t fairing_latency(int order, std::size_t rounds, bool alternate) noexcept {
    std::size_t worst = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        // needed values of the round below, from the last round down: samples 0 ... newest
        std::size_t newest = i;
        for (std::size_t r = rounds; r > 0; --r) {
            const bool mirrored = alternate && (r - 1) % 2 == 1;
            std::size_t need = 0;
            for (std::size_t j = 0; j <= newest && j < 4; ++j) {
                const std::size_t n = j + fairing_reach(order, mirrored, j);
                if (n > need) need = n;
            }
            const std::size_t n = newest + fairing_reach(order, mirrored, newest);
            newest = n > need ? n : need;
        }
        if (newest - i > worst) worst = newest - i;
    }
    return worst;
}

/// One channel's rounds. Samples are numbered as they come, modulo 2^32; level r holds the newest
/// values after r rounds.
template <class Channel, int Order, std::size_t RoundsMax, std::size_t Latency>
class FairingTrack {
    using Value = typename Channel::Value;
    using Index = std::uint32_t;
    static constexpr Index depth = 8;  // values a level keeps: 3 behind, 3 ahead, 2 in the making

  public:
    FairingTrack(std::size_t rounds, float damping, float bound, bool alternate) noexcept
        : bound_{bound}, rounds_{rounds}, damping_{damping}, alternate_{alternate} {}

    void push(const Value& value, bool starts) noexcept {
        if (starts) end_segment();
        const Index k = made_[0]++;
        FAIRLEAD_ASSERT(k - made_[1] < depth - 3);
        Place place{};
        if (open_) place.before = place_[(k - 1) % kept].before + 1;
        if (place.before > 3) place.before = 3;
        levels_[0][k % depth] = value;
        raw_[k % kept] = value;
        place_[k % kept] = place;
        open_ = true;
    }
    /// No more samples belong to the segment.
    void end_segment() noexcept {
        if (open_) place_[(made_[0] - 1) % kept].last = true;
        open_ = false;
    }

    /// Two values a level: one is the rhythm, the other catches up after the start of a segment,
    /// whose first value waits for more than the others, and at its end, which waits for nothing.
    void advance() noexcept {
        for (int pass = 0; pass < 2; ++pass) {
            for (std::size_t r = 1; r <= rounds_; ++r) advance_level(r);
        }
    }

    /// The next value. It waits for more passes only when a stream shorter than the latency is
    /// flushed.
    Value take() noexcept {
        for (std::size_t i = 0; i <= 2 * rounds_ && made_[rounds_] == taken_; ++i) advance();
        FAIRLEAD_ASSERT(made_[rounds_] != taken_);
        return levels_[rounds_][taken_++ % depth];
    }

    void clear() noexcept {
        made_ = {};
        taken_ = 0;
        open_ = false;
    }

  private:
    struct Place {
        std::size_t before{};  // in the segment, at most 3
        bool last{};           // of its segment
    };
    static constexpr Index power_of_two(std::size_t at_least) noexcept {
        Index n = 1;
        while (n < at_least) n *= 2;
        return n;
    }
    static constexpr Index kept = power_of_two(Latency + depth);  // divides 2^32

    void advance_level(std::size_t r) noexcept {
        const Index k = made_[r], known = made_[r - 1] - k;
        const Index unread = r < rounds_ ? k - made_[r + 1] + 3 : k - taken_;
        if (known == 0 || unread >= depth) return;
        const bool mirrored = alternate_ && (r - 1) % 2 == 1;
        FairingPlace place{place_[k % kept].before, 0, mirrored};
        const auto ends = [&] { return place_[(k + static_cast<Index>(place.after)) % kept].last; };
        while (place.after < 3 && !ends() && place.after + 1 < known) ++place.after;
        if (!ends() && place.after < fairing_reach(Order, mirrored, place.before)) return;
        const auto& level = levels_[r - 1];
        const auto at = [&level, k](int j) -> const Value& {
            return level[(k + static_cast<Index>(j)) % depth];
        };
        Value value = faired<Channel, Order>(at, place, damping_);
        if (!bound_.kept(raw_[k % kept], value)) value = at(0);
        levels_[r][k % depth] = value;
        made_[r] = k + 1;
    }

    std::array<std::array<Value, depth>, RoundsMax + 1> levels_{};
    std::array<Index, RoundsMax + 1> made_{};  // values so far, per level
    std::array<Value, kept> raw_{};
    std::array<Place, kept> place_{};
    Index taken_{0};
    FairingBound<Channel> bound_;
    std::size_t rounds_;
    float damping_;
    bool alternate_;
    bool open_{false};
};

}  // namespace detail

/// A pose stream, faired; the rounds are chosen at run time, at least 1 and at most RoundsMax.
/// Alternate: rho_3 mirrored in every second round.
template <int Order, std::size_t RoundsMax, bool Alternate = false>
class AnyFairingWindow {
    static_assert(RoundsMax > 0 && (Order == 3 || !Alternate));

  public:
    static constexpr std::size_t latency_max = detail::fairing_latency(Order, RoundsMax, Alternate);

    explicit AnyFairingWindow(std::size_t rounds, const FairingParams& params = {}) noexcept
        : position_{rounds, params.damping_p, params.bound_m, Alternate},
          orientation_{rounds, params.damping_q, params.bound_rad, Alternate},
          delay_{detail::fairing_latency(Order, rounds, Alternate)} {
        FAIRLEAD_ASSERT(rounds > 0 && rounds <= RoundsMax && check(params));
    }

    /// Records between a record and its faired one.
    std::size_t delay() const noexcept { return delay_; }

    std::optional<Pose> push(const Pose& pose) noexcept {
        feed(position_, pose);
        feed(orientation_, pose);
        records_.push(pose);
        if (records_.size() <= delay_) return std::nullopt;
        return take();
    }

    /// The next of the last records; empty when there is none: the window is as new then.
    std::optional<Pose> flush() noexcept {
        if (records_.empty()) {
            reset();
            return std::nullopt;
        }
        position_.end_segment();
        orientation_.end_segment();
        position_.advance();
        orientation_.advance();
        return take();
    }

    void reset() noexcept {
        records_.clear();
        position_.clear();
        orientation_.clear();
    }

  private:
    template <class Channel>
    using Track = detail::FairingTrack<Channel, Order, RoundsMax, latency_max>;
    using Position = detail::FairPosition<float>;
    using Orientation = detail::FairOrientation<float>;

    template <class Channel>
    static void feed(Track<Channel>& track, const Pose& pose) noexcept {
        if (pose.flags & Channel::valid) {
            track.push(Channel::of(pose), (pose.flags & Channel::gap) != 0);
        } else {
            track.end_segment();
        }
        track.advance();
    }

    Pose take() noexcept {
        Pose record = records_.oldest();
        records_.pop();
        if (record.flags & Position::valid) record.p_w_m = position_.take();
        if (record.flags & Orientation::valid) record.q_wb = orientation_.take();
        return record;
    }

    Ring<Pose, latency_max + 1> records_{};
    Track<Position> position_;
    Track<Orientation> orientation_;
    std::size_t delay_;
};

/// The same with rounds and latency in the type.
template <int Order, std::size_t Rounds, bool Alternate = false>
class FairingWindow : public AnyFairingWindow<Order, Rounds, Alternate> {
  public:
    static constexpr std::size_t latency = detail::fairing_latency(Order, Rounds, Alternate);
    explicit FairingWindow(const FairingParams& params = {}) noexcept
        : AnyFairingWindow<Order, Rounds, Alternate>{Rounds, params} {}
};

}  // namespace fairlead
