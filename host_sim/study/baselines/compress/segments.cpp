#include "host_sim/study/baselines/compress/segments.hpp"

#include <algorithm>

#include "host_sim/study/baselines/compress/fitter.hpp"

namespace fairlead::sim {
namespace {

constexpr std::uint8_t value_context = 0, length_context = 3, first_length_class = 4;

Absolute absolute_of(const Track& track, double tolerance) {
    const double share = track.channel == Channel::position ? 0.25 : 0.5;
    return {track, share * tolerance};  // the first piece begins there: keep it near
}

/// What encoder and decoder know of the last piece.
class Prediction {
  public:
    explicit Prediction(const SegmentParams& params) : params_{params} {}
    void restart() { speed_ = {}; }
    GridSteps steps(std::size_t length) const {
        if (params_.pieces == Pieces::dead_band) return {};
        Step out = speed_;
        for (double& v : out) v *= params_.slope_share * static_cast<double>(length);
        return rounded(out, 1);
    }
    void see(const GridSteps& n, std::size_t length) {
        speed_ = scaled(n, 1 / static_cast<double>(length));
    }
    std::uint8_t context(std::size_t axis, std::size_t length) const {
        if (!params_.by_length) return static_cast<std::uint8_t>(value_context + axis);
        std::uint8_t c = first_length_class;
        for (; length > 1 && c + 1u < contexts_max; length /= 2) ++c;
        return c;
    }

  private:
    const SegmentParams& params_;
    Step speed_{};
};

void put(Frame& frame, Prediction& prediction, const Segment& segment, std::size_t length) {
    frame.symbols.push_back({static_cast<std::uint32_t>(length - 1), length_context, 0});
    const GridSteps expected = prediction.steps(length);
    for (std::size_t d = 0; d < 3; ++d)
        frame.symbols.push_back(
            {fold(segment.n[d] - expected[d]), prediction.context(d, length), 0});
    prediction.see(segment.n, length);
}

}  // namespace

std::vector<PlannedFrame> plan(const Track& track, double tolerance, const SegmentParams& params,
                               std::size_t delay) {
    const Chart chart{track.channel};
    const SegmentFitter fitter{track, tolerance, params};
    const Absolute absolute = absolute_of(track, tolerance);
    const std::size_t group = group_size(track, delay);
    std::vector<PlannedFrame> frames;
    for (std::size_t begin = 0; begin < track.size(); begin += group) {
        const std::size_t last = std::min(begin + group, track.size()) - 1;
        std::size_t a = begin, due = begin;  // a: last vertex; due: first record not yet sent
        std::vector<Symbol> restart;
        absolute.put(restart, begin, chart.sample(track, begin));
        const Symbol* next = restart.data();
        State at = absolute.get(next);
        Step speed{};
        do {
            const std::size_t now = delay < last - due ? due + delay : last;
            PlannedFrame frame{now, a == begin && due == begin, a, fitter.plan(a, at, now, speed)};
            if (now != last && frame.segments.size() > 1) frame.segments.pop_back();  // may grow
            for (const Segment& segment : frame.segments) {
                speed = scaled(segment.n, 1 / static_cast<double>(segment.end - a));
                at = chart.moved(at, scaled(segment.n, fitter.grid()));
                a = segment.end;
            }
            due = a + 1;
            frames.push_back(frame);
        } while (a < last);
    }
    return frames;
}

std::vector<Frame> code(const std::vector<PlannedFrame>& planned, const Track& track,
                        double tolerance, const SegmentParams& params) {
    const Chart chart{track.channel};
    const Absolute absolute = absolute_of(track, tolerance);
    Prediction prediction{params};
    std::vector<Frame> frames;
    for (const PlannedFrame& from : planned) {
        Frame frame;
        frame.sent_at = from.sent_at;
        frame.restart = from.restart;
        if (from.restart) {
            absolute.put(frame.symbols, from.first, chart.sample(track, from.first));
            prediction.restart();
        }
        std::size_t a = from.first;
        for (const Segment& segment : from.segments) {
            put(frame, prediction, segment, segment.end - a);
            a = segment.end;
        }
        frame.end = a + 1;
        frames.push_back(frame);
    }
    return frames;
}

std::vector<Frame> encode(const Track& track, double tolerance, const SegmentParams& params,
                          std::size_t delay) {
    return code(plan(track, tolerance, params, delay), track, tolerance, params);
}

std::vector<State> decode(const std::vector<Frame>& frames, const Track& track, double tolerance,
                          const SegmentParams& params) {
    const Chart chart{track.channel};
    const Absolute absolute = absolute_of(track, tolerance);
    const double grid = params.grid_share * finest_error_grid(track.channel, tolerance);
    Prediction prediction{params};
    std::vector<State> out;
    State at{};
    for (const Frame& frame : frames) {
        const Symbol* next = frame.symbols.data();
        if (frame.restart) {
            at = absolute.get(next);
            prediction.restart();
            out.push_back(at);
        }
        while (out.size() < frame.end) {
            const std::size_t a = out.size() - 1, length = (next++)->value + 1;
            Segment segment{a + length, prediction.steps(length)};
            for (std::size_t d = 0; d < 3; ++d) segment.n[d] += unfold((next++)->value);
            prediction.see(segment.n, length);
            for (std::size_t i = a + 1; i <= segment.end; ++i)
                out.push_back(value_of(chart, params.pieces, at, a, segment, i, grid));
            at = chart.moved(at, scaled(segment.n, grid));
        }
    }
    return out;
}

}  // namespace fairlead::sim
