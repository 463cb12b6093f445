#pragma once
// Rivals that code every sample: delta + Rice and closed-loop DPCM + Rice.
//
// Each sample is predicted from decoded ones, the difference rounded to a grid, the rounded number
// coded. The grid is as coarse as the tolerance allows, so most numbers are 0 where the prediction
// is good; stretches of samples that need no correction at all may be coded as their length.
#include "host_sim/study/baselines/compress/coder.hpp"

namespace fairlead::sim {

enum class Predictor {
    last,     // the last value (delta coding)
    line,     // damped line through the last two
    tracker,  // value and speed, both pulled by what is decoded (alpha-beta filter)
    adaptive  // normalised LMS over the last increments
};

struct PredictiveParams {
    Predictor predictor{};
    double grid_share{1};  // of the coarsest grid
    double alpha{1};       // tracker: pull on the value; adaptive: step size
    double beta{1};        // tracker: pull on the speed; line: damping
    double keep{1};        // tracker: what remains of the speed from sample to sample
    std::size_t taps{4};   // adaptive
    bool runs{};           // lengths of stretches without correction
};

std::vector<Frame> encode(const Track& track, double tolerance, const PredictiveParams& params,
                          std::size_t delay);
std::vector<State> decode(const std::vector<Frame>& frames, const Track& track, double tolerance,
                          const PredictiveParams& params);

}  // namespace fairlead::sim
