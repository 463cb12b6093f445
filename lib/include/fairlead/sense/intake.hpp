#pragma once
// The one gate for Samples and Poses: behind it every value is finite, in range and in order.
//
// Times: strictly rising; a record that repeats or goes back in time is refused, and so is a leap
// forward by more than leap_ns (a damaged stamp) until the record after it confirms it. A pause
// longer than gap_ns sets gap_before on the next record that is accepted. The first stamp of a
// stream is believed; where a clock may start anew, set restart_records.
// Values: a channel whose value is not finite, out of range, no rotation, or frozen is made invalid
// in that record (value cleared); the other channels stay. A channel that comes back after more
// than gap_ns gets its gap flag. A record may pass with no valid channel: it still tells the time.
// Quaternions: normalised within unit_tolerance, signs continuous.
// Everything is counted by kind; no record that was accepted is ever lost, and gap flags of refused
// records move to the next accepted one. Cost: constant, no history. Latency: 0.
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fairlead/base/types.hpp"
#include "fairlead/sense/fault.hpp"
#include "fairlead/sense/intake_gate.hpp"

namespace fairlead {

namespace detail {

template <class Record>
class IntakeChannels;

template <>
class IntakeChannels<Pose> {
  public:
    void pass(Pose& r, const IntakeParams& p, FaultCounts& counts) noexcept {
        position_.pass(r.t_ns, r.p_w_m, r.flags,
                       {flag::position_valid, flag::position_gap, p.position_max_m}, p, counts);
        orientation_.pass(r.t_ns, r.q_wb, r.flags,
                          {flag::orientation_valid, flag::orientation_gap, 0}, p, counts);
    }

  private:
    ChannelGate<Vec3> position_{};
    ChannelGate<Quat> orientation_{};
};

template <>
class IntakeChannels<Sample> {
  public:
    void pass(Sample& r, const IntakeParams& p, FaultCounts& counts) noexcept {
        gyro_.pass(r.t_ns, r.gyro_rad_s, r.flags, {flag::gyro_valid, 0, p.gyro_max_rad_s}, p,
                   counts);
        accel_.pass(r.t_ns, r.accel_m_s2, r.flags, {flag::accel_valid, 0, p.accel_max_m_s2}, p,
                    counts);
        mag_.pass(r.t_ns, r.mag_uT, r.flags, {flag::mag_valid, 0, p.mag_max_uT}, p, counts);
    }

  private:
    ChannelGate<Vec3> gyro_{};
    ChannelGate<Vec3> accel_{};
    ChannelGate<Vec3> mag_{};
};

}  // namespace detail

/// Record: Sample or Pose, with the valid bits set by its source.
template <class Record>
class Intake {
  public:
    static constexpr std::size_t latency = 0;

    constexpr Intake() noexcept = default;
    constexpr explicit Intake(const IntakeParams& params) noexcept : params_{params} {}

    /// Empty: the record is refused.
    std::optional<Record> push(const Record& record) noexcept {
        using Verdict = detail::IntakeClock::Verdict;
        gap_ = gap_ || (record.flags & flag::gap_before);
        channel_gaps_ |= record.flags & any_gap & ~flag::gap_before;
        switch (clock_.check(record.t_ns, params_)) {
            case Verdict::repeated: return counts_.add(Fault::repeated_time), std::nullopt;
            case Verdict::backward: return counts_.add(Fault::backward_time), std::nullopt;
            case Verdict::leap: return counts_.add(Fault::leap), std::nullopt;
            case Verdict::gap: gap_ = true; break;
            case Verdict::next:
            default: break;
        }
        Record out = record;
        out.flags |= channel_gaps_;
        channel_gaps_ = 0;
        if (gap_) out.flags |= flag::gap_before;
        gap_ = false;
        channels_.pass(out, params_, counts_);
        if (out.flags & any_gap) counts_.add(Fault::gap);
        return out;
    }
    static constexpr std::optional<Record> flush() noexcept { return std::nullopt; }

    /// As new, for another stream; the counts stay.
    constexpr void reset() noexcept {
        clock_ = {};
        channels_ = {};
        gap_ = false;
        channel_gaps_ = 0;
    }

    constexpr const FaultCounts& faults() const noexcept { return counts_; }

  private:
    static constexpr std::uint32_t any_gap =
        flag::gap_before | flag::position_gap | flag::orientation_gap;

    IntakeParams params_{};
    FaultCounts counts_{};
    detail::IntakeClock clock_{};
    detail::IntakeChannels<Record> channels_{};
    std::uint32_t channel_gaps_{0};
    bool gap_{false};
};

}  // namespace fairlead
