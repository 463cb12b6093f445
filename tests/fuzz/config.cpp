// The gateway's configuration: any text is read, or refused with errors that name the file: the
// configuration, or the file of a chip or of a calibration that it names.
#include "examples/gateway/config.hpp"

#include <string>

#include "tests/fuzz/input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text{reinterpret_cast<const char*>(data), size};
    const auto result = fairlead::gateway::parse_config(text, "fuzz/fuzz.toml");
    for (const std::string& error : result.errors) {
        const bool beside = error.rfind("fuzz/", 0) == 0, absolute = error.rfind('/', 0) == 0;
        FUZZ_EXPECT((beside || absolute) && error.find(": ") != std::string::npos);
    }
    return 0;
}
