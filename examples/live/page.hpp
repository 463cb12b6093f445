#pragma once
// The live page, whole: style, libraries and scripts in one text.
#include <string>

namespace fairlead::live {

/// `title`: what is shown, a file, a line or a gateway.
std::string page(const std::string& title);

}  // namespace fairlead::live
