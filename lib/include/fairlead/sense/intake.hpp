#pragma once
// The one gate for Samples, Poses and VectorSamples. Accepted has one meaning, and it is decided
// here: what passes is finite, in range and in order, and the stages behind can carry it. They
// state what they can carry (IntakeLimits) and have no rule of their own for time or range.
//
// Times. Within a run, accepted times rise by at least limits.spacing_min_ns, and the run lasts at
// most limits.run_ns_max. A pause longer than gap_ns sets gap_before. Where the clock goes back, or
// leaps ahead by more than leap_ns, a run begins: new_run and gap_before are set, and times before
// it must not be compared with times after it. A stamp that would begin a run is doubtful:
//   - it waits, as the only record that ever does, for the record after it;
//   - if that one goes on with the clock before, the doubtful record is refused: a lone wrong stamp
//     costs itself;
//   - otherwise both are accepted, and from then on push() gives the record before the one that it
//     takes, until a record is refused, idle() or flush(). So a record waits for one push at most.
// A lone wrong stamp up to leap_ns ahead passes as one after a pause; the next one, back on the
// clock before, begins a run at once. A record that repeats the time before it is refused.
// Values. A channel whose value is not finite, out of range, no rotation, or frozen is made invalid
// in that record (value cleared); the other channels stay. A channel that comes back after more
// than gap_ns gets its gap flag. A record may pass with no valid channel: it still tells the time.
// Quaternions: normalised within unit_tolerance, signs continuous.
// Everything is counted by kind; no record that was accepted is ever lost, and gap flags of refused
// records move to the next accepted one. Cost: at most two records are checked in a push; no loop,
// no history. Latency: 0, and 1 while a record waits. With refused parameters it refuses all.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <type_traits>

#include "fairlead/base/types.hpp"
#include "fairlead/sense/fault.hpp"
#include "fairlead/sense/intake_clock.hpp"
#include "fairlead/sense/intake_gate.hpp"
#include "fairlead/sense/intake_limits.hpp"
#include "fairlead/sense/intake_params.hpp"

namespace fairlead {

namespace detail {

/// Stands for the gate of a value that nobody behind the intake takes: it is cleared.
template <class Value>
struct NoGate {
    static void pass(std::int64_t, Value& value, flag::Bits& flags, const ChannelLimits& limits,
                     const IntakeParams&, FaultCounts&) noexcept {
        value = {};
        flags &= ~(limits.valid | limits.gap);
    }
};
template <class Value, bool taken>
using Gate = std::conditional_t<taken, ChannelGate<Value>, NoGate<Value>>;

template <class Record, flag::Bits values>
class IntakeChannels;

template <flag::Bits values>
class IntakeChannels<Pose, values> {
  public:
    void pass(Pose& r, const IntakeParams& p, FaultCounts& counts) noexcept {
        position_.pass(r.t_ns, r.p_w_m, r.flags,
                       {flag::position_valid, flag::position_gap, p.position_max_m}, p, counts);
        orientation_.pass(r.t_ns, r.q_wb, r.flags,
                          {flag::orientation_valid, flag::orientation_gap, 0}, p, counts);
    }

  private:
    Gate<Vec3, (values & flag::position_valid) != 0> position_{};
    Gate<Quat, (values & flag::orientation_valid) != 0> orientation_{};
};

template <flag::Bits values>
class IntakeChannels<Sample, values> {
  public:
    void pass(Sample& r, const IntakeParams& p, FaultCounts& counts) noexcept {
        gyro_.pass(r.t_ns, r.gyro_rad_s, r.flags, {flag::gyro_valid, 0, p.gyro_max_rad_s}, p,
                   counts);
        accel_.pass(r.t_ns, r.accel_m_s2, r.flags, {flag::accel_valid, 0, p.accel_max_m_s2}, p,
                    counts);
        mag_.pass(r.t_ns, r.mag_uT, r.flags, {flag::mag_valid, 0, p.mag_max_uT}, p, counts);
    }

  private:
    Gate<Vec3, (values & flag::gyro_valid) != 0> gyro_{};
    Gate<Vec3, (values & flag::accel_valid) != 0> accel_{};
    Gate<Vec3, (values & flag::mag_valid) != 0> mag_{};
};

template <std::size_t D, flag::Bits values>
class IntakeChannels<VectorSample<D>, values> {
  public:
    void pass(VectorSample<D>& r, const IntakeParams& p, FaultCounts& counts) noexcept {
        value_.pass(r.t_ns, r.value, r.flags, {flag::vector_valid, flag::vector_gap, p.value_max},
                    p, counts);
    }

  private:
    ChannelGate<std::array<float, D>> value_{};
};

}  // namespace detail

/// Record: Sample, Pose or VectorSample, with the valid bits set by its source. values: valid bits
/// of what the stages behind take; the rest of a record is cleared, and costs no code.
template <class Record, flag::Bits values = ~flag::Bits{0}>
class Intake {
    using Clock = detail::IntakeClock;
    using Verdict = Clock::Verdict;

  public:
    static constexpr std::size_t latency = 0;
    static constexpr std::size_t waiting_max = 1;  // records

    constexpr Intake() noexcept : Intake{IntakeParams{}} {}
    constexpr explicit Intake(const IntakeParams& params, const IntakeLimits& limits = {}) noexcept
        : asked_{params}, checked_{fairlead::check(params, limits)} {
        set_limits(limits);
    }

    /// Other limits from the next record on. A parameter that is beyond them counts as the limit.
    constexpr void set_limits(const IntakeLimits& limits) noexcept {
        limits_ = limits;
        params_ = within(completed(asked_, limits), limits);
    }

    /// Empty: nothing was accepted in this call; waiting() tells whether the record waits.
    std::optional<Record> push(const Record& record) noexcept {
        refused_ = !checked_;
        if (refused_) return std::nullopt;
        std::optional<Record> out;
        if (state_ == Held::accepted) out = held_;
        if (state_ == Held::doubtful) {
            const Clock::Doubt doubt = clock_.weigh(held_.t_ns, record.t_ns, limits_);
            if (doubt == Clock::Doubt::open) {
                refuse(record, repeats(record) ? Fault::repeated_time : Fault::too_close);
                refused_ = true;
                return std::nullopt;
            }
            if (doubt == Clock::Doubt::wrong) refuse(held_, doubt_);
            if (doubt == Clock::Doubt::confirmed) out = admit(held_, Verdict::run);
        }
        state_ = Held::none;
        const std::optional<Record> admitted = judge(record);
        if (!admitted || !out) return out ? out : admitted;
        held_ = *admitted;
        state_ = Held::accepted;
        return out;
    }

    /// The accepted record that waits, where no record came in its time; a doubtful one stays.
    std::optional<Record> idle() noexcept {
        refused_ = false;
        if (state_ != Held::accepted) return std::nullopt;
        state_ = Held::none;
        return held_;
    }

    /// The record that waits, at the end of a stream: a doubtful one is believed.
    std::optional<Record> flush() noexcept {
        refused_ = false;
        if (state_ == Held::doubtful) held_ = admit(held_, Verdict::run);
        if (state_ == Held::none) return std::nullopt;
        state_ = Held::none;
        return held_;
    }

    /// The record that waits for the one after it, accepted already or doubtful; null: none does.
    constexpr const Record* waiting() const noexcept {
        return state_ == Held::none ? nullptr : &held_;
    }
    /// The same where it is accepted already.
    constexpr const Record* accepted() const noexcept {
        return state_ == Held::accepted ? &held_ : nullptr;
    }
    /// Was the record of the last push refused?
    constexpr bool refused() const noexcept { return refused_; }

    /// As new, for another stream; the counts stay.
    constexpr void reset() noexcept {
        clock_ = {};
        channels_ = {};
        state_ = Held::none;
        gap_ = false;
        channel_gaps_ = 0;
        refused_ = false;
    }

    /// The longest pause within a curve that these limits would allow, ns.
    constexpr std::int64_t gap_ns(const IntakeLimits& limits) const noexcept {
        return within(completed(asked_, limits), limits).gap_ns;
    }
    /// ok, or the name of the field for which the intake refuses everything.
    constexpr const Check& check() const noexcept { return checked_; }
    constexpr const FaultCounts& faults() const noexcept { return counts_; }
    constexpr const IntakeLimits& limits() const noexcept { return limits_; }

  private:
    enum class Held : std::uint8_t { none, doubtful, accepted };
    static constexpr flag::Bits any_gap =
        flag::gap_before | flag::position_gap | flag::orientation_gap;

    std::optional<Record> judge(const Record& record) noexcept {
        const Verdict verdict = clock_.judge(record.t_ns, params_, limits_);
        if (Clock::accepted(verdict)) return admit(record, verdict);
        if (Clock::doubtful(verdict)) {
            held_ = record;
            state_ = Held::doubtful;
            doubt_ = verdict == Verdict::behind ? Fault::backward_time : Fault::leap;
            return std::nullopt;
        }
        refuse(record, verdict == Verdict::repeated ? Fault::repeated_time : Fault::too_close);
        refused_ = true;
        return std::nullopt;
    }

    bool repeats(const Record& record) const noexcept {
        return record.t_ns == held_.t_ns ||
               clock_.judge(record.t_ns, params_, limits_) == Verdict::repeated;
    }

    void refuse(const Record& record, Fault why) noexcept {
        counts_.add(why);
        gap_ = gap_ || (record.flags & flag::gap_before) != 0;
        channel_gaps_ |= record.flags & any_gap & ~flag::gap_before;
    }

    Record admit(const Record& record, Verdict verdict) noexcept {
        Record out = record;
        const bool first = !clock_.running();
        out.flags = (out.flags & ~flag::new_run) | channel_gaps_;
        channel_gaps_ = 0;
        if (verdict == Verdict::run && !first) {
            counts_.add(Fault::new_run);
            out.flags |= flag::new_run | flag::gap_before;
        }
        if (gap_ || verdict == Verdict::gap) out.flags |= flag::gap_before;
        gap_ = false;
        clock_.accept(record.t_ns, verdict);
        channels_.pass(out, params_, counts_);
        if (out.flags & any_gap) counts_.add(Fault::gap);
        return out;
    }

    IntakeParams asked_{};
    IntakeParams params_{};  // completed by the limits
    IntakeLimits limits_{};
    Check checked_{};
    FaultCounts counts_{};
    Clock clock_{};
    detail::IntakeChannels<Record, values> channels_{};
    Record held_{};
    flag::Bits channel_gaps_{0};
    Fault doubt_{};  // what the doubtful record is counted as if it is refused
    Held state_{Held::none};
    bool gap_{false};
    bool refused_{false};
};

}  // namespace fairlead
