#include "host_sim/generate/motion.hpp"

#include <algorithm>

namespace fairlead::sim {
namespace {

/// A scalar course and its first two derivatives.
struct Course {
    double value{}, rate{}, acceleration{};
};

Course min_jerk(double u) {  // 0 to 1 over u in [0, 1]
    if (u <= 0) return {};
    if (u >= 1) return {1, 0, 0};
    return {u * u * u * (10 + u * (-15 + u * 6)), 30 * u * u * (1 + u * (-2 + u)),
            60 * u * (1 + u * (-3 + u * 2))};
}

Course scaled(const Course& c, double per_s) {
    return {c.value, c.rate * per_s, c.acceleration * per_s * per_s};
}

/// sin(2 pi f t) under an envelope that rises and falls over a fifth of the duration.
Course wave(double t_s, double duration_s, double hz, double quarter_turns) {
    constexpr double edge = 0.2;
    const double per_s = 1 / (edge * duration_s);
    Course e = scaled(min_jerk(t_s * per_s), per_s);
    if (t_s > duration_s / 2) {
        e = scaled(min_jerk((duration_s - t_s) * per_s), per_s);
        e.rate = -e.rate;
    }
    const double w = 2 * pi_v<double> * hz;
    const auto sc = approx::sin_cos(w * t_s + quarter_turns * pi_v<double> / 2);
    return {e.value * sc.sin, e.rate * sc.sin + e.value * w * sc.cos,
            e.acceleration * sc.sin + 2 * e.rate * w * sc.cos - e.value * w * w * sc.sin};
}

}  // namespace

Motion::Segment& Motion::append(double duration_s) {
    Segment segment;
    segment.start_s = end_s_;
    segment.duration_s = duration_s;
    segment.p = p_;
    segment.q = q_;
    end_s_ += duration_s;
    segments_.push_back(segment);
    return segments_.back();
}

void Motion::finish(const Segment& segment) {
    if (segment.hz > 0) return;  // an oscillation ends where it began
    p_ = p_ + segment.move;
    q_ = normalised(q_ * from_rotation_vector(segment.angle * segment.axis));
}

void Motion::rest(double s) { append(s); }

void Motion::reach(double s, double reach_m, double turn_rad) {
    Segment& segment = append(s);
    const Vec3d direction = random_.direction();
    segment.move = (reach_m * random_.uniform(0.3, 1)) * direction - p_;
    segment.axis = random_.direction();
    segment.angle = turn_rad * random_.uniform(0.3, 1);
    finish(segment);
}

void Motion::oscillate(double s, double hz, double amplitude_m, double amplitude_rad) {
    Segment& segment = append(s);
    segment.move = amplitude_m * random_.direction();
    segment.axis = random_.direction();
    segment.second_axis = random_.direction();
    segment.angle = amplitude_rad;
    segment.hz = hz;
}

void Motion::turn(double s, double peak_rad_s) {
    Segment& segment = append(s);
    segment.axis = random_.direction();
    segment.angle = peak_rad_s * s / 1.875;  // the peak of the min-jerk rate
    finish(segment);
}

void Motion::jump(double by_m, double by_rad) {
    p_ = p_ + by_m * random_.direction();
    q_ = normalised(q_ * from_rotation_vector(by_rad * random_.direction()));
}

MotionState Motion::at(double t_s) const {
    if (segments_.empty()) return {};
    t_s = std::clamp(t_s, 0.0, end_s_);
    const auto later = [](double t, const Segment& s) { return t < s.start_s; };
    const auto next = std::upper_bound(segments_.begin() + 1, segments_.end(), t_s, later);
    const Segment& s = *(next - 1);
    const double t = t_s - s.start_s;
    MotionState state;
    if (s.hz > 0) {
        const Course a = wave(t, s.duration_s, s.hz, 0), b = wave(t, s.duration_s, s.hz, 1);
        const Quatd second = from_rotation_vector(s.angle * b.value * s.second_axis);
        state.p_w_m = s.p + a.value * s.move;
        state.accel_w_m_s2 = a.acceleration * s.move;
        state.q_wb = s.q * from_rotation_vector(s.angle * a.value * s.axis) * second;
        state.rate_b_rad_s =
            rotate(conj(second), (s.angle * a.rate) * s.axis) + (s.angle * b.rate) * s.second_axis;
        state.moving = true;
        return state;
    }
    const Course c = scaled(min_jerk(t / s.duration_s), 1 / s.duration_s);
    state.p_w_m = s.p + c.value * s.move;
    state.accel_w_m_s2 = c.acceleration * s.move;
    state.q_wb = s.q * from_rotation_vector((s.angle * c.value) * s.axis);
    state.rate_b_rad_s = (s.angle * c.rate) * s.axis;
    state.moving = s.angle != 0 || dot(s.move, s.move) > 0;
    return state;
}

}  // namespace fairlead::sim
