#pragma once
// Random records for searches of counter-examples: any rate, jitter, pauses, leaps of value, noise,
// rest, extremes, channels that come and go. The same seed gives the same records everywhere.
#include <cmath>
#include <cstdint>
#include <random>

#include "fairlead/base/types.hpp"
#include "fairlead/curve/scale.hpp"
#include "fairlead/math/quat.hpp"

namespace fairlead::test {

class RandomMotion {
  public:
    explicit RandomMotion(std::uint64_t seed) : random_{seed} {
        period_ns = static_cast<std::int64_t>(std::exp(uniform(std::log(125e3), std::log(1e9))));
        jitter_ = chance(0.5) ? 0 : uniform(0, 0.34);
        missing_ = chance(0.6) ? 0 : uniform(0, 0.3);
        pause_ = chance(0.7) ? 0 : uniform(0, 0.05);
        off_rate_ = chance(0.6) ? 1 : uniform(0.7, 1.4);
        leap_ = chance(0.5) ? 0 : std::pow(10, uniform(-3, 0));
        noise_ = chance(0.4) ? 0 : std::pow(10, uniform(-2, 2));
        speed_ = std::pow(10, uniform(-3, 2.5));
        far_ = chance(0.2) ? std::pow(10, uniform(2, 6.9)) : 0;
        loss_ = chance(0.7) ? 0 : uniform(0, 0.2);
        rest_ = chance(0.5) ? 0 : 0.02;
        tolerance = static_cast<float>(std::pow(10, uniform(-6, 1)));
        tolerance_rad = static_cast<float>(std::pow(10, uniform(std::log10(1.3e-4), -0.5)));
        t_ns = chance(0.1) ? static_cast<std::int64_t>(uniform(-4e18, 4e18)) : 0;
    }
    std::int64_t period_ns{}, t_ns{};
    float tolerance{}, tolerance_rad{};
    std::array<float, 3> p{};
    Quat q{};
    std::uint32_t valid{3}, gaps{0};

    void next() {
        step_time();
        if (rest_ > 0 && chance(rest_)) resting_ = !resting_;
        for (std::size_t a = 0; a < 3; ++a) {
            if (!resting_) {
                v_[a] += speed_ * 0.3 * normal() - 0.05 * v_[a];
                x_[a] += v_[a];
                w_[a] += speed_ * 0.1 * normal() - 0.05 * w_[a];
            }
            if (chance(leap_)) x_[a] = chance(0.3) ? far_ * normal() : 3e3 * normal();
            const double most = 1.6e7;
            x_[a] = std::fmin(most, std::fmax(-most, x_[a]));
            const double y = std::fmin(most, std::fmax(-most, x_[a] + noise_ * normal()));
            p[a] = static_cast<float>(y * static_cast<double>(tolerance) * 1.19);
        }
        turn();
        valid = 3;
        if (chance(loss_)) valid = 1u + static_cast<std::uint32_t>(random_() % 2);
        gaps = chance(0.003) ? 1u + static_cast<std::uint32_t>(random_() % 3) : 0;
    }
    bool chance(double probability) { return uniform(0, 1) < probability; }
    double uniform(double a, double b) {
        return a + (b - a) * static_cast<double>(random_() >> 11) * 0x1p-53;
    }

  private:
    double normal() {  // a sum: the same with every library
        double s = -6;
        for (int i = 0; i < 12; ++i) s += uniform(0, 1);
        return s;
    }
    void step_time() {
        if (first_) {
            first_ = false;
            nominal_ = static_cast<double>(period_ns) * off_rate_;
            return;
        }
        double gone = nominal_ + nominal_ * jitter_ * (2 * uniform(0, 1) - 1) - late_;
        late_ = 0;
        while (chance(missing_)) gone += nominal_;
        if (chance(pause_)) gone += nominal_ * std::pow(10, uniform(0, 4));
        const std::int64_t least = period_ns * 20 / 64 + 40;
        auto step = static_cast<std::int64_t>(gone);
        if (step < least) step = least;
        t_ns += step;
    }
    void turn() {
        const double scale = static_cast<double>(tolerance_rad);
        Vec3 r{};
        for (std::size_t a = 0; a < 3; ++a) {
            const double x = (resting_ ? 0 : w_[a] * scale) + 0;
            const auto f = static_cast<float>(std::fmin(3, std::fmax(-3, x)));
            (a == 0 ? r.x : a == 1 ? r.y : r.z) = f;
        }
        held_ = normalised(held_ * from_rotation_vector(r));
        if (chance(leap_ * 0.5))
            held_ = normalised(Quat{static_cast<float>(normal()), static_cast<float>(normal()),
                                    static_cast<float>(normal()), static_cast<float>(normal())});
        const double n = std::fmin(1, noise_ * scale * 0.3);
        const Vec3 e{static_cast<float>(n * normal()), static_cast<float>(n * normal()),
                     static_cast<float>(n * normal())};
        q = normalised(held_ * from_rotation_vector(e));
        if (chance(0.3)) q = -q;
    }

    std::mt19937_64 random_;
    double jitter_{}, missing_{}, pause_{}, off_rate_{}, leap_{}, noise_{}, speed_{}, far_{},
        loss_{}, rest_{}, late_{}, nominal_{};
    std::array<double, 3> x_{}, v_{}, w_{};
    Quat held_{};
    bool first_{true}, resting_{false};
};

}  // namespace fairlead::test
