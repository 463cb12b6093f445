#include "host_sim/replay.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "fairlead/imu_pipeline.hpp"
#include "host_sim/curve_store.hpp"
#include "host_sim/filter_chain.hpp"
#include "host_sim/progress.hpp"
#include "host_sim/seal.hpp"

namespace fairlead::sim {
namespace {

// in float32 with time and validity: a pose as in a .trk, an IMU's sensors as in an .imu
constexpr std::size_t pose_bytes = 36, sensor_bytes = 12, time_bytes = 8;

/// The filter of the pipeline, with an ear on what goes in and out. Memory is reserved beforehand.
struct TappedFilter {
    FilterChain chain{};
    std::vector<Pose>* in{nullptr};
    std::vector<Pose>* out{nullptr};

    std::optional<Pose> push(const Pose& pose) noexcept {
        in->push_back(pose);
        return noted(chain.push(pose));
    }
    std::optional<Pose> flush() noexcept { return noted(chain.flush()); }
    void reset() noexcept { chain.reset(); }

  private:
    std::optional<Pose> noted(const std::optional<Pose>& pose) const noexcept {
        if (pose) out->push_back(*pose);
        return pose;
    }
};

template <std::size_t Window>
struct HostConfig : PipelineConfig {
    using Filter = TappedFilter;
    static constexpr std::size_t window = Window;
    static constexpr Credit slice = slice_large;
};
using HostParams = Pipeline<HostConfig<delay_most>>::Params;

/// A grid for the knots: half a period, and no coarser than the smallest step.
std::uint32_t tick_for(const Recording& recording) {
    std::int64_t tick_ns = static_cast<std::int64_t>(recording.period_s * 0.5e9);
    for (std::size_t i = 1; i < recording.size(); ++i) {
        const std::int64_t step_ns = recording.t_ns(i) - recording.t_ns(i - 1);
        if (step_ns > 0) tick_ns = std::min(tick_ns, step_ns);
    }
    tick_ns = std::clamp<std::int64_t>(tick_ns, 1000, 1000000000);
    std::int64_t step_ns = 1;  // two digits: a restart point tells them in few bits
    while (tick_ns / step_ns > 99) step_ns *= 10;
    return static_cast<std::uint32_t>(tick_ns / step_ns * step_ns);
}

HostParams parameters(const Recording& recording, const ReplayOptions& options, Replay& result) {
    HostParams params;
    params.intake = intake_params(recording);
    params.filter.chain = parse_filters(options.filter, recording.period_s);
    params.filter.in = &result.raw;
    params.filter.out = &result.input;
    const auto tolerance = static_cast<float>(options.tol_pos_m);
    params.encoder.tol_position_m = {tolerance, tolerance, tolerance};
    params.encoder.tol_orientation_rad = static_cast<float>(options.tol_rot_rad);
    params.encoder.tick_ns = tick_for(recording);
    params.encoder.delay_max = options.delay_max;
    params.encoder.slice = options.slice;
    params.encoder.goal = options.goal;
    params.encoder.restart_interval_ns = static_cast<std::int64_t>(options.restart_s * 1e9);
    params.encoder.position = options.position;
    params.encoder.orientation = options.orientation;
    return params;
}

/// Notes what the stream held when each pose of `input` had been taken.
void take(const Bytes& bytes, Replay& result) {
    const std::size_t before = result.stream.size();
    result.stream.append(reinterpret_cast<const char*>(bytes.data), bytes.size);
    auto& after = result.bytes_after_input;
    if (after.size() == result.input.size()) return;  // the reducers' own flush
    after.resize(result.input.size(), before);
    after.back() = result.stream.size();
}

template <class Step>
Bytes sealed(Step step) {
    const HeapSeal seal;
    return step();
}

/// Gives discrete events to the chain, each before the first record that is not earlier.
template <class Chain>
class EventFeed {
  public:
    EventFeed(const std::vector<Event>& events, Chain& chain, Replay& result)
        : events_{events}, chain_{chain}, result_{result.events}, stream_{result.stream} {}

    void offer(std::int64_t until_ns) {
        while (next_ < events_.size() && events_[next_].t_ns <= until_ns) offer_one();
    }
    bool offer_one() {
        if (next_ == events_.size()) return false;
        const Event& event = events_[next_++];
        ++result_.offered;
        if (chain_.push_event(event))
            result_.accepted.push_back(event);
        else
            ++result_.refused;
        return true;
    }
    /// The record is through: what was offered before it must be in the stream.
    void due() { result_.due.resize(result_.accepted.size(), stream_.size()); }

  private:
    const std::vector<Event>& events_;
    Chain& chain_;
    EventResult& result_;
    const std::string& stream_;
    std::size_t next_{0};
};

/// Leads every record through the chain; `note` may look at it after each.
template <class Chain, class Record, class Note>
void feed(Chain& chain, const std::vector<Record>& records, const std::vector<Event>& discrete,
          Note note, Replay& result) {
    Progress progress{"replay", records.size()};
    EventFeed<Chain> events{discrete, chain, result};
    for (const Record& record : records) {
        events.offer(record.t_ns);
        take(sealed([&] { return chain.push(record); }), result);
        events.due();
        note();
        result.bytes_after_record.push_back(result.stream.size());
        progress.show(result.bytes_after_record.size());
    }
    while (events.offer_one()) {  // those after the last record
        take(sealed([&] { return chain.idle(); }), result);
        events.due();
    }
    for (;;) {
        const Bytes bytes = sealed([&] { return chain.flush(); });
        take(bytes, result);
        if (bytes.empty()) break;
    }
    const FaultCounts& faults = chain.intake().faults();
    for (std::size_t i = 0; i < fault_kinds; ++i) {
        const auto kind = static_cast<Fault>(i);
        result.faults.emplace_back(to_string(kind), static_cast<std::size_t>(faults[kind]));
    }
}

template <std::size_t Window>
void run_poses(const Recording& recording, const HostParams& params, Replay& result) {
    using Chain = Pipeline<HostConfig<Window>>;
    const auto chain = std::make_unique<Chain>(
        typename Chain::Params{params.intake, params.filter, params.encoder});
    result.bytes_per_record = pose_bytes;
    feed(
        *chain, recording.poses, recording.events, [] {}, result);
}

template <AttitudeMode mode>
void run_imu(const Recording& recording, const HostParams& motion, Replay& result) {
    using Chain = ImuPipeline<HostConfig<delay_most>, mode>;
    typename Chain::Params params;
    params.intake = motion.intake;
    params.motion = motion;
    const auto chain = std::make_unique<Chain>(params);
    constexpr std::size_t sensors = mode == AttitudeMode::gyro  ? 1
                                    : mode == AttitudeMode::imu ? 2
                                                                : 3;
    result.bytes_per_record = time_bytes + sensors * sensor_bytes;
    AttitudeTrace& trace = result.attitude.emplace();
    trace.mode = mode;
    const auto note = [&] {
        if (chain->pose()) trace.note(*chain->pose(), chain->orientation());
    };
    feed(*chain, recording.samples, recording.events, note, result);
    add_errors(trace, recording, result.raw);
}

void run(const Recording& recording, const ReplayOptions& options, Replay& result) {
    result.raw.reserve(recording.size());
    result.input.reserve(recording.size());
    const auto params = parameters(recording, options, result);
    result.filter_delay = params.filter.chain.delay();
    if (recording.samples.empty()) {  // in the memory that a board would give to such a delay
        if (options.delay_max <= 60) return run_poses<60>(recording, params, result);
        if (options.delay_max <= 120) return run_poses<120>(recording, params, result);
        return run_poses<delay_most>(recording, params, result);
    }
    switch (options.mode.value_or(all_sensors(recording))) {
        case AttitudeMode::gyro: return run_imu<AttitudeMode::gyro>(recording, params, result);
        case AttitudeMode::imu: return run_imu<AttitudeMode::imu>(recording, params, result);
        case AttitudeMode::imu_mag: break;
    }
    run_imu<AttitudeMode::imu_mag>(recording, params, result);
}

double distance(const Vec3& a, const Vec3& b) {  // per axis, in double
    const auto apart = [](float x, float y) {
        return std::fabs(static_cast<double>(x) - static_cast<double>(y));
    };
    return std::max({apart(a.x, b.x), apart(a.y, b.y), apart(a.z, b.z)});
}

double distance(const Quat& a, const Quat& b) {  // full rotation angle, in double
    const auto wide = [](const Quat& q) {
        return BasicQuat<double>{static_cast<double>(q.w), static_cast<double>(q.x),
                                 static_cast<double>(q.y), static_cast<double>(q.z)};
    };
    return rotation_angle(wide(a), wide(b));
}

/// How one channel is read from a pose.
struct PositionView {
    static constexpr std::uint32_t valid = flag::position_valid;
    static const Vec3& of(const Pose& pose) { return pose.p_w_m; }
    static bool same(const Pose& a, const Pose& b) {
        return a.p_w_m.x == b.p_w_m.x && a.p_w_m.y == b.p_w_m.y && a.p_w_m.z == b.p_w_m.z;
    }
};
struct OrientationView {
    static constexpr std::uint32_t valid = flag::orientation_valid;
    static const Quat& of(const Pose& pose) { return pose.q_wb; }
    static bool same(const Pose& a, const Pose& b) {
        return a.q_wb.w == b.q_wb.w && a.q_wb.x == b.q_wb.x && a.q_wb.y == b.q_wb.y &&
               a.q_wb.z == b.q_wb.z;
    }
};

/// Notes for each sample after which record the bytes so far let a decoder evaluate the curve
/// there, and what it evaluated to.
template <class View>
class DelayMeter {
  public:
    DelayMeter(const Replay& replay, ChannelResult& channel) : replay_{replay}, channel_{channel} {
        channel_.delay.assign(replay.input.size(), 0);
        first_.resize(replay.input.size());
    }

    /// The store holds the bytes that were there after record `now`.
    void look(const CurveStore& store, std::size_t now) {
        for (; next_ <= now; ++next_) {
            const Pose& sample = replay_.input[next_];
            if ((sample.flags & View::valid) == 0) continue;
            const Pose curve = store.at(sample.t_ns);
            if ((curve.flags & View::valid) == 0) return;
            first_[next_] = curve;
            note(next_, now);
        }
    }

    void finish(const CurveStore& store) {
        look(store, replay_.input.size() - 1);
        if (covered_ > 0) channel_.mean_delay = sum_ / static_cast<double>(covered_);
        for (std::size_t i = 0; i < next_; ++i)
            if ((first_[i].flags & View::valid) != 0 &&
                !View::same(first_[i], store.at(first_[i].t_ns)))
                ++channel_.changed;
    }

  private:
    void note(std::size_t i, std::size_t now) {
        const auto delay = static_cast<std::uint32_t>(now - i);
        channel_.delay[i] = delay;
        channel_.max_delay = std::max(channel_.max_delay, delay);
        const double ms =
            static_cast<double>(replay_.input[now].t_ns - replay_.input[i].t_ns) * 1e-6;
        channel_.max_delay_ms = std::max(channel_.max_delay_ms, ms);
        sum_ += delay;
        ++covered_;
    }

    const Replay& replay_;
    ChannelResult& channel_;
    std::vector<Pose> first_;
    std::size_t next_{0}, covered_{0};
    double sum_{0};
};

template <class View>
void judge(const Replay& replay, double tolerance, ChannelResult& channel) {
    double raw2 = 0;
    channel.error.assign(replay.input.size(), NAN);
    for (std::size_t i = 0; i < replay.input.size(); ++i) {
        const Pose &input = replay.input[i], &curve = replay.decoded[i];
        if ((input.flags & View::valid) == 0) continue;
        ++channel.samples;
        if ((curve.flags & View::valid) == 0) {
            ++channel.violations;
            continue;
        }
        const double error = distance(View::of(curve), View::of(input));
        const double raw = distance(View::of(curve), View::of(replay.raw[i]));
        channel.error[i] = error;
        if (!(error <= tolerance)) ++channel.violations;
        channel.max_error = std::max(channel.max_error, error);
        channel.max_raw = std::max(channel.max_raw, raw);
        raw2 += raw * raw;
    }
    if (channel.samples > 0)
        channel.rms_raw = std::sqrt(raw2 / static_cast<double>(channel.samples));
}

template <class List>
void count(const List& list, ChannelResult& channel) {
    channel.curves = list.curves();
    channel.breaks = list.breaks();
    channel.knots = list.knots();
    channel.control_points = list.control_points();
    for (const auto& piece : list.pieces()) channel.knot_ns.push_back(piece.t0_ns());
}

/// The events as the far end has them, and whether they were there in time.
void judge_events(const CurveStore& whole, Replay& result) {
    EventResult& events = result.events;
    events.decoded = whole.events();
    events.bytes = static_cast<std::size_t>(whole.event_counters().bytes);
    CurveStore store;
    std::size_t fed = 0;
    for (std::size_t i = 0; i < events.accepted.size(); ++i) {
        store.push(std::string_view(result.stream).substr(fed, events.due[i] - fed));
        fed = events.due[i];
        if (store.events().size() <= i) ++events.late;
        const Event& in = events.accepted[i];
        const auto same = [&in](const Event& out) {
            return in.t_ns == out.t_ns && in.channel == out.channel && in.value == out.value;
        };
        if (i >= events.decoded.size() || !same(events.decoded[i])) ++events.wrong;
    }
    if (events.decoded.size() > events.accepted.size())
        events.wrong += events.decoded.size() - events.accepted.size();
}

/// Shares the curves' bytes out: a channel's own bits, and half of what frames need beside.
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

/// The stream as the far end sees it: portion by portion, then as a whole.
void judge(Replay& result) {
    const auto& o = result.options;
    CurveStore store;
    if (!result.input.empty()) {
        DelayMeter<PositionView> position{result, result.position};
        DelayMeter<OrientationView> orientation{result, result.orientation};
        std::size_t fed = 0;
        const auto feed = [&](std::size_t size) {
            store.push(std::string_view(result.stream).substr(fed, size - fed));
            fed = size;
        };
        Progress progress{"judging the stream", result.input.size()};
        for (std::size_t i = 0; i < result.input.size(); ++i) {
            progress.show(i);
            feed(result.bytes_after_input[i]);
            if (o.position) position.look(store, i);
            if (o.orientation) orientation.look(store, i);
        }
        feed(result.stream.size());
        store.finish();
        if (o.position) position.finish(store);
        if (o.orientation) orientation.finish(store);
    }
    for (const Pose& pose : result.input) result.decoded.push_back(store.at(pose.t_ns));
    if (o.position) judge<PositionView>(result, o.tol_pos_m, result.position);
    if (o.orientation) judge<OrientationView>(result, o.tol_rot_rad, result.orientation);
    count(store.position(), result.position);
    count(store.orientation(), result.orientation);
    judge_events(store, result);
    share_bytes(store.counters(), result);
}

}  // namespace

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
    run(recording, result.options, result);
    result.bytes_in = result.bytes_per_record * result.records_in;
    judge(result);
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
