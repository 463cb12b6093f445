#pragma once
#include "examples/firmware/config.hpp"
#include "tests/target/pipeline_stage.hpp"

struct Subject {
    static constexpr const char* text = "Encoder<32>: both reducers and the codec";
    static constexpr unsigned latency = 32;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = false;
    using Output = fairlead::Bytes;
    fairlead::Encoder<32> encoder{Config::params().encoder};

    std::optional<Output> push(const fairlead::target::Record& in) {
        return some(encoder.push(in.pose));
    }
    std::optional<Output> flush() { return some(encoder.flush()); }

  private:
    static std::optional<Output> some(const fairlead::Bytes& bytes) {
        if (bytes.empty()) return std::nullopt;
        return bytes;
    }
};
