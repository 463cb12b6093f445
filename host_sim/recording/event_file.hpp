#pragma once
// Discrete events in a file beside a recording: CSV, t_ns,channel,value,gap. The recordings'
// formats have no place for them.
#include <string>
#include <string_view>
#include <vector>

#include "fairlead/base/types.hpp"

namespace fairlead::sim {

/// With a header; gap is 1 where events before this one are missing.
std::string to_events_csv(const std::vector<Event>& events);

/// The fourth column may be absent. Throws BadData with the line.
std::vector<Event> parse_events(std::string_view text, const std::string& name);

/// Empty for an empty path. Throws BadData.
std::vector<Event> read_events(const std::string& path);

}  // namespace fairlead::sim
