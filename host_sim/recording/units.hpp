#pragma once
// The units that files of others use, and their factors to the library's: s, rad/s, m/s^2, uT, m,
// degrees Celsius.
#include <optional>
#include <string>
#include <string_view>

namespace fairlead::sim {

enum class Quantity { time, gyro, accel, mag, position, temperature };
constexpr std::size_t quantities = 6;

/// The quantity's name in options and messages: t, gyro, accel, mag, position, temperature.
const char* to_string(Quantity quantity);

struct Unit {
    std::string name;   // as messages show it
    double factor{1};   // value * factor + offset is in the library's unit
    double offset{0};   // of temperatures
    int time_shift{0};  // of times: value * 10^time_shift is in nanoseconds
};

/// The unit that a text names, in any common spelling: "rad s^-1", "rad/s", "RAD_S", "deg/s",
/// "m/s²", "µT". A plain number is a factor to the library's unit; of times a power of ten.
std::optional<Unit> unit_of(Quantity quantity, std::string_view text);

/// The library's own unit of a quantity (nanoseconds for times).
Unit own_unit(Quantity quantity);

/// "ns, us, ms, s": what can be said.
const char* known_units(Quantity quantity);

/// Lower case, without blanks and signs between; the common signs outside ASCII are spelt out.
std::string plain_unit(std::string_view text);

}  // namespace fairlead::sim
