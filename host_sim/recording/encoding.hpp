#pragma once
// The bytes of a text file as UTF-8: byte order marks, UTF-16 of both orders, Latin-1.
#include <string>
#include <string_view>
#include <vector>

namespace fairlead::sim {

/// Text as programs on Windows write it, with a zero byte in every ASCII character.
bool looks_utf16(std::string_view bytes);

/// The text in UTF-8. `storage` keeps it where it had to be rewritten; `notes` says what was found.
/// Throws BadData for UTF-32.
std::string_view as_utf8(std::string_view bytes, std::string& storage,
                         std::vector<std::string>& notes);

}  // namespace fairlead::sim
