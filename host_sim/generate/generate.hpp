#pragma once
// Recordings with known truth from a short description. Same SPEC and seed, same bytes, with every
// compiler. The grammar is in docs/formats.md and in `fairlead-sim generate --help`.
#include <cstdint>
#include <string>

#include "host_sim/recording/recording.hpp"

namespace fairlead::sim {

/// Throws BadSpec. The result holds poses (tracker models) or samples (IMU models), and the truth,
/// one pose per record.
Recording generate(const std::string& spec, std::uint64_t seed);

extern const char* const generate_help;

}  // namespace fairlead::sim
