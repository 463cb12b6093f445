#pragma once
// The register map as other people's tools want it. All of it is printed from
// examples/gateway/register_map.hpp.
#include <array>
#include <string>

namespace fairlead::gateway {

std::string map_markdown();        // docs/registers.md
std::string map_telegraf();        // examples/gateway/clients/telegraf.conf
std::string map_home_assistant();  // examples/gateway/clients/home_assistant.yaml
std::string map_mbpoll();          // examples/gateway/clients/mbpoll.sh
std::string map_c_header();        // examples/gateway/clients/fairlead_registers.h

struct GeneratedFile {
    const char* path;
    std::string (*text)();
};
inline constexpr std::array<GeneratedFile, 5> generated_files{{
    {"docs/registers.md", map_markdown},
    {"examples/gateway/clients/telegraf.conf", map_telegraf},
    {"examples/gateway/clients/home_assistant.yaml", map_home_assistant},
    {"examples/gateway/clients/mbpoll.sh", map_mbpoll},
    {"examples/gateway/clients/fairlead_registers.h", map_c_header},
}};

}  // namespace fairlead::gateway
