#pragma once
// No stage at all: what the seam itself costs.
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text = "nothing, the seam alone";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = true;
    using Output = std::uint32_t;
    std::optional<Output> push(const fairlead::target::Record&) { return std::nullopt; }
    std::optional<Output> flush() { return std::nullopt; }
};
