#pragma once
// A record into the adaptive filter, then where the body will be 20 ms later: by the filter's own
// rates, and from the last two records alone.
#include "fairlead/smooth/adaptive.hpp"
#include "fairlead/smooth/predict.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text = "predicted() and AdaptivePoseFilter::predict, one of each";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = false;
    using Output = std::array<fairlead::Pose, 2>;
    fairlead::AdaptivePoseFilter filter{};
    fairlead::Pose before{};

    void prepare(const fairlead::target::Record& in) { (void)filter.push(in.pose); }
    std::optional<Output> push(const fairlead::target::Record& in) {
        const std::int64_t then_ns = in.pose.t_ns + 20'000'000;
        const Output out{predicted(before, in.pose, then_ns), filter.predict(then_ns)};
        before = in.pose;
        return out;
    }
    std::optional<Output> flush() { return std::nullopt; }
};
