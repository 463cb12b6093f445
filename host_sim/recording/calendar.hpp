#pragma once
// Times as a calendar writes them, "2023-05-01T12:34:56.789+02:00" (ISO 8601) or "01-May-2023
// 12:34:56.789", as seconds since 1970 in decimal digits; times of the day alone, "12:34:56.789",
// as seconds since the midnight before the first. They are rewritten before anything else looks at
// the text, so that all later rules for times hold for them too, and no digit is lost.
#include <string>
#include <string_view>
#include <vector>

namespace fairlead::sim {

/// The text with the first calendar time of each line as decimal seconds, kept in `storage`; the
/// text itself where its first record holds none. `column`: the field of the first record that
/// holds it; npos: none. A time without a zone is
/// taken as UTC, with a note. Years 1970 to 2261; a date that does not exist is left as it is. A
/// time of the day alone must be a whole field; where it goes back by half a day or more, a day is
/// added.
std::string_view with_decimal_times(std::string_view text, std::string& storage,
                                    std::size_t& column, std::vector<std::string>& notes);

}  // namespace fairlead::sim
