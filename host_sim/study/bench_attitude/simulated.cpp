#include "host_sim/study/bench_attitude/simulated.hpp"

#include <algorithm>
#include <cmath>

#include "fairlead/math/mat3.hpp"
#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {
namespace {

constexpr double deg = 0.017453292519943295, g = 9.81;
constexpr V3 field_uT{0, 20, -43};

/// Noise densities are one-sided: deg/s/sqrt(Hz), ug/sqrt(Hz). Bias, zero, scale, misalignment:
/// standard deviations. Steps: of one count at 2000 deg/s and 16 g.
struct Chip {
    const char* name;
    double gyro_noise, accel_noise_ug, bias_deg_s, zero_mg, scale, misalignment, gyro_step_deg_s,
        accel_step_g, bias_walk_deg_s;
};
constexpr Chip chips[]{
    {"bmi160", 0.007, 180, 1.0, 20, 0.01, 0.005, 1 / 16.4, 1 / 2048.0, 0.002},
    {"icm42688", 0.0028, 70, 0.5, 10, 0.005, 0.003, 1 / 16.4, 1 / 2048.0, 0.0015},
    {"lsm6dso", 0.0038, 70, 0.5, 10, 0.005, 0.005, 0.07, 0.000488, 0.0015},
    {"mpu6050", 0.005, 400, 1.0, 30, 0.01, 0.01, 1 / 16.4, 1 / 2048.0, 0.003},
};

const Chip& chip_named(const std::string& name) {
    for (const Chip& chip : chips)
        if (name == chip.name) return chip;
    throw BadSpec("unknown chip '" + name + "'");
}

BasicMat3<double> imperfect(Random& random, double scale, double misalignment) {
    BasicMat3<double> m;
    const auto row = [&](V3 v) {
        const V3 s = random.normal3(misalignment);
        return v + s;
    };
    m.x = row({1, 0, 0});
    m.y = row({0, 1, 0});
    m.z = row({0, 0, 1});
    m.x.x = 1 + scale * random.normal();
    m.y.y = 1 + scale * random.normal();
    m.z.z = 1 + scale * random.normal();
    return m;
}

double rounded(double x, double step) { return std::round(x / step) * step; }
V3 counted(const V3& v, double step, double limit) {
    const auto one = [&](double x) { return std::clamp(rounded(x, step), -limit, limit); };
    return {one(v.x), one(v.y), one(v.z)};
}
Vec3 narrow(const V3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

void turn_over(Motion& m, const TurnOver& t, Random& random) {
    const double around = random.uniform(0, 2 * pi_v<double>);
    const auto at = static_cast<std::size_t>(t.at_s * m.rate_hz);
    if (at >= m.q_wb.size()) return;
    // about an axis that is horizontal where it begins
    const V3 axis = rotate(conj(m.q_wb[at]), V3{std::cos(around), std::sin(around), 0});
    for (std::size_t i = at; i < m.q_wb.size(); ++i) {
        const double u = std::min(1.0, (static_cast<double>(i) / m.rate_hz - t.at_s) / t.seconds);
        const double share = 0.5 - 0.5 * std::cos(pi_v<double> * u);
        m.q_wb[i] = m.q_wb[i] * from_rotation_vector((share * t.angle_deg * deg) * axis);
    }
}

/// Readings of one sensor chip, sample by sample.
class Sensors {
  public:
    Sensors(const SimPlan& plan, Random& random)
        : plan_{plan}, chip_{chip_named(plan.chip)}, random_{random} {
        gyro_ = imperfect(random, chip_.scale, chip_.misalignment);
        accel_ = imperfect(random, chip_.scale, chip_.misalignment / 2);
        bias_ = plan.bias_deg_s ? V3{*plan.bias_deg_s, *plan.bias_deg_s, *plan.bias_deg_s}
                                : random.normal3(chip_.bias_deg_s);
        zero_ = random.normal3(1e-3 * chip_.zero_mg * g);
        iron_ = plan.hard_iron_uT * random.direction();
        const auto sign = [&] { return random.below(2) == 0 ? 1.0 : -1.0; };
        signs_ = {sign(), sign(), sign()};
    }

    Sample read(double t, const V3& rate, const V3& force, const Q4& q, bool moving) {
        const double root = std::sqrt(plan_.rate_hz / 2);
        bias_ += random_.normal3(chip_.bias_walk_deg_s / std::sqrt(plan_.rate_hz));
        double more = 0;
        if (plan_.drift) {
            const Drift& d = *plan_.drift;
            const double u = std::clamp((t - d.from_s) / (d.to_s - d.from_s), 0.0, 1.0);
            more += d.from_deg_s + u * (d.to_deg_s - d.from_deg_s);
        }
        if (plan_.jump && t >= plan_.jump->at_s) more += plan_.jump->by_deg_s;
        const V3 gyro = gyro_ * rate + deg * (bias_ + more * signs_) +
                        random_.normal3(chip_.gyro_noise * deg * root);
        const V3 shaken = moving ? force + random_.normal3(plan_.vibration_m_s2) : force;
        const V3 accel =
            accel_ * shaken + zero_ + random_.normal3(chip_.accel_noise_ug * 1e-6 * g * root);
        const bool saturates =
            plan_.turn_over && plan_.turn_over->failure == TurnOver::Failure::saturation;
        Sample s;
        s.t_ns = std::llround(t * 1e9);
        const double gyro_range = saturates ? 125 * deg : 2000 * deg;
        s.gyro_rad_s = narrow(counted(gyro, chip_.gyro_step_deg_s * deg, gyro_range));
        s.accel_m_s2 = narrow(counted(accel, chip_.accel_step_g * g, 16 * g));
        s.mag_uT = narrow(rotate(conj(q), field_uT) + iron_ + random_.normal3(0.5));
        s.flags = flag::gyro_valid | flag::accel_valid | flag::mag_valid;
        if (saturates && at_end(s.gyro_rad_s, gyro_range))
            s.flags |= flag::clipped | flag::gyro_clipped;
        return s;
    }

  private:
    static bool at_end(const Vec3& v, double range) {
        const auto limit = static_cast<float>(0.999 * range);
        return approx::absolute(v.x) >= limit || approx::absolute(v.y) >= limit ||
               approx::absolute(v.z) >= limit;
    }
    static V3 scaled(double s, const V3& v) { return s * v; }

    const SimPlan& plan_;
    const Chip& chip_;
    Random& random_;
    BasicMat3<double> gyro_, accel_;
    V3 bias_, zero_, iron_, signs_;
};

/// What the failure of a turn-over does to a reading; false: it is lost.
bool fail(Sample& s, double t, const SimPlan& plan, Sample& frozen) {
    if (!plan.turn_over) return true;
    const TurnOver& over = *plan.turn_over;
    if (t < over.at_s) frozen = s;
    if (t < over.at_s || t >= over.at_s + over.seconds) return true;
    switch (over.failure) {
        case TurnOver::Failure::gap: return false;
        case TurnOver::Failure::saturation: break;
        case TurnOver::Failure::frozen_gyro: s.gyro_rad_s = frozen.gyro_rad_s; break;
        case TurnOver::Failure::frozen_all: {
            const std::int64_t t_ns = s.t_ns;
            s = frozen;
            s.t_ns = t_ns;
            break;
        }
    }
    return true;
}

}  // namespace

Simulated simulate(const SimPlan& plan) {
    Random random{plan.seed};
    const auto over = static_cast<std::size_t>(std::max(1.0, std::ceil(400 / plan.rate_hz)));
    const double fine_hz = plan.rate_hz * static_cast<double>(over), dt = 1 / fine_hz;
    Motion m = make_motion(plan.motion, random, fine_hz);
    if (plan.turn_over) turn_over(m, *plan.turn_over, random);
    Sensors sensors{plan, random};
    Simulated out;
    Recording& r = out.recording;
    r.name = plan.name;
    r.format = Format::imu;
    r.period_s = 1 / plan.rate_hz;
    out.forward = narrow(m.forward);
    V3 turned{}, pushed{};
    Sample frozen;
    double next_field = 0;
    for (std::size_t i = 1; i + 1 < m.q_wb.size(); ++i) {
        turned += rotation_vector(conj(m.q_wb[i - 1]) * m.q_wb[i]);
        const V3 acc = fine_hz * fine_hz * (m.p_m[i + 1] - 2.0 * m.p_m[i] + m.p_m[i - 1]) +
                       (m.shake_m_s2.empty() ? V3{} : m.shake_m_s2[i]);
        pushed += rotate(conj(m.q_wb[i]), acc + V3{0, 0, g});
        if (i % over != 0) continue;
        const double t = static_cast<double>(i) * dt;
        const auto n = static_cast<double>(over);
        Sample s =
            sensors.read(t, (fine_hz / n) * turned, (1 / n) * pushed, m.q_wb[i], m.moving[i] != 0);
        turned = pushed = {};
        if (!fail(s, t, plan, frozen) || t < plan.cut_s) continue;
        if (plan.mag_rate_hz > 0) {
            if (t < next_field)
                s.flags &= ~static_cast<std::uint32_t>(flag::mag_valid);
            else
                next_field = t + 1 / plan.mag_rate_hz;
        }
        Pose truth;
        truth.t_ns = s.t_ns;
        const Q4& q = m.q_wb[i];
        truth.q_wb = {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
                      static_cast<float>(q.z)};
        truth.flags = flag::orientation_valid;
        r.samples.push_back(s);
        r.truth.push_back(truth);
        r.moving.push_back(1);
        if (!m.speed_m_s.empty()) out.speed_m_s.push_back(static_cast<float>(m.speed_m_s[i]));
    }
    return out;
}

}  // namespace fairlead::sim
