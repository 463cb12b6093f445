#pragma once
// Random streams for a whole pipeline: rates from 1 Hz to 8 kHz, jitter, lost records, gaps of one
// channel and of all, rests, motions, noise, teleports, extremes, clocks that leap. Each stream is
// one seed; shrinking it is a matter of its length.
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "fairlead/base/types.hpp"
#include "fairlead/math/quat.hpp"
#include "fairlead/stream_params.hpp"

namespace fairlead::test {

class Streams {
  public:
    explicit Streams(std::uint64_t seed) : random_{seed} {
        const double hz = std::exp(uniform(0, std::log(8000.0)));
        period_ns_ = static_cast<std::int64_t>(1e9 / hz);
        if (chance(0.4)) {
            constexpr std::int64_t usual[] = {40'000'000, 16'666'667, 10'000'000, 8'333'333,
                                              5'000'000,  2'500'000,  1'000'000,  125'000};
            period_ns_ = usual[below(8)];
        }
        jitter_ = chance(0.5) ? uniform(0, 0.3) : 0;
        lost_ = chance(0.3) ? uniform(0, 0.3) : 0;
        wild_time_ = chance(0.3) ? 0.02 : 0;
        wild_value_ = chance(0.3) ? uniform(0, 0.05) : 0;
        away_ = chance(0.3) ? 0.02 : 0;
        noise_ = chance(0.5) ? std::pow(10, uniform(-2, 2)) : 0;
        speed_ = std::pow(10, uniform(-2, 3));
        t_ns_ = chance(0.2) ? static_cast<std::int64_t>(random_()) : 1'700'000'000'000'000'000;
        place_ = chance(0.1) ? std::pow(10, uniform(0, 5)) : 0;
    }

    std::int64_t period_ns() const { return period_ns_; }
    std::mt19937_64& random() { return random_; }
    std::uint64_t below(std::uint64_t n) { return random_() % n; }
    double uniform(double a, double b) {
        return a + (b - a) * static_cast<double>(random_() >> 11) * 0x1p-53;
    }
    bool chance(double p) { return uniform(0, 1) < p; }

    /// The next pose; `tolerance` sets the scale of motion and noise.
    Pose pose(float tolerance_m, float tolerance_rad) {
        move();
        Pose pose;
        pose.t_ns = t_ns_;
        const double u = phase_;
        const double m = static_cast<double>(tolerance_m) * speed_;
        const double r = static_cast<double>(tolerance_rad) * std::min(speed_, 300.0);
        const auto rough = [this](float tol) {
            return noise_ * static_cast<double>(tol) * uniform(-1, 1);
        };
        pose.p_w_m = {static_cast<float>(place_ + jump_ * static_cast<double>(tolerance_m) +
                                         m * std::sin(u) + rough(tolerance_m)),
                      static_cast<float>(m * std::cos(0.7 * u) + rough(tolerance_m)),
                      static_cast<float>(m * u * 0.1 - place_ + rough(tolerance_m))};
        pose.q_wb = from_rotation_vector(
            Vec3{static_cast<float>(r * std::sin(u) + rough(tolerance_rad) + turn_),
                 static_cast<float>(r * std::sin(1.3 * u) + rough(tolerance_rad)),
                 static_cast<float>(0.05 * r * u)});
        pose.flags = flag::position_valid | flag::orientation_valid;
        spoil(pose);
        return pose;
    }

  private:
    void move() {
        double step = 1;
        if (jitter_ > 0) step += uniform(-jitter_, jitter_);
        while (chance(lost_)) step += 1;
        if (chance(0.003)) step += std::exp(uniform(0, 12));  // a pause
        auto wrapped = static_cast<std::uint64_t>(t_ns_) +
                       static_cast<std::uint64_t>(step * static_cast<double>(period_ns_));
        if (lone_)
            wrapped = static_cast<std::uint64_t>(before_lone_) +
                      2 * static_cast<std::uint64_t>(period_ns_);
        lone_ = false;
        t_ns_ = static_cast<std::int64_t>(wrapped);
        if (chance(wild_time_)) {
            before_lone_ = t_ns_;
            lone_ = chance(0.7);
            constexpr std::int64_t ends[] = {std::numeric_limits<std::int64_t>::min(),
                                             std::numeric_limits<std::int64_t>::max(), 0};
            t_ns_ = chance(0.3) ? ends[below(3)]
                    : chance(0.3)
                        ? static_cast<std::int64_t>(random_())
                        : static_cast<std::int64_t>(
                              wrapped + (below(40) - 20) * static_cast<std::uint64_t>(period_ns_));
        }
        if (chance(0.02)) moving_ = !moving_;
        if (moving_) phase_ += 0.02 + 0.03 * uniform(0, 1);
        if (chance(0.003)) jump_ = std::pow(10, uniform(0, 7)) * (chance(0.5) ? 1 : -1);
        if (chance(0.003)) turn_ = uniform(-3, 3);
        if (chance(0.002)) noise_ = chance(0.5) ? 0 : std::pow(10, uniform(-2, 2));
    }
    void spoil(Pose& pose) {
        if (chance(away_)) position_away_ = !position_away_;
        if (chance(away_)) orientation_away_ = !orientation_away_;
        if (position_away_) pose.flags &= ~flag::position_valid;
        if (orientation_away_) pose.flags &= ~flag::orientation_valid;
        if (chance(0.002)) pose.flags |= flag::gap_before;
        if (chance(0.002)) pose.flags |= chance(0.5) ? flag::position_gap : flag::orientation_gap;
        if (!chance(wild_value_)) return;
        const float values[] = {
            std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(),
            std::numeric_limits<float>::max(), static_cast<float>(std::pow(10, uniform(-8, 8))),
            static_cast<float>(-std::pow(10, uniform(-8, 8)))};
        (&pose.p_w_m.x)[below(3)] = values[below(5)];
        if (chance(0.3))
            (&pose.q_wb.w)[below(4)] = values[below(5)];
        else if (chance(0.5))
            pose.q_wb = normalised(Quat{static_cast<float>(uniform(-1, 1)),
                                        static_cast<float>(uniform(-1, 1)),
                                        static_cast<float>(uniform(-1, 1)), 0.01f});
    }

    std::mt19937_64 random_;
    std::int64_t period_ns_{}, t_ns_{}, before_lone_{};
    double jitter_{}, lost_{}, wild_time_{}, wild_value_{}, away_{}, noise_{}, speed_{}, place_{};
    double phase_{}, jump_{}, turn_{};
    bool moving_{true}, lone_{false}, position_away_{false}, orientation_away_{false};
};

/// A tolerance, log-even over the range that makes sense; delay over all of the board's.
template <class Params>
void draw(Params& params, Streams& s, std::uint32_t delay_max) {
    params.sample_period_ns = s.chance(0.25) ? 0 : s.period_ns();
    if (params.sample_period_ns != 0 && s.chance(0.1))  // told wrong, within reason
        params.sample_period_ns = std::clamp(
            static_cast<std::int64_t>(static_cast<double>(s.period_ns()) * s.uniform(0.5, 2)),
            sample_period_min_ns, sample_period_max_ns);
    params.delay_records = static_cast<std::uint32_t>(16 + s.below(delay_max - 15));
    if (s.chance(0.3)) params.delay_records = s.chance(0.5) ? 16 : delay_max;
    params.restart_interval_ns =
        s.chance(0.3)   ? 0
        : s.chance(0.3) ? never_ns
                        : s.period_ns() * (1 + static_cast<std::int64_t>(s.below(500)));
    params.header_interval_ns =
        s.chance(0.3) ? never_ns
                      : 1'000'000'000 + static_cast<std::int64_t>(s.below(60'000'000'000));
    params.stream_id = static_cast<std::uint16_t>(s.below(65536));
}

}  // namespace fairlead::test
