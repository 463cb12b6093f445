#pragma once
#include "fairlead/sense/intake.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text = "Intake<Sample>";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = true;
    static constexpr bool takes_anything = true;
    using Output = fairlead::Sample;
    fairlead::Intake<fairlead::Sample> stage{};

    std::optional<Output> push(const fairlead::target::Record& in) { return stage.push(in.sample); }
    std::optional<Output> flush() { return std::nullopt; }
};
