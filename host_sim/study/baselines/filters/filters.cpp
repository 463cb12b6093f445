#include "host_sim/study/baselines/filters/filters.hpp"

#include "fairlead/math/quat.hpp"

namespace fairlead::sim {

void MaskWindow::push(const Pose& pose) {
    Pose next = pose;
    if (!poses_.empty()) next.q_wb = same_side(poses_.back().q_wb, next.q_wb);
    do poses_.push_back(next);
    while (poses_.size() < taps_);
    if (poses_.size() > taps_) poses_.pop_front();
}

Pose MaskBaseline::push(const Pose& pose) {
    window_.push(pose);
    Pose out = window_[centre_];
    out.p_w_m = {};
    for (std::size_t i = 0; i < taps_.size(); ++i) out.p_w_m += taps_[i] * window_[i].p_w_m;
    out.q_wb = orientation();
    return out;
}

Quat ComponentFilter::orientation() {
    Quat sum{0, 0, 0, 0};
    for (std::size_t i = 0; i < taps_.size(); ++i) {
        const Quat& q = window_[i].q_wb;
        sum = {sum.w + taps_[i] * q.w, sum.x + taps_[i] * q.x, sum.y + taps_[i] * q.y,
               sum.z + taps_[i] * q.z};
    }
    return normalised(sum);
}

Quat GlobalLogFilter::orientation() {
    Vec3 sum{};
    for (std::size_t i = 0; i < taps_.size(); ++i) sum += taps_[i] * log(window_[i].q_wb);
    return exp(sum);
}

Quat CumulativeFilter::orientation() {
    const std::size_t n = taps_.size();
    if (steps_.empty()) {
        steps_.assign(n, Vec3{});
        return out_ = window_[n - 1].q_wb;
    }
    steps_.pop_front();
    steps_.push_back(n > 1 ? log(conj(window_[n - 2].q_wb) * window_[n - 1].q_wb) : Vec3{});
    Vec3 step{};
    for (std::size_t i = 0; i < n; ++i) step += taps_[i] * steps_[i];
    return out_ = normalised(out_ * exp(step));
}

CasteljauFilter::CasteljauFilter(std::size_t taps) : MaskBaseline{binomial_taps(taps), taps / 2} {}

Quat CasteljauFilter::orientation() {
    std::vector<Quat> q;
    for (std::size_t i = 0; i < taps_.size(); ++i) q.push_back(window_[i].q_wb);
    for (std::size_t n = q.size(); n > 1; --n)
        for (std::size_t i = 0; i + 1 < n; ++i) q[i] = slerp(q[i], q[i + 1], 0.5f);
    return normalised(q[0]);
}

Pose ExponentialFilter::push(const Pose& pose) {
    const Pose last = out_;
    out_ = pose;
    if (started_) {
        out_.p_w_m = last.p_w_m + part_ * (pose.p_w_m - last.p_w_m);
        out_.q_wb = normalised(slerp(last.q_wb, pose.q_wb, part_));
    }
    started_ = true;
    return out_;
}

namespace {

/// The share of the new value in a first-order low-pass [Casiez et al. 2012, (6), (7)].
float share(float cutoff_hz, float dt_s) {
    const float tau_s = 1 / (2 * pi_v<float> * cutoff_hz);
    return 1 / (1 + tau_s / dt_s);
}

}  // namespace

Pose OneEuroFilter::push(const Pose& pose) {
    const Pose last = out_;
    out_ = pose;
    if (started_) {
        const float dt = static_cast<float>(pose.t_ns - raw_.t_ns) * 1e-9f;
        const Vec3 velocity = (1 / dt) * (pose.p_w_m - raw_.p_w_m);
        const Vec3 rate = (1 / dt) * rotation_vector(conj(raw_.q_wb) * pose.q_wb);
        velocity_ += share(position_.speed_cutoff_hz, dt) * (velocity - velocity_);
        rate_ += share(orientation_.speed_cutoff_hz, dt) * (rate - rate_);
        const float p_hz = position_.cutoff_min_hz + position_.speed_gain * norm(velocity_);
        const float q_hz = orientation_.cutoff_min_hz + orientation_.speed_gain * norm(rate_);
        out_.p_w_m = last.p_w_m + share(p_hz, dt) * (pose.p_w_m - last.p_w_m);
        out_.q_wb = normalised(slerp(last.q_wb, pose.q_wb, share(q_hz, dt)));
    }
    raw_ = pose;
    started_ = true;
    return out_;
}

std::vector<float> binomial_taps(std::size_t n) {
    std::vector<double> row{1};
    while (row.size() < n) {
        std::vector<double> next(row.size() + 1, 0);
        for (std::size_t i = 0; i < row.size(); ++i)
            next[i] += row[i] / 2, next[i + 1] += row[i] / 2;
        row = next;
    }
    return {row.begin(), row.end()};
}

std::vector<float> average_taps(std::size_t n) {
    return std::vector<float>(n, 1 / static_cast<float>(n));
}

std::vector<float> exponential_taps(std::size_t n, float part) {
    std::vector<float> taps(n);
    float weight = 1, sum = 0;
    for (std::size_t i = n; i-- > 0; weight *= 1 - part) sum += taps[i] = weight;
    for (auto& tap : taps) tap /= sum;
    return taps;
}

}  // namespace fairlead::sim
