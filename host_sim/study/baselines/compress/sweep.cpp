#include "host_sim/study/baselines/compress/sweep.hpp"

#include <cstdio>

#include "host_sim/study/baselines/compress/deflate.hpp"
#include "host_sim/study/baselines/compress/predictive.hpp"
#include "host_sim/study/baselines/compress/segments.hpp"

namespace fairlead::sim {
namespace {

constexpr unsigned memories[] = {16, 64};  // of the entropy states

template <class... Numbers>
std::string text(const char* format, Numbers... numbers) {
    char out[96];
    std::snprintf(out, sizeof out, format, numbers...);
    return out;
}

class Sweep {
  public:
    Sweep(const Track& track, double tolerance, std::size_t delay)
        : track_{track}, tolerance_{tolerance}, delay_{delay} {}

    void offer(const char* rival, const std::string& setting, const PredictiveParams& params) {
        const auto frames = encode(track_, tolerance_, params, delay_);
        offer(rival, setting, frames, decode(frames, track_, tolerance_, params));
    }
    /// All slope predictions and entropy states over one plan where they do not change it.
    void offer(const char* rival, SegmentParams params, const std::vector<double>& slopes) {
        const bool near = params.choice == Choice::near_prediction;
        const bool planned_by_slope = params.pieces == Pieces::swing && near;
        std::vector<PlannedFrame> planned;
        for (const double slope : slopes) {
            params.slope_share = slope;
            if (planned.empty() || planned_by_slope)
                planned = plan(track_, tolerance_, params, delay_);
            for (const bool by_length : {false, true}) {
                if (by_length && params.pieces == Pieces::dead_band) continue;
                params.by_length = by_length;
                const auto frames = code(planned, track_, tolerance_, params);
                offer(rival, name_of(params), frames, decode(frames, track_, tolerance_, params));
            }
        }
    }
    void offer_raw(const std::string& setting, const DeflateParams& params) {
        out.push_back({"float32 + zlib", setting, deflated_size(track_, params, delay_), true});
    }

    std::vector<Tried> out;

  private:
    void offer(const char* rival, const std::string& setting, const std::vector<Frame>& frames,
               const std::vector<State>& decoded) {
        const bool within = largest_error(track_, decoded) <= tolerance_;
        for (const unsigned memory : memories)
            out.push_back(
                {rival, setting + text(" memory %u", memory), coded_size(frames, memory), within});
    }
    static std::string name_of(const SegmentParams& params) {
        const bool free = params.pieces == Pieces::swing || params.pieces == Pieces::dead_band;
        const bool near = params.choice == Choice::near_prediction;
        return text("grid %.2f slope %.1f%s%s", params.grid_share, params.slope_share,
                    !free  ? ""
                    : near ? " near"
                           : " middle",
                    params.by_length ? " by length" : "");
    }

    const Track& track_;
    double tolerance_;
    std::size_t delay_;
};

void add_delta(Sweep& sweep) {
    for (const double grid : {1.0, 0.95, 0.9, 0.8, 0.7}) {
        PredictiveParams params;
        params.grid_share = grid;
        sweep.offer("delta + Rice", text("first grid %.2f", grid), params);
        params.predictor = Predictor::line;
        sweep.offer("delta + Rice", text("second grid %.2f", grid), params);
    }
}

void add_dpcm(Sweep& sweep) {
    for (const bool runs : {false, true}) {
        const char* const with = runs ? " runs" : "";
        const auto offer = [&](const std::string& setting, PredictiveParams params) {
            params.runs = runs;
            sweep.offer("DPCM + Rice", setting + with, params);
        };
        if (runs) offer("last", {});
        for (const double beta : {0.25, 0.5, 0.75, 0.9})
            offer(text("line %.2f", beta), {Predictor::line, 1, 1, beta, 1, 0, false});
        for (const double alpha : {1.0, 0.7, 0.4})
            for (const double beta : {0.02, 0.05, 0.1, 0.2, 0.4})
                for (const double keep : {1.0, 0.98})
                    offer(text("tracker %.1f %.2f keep %.2f", alpha, beta, keep),
                          {Predictor::tracker, 1, alpha, beta, keep, 0, false});
        for (const std::size_t taps : {4u, 12u})
            for (const double pull : {0.005, 0.02})
                offer(text("adaptive %zu taps %.3f", taps, pull),
                      {Predictor::adaptive, 1, pull, 1, 1, taps, false});
    }
}

void add_pieces(Sweep& sweep) {
    const Choice near = Choice::near_prediction, middle = Choice::least_squares;
    const std::vector<double> slopes{0.0, 0.5, 1.0};
    for (const double grid : {0.25, 0.5, 0.75, 1.0}) {
        for (const Choice choice : {near, middle})
            sweep.offer("swing filter + Rice", {Pieces::swing, grid, choice, 0, false}, slopes);
        sweep.offer("swinging door + Rice", {Pieces::door, grid, near, 0, false}, slopes);
    }
    for (const double grid : {0.15, 0.25, 0.4, 0.6})
        sweep.offer("Ramer-Douglas-Peucker + Rice", {Pieces::peucker, grid, near, 0, false},
                    slopes);
    for (const double grid : {0.25, 0.4, 0.6, 0.8, 0.9, 1.0})
        for (const Choice choice : {near, middle})
            sweep.offer("dead band + Rice", {Pieces::dead_band, grid, choice, 0, false}, {0.0});
}

void add_raw(Sweep& sweep) {
    const char* const names[] = {"default", "filtered", "Huffman", "run lengths", "fixed codes"};
    for (const int strategy : {0, 1, 2, 3, 4})
        for (const bool planes : {false, true})
            for (const bool differences : {false, true})
                sweep.offer_raw(text("%s%s%s", names[strategy], planes ? " byte planes" : "",
                                     differences ? " differences" : ""),
                                {strategy, planes, differences});
}

}  // namespace

std::vector<Tried> sweep(const Track& track, double tolerance, std::size_t delay) {
    Sweep all{track, tolerance, delay};
    add_pieces(all);
    add_dpcm(all);
    add_delta(all);
    add_raw(all);
    return all.out;
}

}  // namespace fairlead::sim
