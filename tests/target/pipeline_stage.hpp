#pragma once
// A whole pipeline: poses or samples in, bytes out. Config is what Pipeline<Config> or
// ImuPipeline<Config, mode> takes, with that one's run-time parameters in a static function
// params(): their type says which of the two it is.
#include "fairlead/imu_pipeline.hpp"
#include "tests/target/subject.hpp"

namespace fairlead {

/// The bytes that a push completed, as far as the digest is concerned.
inline void mix(target::Digest& d, const Bytes& bytes) noexcept {
    target::mix_bytes(d, bytes.data, bytes.size);
}

namespace target {

template <class Config, class Whole>
inline constexpr bool configures =
    std::is_same_v<decltype(Config::params()), typename Whole::Params>;

template <class Config>
struct PipelineStage {
    using Imu = ImuPipeline<Config, AttitudeMode::imu>;
    using ImuMag = ImuPipeline<Config, AttitudeMode::imu_mag>;
    using Whole =
        std::conditional_t<configures<Config, ImuMag>, ImuMag,
                           std::conditional_t<configures<Config, Imu>, Imu, Pipeline<Config>>>;

    static constexpr unsigned latency = Config::window + Config::Filter::latency;  // at most
    static constexpr bool takes_samples = !std::is_same_v<Whole, Pipeline<Config>>;
    static constexpr bool takes_anything = true;
    using Output = Bytes;
    Whole pipeline{Config::params()};

    std::optional<Output> push(const Record& in) {
        if constexpr (takes_samples)
            return some(pipeline.push(in.sample));
        else
            return some(pipeline.push(in.pose));
    }
    std::optional<Output> flush() { return some(pipeline.flush()); }

  private:
    static std::optional<Output> some(const Bytes& bytes) {
        if (bytes.empty()) return std::nullopt;
        return bytes;
    }
};

}  // namespace target
}  // namespace fairlead
