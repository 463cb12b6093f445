// Any bytes as a configuration: parse_config() answers with a Config or with errors, and never ends
// the program. As the calibration file of a unit, too. Build: make fuzz-config.
#include <cstddef>
#include <cstdint>
#include <string>

#include "examples/gateway/config.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace fairlead::gateway;
    const std::string text{reinterpret_cast<const char*>(data), size};
    const ConfigResult result = parse_config(text, "fuzz.toml");
    // what is accepted can be served: ids fit their table, limits their arrays
    if (!result.errors.empty()) return 0;
    for (const UnitConfig& unit : result.config.units)
        if (unit.id < 1 || unit.id > 247) __builtin_trap();
    if (result.config.units.empty() || result.config.listen.size() > 4) __builtin_trap();
    return 0;
}
