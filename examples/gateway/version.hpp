#pragma once
// The gateway tells its clients the version of the library that it was built with.
#include "fairlead/version.hpp"

namespace fairlead::gateway {

inline constexpr const char* version = FAIRLEAD_VERSION;

}  // namespace fairlead::gateway
