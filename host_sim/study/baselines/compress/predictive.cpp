#include "host_sim/study/baselines/compress/predictive.hpp"

#include <algorithm>

namespace fairlead::sim {
namespace {

constexpr std::uint8_t value_context = 0, run_context = 3;

/// The part that encoder and decoder share: predicts the next value, learns the decoded correction.
class Loop {
  public:
    Loop(Channel channel, double grid, const PredictiveParams& params)
        : chart_{channel}, grid_{grid}, params_{params} {}

    void restart(const State& value) {
        value_ = base_ = value;
        speed_ = {};
        past_.assign(params_.taps, Step{});
        weights_.assign(params_.taps, 0);
        if (!weights_.empty()) weights_[0] = 1;
    }
    State predict() {
        step_ = {};
        if (params_.predictor == Predictor::line) step_ = times(speed_, params_.beta);
        if (params_.predictor == Predictor::tracker) step_ = times(speed_, params_.keep);
        if (params_.predictor == Predictor::adaptive)
            for (std::size_t j = 0; j < past_.size(); ++j)
                step_ = plus(step_, times(past_[j], weights_[j]));
        return predicted_ = chart_.moved(base_, step_);
    }
    const State& correct(const GridSteps& n) {
        const Step correction = scaled(n, grid_);
        const State before = value_;
        value_ = chart_.moved(predicted_, correction);
        base_ = value_;
        const Step increment = chart_.difference(before, value_);
        if (params_.predictor == Predictor::line) speed_ = increment;
        if (params_.predictor == Predictor::tracker) {
            base_ = chart_.moved(predicted_, times(correction, params_.alpha));
            speed_ = plus(step_, times(correction, params_.beta));
        }
        if (params_.predictor == Predictor::adaptive) learn(correction, increment);
        return value_;
    }

  private:
    static Step times(const Step& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
    static Step plus(const Step& a, const Step& b) {
        return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
    }
    static double dot(const Step& a, const Step& b) {
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    }
    void learn(const Step& correction, const Step& increment) {
        double power = grid_ * grid_;
        for (const Step& past : past_) power += dot(past, past);
        for (std::size_t j = 0; j < past_.size(); ++j)
            weights_[j] += params_.alpha * dot(correction, past_[j]) / power;
        std::rotate(past_.begin(), past_.end() - 1, past_.end());
        past_.front() = increment;
    }

    Chart chart_;
    double grid_;
    const PredictiveParams& params_;
    State value_{}, base_{}, predicted_{};
    Step speed_{}, step_{};
    std::vector<Step> past_;
    std::vector<double> weights_;
};

double grid_of(const Track& track, double tolerance, const PredictiveParams& params) {
    return params.grid_share * finest_error_grid(track.channel, tolerance);
}

/// Absolute values err by at most half the tolerance: the first sample of a group is the value.
Absolute absolute_of(const Track& track, double tolerance) {
    return {track, track.channel == Channel::position ? tolerance * (1 - 1e-9) : tolerance};
}

void put(Frame& frame, const GridSteps& n) {
    for (std::size_t d = 0; d < 3; ++d)
        frame.symbols.push_back({fold(n[d]), static_cast<std::uint8_t>(value_context + d), 0});
}

}  // namespace

std::vector<Frame> encode(const Track& track, double tolerance, const PredictiveParams& params,
                          std::size_t delay) {
    const Chart chart{track.channel};
    const double grid = grid_of(track, tolerance, params);
    const Absolute absolute = absolute_of(track, tolerance);
    const Schedule schedule{track, delay};
    Loop loop{track.channel, grid, params};
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < track.size();) {
        Frame frame;
        frame.end = schedule.end(i, track.size());
        frame.sent_at = frame.end - 1;
        frame.restart = i % schedule.group == 0;
        if (frame.restart) {
            absolute.put(frame.symbols, i, chart.sample(track, i));
            const Symbol* next = frame.symbols.data();
            loop.restart(absolute.get(next));
            ++i;
        }
        std::uint32_t run = 0;
        for (; i < frame.end; ++i) {
            const GridSteps n =
                rounded(chart.difference(loop.predict(), chart.sample(track, i)), grid);
            loop.correct(n);
            if (params.runs && n == GridSteps{}) {
                ++run;
                continue;
            }
            if (params.runs) frame.symbols.push_back({run, run_context, 0});
            put(frame, n);
            run = 0;
        }
        if (params.runs && run > 0) frame.symbols.push_back({run, run_context, 0});
        frames.push_back(frame);
    }
    return frames;
}

std::vector<State> decode(const std::vector<Frame>& frames, const Track& track, double tolerance,
                          const PredictiveParams& params) {
    const Absolute absolute = absolute_of(track, tolerance);
    Loop loop{track.channel, grid_of(track, tolerance, params), params};
    std::vector<State> out;
    for (const Frame& frame : frames) {
        const Symbol* next = frame.symbols.data();
        if (frame.restart) {
            out.push_back(absolute.get(next));
            loop.restart(out.back());
        }
        while (out.size() < frame.end) {
            for (std::uint32_t run = params.runs ? (next++)->value : 0; run > 0; --run) {
                loop.predict();
                out.push_back(loop.correct({}));
            }
            if (out.size() >= frame.end) break;
            const GridSteps n{unfold(next[0].value), unfold(next[1].value), unfold(next[2].value)};
            next += 3;
            loop.predict();
            out.push_back(loop.correct(n));
        }
    }
    return out;
}

}  // namespace fairlead::sim
