#pragma once
// Spoils recordings on purpose, so that people can see what their chain does with bad input. Same
// recording, SPEC and seed: same bytes.
#include <cstdint>
#include <string>

#include "host_sim/recording/recording.hpp"
#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {

extern const char* const faults_help;

/// True for items that spoil bytes (cut, flip); the others spoil records. Throws BadSpec.
bool is_byte_fault(const SpecItem& item);
void spoil_records(Recording& recording, const SpecItem& item, std::uint64_t seed);
void spoil_bytes(std::string& bytes, const SpecItem& item, std::uint64_t seed);

}  // namespace fairlead::sim
