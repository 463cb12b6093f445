#include "host_sim/study/baselines/earlier/replay.hpp"

#include <array>
#include <optional>

#include "host_sim/replay/replay_board.hpp"
#include "host_sim/replay/replay_judge.hpp"
#include "host_sim/study/baselines/earlier/curve_store.hpp"
#include "host_sim/study/baselines/earlier/wire/encoder.hpp"

namespace fairlead::sim::earlier {

using namespace fairlead::earlier;
namespace {

/// The earlier encoder as the codec of a pipeline. The width of the search is its slice of work.
template <class Board>
class Codec {
  public:
    using Stream = StreamParams<typename Board::Channels, Board::delay_records_max>;
    struct Counts {
        std::uint32_t frame_count{0};
        std::uint32_t frames() const { return frame_count; }
        std::uint32_t restarts() const { return 0; }  // it does not count them
        std::uint32_t overflows() const { return 0; }
        std::uint32_t given_up() const { return 0; }
    };

    static constexpr Check check(const Stream& stream) noexcept {
        if (stream.restart_interval_ns == 0) return {Status::bad_argument, "restart_interval_ns"};
        return {};
    }
    static constexpr IntakeLimits limits(const Stream&, std::int64_t period_ns) noexcept {
        IntakeLimits limits;
        limits.spacing_min_ns = tick_ns(period_ns);
        limits.gap_ns = default_gap_ns(period_ns);
        return limits;
    }
    Codec(const Stream& stream, std::uint32_t delay_records) noexcept {
        if constexpr (Board::Channels::template has<Position>)
            for (std::size_t i = 0; i < 3; ++i)
                params_.tol_position_m[i] = stream.tolerance.position_m[i];
        if constexpr (Board::Channels::template has<Orientation>)
            params_.tol_orientation_rad = stream.tolerance.orientation_rad;
        params_.position = Board::Channels::template has<Position>;
        params_.orientation = Board::Channels::template has<Orientation>;
        params_.delay_max = delay_records;
        params_.restart_interval_ns = stream.restart_interval_ns;
        constexpr std::array<Credit, 3> slices{slice_small, slice_medium, slice_large};
        params_.slice = slices[static_cast<std::size_t>(Board::beam)];
        set_period(stream.sample_period_ns);
    }
    /// The grid of its knots cannot change once it runs.
    void set_period(std::int64_t period_ns) noexcept {
        if (begun_) return;
        params_.tick_ns = static_cast<std::uint32_t>(tick_ns(period_ns));
        encoder_.emplace(params_);
    }
    Bytes push(const Pose& pose) noexcept {
        begun_ = true;
        return encoder_->push(pose);
    }
    Bytes idle() noexcept { return encoder_->idle(); }
    static constexpr bool busy() noexcept { return false; }
    Bytes flush() noexcept {
        Bytes bytes = encoder_->flush();
        if (bytes.empty()) bytes.status = Status::end;
        return bytes;
    }
    bool push_event(const Event& event) noexcept { return encoder_->push_event(event); }
    void reset() noexcept { encoder_.emplace(params_); }
    Counts inner() const noexcept { return {encoder_->frames()}; }

  private:
    /// Half a period; two digits, so that a restart point tells it in few bits.
    static constexpr std::int64_t tick_ns(std::int64_t period_ns) noexcept {
        std::int64_t tick = period_ns / 2 < 1000 ? 1000 : period_ns / 2, unit = 1;
        while (tick / unit > 99) unit *= 10;
        return tick / unit * unit;
    }

    EncoderParams params_{};
    std::optional<Encoder<Board::delay_records_max, slice_large, Board::events_max>> encoder_{};
    bool begun_{false};
};

/// Its curves are in float.
class Reader : public CurveStore {
  public:
    CurvePoint point_at(std::uint32_t, std::int64_t t_ns) const { return CurvePoint::of(at(t_ns)); }
};

template <class List>
void count(List CurveRun::*member, const CurveStore& store, ChannelResult& channel) {
    for (const CurveRun& run : store.runs()) {
        const List& list = run.*member;
        channel.curves += list.curves();
        channel.breaks += list.breaks();
        channel.knots += list.knots();
        channel.control_points += list.control_points();
        channel.pieces += list.pieces().size();
        for (const auto& piece : list.pieces()) channel.knot_ns.push_back(piece.t0_ns());
    }
}

void share_bytes(const Decoder::Counters& counters, Replay& result) {
    ChannelResult &p = result.position, &r = result.orientation;
    const std::size_t total = result.stream.size() - result.events.bytes;
    if (p.samples > 0 && r.samples > 0) {
        const std::size_t own = counters.position_bits + counters.orientation_bits;
        const std::size_t beside = 8 * total > own ? 8 * total - own : 0;
        p.bytes = std::min(total, (counters.position_bits + beside / 2) / 8);
        r.bytes = total - p.bytes;
    } else {
        (p.samples > 0 ? p : r).bytes = total;
    }
}

}  // namespace

void run(const Recording& recording, Replay& result) {
    switch (result.options.beam) {
        case Beam::narrow: return run_board<Beam::narrow, Codec>(recording, result);
        case Beam::wide: return run_board<Beam::wide, Codec>(recording, result);
        case Beam::medium:
        default: break;
    }
    run_board<Beam::medium, Codec>(recording, result);
}

void judge_stream(Replay& result) {
    const Reader store = judge<Reader>(result);
    result.events.bytes = static_cast<std::size_t>(store.event_counters().bytes);
    result.restarts = store.counters().restarts;
    result.runs = store.runs().size();
    count(&CurveRun::position, store, result.position);
    count(&CurveRun::orientation, store, result.orientation);
    share_bytes(store.counters(), result);
}

}  // namespace fairlead::sim::earlier
