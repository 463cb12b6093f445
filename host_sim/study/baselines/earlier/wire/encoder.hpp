#pragma once
// Poses in, bytes out: both reducers and the frames that carry what they make final.
//
// A frame leaves when a sample of either channel is due; what the other channel can give rides
// along. Restart points at a stated interval hold the whole state, so that a late joiner or a
// decoder that lost a frame is back in step there, bit for bit.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/bytes.hpp"
#include "fairlead/base/types.hpp"
#include "host_sim/study/baselines/earlier/wire/events.hpp"
#include "host_sim/study/baselines/earlier/wire/layout.hpp"

namespace fairlead::earlier {

/// Work per push and channel on the search, in instructions of a Cortex-M4F, about.
inline constexpr Credit slice_small = 24000, slice_medium = 100000, slice_large = 380000;

struct EncoderParams {
    std::array<float, 3> tol_position_m{0.001f, 0.001f, 0.001f};
    float tol_orientation_rad{0.0043633f};
    std::uint32_t tick_ns{4000000};  // grid of the knots, at most the smallest sample spacing
    std::uint32_t delay_max{60};     // records
    std::int64_t restart_interval_ns{2000000000};
    std::uint32_t goal{
        0};           // records that a frame leaves open where it can; 0: a third of delay_max
    Credit slice{0};  // less work on the search than the encoder's Slice; 0: all of it
    std::uint32_t event_delay_max{0};  // records that an event may wait for company
    bool position{true};
    bool orientation{true};
};

/// N: ring capacity in samples, the largest delay_max. Slice: work per push and channel on the
/// search for few knots, in instructions of a Cortex-M4F, about; beside it a push costs what
/// BOUNDS.md says. Events: discrete events that may wait between two records, and channels of them
/// that a late joiner learns of. Memory: sizeof.
template <std::size_t N, Credit Slice = slice_medium, std::size_t Events = 8>
class Encoder {
  public:
    using PositionReducer = Reducer<VectorChannel<3>, N>;
    using OrientationReducer = Reducer<OrientationChannel, N>;

    explicit Encoder(const EncoderParams& params) noexcept
        : params_{params},
          slice_{params.slice > 0 && params.slice < Slice ? params.slice : Slice},
          position_{{params.tol_position_m, params.tick_ns, params.delay_max, goal(params)}},
          orientation_{
              {params.tol_orientation_rad, params.tick_ns, params.delay_max, goal(params)}} {
        position_link_.scale = position_.scale();
        orientation_link_.scale = orientation_.scale();
        position_link_.enabled = params.position;
        orientation_link_.enabled = params.orientation;
    }

    /// One record; without its slice of the search where several come at once. @return the frames
    /// that it completed, possibly none.
    Bytes push(const Pose& pose, bool searches = true) noexcept {
        size_ = 0;
        const std::int64_t before_ns = now_ns_;
        now_ns_ = pose.t_ns;
        if (!started_) start();
        feed(position_, params_.position && (pose.flags & flag::position_valid), pose,
             {pose.p_w_m.x, pose.p_w_m.y, pose.p_w_m.z}, flag::gap_before | flag::position_gap,
             position_gap_);
        feed(orientation_, params_.orientation && (pose.flags & flag::orientation_valid), pose,
             pose.q_wb, flag::gap_before | flag::orientation_gap, orientation_gap_);
        // a restart point is a frame like others: what it can take along need not leave soon after
        const std::int64_t lead_ns = (now_ns_ - before_ns) * position_.lead();
        const bool closing = position_.closing() || orientation_.closing() || restart_due(lead_ns);
        const Credit slice = searches ? slice_ : 0;
        position_.allot(slice, closing);
        orientation_.allot(slice, closing);
        // rarely two: where knots crowd before a sample that is due, or a curve starts
        for (std::size_t i = 0; i < max_frames; ++i) {
            if (!position_.due() && !orientation_.due() && !restart_due()) break;
            frame(i + 1 == max_frames);
        }
        position_.work();
        orientation_.work();
        let_out_events(size_ > 0 ? 0 : params_.event_delay_max);
        return {out_.data(), size_, Status::ok};
    }

    /// An event of a discrete channel; it leaves with the next record, at most event_delay_max
    /// records later. @return false: Events of them wait already, and it is not taken.
    bool push_event(const Event& event) noexcept { return events_.push(event); }

    /// Instead of push(), where no record has come: lets out events alone.
    Bytes idle() noexcept {
        size_ = 0;
        let_out_events(params_.event_delay_max);
        return {out_.data(), size_, Status::ok};
    }

    /// Makes everything final; call until it returns nothing. A call costs what a push costs.
    Bytes flush() noexcept {
        size_ = 0;
        if (!position_.empty() || !orientation_.empty()) {
            position_.close(slice_);
            orientation_.close(slice_);
            frame(false);
        }
        let_out_events(0);
        position_gap_ = orientation_gap_ = true;  // what comes later starts new curves
        return {out_.data(), size_, Status::ok};
    }

    const PositionReducer& position() const noexcept { return position_; }
    const OrientationReducer& orientation() const noexcept { return orientation_; }
    std::uint32_t frames() const noexcept { return sequence_; }
    std::uint32_t refused_events() const noexcept { return events_.refused(); }

    static constexpr std::size_t max_frames = 2;  // a push completes at most

  private:
    static constexpr Credit frame_cost = 3000, byte_cost = 250;
    static constexpr std::int64_t restart_slack = 16;  // a part of the interval

    static std::uint32_t goal(const EncoderParams& p) noexcept {
        return p.goal ? p.goal : p.delay_max / 3;
    }

    template <class Reduction>
    void feed(Reduction& reduction, bool valid, const Pose& pose,
              const typename Reduction::Value& value, std::uint32_t gap_flags, bool& gap) noexcept {
        gap = gap || (pose.flags & gap_flags) != 0;
        if (!valid) {
            reduction.skip();
            return;
        }
        reduction.push(pose.t_ns, value, gap);
        gap = false;
    }

    void start() noexcept {
        started_ = true;
        epoch_ns_ = now_ns_;
        position_.set_epoch(now_ns_);
        orientation_.set_epoch(now_ns_);
        restart_wanted_ = true;
    }

    bool restart_due(std::int64_t soon_ns = 0) const noexcept {
        return !restart_wanted_ &&
               now_ns_ - last_restart_ns_ >= params_.restart_interval_ns - soon_ns;
    }

    void let_out_events(std::uint32_t hold) noexcept {
        size_ += events_.frame(out_.data() + size_, hold);
    }

    /// One frame with what both channels can make final.
    void frame(bool last) noexcept {
        const auto position = position_.take(last);
        const auto orientation = orientation_.take(last);
        // rather a little early than with one more frame
        if (restart_wanted_ || restart_due(params_.restart_interval_ns / restart_slack)) {
            restart_wanted_ = !write(true, position, orientation);  // no room: with the next
            if (!restart_wanted_) return;
        }
        const bool fits = write(false, position, orientation);  // always (test_layout.cpp)
        FAIRLEAD_ASSERT(fits);
        static_cast<void>(fits);
    }

    /// @return false where there is no room for it; then nothing has changed.
    bool write(bool restart, const typename PositionReducer::Frozen& position,
               const typename OrientationReducer::Frozen& orientation) noexcept {
        BitWriter io{out_.data() + size_ + 2, wire::max_payload};
        const auto position_before = position_link_;
        const auto orientation_before = orientation_link_;
        const auto header_before = header_;
        if (restart) {
            header_ = {sequence_, params_.tick_ns,
                       epoch_ns_ + (now_ns_ - epoch_ns_) / params_.tick_ns * params_.tick_ns};
            wire::header(io, header_);
            wire::state(io, position_link_, header_.base_ns, params_.tick_ns);
            wire::state(io, orientation_link_, header_.base_ns, params_.tick_ns);
        }
        put(io, position, position_link_);
        put(io, orientation, orientation_link_);
        if (!io.ok()) {
            position_link_ = position_before;
            orientation_link_ = orientation_before;
            header_ = header_before;
            return false;
        }
        seal(restart, io.size());
        // the search pays for it
        const Credit cost = frame_cost + byte_cost * static_cast<Credit>(io.size());
        const bool both = params_.position && params_.orientation;
        position_.spend(both ? cost / 2 : cost);
        orientation_.spend(both ? cost / 2 : cost);
        if (!restart) return true;
        last_restart_ns_ = now_ns_;
        events_.repeat();
        return true;
    }

    template <class Frozen, class Channel>
    void put(BitWriter& io, Frozen batch, wire::Link<Channel>& link) noexcept {
        wire::content(io, link, batch, header_.base_ns, params_.tick_ns);
        wire::follow_start(link, batch);
        for (std::size_t i = 0; i < batch.size; ++i)
            wire::follow_knot(link, batch, i, params_.tick_ns);
        if (batch.covers) link.cover_ticks = batch.cover_ticks;
    }

    /// Puts length and checksum around the payload that stands two bytes after the frames so far.
    void seal(bool restart, std::size_t n) noexcept {
        std::uint8_t* out = out_.data() + size_;
        const std::size_t head = restart || n > 127 ? 2 : 1;
        if (head == 1) {
            out[0] = static_cast<std::uint8_t>(n);
            for (std::size_t i = 0; i < n; ++i) out[1 + i] = out[2 + i];
        } else {
            out[0] = static_cast<std::uint8_t>((restart ? 0xC0u : 0x80u) | (n >> 8));
            out[1] = static_cast<std::uint8_t>(n & 0xffu);
        }
        const std::uint16_t seed =
            restart ? wire::restart_seed : static_cast<std::uint16_t>(sequence_);
        size_ += append_crc16(out, head + n, seed);
        sequence_ = (sequence_ + 1) & wire::sequence_mask;
    }

    EncoderParams params_;
    Credit slice_;
    PositionReducer position_;
    OrientationReducer orientation_;
    wire::Link<VectorChannel<3>> position_link_{};
    wire::Link<OrientationChannel> orientation_link_{};
    wire::Header header_{};
    EventSender<Events> events_{};
    std::array<std::uint8_t, max_frames * wire::max_frame + EventSender<Events>::frame_size_max>
        out_{};
    std::size_t size_{0};
    std::uint32_t sequence_{0};
    std::int64_t now_ns_{0}, epoch_ns_{0}, last_restart_ns_{0};
    bool started_{false}, restart_wanted_{false};
    bool position_gap_{false}, orientation_gap_{false};
};

}  // namespace fairlead::earlier
