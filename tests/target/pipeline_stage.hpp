#pragma once
// A whole pipeline: poses in, bytes out. Config is what Pipeline<Config> takes, with its run-time
// parameters in a static function params().
#include "fairlead/pipeline.hpp"
#include "tests/target/subject.hpp"

namespace fairlead {

/// The bytes that a push completed, as far as the digest is concerned.
inline void mix(target::Digest& d, const Bytes& bytes) noexcept {
    target::mix_bytes(d, bytes.data, bytes.size);
}

namespace target {

template <class Config>
struct PipelineStage {
    static constexpr unsigned latency = Config::window + Config::Filter::latency;  // at most
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = true;
    using Output = Bytes;
    Pipeline<Config> pipeline{Config::params()};

    std::optional<Output> push(const Record& in) { return some(pipeline.push(in.pose)); }
    std::optional<Output> flush() { return some(pipeline.flush()); }

  private:
    static std::optional<Output> some(const Bytes& bytes) {
        if (bytes.empty()) return std::nullopt;
        return bytes;
    }
};

}  // namespace target
}  // namespace fairlead
