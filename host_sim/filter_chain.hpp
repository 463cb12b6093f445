#pragma once
// --filter SPEC: filters chosen at run time, one after another, as one stage. All memory is inside.
#include <array>
#include <optional>
#include <string>

#include "fairlead/smooth/filter.hpp"

namespace fairlead::sim {

extern const char* const filter_help;

class FilterChain {
  public:
    static constexpr std::size_t taps_max = 257, stages_max = 8;

    /// binomial:N | hs:LAMBDA | hu:LAMBDA | sg:N:P | csg:N:P | taps:A,B,...@CENTRE, joined by '+'.
    /// Empty: no filter. Throws BadSpec.
    explicit FilterChain(const std::string& spec);

    std::optional<Pose> push(const Pose& pose) noexcept { return carry(0, pose); }
    std::optional<Pose> flush() noexcept;
    void reset() noexcept;

    /// Records between a record and its filtered one.
    std::size_t delay() const noexcept;
    bool empty() const noexcept { return count_ == 0; }

  private:
    using Filter = AnyPoseFilter<taps_max>;

    std::optional<Pose> carry(std::size_t stage, const Pose& pose) noexcept;

    std::array<Filter, stages_max> filters_{};
    std::size_t count_{0}, flushing_{0};
};

}  // namespace fairlead::sim
