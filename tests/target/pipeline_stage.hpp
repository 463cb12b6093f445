#pragma once
// A whole pipeline: poses or samples in, bytes out. Config is a board (fairlead/board.hpp) with the
// parameters of its pipeline in a static function params().
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
    using Whole = Pipeline<Config>;

    static constexpr unsigned latency = Config::delay_records_max + Config::Filter::latency;
    static constexpr bool takes_samples = std::is_same_v<typename Whole::Raw, Sample>;
    static constexpr bool takes_anything = true;
    using Output = Bytes;
    Whole pipeline{Config::params()};

    std::optional<Output> push(const Record& in) {
        if constexpr (takes_samples)
            return some(pipeline.push(in.sample));
        else
            return some(pipeline.push(in.pose));
    }
    std::optional<Output> flush() {
        const Bytes bytes = pipeline.flush();
        if (bytes.empty() && bytes.status == Status::end) return std::nullopt;
        return bytes;
    }

  private:
    static std::optional<Output> some(const Bytes& bytes) {
        if (bytes.empty()) return std::nullopt;
        return bytes;
    }
};

}  // namespace target
}  // namespace fairlead
