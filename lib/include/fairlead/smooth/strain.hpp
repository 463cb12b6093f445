#pragma once
// Strain smoothing of poses: squared deviation plus weighted strain, minimised [Hsieh et al. 1998].
// The weight comes from a cut-off in Hz (smooth/strain_weight.hpp); positions are exact
// (smooth/strain_position.hpp), orientations a few Gauss-Newton steps
// (smooth/strain_orientation.hpp).
//
// Here, a stream: each record leaves Lag records late, smoothed with all that is known then. The
// past is kept exactly, as the cost it lays on the present; only what later records would still
// change is lost. strain_lag() says how large Lag must be for that to be below 2e-6 m and 1e-5 rad.
// A whole recording at once: smooth/strain_buffer.hpp.
//
// The samples of a channel are the records in which it is valid; records without one are
// bridged (time steps may be uneven), gap flags start a segment anew. Scaling the positions
// scales the result, moving and turning the frame moves and turns it.
//
// In:   records in order of time, unit q_wb, neighbours closer than pi.
// Cost: per push, L times (20 flops for a position, 500 flops, two logs and an exp for an
//       orientation and step). RAM: about 350 bytes x (L + 1).
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "fairlead/base/ring.hpp"
#include "fairlead/base/types.hpp"
#include "fairlead/smooth/strain_orientation.hpp"
#include "fairlead/smooth/strain_position.hpp"
#include "fairlead/smooth/strain_weight.hpp"

namespace fairlead {

namespace detail {

/// The positions of the records inside the lag. The newest sample stays when it has left already,
/// for the next one to continue from: Lag may be 0, and a channel lost for long is bridged.
template <std::size_t Lag>
class StrainPositionTrack {
    using Position = StrainPosition<float>;

  public:
    explicit StrainPositionTrack(const StrainWeight& weight) noexcept : weight_{weight} {}

    void gap() noexcept { anew_ = true; }
    void push(const Vec3& y, std::int64_t t_ns) noexcept {
        if (anew_) {
            nodes_.push(Position::start(y));
        } else {
            const float step = nominal_steps(newest_ns_, t_ns, weight_.step_s());
            nodes_.push(Position::next(nodes_[nodes_.size() - 1], y, step, weight_.lambda()));
        }
        if (left_) nodes_.pop();
        anew_ = left_ = false;
        newest_ns_ = t_ns;
    }
    /// The oldest sample, smoothed with what is known now.
    Vec3 take() noexcept {
        std::size_t i = segment_end(nodes_, 0, nodes_.size()) - 1;
        auto state = Position::last(nodes_[i]);
        for (; i > 0; --i) state = Position::back(nodes_[i - 1], nodes_[i], state);
        const Vec3 p = nodes_.oldest().y + state.u;
        left_ = nodes_.size() == 1;
        if (!left_) nodes_.pop();
        return p;
    }
    void clear() noexcept {
        nodes_.clear();
        left_ = false;
        anew_ = true;
    }

  private:
    Ring<Position::Node, Lag + 2> nodes_{};
    StrainWeight weight_;
    std::int64_t newest_ns_{0};
    bool anew_{true};
    bool left_{false};
};

/// The orientations of the records inside the lag; the newest stays, as above.
template <std::size_t Lag>
class StrainOrientationTrack {
    using Orientation = StrainOrientation<float>;

  public:
    explicit StrainOrientationTrack(const StrainWeight& weight, std::size_t steps) noexcept
        : weight_{weight}, steps_{steps} {}

    void gap() noexcept { anew_ = true; }
    void push(const Quat& q, std::int64_t t_ns) noexcept {
        if (anew_) {
            nodes_.push(Orientation::node(q, nullptr, 1));
        } else {
            const float step = nominal_steps(newest_ns_, t_ns, weight_.step_s());
            nodes_.push(Orientation::node(q, &nodes_[nodes_.size() - 1], step));
        }
        if (left_) drop();
        anew_ = left_ = false;
        newest_ns_ = t_ns;
    }
    /// One round of steps over all that is known. Each push and each flush does one, so that the
    /// newest sample, which came as it was measured, settles while the older ones leave.
    void solve() noexcept {
        if (left_) return;
        for (std::size_t i = 0; i < nodes_.size();) {
            const std::size_t end = segment_end(nodes_, i, nodes_.size());
            const auto at = [ this, i ](std::size_t j) -> auto& { return nodes_[i + j]; };
            Orientation::solve(at, end - i, weight_.lambda(), steps_,
                               i == 0 ? prior_ : typename Orientation::Prior{});
            i = end;
        }
    }
    Quat take() noexcept {
        const Quat q = same_side(nodes_.oldest().raw, nodes_.oldest().now);
        left_ = nodes_.size() == 1;
        if (!left_) drop();
        return q;
    }
    void clear() noexcept {
        nodes_.clear();
        prior_ = {};
        left_ = false;
        anew_ = true;
    }

  private:
    /// Drops the oldest sample; what it and those before it say goes on to the next.
    void drop() noexcept {
        const auto leaving = nodes_.oldest();
        nodes_.pop();
        prior_ = nodes_.oldest().first
                     ? typename Orientation::Prior{}
                     : Orientation::hand_over(leaving, nodes_.oldest(), weight_.lambda(), prior_);
    }

    Ring<Orientation::Node, Lag + 2> nodes_{};
    Orientation::Prior prior_{};
    StrainWeight weight_;
    std::size_t steps_;
    std::int64_t newest_ns_{0};
    bool anew_{true};
    bool left_{false};
};

}  // namespace detail

/// Smooths a stream, `lag` records late: chosen at run time, at most LagMax.
template <std::size_t LagMax>
class AnyStrainSmoother {
  public:
    /// params.steps: Gauss-Newton steps a push; one is enough where the lag is strain_lag().
    AnyStrainSmoother(const StrainParams& params, std::size_t lag) noexcept
        : position_{params.position}, orientation_{params.orientation, params.steps}, lag_{lag} {
        FAIRLEAD_ASSERT(lag <= LagMax && check(params));
    }

    /// Records between a record and its smoothed one.
    std::size_t delay() const noexcept { return lag_; }

    std::optional<Pose> push(const Pose& pose) noexcept {
        if (pose.flags & (flag::gap_before | flag::position_gap)) position_.gap();
        if (pose.flags & (flag::gap_before | flag::orientation_gap)) orientation_.gap();
        if (pose.flags & flag::position_valid) position_.push(pose.p_w_m, pose.t_ns);
        if (pose.flags & flag::orientation_valid) orientation_.push(pose.q_wb, pose.t_ns);
        orientation_.solve();
        records_.push(pose);
        if (records_.size() <= lag_) return std::nullopt;
        return take();
    }

    /// The next of the last records; empty when there is none: the smoother is as new then.
    std::optional<Pose> flush() noexcept {
        if (records_.empty()) {
            reset();
            return std::nullopt;
        }
        orientation_.solve();
        return take();
    }

    void reset() noexcept {
        records_.clear();
        position_.clear();
        orientation_.clear();
    }

  private:
    Pose take() noexcept {
        Pose record = records_.oldest();
        records_.pop();
        if (record.flags & flag::position_valid) record.p_w_m = position_.take();
        if (record.flags & flag::orientation_valid) record.q_wb = orientation_.take();
        return record;
    }

    Ring<Pose, LagMax + 1> records_{};
    detail::StrainPositionTrack<LagMax> position_;
    detail::StrainOrientationTrack<LagMax> orientation_;
    std::size_t lag_;
};

/// The same with the lag in the type.
template <std::size_t Lag>
class StrainSmoother : public AnyStrainSmoother<Lag> {
  public:
    static constexpr std::size_t latency = Lag;
    explicit StrainSmoother(const StrainParams& params) noexcept
        : AnyStrainSmoother<Lag>{params, Lag} {}
};

}  // namespace fairlead
