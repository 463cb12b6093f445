#pragma once
// Fixed-lag smoothing of the attitude filter: the orientation of N samples ago, with what the
// filter has learned since.
//
// The filter's corrections of tilt and heading come late: what a Kalman step finds now was wrong
// before as well. Between two steps an error only moves with the gyro's noise, so that the later
// corrections apply to the earlier orientations almost whole: this is the Rauch-Tung-Striebel
// smoother [Rauch, Tung & Striebel 1965] of an error state that stands still, whose gain over the
// lag is p / (p + q), p the variance of the tilt and q what the gyro's noise adds to it meanwhile.
// For pipelines that wait for the reducer anyway. What each lag is worth: docs/attitude.md.
//
// In: Samples behind an Intake. Out: q_wb of N samples ago; settling until the whole lag lies
// behind the last levelling. Latency: N samples. Cost beside the filter's: about 100
// multiplications a sample, always. Memory: 36 bytes a sample of lag.
#include <array>
#include <cstddef>
#include <optional>

#include "fairlead/sense/attitude.hpp"

namespace fairlead {

template <std::size_t N, class Real = float, AttitudeMode mode = AttitudeMode::imu_mag>
class LaggedAttitude {
    static_assert(N >= 1 && N <= 4096, "a lag in samples");
    using Filter = BasicAttitude<Real, mode>;
    using Kalman = KalmanStep<Real, mode>;
    using Vector = BasicVec3<Real>;

  public:
    static constexpr std::size_t latency = N;

    explicit LaggedAttitude(const AttitudeParams& params = {}) noexcept
        : filter_{params}, noise_{params.gyro_noise}, scale_noise_{params.gyro_scale_noise} {}

    void reset() noexcept {
        filter_.reset();
        count_ = 0;
    }

    /// Empty while the lag fills, and where the filter says nothing.
    std::optional<Pose> push(const Sample& sample) noexcept {
        const auto before = filter_.state().part;
        const auto pose = filter_.push(sample);
        if (!pose) return std::nullopt;
        const auto& s = filter_.state();
        if (s.phase != AttitudePhase::running) {
            since_ = 0;
            learned_ = {};
        } else if (before == Kalman::apply && s.part == Kalman::idle) {
            learn();
        }
        std::optional<Pose> out;
        Entry& entry = ring_[at_];
        if (count_ == N) out = smoothed(entry);
        entry = {*pose, learned_, since_};
        at_ = at_ + 1 == N ? 0 : at_ + 1;
        if (count_ < N) ++count_;
        if (since_ < N) ++since_;
        return out;
    }

    /// The rest, oldest first, once no more samples come; then empty.
    std::optional<Pose> flush() noexcept {
        if (count_ == 0) return std::nullopt;
        const std::size_t oldest = at_ >= count_ ? at_ - count_ : at_ + N - count_;
        --count_;
        return smoothed(ring_[oldest]);
    }

    const Filter& filter() const noexcept { return filter_; }
    void drive(const Vec3& velocity_b_m_s, float sigma_m_s) noexcept {
        filter_.drive(velocity_b_m_s, sigma_m_s);
    }

  private:
    struct Entry {
        Pose pose{};
        Vector learned{};
        std::size_t since{};  // the last levelling
    };

    /// Adds up the corrections that the Kalman step has just applied.
    void learn() noexcept {
        const auto& s = filter_.state();
        const auto& x = s.correction;
        using State = typename Filter::State;
        learned_.x += x[State::tilt];
        learned_.y += x[State::tilt + 1];
        if constexpr (mode == AttitudeMode::imu_mag) learned_.z += x[State::heading];
    }

    Pose smoothed(const Entry& entry) const noexcept {
        Pose out = entry.pose;
        const auto& s = filter_.state();
        using State = typename Filter::State;
        // levelled anew since then: what was learned does not belong to it
        if (s.phase != AttitudePhase::running || entry.since + N > since_ + count_) {
            if (s.phase != AttitudePhase::running) out.flags |= flag::settling;
            if (entry.since > 0) return out;
        }
        const Real lag_s = static_cast<Real>(static_cast<std::int32_t>(
                               std::min<std::int64_t>(s.t_ns - out.t_ns, 2'000'000'000))) *
                           static_cast<Real>(1e-9);
        const Real speed = norm(s.means.rate);
        const Real q = (static_cast<Real>(noise_ * noise_) +
                        static_cast<Real>(scale_noise_ * scale_noise_) * speed) *
                       lag_s;
        const auto gain = [q](Real p) { return p > 0 ? p / (p + q) : Real{0}; };
        const Real tilt = gain((s.covariance(State::tilt, State::tilt) +
                                s.covariance(State::tilt + 1, State::tilt + 1)) /
                               2);
        const Vector d = learned_ - entry.learned;
        const Vector r{tilt * d.x, tilt * d.y, 0};
        BasicQuat<Real> turn = turn_quat(r, dot(r, r));
        if constexpr (mode == AttitudeMode::imu_mag)
            turn = about_up(gain(s.covariance(State::heading, State::heading)) * d.z) * turn;
        const BasicQuat<Real> q_wb{static_cast<Real>(out.q_wb.w), static_cast<Real>(out.q_wb.x),
                                   static_cast<Real>(out.q_wb.y), static_cast<Real>(out.q_wb.z)};
        const auto u = normalised(turn * q_wb);
        out.q_wb = {static_cast<float>(u.w), static_cast<float>(u.x), static_cast<float>(u.y),
                    static_cast<float>(u.z)};
        return out;
    }

    Filter filter_;
    float noise_, scale_noise_;
    std::array<Entry, N> ring_{};
    std::size_t at_{}, count_{}, since_{};
    Vector learned_{};
};

}  // namespace fairlead
