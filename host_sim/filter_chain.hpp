#pragma once
// --filter SPEC: filters chosen at run time, one after another, as one stage. All memory is inside.
#include <optional>
#include <string>
#include <variant>

#include "fairlead/smooth/adaptive.hpp"
#include "fairlead/smooth/cascade.hpp"

namespace fairlead::sim {

extern const char* const filter_help;

inline constexpr std::size_t taps_max = 257, filters_max = 8;

/// Any of the filters that a SPEC can name.
class NamedFilter {
  public:
    NamedFilter() = default;
    explicit NamedFilter(const AnyMask<taps_max>& mask) : filter_{Masked{mask}} {}
    explicit NamedFilter(const AdaptivePoseFilter& filter) : filter_{filter} {}

    std::optional<Pose> push(const Pose& pose) noexcept {
        return std::visit([&](auto& f) { return f.push(pose); }, filter_);
    }
    std::optional<Pose> flush() noexcept {
        return std::visit([](auto& f) { return f.flush(); }, filter_);
    }
    void reset() noexcept {
        std::visit([](auto& f) { f.reset(); }, filter_);
    }
    std::size_t delay() const noexcept {
        return std::visit([](const auto& f) { return f.delay(); }, filter_);
    }

  private:
    using Masked = AnyPoseFilter<taps_max>;
    std::variant<Masked, AdaptivePoseFilter> filter_{};
};

using FilterChain = Chain<NamedFilter, filters_max>;

/// binomial:N | hs:LAMBDA | hu:LAMBDA | sg:N:P | csg:N:P | taps:A,B,...@CENTRE |
/// adaptive:HZ:SLOPE, joined by '+'. Empty: no filter. Throws BadSpec.
FilterChain parse_filters(const std::string& spec);

}  // namespace fairlead::sim
