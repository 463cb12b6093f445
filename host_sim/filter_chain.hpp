#pragma once
// --filter SPEC: filters chosen at run time, one after another, as one stage. All memory is inside.
#include <optional>
#include <string>

#include "fairlead/smooth/cascade.hpp"

namespace fairlead::sim {

extern const char* const filter_help;

inline constexpr std::size_t taps_max = 257, filters_max = 8;
using FilterChain = Chain<AnyPoseFilter<taps_max>, filters_max>;

/// binomial:N | hs:LAMBDA | hu:LAMBDA | sg:N:P | csg:N:P | taps:A,B,...@CENTRE, joined by '+'.
/// Empty: no filter. Throws BadSpec.
FilterChain parse_filters(const std::string& spec);

}  // namespace fairlead::sim
