// The gateway's configuration: any text is read, or refused with errors that name the file.
#include "examples/gateway/config.hpp"

#include <string>

#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text{reinterpret_cast<const char*>(data), size};
    const auto result = fairlead::gateway::parse_config(text, "fuzz.toml");
    for (const std::string& error : result.errors)
        FUZZ_EXPECT(error.find("fuzz.toml") != std::string::npos);
    return 0;
}
