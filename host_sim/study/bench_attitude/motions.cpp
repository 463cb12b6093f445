#include "host_sim/study/bench_attitude/motions.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {
namespace {

constexpr double pi = 3.14159265358979323846, g = 9.81;

/// A smooth random signal of unit variance between two frequencies: a sum of sines.
class Wander {
  public:
    Wander(Random& random, double low_hz, double high_hz) {
        for (Wave& w : waves_)
            w = {2 * pi * random.uniform(low_hz, high_hz), random.uniform(0, 2 * pi)};
    }
    double operator()(double t) const {
        double sum = 0;
        for (const Wave& w : waves_) sum += std::sin(w.rate * t + w.phase);
        return sum * std::sqrt(2.0 / waves);
    }

  private:
    static constexpr int waves = 16;
    struct Wave {
        double rate, phase;
    };
    Wave waves_[waves];
};

struct Wander3 {
    Wander x, y, z;
    Wander3(Random& r, double low_hz, double high_hz)
        : x{r, low_hz, high_hz}, y{r, low_hz, high_hz}, z{r, low_hz, high_hz} {}
    V3 operator()(double t) const { return {x(t), y(t), z(t)}; }
};

/// 1 between from and to, 0 outside, with cosine ramps.
double fade(double t, double from, double to, double ramp) {
    const double w =
        std::clamp((t - from) / ramp, 0.0, 1.0) * std::clamp((to - t) / ramp, 0.0, 1.0);
    return 0.5 - 0.5 * std::cos(pi * w);
}

Q4 about(double angle, double x, double y, double z) {
    return from_rotation_vector(V3{angle * x, angle * y, angle * z});
}
Q4 yaw_pitch_roll(double yaw, double pitch, double roll) {
    return about(yaw, 0, 0, 1) * about(pitch, 0, 1, 0) * about(roll, 1, 0, 0);
}

class Maker {
  public:
    Maker(const MotionPlan& plan, Random& random, double rate_hz)
        : plan_{plan}, random_{random}, dt_{1 / rate_hz} {
        m_.rate_hz = rate_hz;
        n_ = static_cast<std::size_t>(plan.seconds * rate_hz);
        mount_ = from_rotation_vector(random.uniform(0.3, 3) * random.direction());
        m_.q_wb.resize(n_);
        m_.p_m.resize(n_);
        m_.moving.assign(n_, 1);
    }

    /// Turns and moves at hand: rates rad/s, amplitude m.
    Motion hand(double rate, double rate_hz, double amplitude, double move_hz, double from) {
        const Wander3 turn{random_, 0.02, rate_hz}, move{random_, 0.15, move_hz};
        Q4 q = mount_;
        const double end = plan_.seconds - 5, half = plan_.seconds / 2;
        each([&](std::size_t i, double t) {
            const double s = plan_.seconds < 40
                                 ? fade(t, from, end, 1)
                                 : std::max(fade(t, from, half - 4, 1), fade(t, half + 4, end, 1));
            q = normalised(q * from_rotation_vector((dt_ * s * rate / std::sqrt(3.0)) * turn(t)));
            set(i, q, (amplitude * s) * move(t), s > 0.01 && amplitude > 0);
        });
        return std::move(m_);
    }

    /// Steps with heel strikes; runs when the speed is a runner's. Stops twice.
    Motion walk(double speed, double step_hz, double strike_m_s2, double bounce_m) {
        const Wander pace{random_, 0.02, 0.2}, bend{random_, 0.005, 0.08}, look{random_, 0.01, 0.1};
        double phase = 0, yaw = 0;
        V3 place{};
        m_.shake_m_s2.resize(n_);
        m_.speed_m_s.resize(n_);
        double since = 1, strength = 0;
        V3 strike{};
        const double half = plan_.seconds / 2;
        each([&](std::size_t i, double t) {
            const double s =
                std::max(fade(t, 10, half - 5, 2), fade(t, half + 5, plan_.seconds - 5, 2));
            const double before = phase;
            phase += 2 * pi * step_hz * s * (1 + 0.05 * pace(t)) * dt_;
            yaw += 0.35 * bend(t) * s * dt_;
            place += (speed * s * dt_) * V3{-std::sin(yaw), std::cos(yaw), 0};
            const double side = 0.02 * std::sin(phase / 2) * s, ahead = 0.015 * std::sin(phase) * s;
            const V3 sway{std::cos(yaw) * side - std::sin(yaw) * ahead,
                          std::sin(yaw) * side + std::cos(yaw) * ahead,
                          bounce_m * std::cos(phase) * s};
            if (std::floor(phase / (2 * pi)) > std::floor(before / (2 * pi))) {
                since = 0;
                strength = strike_m_s2 * random_.uniform(0.6, 1.3) * s;
                strike = {0.3 * random_.normal(), 0.3 * random_.normal(), 1};
            }
            since += dt_;
            m_.shake_m_s2[i] =
                (strength * std::exp(-since / 0.03) * std::cos(2 * pi * 25 * since)) * strike;
            m_.speed_m_s[i] = speed * s;
            const double k = step_hz / 1.9;  // a runner's body moves more
            set(i,
                yaw_pitch_roll(yaw + k * 0.08 * std::sin(phase / 2) * s,
                               -0.4 + k * 0.05 * std::sin(phase) * s + 0.2 * look(t) * s,
                               k * 0.05 * std::sin(phase / 2 + 1) * s) *
                    mount_,
                place + sway, s > 0.01);
        });
        return std::move(m_);
    }

    /// Flies: thrust along its own z axis, so that every acceleration is a tilt.
    Motion drone() {
        const Wander3 fly{random_, 0.02, plan_.rate_hz_max};
        const Wander bend{random_, 0.005, 0.1};
        V3 place{};
        double yaw = 0;
        const auto velocity = [&](double t) {
            const V3 w = fly(t);
            return fade(t, 10, plan_.seconds - 8, 3) * V3{3 * w.x, 3 * w.y, w.z};
        };
        each([&](std::size_t i, double t) {
            place += dt_ * velocity(t);
            yaw += 0.5 * bend(t) * fade(t, 10, plan_.seconds - 8, 3) * dt_;
            const V3 thrust = 1 / (2 * dt_) * (velocity(t + dt_) - velocity(t - dt_)) + V3{0, 0, g};
            set(i, shortest_to(thrust) * about(yaw, 0, 0, 1) * mount_, place, t > 10);
        });
        return std::move(m_);
    }

    /// Legs of acceleration, bends and slopes; leans outwards in bends. Up to 25 m/s.
    Motion car() {
        std::vector<double> speed(n_), bend(n_);
        plan_legs(speed, bend);
        speed = smoothed(speed);
        bend = smoothed(bend);
        const Wander hill{random_, 0.003, 0.04}, road{random_, 0.5, 3};
        m_.speed_m_s = speed;
        m_.forward = rotate(conj(mount_), V3{0, 1, 0});
        double yaw = 0, slope = 0;
        V3 place{};
        each([&](std::size_t i, double t) {
            yaw += bend[i] * dt_;
            const double wish = speed[i] > 0.5 ? 0.07 * hill(t) : slope;
            slope += dt_ / 2 * (wish - slope);
            place += (speed[i] * dt_) * V3{-std::sin(yaw) * std::cos(slope),
                                           std::cos(yaw) * std::cos(slope), std::sin(slope)};
            const double push = i > 0 ? (speed[i] - speed[i - 1]) / dt_ : 0;
            const Q4 q = about(yaw, 0, 0, 1) * about(slope + 0.004 * push, 1, 0, 0) *
                         about(0.008 * -speed[i] * bend[i], 0, 1, 0) * mount_;
            const V3 bump{0, 0, 0.004 * road(t) * std::min(speed[i] / 5, 1.0)};
            set(i, q, place + bump, speed[i] > 0.2);
        });
        return std::move(m_);
    }

    /// On a circle for a minute: a walker (radius and turn_deg_s make the speed), or a carousel.
    Motion circle() {
        const double rate = plan_.turn_deg_s * pi / 180;
        double yaw = 0;
        const bool travels = plan_.radius_m > 0;
        if (travels) m_.speed_m_s.resize(n_);
        m_.forward = rotate(conj(mount_), V3{0, 1, 0});
        each([&](std::size_t i, double t) {
            const double s = fade(t, 20, 80, 4);
            yaw += rate * s * dt_;
            if (travels) m_.speed_m_s[i] = rate * s * plan_.radius_m;
            set(i, about(yaw, 0, 0, 1) * mount_,
                plan_.radius_m * V3{std::cos(yaw), std::sin(yaw), 0}, t > 20 && plan_.radius_m > 0);
        });
        return std::move(m_);
    }

    /// A hinge about one body axis, the other two quiet.
    Motion hinge() {
        const Wander turn{random_, 0.05, 0.6};
        const V3 axis = random_.direction(), arm = 0.3 * random_.direction();
        each([&](std::size_t i, double t) {
            const double s = fade(t, 8, plan_.seconds - 5, 1);
            const Q4 q = mount_ * from_rotation_vector((0.9 * s * turn(t)) * axis);
            set(i, q, rotate(q, arm), s > 0.01);
        });
        return std::move(m_);
    }

  private:
    template <class F>
    void each(F f) {
        for (std::size_t i = 0; i < n_; ++i) f(i, static_cast<double>(i) * dt_);
    }
    void set(std::size_t i, const Q4& q, const V3& p, bool moving) {
        m_.q_wb[i] = q;
        m_.p_m[i] = p;
        m_.moving[i] = moving ? 1 : 0;
    }
    static Q4 shortest_to(const V3& up) {
        const V3 u = (1 / norm(up)) * up;
        return normalised(Q4{1 + u.z, -u.y, u.x, 0});
    }
    void plan_legs(std::vector<double>& speed, std::vector<double>& bend) {
        double now = 0;
        const auto last = n_ - std::min(n_, static_cast<std::size_t>(12 / dt_));
        std::size_t i = static_cast<std::size_t>(10 / dt_);
        while (i < last) {
            const auto kind = random_.below(5);
            const double seconds = random_.uniform(4, 12);
            double push = 0, turn = 0;
            if (kind == 0 || now < 3)
                push = random_.uniform(1, 3);
            else if (kind == 1)
                push = -std::min(random_.uniform(1, 4), now / seconds);
            if (kind >= 3 && now > 3)
                turn =
                    (random_.below(2) == 0 ? 1 : -1) * std::min(random_.uniform(1, 4) / now, 0.6);
            const std::size_t end = std::min(n_, i + static_cast<std::size_t>(seconds / dt_));
            for (; i < end; ++i) {
                now = std::clamp(now + push * dt_, 0.0, 25.0);
                speed[i] = now;
                bend[i] = turn;
            }
        }
        for (; i < n_; ++i) speed[i] = now = std::max(0.0, now - 3 * dt_);
    }
    /// Twice a running mean over 1.2 s: no step of acceleration.
    std::vector<double> smoothed(std::vector<double> x) const {
        const auto width = static_cast<std::size_t>(1.2 / dt_);
        for (int pass = 0; pass < 2; ++pass) {
            std::vector<double> y(x.size());
            double sum = 0;
            for (std::size_t i = 0; i < x.size() + width / 2; ++i) {
                if (i < x.size()) sum += x[i];
                if (i >= width) sum -= x[i - width];
                if (i >= width / 2) y[i - width / 2] = sum / static_cast<double>(width);
            }
            x = y;
        }
        return x;
    }

    const MotionPlan& plan_;
    Random& random_;
    double dt_;
    std::size_t n_{};
    Q4 mount_;
    Motion m_;
};

}  // namespace

const std::vector<std::string>& motion_kinds() {
    static const std::vector<std::string> kinds{"hand",      "slow",  "fast", "walk",
                                                "run",       "drone", "car",  "circle",
                                                "turntable", "hinge", "rest"};
    return kinds;
}

Motion make_motion(const MotionPlan& plan, Random& random, double rate_hz) {
    Maker make{plan, random, rate_hz};
    const std::string& kind = plan.kind;
    if (kind == "hand") return make.hand(2.0, 0.8, 0.25, 1.2, 12);
    if (kind == "slow") return make.hand(0.6, 0.4, 0.1, 0.5, 12);
    if (kind == "fast") return make.hand(6.0, 1.5, 0.35, 1.2, 2);
    if (kind == "walk") return make.walk(1.4, 1.9, 12, 0.025);
    if (kind == "run") return make.walk(2.8, 2.7, 30, 0.045);
    if (kind == "drone") return make.drone();
    if (kind == "car") return make.car();
    if (kind == "circle") return make.circle();
    if (kind == "hinge") return make.hinge();
    if (kind == "rest") return make.hand(0, 0.8, 0, 1.2, 12);
    if (kind == "turntable") {
        MotionPlan on_axis = plan;
        on_axis.radius_m = 0;
        Maker still{on_axis, random, rate_hz};
        return still.circle();
    }
    throw BadSpec("unknown motion '" + kind + "'");
}

}  // namespace fairlead::sim
