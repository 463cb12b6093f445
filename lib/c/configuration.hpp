#pragma once
// What the C interface is built for: FAIRLEAD_CONFIG names a header that defines Config, as for
// `make bounds`: a board (fairlead/board.hpp) with `static Pipeline<Config>::Params params()`.
// Config may also say `static constexpr fairlead::AttitudeMode attitude_mode = ...`, the sensors of
// the attitude filter alone; without it those of the Input, or all three.
#include FAIRLEAD_CONFIG

#include <algorithm>
#include <cstdint>
#include <type_traits>

#include "fairlead/pipeline.hpp"
#include "fairlead/sense/saved.hpp"
#include "fairlead/version.hpp"
#include "fairlead/wire/live.hpp"

namespace fairlead::c {

template <class Input>
struct InputKind {  // a Pose
    static constexpr bool poses = true, samples = false, vectors = false;
    static constexpr std::size_t components = 0;
    static constexpr AttitudeMode mode = AttitudeMode::imu_mag;
};
template <AttitudeMode m>
struct InputKind<Imu<m>> {
    static constexpr bool poses = false, samples = true, vectors = false;
    static constexpr std::size_t components = 0;
    static constexpr AttitudeMode mode = m;
};
template <std::size_t D>
struct InputKind<VectorSample<D>> {
    static constexpr bool poses = false, samples = false, vectors = true;
    static constexpr std::size_t components = D;
    static constexpr AttitudeMode mode = AttitudeMode::imu_mag;
};

template <class AConfig, class = void>
inline constexpr AttitudeMode attitude_mode = InputKind<typename AConfig::Input>::mode;
template <class AConfig>
inline constexpr AttitudeMode
    attitude_mode<AConfig, std::void_t<decltype(AConfig::attitude_mode)>> = AConfig::attitude_mode;

using Kind = InputKind<Config::Input>;
using BoardPipeline = Pipeline<Config>;
inline constexpr AttitudeMode mode = attitude_mode<Config>;
inline constexpr bool sends_position = Config::Channels::has<Position> && !Kind::vectors,
                      sends_orientation = Config::Channels::has<Orientation>;

// a reader of this board's streams, and of any stream of poses
inline constexpr std::size_t decoder_axes = (std::max)(std::size_t{3}, Kind::components);
inline constexpr std::size_t live_pieces = 32;
using BoardDecoder = wire::Decoder<decoder_axes, 1>;
using BoardLive = wire::LiveDecoder<live_pieces, decoder_axes, 1>;
using HeldPiece = wire::LiveTrack<1>::Held;  // a piece and its time grid

/// Attitude alone: intake, calibration and filter, as in a pipeline with this input.
struct AttitudeAlone {
    using Front = fairlead::detail::Front<Imu<mode>>;
    Check checked;
    Intake<Sample, Front::takes> intake;
    Front front;
};
using SavedAttitude = Saved<AttitudeAlone::Front::Attitude::State>;

/// What lies in the caller's memory. The tag tells an object from memory that holds none.
template <class Value, std::uint32_t object_tag>
struct Cell {
    static constexpr std::uint32_t tag_value = object_tag;
    template <class... Arguments>
    explicit Cell(const Arguments&... arguments) noexcept : tag{object_tag}, value{arguments...} {}

    std::uint32_t tag;
    Value value;
};
using PipelineCell = Cell<BoardPipeline, 0x66614c31>;
using DecoderCell = Cell<BoardDecoder, 0x66614c32>;
using LiveCell = Cell<BoardLive, 0x66614c33>;
using AttitudeCell = Cell<AttitudeAlone, 0x66614c34>;

}  // namespace fairlead::c
