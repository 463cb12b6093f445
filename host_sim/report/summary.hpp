#pragma once
// The summary of a replay: one set of rows for the terminal, the page and the README.
#include <string>
#include <vector>

#include "host_sim/replay/replay.hpp"

namespace fairlead::sim {

struct Row {
    std::string name, position, orientation;  // a value for the whole run stands in `position`
    bool whole{false};
};

std::vector<Row> summary_rows(const Replay& replay);
std::string summary_table(const Replay& replay);  // plain text

/// One object: "samples", "bytes", "position" and "orientation" (the channels that are reduced),
/// "events" (if there are any), then how the stream was made. docs/reducer.md names all fields.
std::string summary_json(const Replay& replay);

/// The sensors that the orientation is made of, in words.
const char* to_string(AttitudeMode mode);

/// "none", or "3 not finite, 1 gap".
std::string faults_text(const Replay& replay);

/// "12 345" with narrow groups of three, for people.
std::string grouped(std::size_t n);

}  // namespace fairlead::sim
