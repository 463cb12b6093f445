// The rival filters do what their papers say, and the measurement of filters measures.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "fairlead/smooth/strain_buffer.hpp"
#include "host_sim/study/baselines/filters/filters.hpp"
#include "host_sim/study/baselines/filters/gradient_descent.hpp"
#include "host_sim/study/experiments/frontier.hpp"
#include "tests/ref/motions.hpp"

namespace fairlead::test {
namespace {

using namespace fairlead::sim;

std::vector<Pose> run(CausalFilter& filter, const std::vector<Pose>& in) {
    std::vector<Pose> out;
    for (const auto& pose : in) out.push_back(filter.push(pose));
    return out;
}

/// A turn about one axis: every mask must give the scalar filter there.
std::vector<Pose> one_axis(Motions& motions, std::vector<double>& angles) {
    std::vector<Pose> poses(80);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        angles.push_back(0.5 * std::sin(0.1 * static_cast<double>(i)) +
                         motions.uniform(-0.05, 0.05));
        poses[i].t_ns = static_cast<std::int64_t>(i) * 8'000'000;
        poses[i].flags = flag::position_valid | flag::orientation_valid;
        poses[i].q_wb = to_float(exp_d(Vector3d(0, 0, angles.back())));
    }
    return poses;
}

TEST(FilterBaselines, are_the_scalar_filter_on_one_axis) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    std::vector<double> angles;
    const auto in = one_axis(motions, angles);
    const auto taps = binomial_taps(7);
    CasteljauFilter casteljau{7};
    GlobalLogFilter global{taps, 3};
    CumulativeFilter cumulative{taps, 3};
    ComponentFilter component{taps, 3};
    const auto a = run(casteljau, in), b = run(global, in), c = run(cumulative, in),
               d = run(component, in);
    for (std::size_t i = 20; i < in.size(); ++i) {
        double expected = 0;
        for (std::size_t k = 0; k < 7; ++k)
            expected += static_cast<double>(taps[k]) * angles[i - 6 + k];
        const auto z = [i](const std::vector<Pose>& out) {
            return log_d(to_double(out[i].q_wb)).z();
        };
        EXPECT_NEAR(z(a), expected, 2e-6);
        EXPECT_NEAR(z(b), expected, 2e-6);
        EXPECT_NEAR(z(d), expected, 2e-4);  // re-normalisation bends
        // the cumulative scheme keeps the offset with which it began
        EXPECT_NEAR(z(c) - z(b),
                    log_d(to_double(c[19].q_wb)).z() - log_d(to_double(b[19].q_wb)).z(), 1e-5);
    }
}

TEST(FilterBaselines, one_euro_without_speed_is_the_exponential_filter) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    const auto in = motions.make({});
    const OneEuroParams plain{3, 0, 1};
    OneEuroFilter euro{plain, plain};
    const double tau = 1 / (2 * 3.14159265 * 3), dt = 1 / 120.0;
    ExponentialFilter exponential{static_cast<float>(1 / (1 + tau / dt))};
    const auto a = run(euro, in), b = run(exponential, in);
    for (std::size_t i = 0; i < in.size(); ++i) {
        EXPECT_LT((to_double(a[i].p_w_m) - to_double(b[i].p_w_m)).norm(), 1e-5);
        EXPECT_LT(angle_d(to_double(a[i].q_wb), to_double(b[i].q_wb)), 1e-5);
    }
}

TEST(FilterBaselines, gradient_descent_ends_where_strain_does) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    MotionPlan plan;
    plan.n = 60;
    const auto in = motions.make(plan);
    const auto params = StrainParams::from_cutoff(12, 1 / 120.0f, 20);
    const auto lambda = static_cast<double>(params->position.lambda());
    const auto buffer = std::make_unique<StrainBuffer<60>>();
    std::vector<Pose> out(in.size());
    buffer->smooth(in.data(), out.data(), in.size(), *params);
    std::vector<Vec3> raw_p, p, best_p;
    std::vector<Quat> raw_q, q, best_q;
    for (std::size_t i = 0; i < in.size(); ++i) {
        raw_p.push_back(in[i].p_w_m), raw_q.push_back(in[i].q_wb);
        best_p.push_back(out[i].p_w_m), best_q.push_back(out[i].q_wb);
    }
    descend(raw_p, p, lambda, 0, 3000);
    descend(raw_q, q, lambda, 0, 3000);
    for (std::size_t i = 0; i < in.size(); ++i) {
        EXPECT_LT((to_double(p[i]) - to_double(best_p[i])).norm(), 2e-6);
        EXPECT_LT(angle_d(to_double(q[i]), to_double(best_q[i])), 2e-5);
    }
}

class Delay final : public CausalFilter {
  public:
    Pose push(const Pose& pose) override {
        last_.push_back(pose);
        return last_[last_.size() > 3 ? last_.size() - 4 : 0];
    }

  private:
    std::vector<Pose> last_;
};

TEST(Measure, finds_a_delay_and_its_noise) {
    SCOPED_TRACE(seed_text());
    Motions motions{seed()};
    MotionPlan plan;
    plan.n = 1500;
    plan.noise_m = plan.noise_rad = 0;
    NoisyMotion motion;
    motion.step_s = plan.step_s;
    motion.truth = motion.input = motions.make(plan);
    for (auto& pose : motion.input) {
        pose.p_w_m = to_float(to_double(pose.p_w_m) + motions.normal(0.002));
        pose.q_wb = to_float(to_double(pose.q_wb) * exp_d(motions.normal(0.02)));
    }
    const Candidate candidate{"delay", "3", false, [] { return std::make_unique<Delay>(); }};
    const auto f = measure(candidate, motion, 5);
    EXPECT_NEAR(f.position.lag, 3, 0.1);
    EXPECT_NEAR(f.orientation.lag, 3, 0.1);
    // white noise loses what lies below 5 of 60 Hz, and a little to the interpolation of the lag
    EXPECT_NEAR(f.position.error, 0.002 * std::sqrt(3.0), 3e-4);
    EXPECT_NEAR(f.orientation.error, 0.02 * std::sqrt(3.0), 3e-3);
    EXPECT_NEAR(f.position.noise / f.position.error, std::sqrt(55 / 60.0), 0.03);
    EXPECT_NEAR(f.position.overshoot, 0, 1e-6);
}

TEST(Frontier, keeps_what_nobody_beats_and_matches_it_fairly) {
    const auto entry = [](bool ours, double lag, double noise, double error) {
        Entry e{"f", "s", ours, {}};
        e.figures.position = {lag, noise, error, 0, 0};
        return e;
    };
    const std::vector<Entry> entries{entry(false, 1, 5, 6),   entry(false, 2, 6, 6),
                                     entry(false, 3, 2, 4),   entry(true, 0.5, 4, 5),
                                     entry(true, 0.2, 1, 99), entry(true, 2.9, 1.5, 3)};
    const auto all = matches(entries, &Figures::position);
    ASSERT_EQ(all.size(), 2u);            // the rival at lag 2 is beaten by the one at lag 1
    EXPECT_EQ(all[0].same_lag.noise, 4);  // not the one that bends the motion
    EXPECT_EQ(all[0].same_noise.lag, 0.5);
    EXPECT_EQ(all[1].same_lag.noise, 1.5);
}

}  // namespace
}  // namespace fairlead::test
