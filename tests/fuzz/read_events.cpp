// The reader of events CSV, with any bytes: what is read is written back the same.
#include <cstddef>
#include <cstdint>

#include "host_sim/recording/event_file.hpp"
#include "host_sim/recording/recording.hpp"

using namespace fairlead::sim;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        const std::string once = to_events_csv(parse_events(text, "x"));
        if (to_events_csv(parse_events(once, "y")) != once) __builtin_trap();
    } catch (const BadData&) {
    }
    return 0;
}
