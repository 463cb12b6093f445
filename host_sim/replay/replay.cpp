#include "host_sim/replay/replay.hpp"

#include "host_sim/replay/curve_store.hpp"
#include "host_sim/replay/replay_board.hpp"
#include "host_sim/replay/replay_judge.hpp"
#include "host_sim/study/baselines/earlier/replay.hpp"

namespace fairlead::sim {
namespace {

void run(const Recording& recording, Replay& result) {
    result.raw.reserve(recording.size());
    result.input.reserve(recording.size());
    if (result.options.objective == Objective::knots) return earlier::run(recording, result);
    if (result.options.continuity == 2) return run_cubics(recording, result);
    switch (result.options.beam) {
        case Beam::narrow: return run_beam<Beam::narrow>(recording, result);
        case Beam::wide: return run_beam<Beam::wide>(recording, result);
        case Beam::medium:
        default: break;
    }
    run_beam<Beam::medium>(recording, result);
}

void count(const StoredChannel& (CurveRun::*member)() const, const CurveStore& store,
           ChannelResult& out) {
    for (const CurveRun& run : store.runs()) {
        const StoredChannel& channel = (run.*member)();
        out.curves += channel.curves();
        out.breaks += channel.breaks();
        out.pieces += channel.pieces();
        out.knots += channel.knots();
        out.control_points += channel.control_points();
        for (const CurveTrack& track : channel.tracks)
            for (const CurveTrack::Piece& piece : track.pieces())
                out.knot_ns.push_back(piece.start_ns);
    }
    std::sort(out.knot_ns.begin(), out.knot_ns.end());
}

/// Shares the curves' bytes out: the bytes of a channel's own pieces, and half of what frames and
/// headers need beside them.
void share_bytes(const CurveStore& store, Replay& result) {
    ChannelResult &p = result.position, &r = result.orientation;
    const std::size_t total = result.stream.size() - result.events.bytes;
    if (result.options.position && result.options.orientation) {
        const std::size_t own = store.piece_bytes(0) + store.piece_bytes(1);
        const std::size_t beside = total > own ? total - own : 0;
        p.bytes = std::min(total, store.piece_bytes(0) + beside / 2);
        r.bytes = total - p.bytes;
    } else {
        (result.options.position ? p : r).bytes = total;
    }
}

void judge_stream(Replay& result) {
    const CurveStore store = judge<CurveStore>(result);
    const StreamBytes bytes = stream_bytes(result.stream);
    result.events.bytes = bytes.events;
    result.header_bytes = bytes.headers;
    for (const CurveRun& run : store.runs()) result.runs += !run.empty();
    count(&CurveRun::position, store, result.position);
    count(&CurveRun::orientation, store, result.orientation);
    share_bytes(store, result);
}

}  // namespace

const char* to_string(Beam beam) {
    return beam == Beam::narrow ? "narrow" : beam == Beam::medium ? "medium" : "wide";
}
const char* to_string(Objective objective) {
    return objective == Objective::bytes ? "bytes" : "knots";
}

IntakeParams intake_params(const Recording& recording) {
    IntakeParams params;
    params.gap_ns = default_gap_ns(static_cast<std::int64_t>(recording.period_s * 1e9));
    return params;
}

Replay replay(const Recording& recording, const ReplayOptions& options) {
    Replay result;
    result.name = recording.name;
    result.options = options;
    if (!recording.samples.empty()) result.options.position = false;
    result.records_in = recording.size();
    if (recording.size() > 0)
        result.seconds =
            static_cast<double>(recording.t_ns(recording.size() - 1) - recording.t_ns(0)) * 1e-9;
    run(recording, result);
    result.bytes_in = result.bytes_per_record * result.records_in;
    if (result.options.objective == Objective::knots)
        earlier::judge_stream(result);
    else
        judge_stream(result);
    if (result.attitude && result.attitude->has_truth) {
        result.attitude->estimate = score(recording, result.raw);
        std::vector<Pose> curve;
        for (const Pose& pose : result.decoded)
            if ((pose.flags & flag::orientation_valid) != 0) curve.push_back(pose);
        result.attitude->curve = score(recording, curve);
    }
    return result;
}

}  // namespace fairlead::sim
