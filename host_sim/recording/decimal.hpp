#pragma once
// Numbers as text. Time stamps are read as decimal integers, never through a double: a double keeps
// only a part of a microsecond of the time since 1970.
#include <cstdint>
#include <optional>
#include <string_view>

namespace fairlead::sim {

/// text * 10^shift as an integer, rounded to the nearest one (half: away from zero). Every decimal
/// form is read exactly: 12, -0.5, +.5, 7., 1.4E+18. Empty: no such number, or not within int64.
std::optional<std::int64_t> scaled_integer(std::string_view text, int shift);

/// The power of ten of the last digit that is written: -2 of "1.25", 4 of "1.30503e9".
/// Empty: not a decimal number.
std::optional<int> last_place(std::string_view text);

/// A float32, correctly rounded; nan and inf are read. Empty: not a number.
std::optional<float> real32(std::string_view text);
std::optional<double> real64(std::string_view text);

}  // namespace fairlead::sim
