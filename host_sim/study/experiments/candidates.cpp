#include "host_sim/study/experiments/candidates.hpp"

#include <cmath>

#include "fairlead/smooth/adaptive.hpp"
#include "fairlead/smooth/filter.hpp"
#include "fairlead/smooth/strain.hpp"
#include "host_sim/study/experiments/plot.hpp"

namespace fairlead::sim {
namespace {

/// A stage of the library as a causal filter: what it emits at a push; the pose itself until then.
template <class Stage>
class StageFilter final : public CausalFilter {
  public:
    template <class... Arguments>
    explicit StageFilter(const Arguments&... arguments) : stage_{arguments...} {}
    Pose push(const Pose& pose) override {
        const auto out = stage_.push(pose);
        return out ? *out : pose;
    }

  private:
    Stage stage_;
};

/// The line of the adaptive filter, read where it was a while ago: any time, not only a record's.
class LateLine final : public CausalFilter {
  public:
    LateLine(const AdaptiveParams& q, const AdaptiveParams& p, double late_s)
        : line_{q, p}, late_ns_{std::llround(late_s * 1e9)} {}
    Pose push(const Pose& pose) override {
        line_.push(pose);
        return line_.predict(pose.t_ns - late_ns_);
    }

  private:
    AdaptivePoseFilter line_;
    std::int64_t late_ns_;
};

constexpr std::size_t settings = 24, taps_max = 129;

/// Setting i of `settings`, evenly over the logarithm.
double between(double low, double high, std::size_t i) {
    return low * std::pow(high / low, static_cast<double>(i) / (settings - 1));
}

class List {
  public:
    explicit List(double step_s) : step_s_{step_s} {}

    template <class Make>
    void add(const std::string& family, const std::string& setting, bool ours, Make make) {
        all_.push_back({family, setting, ours, make});
    }

    void strain(std::size_t lag) {
        using Strain = AnyStrainSmoother<20>;
        const auto family = "strain, lag " + std::to_string(lag);
        // dense where hands move and filters work: 0.0125 to 0.2 cycles a sample
        constexpr std::size_t dense = 32;
        for (std::size_t i = 0; i < dense; ++i) {
            const double part = static_cast<double>(i) / (dense - 1);
            const double hz = 0.0125 / step_s_ * std::pow(16, part);
            const auto params =
                StrainParams::from_cutoff(static_cast<float>(hz), static_cast<float>(step_s_), 1);
            add(family, formatted("%.2f Hz", hz), true,
                [p = *params, lag] { return std::make_unique<StageFilter<Strain>>(p, lag); });
        }
    }

    void masks() {
        using Mask = AnyMask<taps_max>;
        using Stage = StageFilter<AnyPoseFilter<taps_max>>;
        const auto mask = [this](const std::string& family, std::size_t n, const Mask& m) {
            add(family, std::to_string(n) + " taps", true,
                [m] { return std::make_unique<Stage>(m); });
        };
        for (std::size_t i = 0; i < settings; ++i)
            mask("binomial mask", 3 + 2 * i, *Mask::binomial(3 + 2 * i));
        for (const std::size_t degree : {1u, 2u}) {
            for (const std::size_t lag : {0u, 1u, 2u, 3u, 4u, 6u}) {
                const auto family = "polynomial mask, degree " + std::to_string(degree) + ", lag " +
                                    std::to_string(lag);
                for (std::size_t n = 2 * lag + degree + 2; n < 2 * lag + 2 + 2 * settings; n += 3)
                    mask(family, n, *Mask::savitzky_golay(n, degree, n - 1 - lag));
            }
        }
    }

    void adaptive() {
        for (const double hz : {0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0, 12.0}) {
            for (const double slope : {0.0, 0.3, 0.6, 1.2, 2.5}) {
                const AdaptiveParams q{static_cast<float>(hz), static_cast<float>(slope)};
                const AdaptiveParams p{static_cast<float>(hz), static_cast<float>(6 * slope)};
                add("adaptive", formatted("%.1f Hz, slope %.1f", hz, slope), true,
                    [q, p] { return std::make_unique<StageFilter<AdaptivePoseFilter>>(q, p); });
            }
        }
    }

    void late_lines() {
        using Mask = AnyMask<taps_max>;
        using Stage = StageFilter<AnyPoseFilter<taps_max>>;
        for (double late = 0.2; late < 20; late += late < 3.3 ? 0.24 : (late < 8 ? 0.48 : 1.9)) {
            for (std::size_t i = 0; i < settings; ++i) {
                const double hz = between(0.008, 0.4, i) / step_s_;
                const AdaptiveParams params{static_cast<float>(hz), 0};
                add("line read late", formatted("%.2f samples, %.2f Hz", late, hz), true,
                    [params, late, h = step_s_] {
                        return std::make_unique<LateLine>(params, params, late * h);
                    });
            }
            for (const double degree : {1.0, 1.4, 1.7, 2.0}) {
                const auto least = static_cast<std::size_t>(late) + 2;
                for (std::size_t n = least; n < 3 * least + 4; n += 1 + n / 9) {
                    add("mask read late",
                        formatted("%.2f samples, degree %.1f, ", late, degree) + std::to_string(n) +
                            " taps",
                        true,
                        [m = *Mask::late(n, degree, late)] { return std::make_unique<Stage>(m); });
                }
            }
        }
    }

    void rivals() {
        for (std::size_t i = 0; i < settings; ++i) {
            const std::size_t n = 2 + i, odd = 3 + 2 * i;
            const auto part = static_cast<float>(between(0.02, 0.95, i));
            const auto taps = std::to_string(n) + " taps";
            const auto weight = formatted("share %.3f", static_cast<double>(part));
            add("component mean", taps, false,
                [n] { return std::make_unique<ComponentFilter>(average_taps(n), n - 1); });
            add("component exponential", weight, false, [part] {
                return std::make_unique<ComponentFilter>(exponential_taps(128, part), 127);
            });
            add("component binomial", std::to_string(odd) + " taps", false,
                [odd] { return std::make_unique<ComponentFilter>(binomial_taps(odd), odd / 2); });
            add("global log mean", taps, false,
                [n] { return std::make_unique<GlobalLogFilter>(average_taps(n), n - 1); });
            add("cumulative mean", taps, false,
                [n] { return std::make_unique<CumulativeFilter>(average_taps(n), n - 1); });
            if (i < 20)
                add("slerp de Casteljau", std::to_string(odd) + " taps", false,
                    [odd] { return std::make_unique<CasteljauFilter>(odd); });
            add("exponential slerp", weight, false,
                [part] { return std::make_unique<ExponentialFilter>(part); });
        }
        for (const double hz : {0.3, 0.6, 1.0, 1.7, 3.0, 5.0, 8.0}) {
            for (const double gain : {0.0, 0.3, 1.0, 3.0, 10.0}) {
                const auto one = [hz](double g) {
                    return OneEuroParams{static_cast<float>(hz), static_cast<float>(g), 1};
                };
                add("One Euro", formatted("%.1f Hz, gain %.1f", hz, gain), false,
                    [p = one(4 * gain), q = one(gain)] {
                        return std::make_unique<OneEuroFilter>(p, q);
                    });
            }
        }
    }

    std::vector<Candidate> take() { return std::move(all_); }

  private:
    double step_s_;
    std::vector<Candidate> all_;
};

}  // namespace

std::vector<Candidate> candidates(double step_s) {
    List list{step_s};
    for (const std::size_t lag : {0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 10u, 12u, 14u, 16u, 18u, 20u})
        list.strain(lag);
    list.late_lines();
    list.masks();
    list.adaptive();
    list.rivals();
    return list.take();
}

}  // namespace fairlead::sim
