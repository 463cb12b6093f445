#pragma once
// Reduction and frames without what stands before them: the encoder of a board. An intake that is
// not part of the stage lets through what the encoder may get.
#include "fairlead/pipeline.hpp"
#include "tests/target/pipeline_stage.hpp"

namespace fairlead::target {

template <class AChannels, std::size_t Delay, Beam Width, class Pieces = curve::Smooth>
struct EncoderStage {
    struct Board {
        using Input = Pose;
        using Channels = AChannels;
        using Kind = Pieces;
        using Filter = NoFilter;
        static constexpr std::size_t delay_records_max = Delay;
        static constexpr Beam beam = Width;
        static constexpr std::size_t events_max = 0;
    };
    using Encoder = StreamEncoder<Board>;
    using Gate = Intake<Pose, detail::valid_bits<AChannels>>;
    using Stream = StreamParams<AChannels, Delay>;

    static constexpr unsigned latency = Delay;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = true;
    using Output = Bytes;

    Encoder encoder{stream(), Delay - Gate::waiting_max};
    std::optional<Pose> accepted{};
    bool fresh{true};

    /// 2 mm and 0.5 deg at 120 records a second, as the firmware.
    static Stream stream() {
        Stream s;
        s.sample_period_ns = 8'333'333;
        if constexpr (AChannels::template has<Position>) s.tolerance.position_m = 0.002f;
        if constexpr (AChannels::template has<Orientation>)
            s.tolerance.orientation_rad = 0.0087266f;
        return s;
    }

    void prepare(const Record& in) {
        static std::optional<Gate> gate;
        if (fresh)
            gate.emplace(IntakeParams{}, Encoder::limits(stream(), stream().sample_period_ns));
        fresh = false;
        accepted = gate->push(in.pose);
    }
    std::optional<Output> push(const Record&) {
        return some(accepted ? encoder.push(*accepted) : encoder.idle());
    }
    std::optional<Output> flush() {
        const Bytes bytes = encoder.flush();
        if (bytes.empty() && bytes.status == Status::end) return std::nullopt;
        return bytes;
    }

  private:
    static std::optional<Output> some(const Bytes& bytes) {
        if (bytes.empty()) return std::nullopt;
        return bytes;
    }
};

using JustPosition = Channels<Position>;
using JustOrientation = Channels<Orientation>;
using Both = Channels<Position, Orientation>;

}  // namespace fairlead::target
