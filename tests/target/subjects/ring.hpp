#pragma once
#include "fairlead/base/ring.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text = "Ring<Pose, 32>: push and, once full, pop";
    static constexpr unsigned latency = 31;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = true;
    using Output = fairlead::Pose;
    fairlead::Ring<fairlead::Pose, 32> ring{};

    std::optional<Output> push(const fairlead::target::Record& in) {
        ring.push(in.pose);
        return ring.full() ? flush() : std::nullopt;
    }
    std::optional<Output> flush() {
        if (ring.empty()) return std::nullopt;
        const fairlead::Pose out = ring.oldest();
        ring.pop();
        return out;
    }
};
