#pragma once
// What the columns of a text file are, by their names. The same grammar reads the header line of a
// file and the option --columns: a quantity, an axis, a unit, in the spellings that loggers use.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/recording/units.hpp"

namespace fairlead::sim {

enum class Role {
    unknown,      // a name that says nothing to us
    ignored,      // understood, and of no use here: a counter, a velocity, a covariance
    time,         // whole time, or its seconds where a time_rest stands beside
    time_rest,    // the nanoseconds beside seconds
    gyro,         // axes 0..2
    accel,        // likewise
    mag,          // likewise
    position,     // likewise
    quaternion,   // axes 0..3: w, x, y, z
    temperature,  // of the gyroscope's die
    bare,         // x, y, z or w (axis 3) without a quantity
    clipped,      // our own format: letters g, a, m of the sensors at the end of their range
    gap,          // our own format: 1 where samples before the record are missing
    moving,       // our own format: 1 in the movement phase of the reference
};
const char* to_string(Role role);

struct Column {
    Role role{};
    int axis{-1};
    std::optional<Unit> unit;  // where the name states one
    std::string name;          // as the file writes it
    std::string unknown_unit;  // what stands in brackets and is no unit of this quantity
    bool secondary{};          // linear, user or uncalibrated: used only where nothing better is
    bool by_unit{};            // the sensor is told by the unit alone, not by the name
    bool numbered{};           // a quaternion's axis is a number: which one is the scalar?
};

Column column_of(std::string_view name);

/// Quantity of a role that has units.
std::optional<Quantity> quantity_of(Role role);

/// Columns as a user names them in --columns: t_ns,gx,gy,gz,-,ax. Throws BadSpec at a name that
/// says nothing; "-" is a column to ignore.
std::vector<Column> parse_columns(const std::string& text);

/// The short name of a column, as --columns takes it: t, gx, ay, mz, px, qw, temperature, -.
std::string short_name(const Column& column);

}  // namespace fairlead::sim
