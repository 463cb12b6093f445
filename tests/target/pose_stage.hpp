#pragma once
// What the subjects share whose stage takes poses and gives poses.
#include "tests/target/subject.hpp"

namespace fairlead::target {

template <class Stage>
struct PoseStage {
    static constexpr unsigned latency = Stage::latency;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = false;
    using Output = Pose;
    Stage stage;

    std::optional<Output> push(const Record& in) { return stage.push(in.pose); }
    std::optional<Output> flush() { return stage.flush(); }
};

}  // namespace fairlead::target
