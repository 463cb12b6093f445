#pragma once
#include "fairlead/sense/intake.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text = "Intake<Pose>";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = true;
    using Output = fairlead::Pose;
    fairlead::Intake<fairlead::Pose> stage{};

    std::optional<Output> push(const fairlead::target::Record& in) { return stage.push(in.pose); }
    std::optional<Output> flush() { return std::nullopt; }
};
