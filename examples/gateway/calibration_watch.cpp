#include "examples/gateway/calibration_watch.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::gateway {
namespace {

namespace bit = calibration_bit;

constexpr float bias_max = 0.2f;  // rad/s
constexpr float apart_uT = 2;     // readings that are nearer tell nothing new
constexpr float far_uT = 10;      // of the readings that are kept for the coverage
constexpr std::int64_t judge_ns = 1'000'000'000;
constexpr std::uint16_t almost = 99;  // percent: only a result makes it 100

std::uint16_t percent(float share) noexcept {
    return static_cast<std::uint16_t>(std::clamp(100 * share, 0.0f, float{almost}));
}

/// Of the 14 directions along the axes and into the octants, those that a reading has come near.
float coverage(const Vec3* readings, std::size_t count) noexcept {
    if (count == 0) return 0;
    Vec3 low = readings[0], high = readings[0];
    for (std::size_t i = 1; i < count; ++i) {
        const Vec3& r = readings[i];
        low = {std::min(low.x, r.x), std::min(low.y, r.y), std::min(low.z, r.z)};
        high = {std::max(high.x, r.x), std::max(high.y, r.y), std::max(high.z, r.z)};
    }
    const Vec3 centre = 0.5f * (low + high);
    unsigned seen = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 d = readings[i] - centre;
        const float most = std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
        if (most > 0.85f * norm(d)) {
            const unsigned axis = most == std::fabs(d.x) ? 0 : most == std::fabs(d.y) ? 1 : 2;
            seen |= 1u << (2 * axis + (component(d, axis) > 0 ? 0 : 1));
        } else {
            seen |= 64u << ((d.x > 0 ? 1u : 0u) + (d.y > 0 ? 2u : 0u) + (d.z > 0 ? 4u : 0u));
        }
    }
    int covered = 0;
    for (unsigned i = 0; i < 14; ++i) covered += static_cast<int>(seen >> i & 1u);
    return static_cast<float>(covered) / 14;
}

}  // namespace

void CalibrationWatch::push(const Sample& sample) noexcept {
    if (!begun_ || sample.t_ns < next_ns_ - spacing_ns) {  // the first, or a clock that began anew
        begun_ = true;
        next_ns_ = judged_ns_ = sample.t_ns;
        count_ = 0;
    }
    if (sample.t_ns < next_ns_) return;
    next_ns_ = sample.t_ns + spacing_ns;
    take(sample);
}

void CalibrationWatch::take(const Sample& sample) noexcept {
    if (sample.flags & flag::gyro_valid) state_.sensors |= bit::gyro;
    if (sample.flags & flag::accel_valid) state_.sensors |= bit::accel;
    if (sample.flags & flag::mag_valid) {
        state_.sensors |= bit::mag;
        take_mag(sample.mag_uT);
    }
    constexpr flag::Bits both = flag::gyro_valid | flag::accel_valid;
    if ((sample.flags & both) != both || (sample.flags & flag::gap_before)) count_ = 0;
    if ((sample.flags & both) == both) held_[count_++] = sample;
    if (count_ == block) end_block();
    if (sample.t_ns - judged_ns_ < judge_ns) return;
    judged_ns_ = sample.t_ns;
    if (state_.sensors & bit::mag) judge_mag();
}

/// A block in which nothing moved serves the gyroscope and the face on which the board lies.
void CalibrationWatch::end_block() noexcept {
    Moments gyro, accel;
    for (const Sample& s : held_) {
        gyro.push(s.gyro_rad_s);
        accel.push(s.accel_m_s2);
    }
    count_ = 0;
    // an even turn about the vertical moves neither: it is larger than any bias
    const bool still = norm(gyro.mean()) <= bias_max &&
                       gyro.deviation() <= GyroBiasFit::moved_rad_s &&
                       accel.deviation() <= AccelFit::moved_m_s2;
    if (!still) {  // NaN is not still
        gyro_.reset();
        still_s_ = 0;
        if (!(state_.done & bit::gyro)) state_.gyro_percent = 0;
        return;
    }
    const auto length_s = static_cast<float>(held_.back().t_ns - held_.front().t_ns) * 1e-9f;
    const float dt_s = length_s / static_cast<float>(block - 1);
    still_s_ += dt_s * static_cast<float>(block);
    for (const Sample& s : held_) {
        gyro_.push(s.gyro_rad_s, dt_s);
        accel_.push(s.accel_m_s2);
    }
    if (!(state_.done & bit::gyro))
        state_.gyro_percent = percent(still_s_ / GyroBiasFit::seconds_min);
    if (const auto found = gyro_.result()) {
        state_.gyro_offset_rad_s = found->bias_rad_s;
        state_.gyro_percent = 100;
        state_.done |= bit::gyro;
    }
    state_.accel_faces = static_cast<std::uint16_t>(accel_.faces_done());
    if (const auto found = accel_.result()) {
        state_.accel = found->correction;
        state_.done |= bit::accel;
    }
}

void CalibrationWatch::take_mag(const Vec3& mag_uT) noexcept {
    if (!is_finite(mag_uT) || !(norm(mag_uT - last_mag_) > apart_uT)) return;
    last_mag_ = mag_uT;
    mag_.push(mag_uT);
    for (std::size_t i = 0; i < directions_count_; ++i)
        if (norm(directions_[i] - mag_uT) < far_uT) return;
    if (directions_count_ < kept_max) directions_[directions_count_++] = mag_uT;
}

void CalibrationWatch::judge_mag() noexcept {
    if (const auto found = mag_.result()) {
        state_.mag = found->correction;
        state_.mag_percent = 100;
        state_.done |= bit::mag;
        return;
    }
    if (state_.done & bit::mag) return;
    const float readings = static_cast<float>(mag_.count()) / float{MagFit::samples_min};
    state_.mag_percent =
        percent(std::min(readings, coverage(directions_.data(), directions_count_)));
}

}  // namespace fairlead::gateway
