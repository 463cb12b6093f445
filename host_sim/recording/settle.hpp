#pragma once
// What the columns that a header names are together: one column for each axis of a sensor or a
// pose, one clock. What contradicts itself is refused with the choices; what is left out is noted.
#include <string>
#include <vector>

#include "host_sim/recording/layout.hpp"

namespace fairlead::sim {

bool has(const std::vector<Column>& columns, Role role);
bool has_sensor(const std::vector<Column>& columns);
inline void set_unused(Column& column) { column.role = Role::ignored; }

/// Sensors and poses. `hint`: the sensor of columns x, y, z alone; Role::bare: not known.
void settle_vectors(std::vector<Column>& columns, Role hint, std::vector<std::string>& notes);

/// Several columns of time: seconds and nanoseconds, or columns that say the same.
void settle_times(std::vector<Column>& columns, const Evidence& evidence,
                  std::vector<std::string>& notes);

}  // namespace fairlead::sim
