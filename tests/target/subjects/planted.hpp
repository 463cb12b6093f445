#pragma once
// Not a stage: a trap for tests/target/search.py. Its dear branch needs a long rest, then a large
// turn, then a rest again; no stream of streams/adverse takes it.
#include "fairlead/math/quat.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text = "a dear branch that the search must find";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = false;
    using Output = float;
    fairlead::Pose before{};
    int rested{0};
    bool turned_after_rest{false};

    std::optional<Output> push(const fairlead::target::Record& in) {
        const float angle = fairlead::rotation_angle(before.q_wb, in.pose.q_wb);
        const bool still = norm(in.pose.p_w_m - before.p_w_m) == 0 && angle == 0;
        before = in.pose;
        float sum = angle;
        if (turned_after_rest && still) {
            for (int i = 0; i < 300; ++i) sum += fairlead::approx::sin(sum);
        }
        turned_after_rest = rested > 24 && angle > 0.3f;
        rested = still ? rested + 1 : 0;
        return sum;
    }
    std::optional<Output> flush() { return std::nullopt; }
};
