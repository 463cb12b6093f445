#pragma once
// Judges a replay by its bytes alone, in double: is each sample covered, in time, within tolerance?
// The store is the reader of the stream's format.
#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "fairlead/math/quat.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/replay/curve_store.hpp"
#include "host_sim/replay/replay.hpp"

namespace fairlead::sim {

/// How one channel is read from a pose and from a point of a curve.
struct PositionView {
    static constexpr std::uint32_t valid = flag::position_valid;
    static double distance(const CurvePoint& curve, const Pose& pose) {  // the largest of the axes
        const BasicVec3<double> d = curve.p_m - CurvePoint::of(pose).p_m;
        return std::max({std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
    }
    static bool same(const CurvePoint& a, const CurvePoint& b) {
        const BasicVec3<double> d = a.p_m - b.p_m;
        return !(std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z) > 0);
    }
};
struct OrientationView {
    static constexpr std::uint32_t valid = flag::orientation_valid;
    static double distance(const CurvePoint& curve, const Pose& pose) {  // full rotation angle
        return rotation_angle(normalised(curve.q), normalised(CurvePoint::of(pose).q));
    }
    static bool same(const CurvePoint& a, const CurvePoint& b) {
        return !(std::fabs(a.q.w - b.q.w) + std::fabs(a.q.x - b.q.x) + std::fabs(a.q.y - b.q.y) +
                     std::fabs(a.q.z - b.q.z) >
                 0);
    }
};

/// The samples that the reducer was given, each with the run that it belongs to, from 1.
struct JudgedInput {
    const Replay& replay;
    std::vector<std::uint32_t> run{};

    explicit JudgedInput(const Replay& of) : replay{of} {
        std::uint32_t now = 1;
        for (std::size_t i = 0; i < replay.input.size(); ++i) {
            if (i > 0 && (replay.input[i].flags & flag::new_run) != 0) ++now;
            run.push_back(now);
        }
    }
    std::size_t size() const { return run.size(); }
    template <class Store>
    CurvePoint curve(const Store& store, std::size_t i) const {
        return store.point_at(run[i], replay.input[i].t_ns);
    }
};

/// Notes for each sample after which record the bytes so far let a decoder evaluate the curve
/// there, and what it evaluated to.
template <class View>
class DelayMeter {
  public:
    DelayMeter(const JudgedInput& input, ChannelResult& channel)
        : input_{input}, channel_{channel}, first_(input.size()) {
        channel_.delay.assign(input.size(), 0);
    }

    /// The store holds the bytes that were there after record `now`.
    template <class Store>
    void look(const Store& store, std::size_t now) {
        for (; next_ <= now; ++next_) {
            if ((input_.replay.input[next_].flags & View::valid) == 0) continue;
            const CurvePoint curve = input_.curve(store, next_);
            if ((curve.flags & View::valid) == 0) return;
            first_[next_] = curve;
            note(next_, now);
        }
    }

    template <class Store>
    void finish(const Store& store) {
        look(store, input_.size() - 1);
        if (covered_ > 0) channel_.mean_delay = sum_ / static_cast<double>(covered_);
        for (std::size_t i = 0; i < next_; ++i)
            if ((first_[i].flags & View::valid) != 0 &&
                !View::same(first_[i], input_.curve(store, i)))
                ++channel_.changed;
    }

  private:
    void note(std::size_t i, std::size_t now) {
        const auto delay = static_cast<std::uint32_t>(now - i);
        const std::vector<Pose>& input = input_.replay.input;
        channel_.delay[i] = delay;
        channel_.max_delay = std::max(channel_.max_delay, delay);
        if (input_.run[i] == input_.run[now]) {
            const double ms = static_cast<double>(input[now].t_ns - input[i].t_ns) * 1e-6;
            channel_.max_delay_ms = std::max(channel_.max_delay_ms, ms);
        }
        sum_ += delay;
        ++covered_;
    }

    const JudgedInput& input_;
    ChannelResult& channel_;
    std::vector<CurvePoint> first_;
    std::size_t next_{0}, covered_{0};
    double sum_{0};
};

template <class View>
void judge_channel(const Replay& replay, const std::vector<CurvePoint>& curves, double tolerance,
                   ChannelResult& channel) {
    double raw2 = 0;
    channel.error.assign(replay.input.size(), NAN);
    for (std::size_t i = 0; i < replay.input.size(); ++i) {
        if ((replay.input[i].flags & View::valid) == 0) continue;
        ++channel.samples;
        if ((curves[i].flags & View::valid) == 0) {
            ++channel.violations;
            continue;
        }
        const double error = View::distance(curves[i], replay.input[i]);
        const double raw = View::distance(curves[i], replay.raw[i]);
        channel.error[i] = error;
        if (!(error <= tolerance)) ++channel.violations;
        channel.max_error = std::max(channel.max_error, error);
        channel.max_raw = std::max(channel.max_raw, raw);
        raw2 += raw * raw;
    }
    if (channel.samples > 0)
        channel.rms_raw = std::sqrt(raw2 / static_cast<double>(channel.samples));
}

/// The events as the far end has them, and whether they were there in time.
template <class Store>
void judge_events(const Store& whole, Replay& result) {
    EventResult& events = result.events;
    events.decoded = whole.events();
    Store store;
    std::size_t fed = 0;
    for (std::size_t i = 0; i < events.accepted.size(); ++i) {
        store.push(std::string_view(result.stream).substr(fed, events.due[i] - fed));
        fed = events.due[i];
        // an event before the first record waits for the header, which begins the stream
        if (store.events().size() <= i && events.due[i] > 0) ++events.late;
        const Event& in = events.accepted[i];
        const auto same = [&in](const Event& out) {
            return in.t_ns == out.t_ns && in.channel == out.channel && in.value == out.value;
        };
        if (i >= events.decoded.size() || !same(events.decoded[i])) ++events.wrong;
    }
    if (events.decoded.size() > events.accepted.size())
        events.wrong += events.decoded.size() - events.accepted.size();
}

/// The stream as the far end sees it: portion by portion, then as a whole. @return the store.
template <class Store>
Store judge(Replay& result) {
    const ReplayOptions& o = result.options;
    Store store;
    const JudgedInput input{result};
    std::size_t fed = 0;
    const auto feed = [&](std::size_t size) {
        store.push(std::string_view(result.stream).substr(fed, size - fed));
        fed = size;
    };
    if (input.size() > 0) {
        DelayMeter<PositionView> position{input, result.position};
        DelayMeter<OrientationView> orientation{input, result.orientation};
        Progress progress{"judging the stream", input.size()};
        for (std::size_t i = 0; i < input.size(); ++i) {
            progress.show(i);
            feed(result.bytes_after_input[i]);
            if (o.position) position.look(store, i);
            if (o.orientation) orientation.look(store, i);
        }
        feed(result.stream.size());
        store.finish();
        if (o.position) position.finish(store);
        if (o.orientation) orientation.finish(store);
    } else {
        feed(result.stream.size());
        store.finish();
    }
    std::vector<CurvePoint> curves;
    Progress progress{"evaluating the curve", input.size()};
    for (std::size_t i = 0; i < input.size(); ++i) {
        progress.show(i);
        curves.push_back(input.curve(store, i));
        result.decoded.push_back(curves[i].rounded(result.input[i].t_ns));
    }
    if (o.position) judge_channel<PositionView>(result, curves, o.tol_pos_m, result.position);
    if (o.orientation)
        judge_channel<OrientationView>(result, curves, o.tol_rot_rad, result.orientation);
    judge_events(store, result);
    return store;
}

}  // namespace fairlead::sim
