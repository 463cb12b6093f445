#pragma once

namespace fairlead::gateway {

inline constexpr const char* version = "0.1.0";

}  // namespace fairlead::gateway
