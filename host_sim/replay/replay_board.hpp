#pragma once
// The pipelines of the host: a board for each kind of record, choice of channels and width of the
// search, in the memory for the longest delay. replay_narrow.cpp, replay_medium.cpp and
// replay_wide.cpp compile one width each, replay_cubic.cpp all widths for C2 cubics; the earlier
// search is a codec for the same pipeline.
#include <algorithm>
#include <cmath>
#include <memory>

#include "fairlead/pipeline.hpp"
#include "host_sim/replay/replay_feed.hpp"

namespace fairlead::sim {

/// Runs the recording with the codec of a width. Defined by the file of that width.
template <Beam beam>
void run_beam(const Recording& recording, Replay& result);
extern template void run_beam<Beam::narrow>(const Recording&, Replay&);
extern template void run_beam<Beam::medium>(const Recording&, Replay&);
extern template void run_beam<Beam::wide>(const Recording&, Replay&);

/// The same with C2 cubics for positions.
void run_cubics(const Recording& recording, Replay& result);

template <class In, class Channel, Beam width, class Pieces = curve::Smooth>
struct HostBoard {
    using Input = In;
    using Channels = Channel;
    using Kind = Pieces;
    using Filter = TappedFilter;
    static constexpr std::size_t delay_records_max = delay_most;
    static constexpr Beam beam = width;
    static constexpr std::size_t events_max = 6;
};

/// The nominal period of a recording, as the grid of the curves takes it.
inline std::int64_t sample_period_ns(const Recording& recording) {
    const double ns = recording.period_s * 1e9;
    if (!(ns > 0)) return 0;  // not known: the pipeline measures it
    return static_cast<std::int64_t>(std::clamp(ns, static_cast<double>(sample_period_min_ns),
                                                static_cast<double>(sample_period_max_ns)));
}

/// The largest float that is no larger: the guarantee holds for the number that the user gave.
inline float not_above(double x) {
    const auto near = static_cast<float>(x);
    return static_cast<double>(near) <= x ? near : std::nextafter(near, 0.0f);
}

template <class Chain, class Channels>
typename Chain::Params host_params(const Recording& recording, Replay& result) {
    const ReplayOptions& options = result.options;
    typename Chain::Params params;
    params.filter.chain = parse_filters(options.filter, recording.period_s);
    params.filter.in = &result.raw;
    params.filter.out = &result.input;
    result.filter_delay = params.filter.chain.delay();
    params.sample_period_ns = sample_period_ns(recording);
    if constexpr (Channels::template has<Position>)
        params.tolerance.position_m = PerAxis<3>{not_above(options.tol_pos_m)};
    if constexpr (Channels::template has<Orientation>)
        params.tolerance.orientation_rad = not_above(options.tol_rot_rad);
    params.delay_records = options.delay_max;
    params.restart_interval_ns = static_cast<std::int64_t>(options.restart_s * 1e9);
    params.stream_id = options.stream_id;
    return params;
}

template <class Chain>
std::unique_ptr<Chain> make_chain(const typename Chain::Params& params) {
    auto chain = std::make_unique<Chain>(params);
    if (!chain->check())
        throw BadSpec(std::string{"the pipeline refuses its parameter "} + chain->check().field);
    return chain;
}

/// What the encoder counted; a codec without such counts has none.
template <class Chain>
void note_counts(const Chain& chain, Replay& result) {
    const auto& encoder = chain.encoder().inner();
    result.frames = encoder.frames();
    result.restarts = encoder.restarts();
    result.overflows = encoder.overflows() + encoder.given_up();
}

// in float32 with time and validity: a pose as in a .trk, an IMU's sensors as in an .imu
inline constexpr std::size_t pose_bytes = 36, sensor_bytes = 12, time_bytes = 8;

template <class Channels, Beam beam, template <class> class Codec, class Pieces = curve::Smooth>
void run_poses(const Recording& recording, Replay& result) {
    using Chain = BasicPipeline<HostBoard<Pose, Channels, beam, Pieces>, Codec>;
    const auto chain = make_chain<Chain>(host_params<Chain, Channels>(recording, result));
    result.bytes_per_record = pose_bytes;
    feed(
        *chain, recording.poses, recording.events, [] {}, result);
    note_counts(*chain, result);
}

template <AttitudeMode mode, Beam beam, template <class> class Codec>
void run_imu(const Recording& recording, Replay& result) {
    using Chain = BasicPipeline<HostBoard<Imu<mode>, Channels<Orientation>, beam>, Codec>;
    const auto chain =
        make_chain<Chain>(host_params<Chain, Channels<Orientation>>(recording, result));
    constexpr std::size_t sensors = mode == AttitudeMode::gyro  ? 1
                                    : mode == AttitudeMode::imu ? 2
                                                                : 3;
    result.bytes_per_record = time_bytes + sensors * sensor_bytes;
    AttitudeTrace& trace = result.attitude.emplace();
    trace.mode = mode;
    const auto note = [&] {
        if (chain->pose()) trace.note(*chain->pose(), chain->attitude());
    };
    feed(*chain, recording.samples, recording.events, note, result);
    note_counts(*chain, result);
    add_errors(trace, recording, result.raw);
}

/// The board that suits the recording and the options.
template <Beam beam, template <class> class Codec>
void run_board(const Recording& recording, Replay& result) {
    const ReplayOptions& o = result.options;
    if (recording.samples.empty()) {
        if (!o.orientation) return run_poses<Channels<Position>, beam, Codec>(recording, result);
        if (!o.position) return run_poses<Channels<Orientation>, beam, Codec>(recording, result);
        return run_poses<Channels<Position, Orientation>, beam, Codec>(recording, result);
    }
    switch (o.mode.value_or(all_sensors(recording))) {
        case AttitudeMode::gyro: return run_imu<AttitudeMode::gyro, beam, Codec>(recording, result);
        case AttitudeMode::imu: return run_imu<AttitudeMode::imu, beam, Codec>(recording, result);
        case AttitudeMode::imu_mag: break;
        default: break;
    }
    run_imu<AttitudeMode::imu_mag, beam, Codec>(recording, result);
}

}  // namespace fairlead::sim
