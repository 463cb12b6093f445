#include "host_sim/study/baselines/compress/fitter.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::sim {
namespace {

constexpr std::size_t patience = 6;      // records to look on after a candidate fails
constexpr int passes_max = 5;            // of weights that lean towards the largest error
constexpr std::size_t length_max = 500;  // records of one piece: matters without a delay bound only
constexpr double margin = 1 - 1e-9;      // of the tolerance, for rounding

double size2(const Step& a, const Step& b) {
    double sum = 0;
    for (std::size_t d = 0; d < 3; ++d) sum += (a[d] - b[d]) * (a[d] - b[d]);
    return sum;
}

Step times(const Step& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }

/// An interval that shrinks, in one axis.
struct Interval {
    double low{-1e300}, high{1e300};
    void cut(double l, double h) {
        low = std::max(low, l);
        high = std::min(high, h);
    }
    bool empty() const { return low > high; }
};

/// The whole number in [low, high] nearest to `wanted`; false where there is none.
bool whole(double low, double high, double wanted, long& n) {
    const double least = std::ceil(low), most = std::floor(high);
    if (least > most) return false;
    n = std::lround(std::min(std::max(wanted, least), most));
    return true;
}

}  // namespace

State value_of(const Chart& chart, Pieces pieces, const State& from, std::size_t a,
               const Segment& segment, std::size_t i, double grid) {
    const double share = pieces == Pieces::dead_band
                             ? 1
                             : static_cast<double>(i - a) / static_cast<double>(segment.end - a);
    return chart.moved(from, times(scaled(segment.n, grid), share));
}

SegmentFitter::SegmentFitter(const Track& track, double tolerance, const SegmentParams& params)
    : track_{track},
      chart_{track.channel},
      tolerance_{tolerance * margin},
      grid_{params.grid_share * finest_error_grid(track.channel, tolerance)},
      params_{params} {}

bool SegmentFitter::fits(std::size_t a, const State& from, const Segment& segment) const {
    for (std::size_t i = segment.end; i > a; --i)  // the far end fails first
        if (track_.error(i, value_of(chart_, params_.pieces, from, a, segment, i, grid_).data()) >
            tolerance_)
            return false;
    return true;
}

std::vector<Segment> SegmentFitter::plan(std::size_t a, const State& from, std::size_t last,
                                         Step speed) const {
    if (params_.pieces == Pieces::peucker) return split(a, from, last);
    std::vector<Segment> out;
    State at = from;
    while (a < last) {
        const std::size_t reach = std::min(last, a + length_max);
        Segment next;
        if (params_.pieces == Pieces::door) next = longest_door(a, at, reach);
        if (params_.pieces == Pieces::dead_band) next = longest_hold(a, at, reach);
        if (params_.pieces == Pieces::swing)
            next = track_.channel == Channel::position ? longest_swing(a, at, reach, speed)
                                                       : longest_arc(a, at, reach, speed);
        at = chart_.moved(at, scaled(next.n, grid_));
        speed = times(scaled(next.n, 1), 1 / static_cast<double>(next.end - a));
        a = next.end;
        out.push_back(next);
    }
    return out;
}

/// Positions: an exact interval of slopes per axis.
Segment SegmentFitter::longest_swing(std::size_t a, const State& from, std::size_t last,
                                     Step speed) const {
    Segment best{a + 1, rounded(seen(from, a + 1), grid_)};
    Interval slopes[3];
    double product[3] = {}, square = 0;
    for (std::size_t j = a + 1; j <= last; ++j) {
        const double dt = static_cast<double>(j - a);
        const Step x = seen(from, j);
        square += dt * dt;
        bool empty = false, exact = true;
        Segment trial{j, {}};
        for (std::size_t d = 0; d < 3; ++d) {
            slopes[d].cut((x[d] - tolerance_) / dt, (x[d] + tolerance_) / dt);
            empty = empty || slopes[d].empty();
            product[d] += dt * x[d];
            const double wanted = params_.choice == Choice::near_prediction
                                      ? params_.slope_share * speed[d] * dt
                                      : product[d] / square * dt / grid_;
            exact = exact && whole(slopes[d].low * dt / grid_, slopes[d].high * dt / grid_, wanted,
                                   trial.n[d]);
        }
        if (empty) break;
        if (exact) best = trial;
    }
    return best;
}

/// Least squares through the start, then leaning towards the largest error, each rounded and tried.
bool SegmentFitter::fit_arc(std::size_t a, const State& from, const std::vector<Step>& steps,
                            Segment& segment) const {
    std::vector<double> weights(steps.size(), 1);
    for (int pass = 0; pass < passes_max; ++pass) {
        Step product{};
        double square = 0;
        for (std::size_t i = 0; i < steps.size(); ++i) {
            const double dt = static_cast<double>(i + 1);
            for (std::size_t d = 0; d < 3; ++d) product[d] += weights[i] * dt * steps[i][d];
            square += weights[i] * dt * dt;
        }
        const Step slope = times(product, 1 / square);
        segment.n = rounded(times(slope, static_cast<double>(segment.end - a)), grid_);
        if (fits(a, from, segment)) return true;
        double worst = 0;
        for (std::size_t i = 0; i < steps.size(); ++i)
            worst = std::max(worst, size2(times(slope, static_cast<double>(i + 1)), steps[i]));
        if (std::sqrt(worst) > (pass == 0 ? 2.5 : 1.5) * tolerance_) return false;
        for (std::size_t i = 0; i < steps.size(); ++i)
            weights[i] *=
                0.02 + std::sqrt(size2(times(slope, static_cast<double>(i + 1)), steps[i]) / worst);
    }
    return false;
}

/// Orientations: the slopes within reach form an intersection of balls, which is searched.
Segment SegmentFitter::longest_arc(std::size_t a, const State& from, std::size_t last,
                                   Step speed) const {
    Segment best{a + 1, rounded(seen(from, a + 1), grid_)};
    std::vector<Step> steps;
    for (std::size_t j = a + 1; j <= std::min(last, best.end + patience); ++j) {
        steps.push_back(seen(from, j));
        Segment trial{j, {}};
        if (fit_arc(a, from, steps, trial)) best = trial;
    }
    if (params_.choice == Choice::near_prediction) {
        const double dt = static_cast<double>(best.end - a);
        const Segment predicted{best.end, rounded(times(speed, params_.slope_share * dt), 1)};
        if (fits(a, from, predicted)) best = predicted;
    }
    return best;
}

Segment SegmentFitter::longest_door(std::size_t a, const State& from, std::size_t last) const {
    Segment best{a + 1, rounded(seen(from, a + 1), grid_)};
    for (std::size_t j = a + 2; j <= std::min(last, best.end + patience); ++j) {
        const Segment trial{j, rounded(seen(from, j), grid_)};
        if (fits(a, from, trial)) best = trial;
    }
    return best;
}

Segment SegmentFitter::longest_hold(std::size_t a, const State& from, std::size_t last) const {
    Segment best{a + 1, rounded(seen(from, a + 1), grid_)};
    if (params_.choice == Choice::near_prediction && fits(a, from, {a + 1, {}})) best.n = {};
    Interval reach[3];
    Step sum{};
    for (std::size_t j = a + 1; j <= std::min(last, best.end + patience); ++j) {
        const Step x = seen(from, j);
        Segment trial{j, best.n};
        if (params_.choice == Choice::least_squares) {
            bool exact = true;
            for (std::size_t d = 0; d < 3; ++d) {
                reach[d].cut(x[d] - tolerance_, x[d] + tolerance_);
                sum[d] += x[d] / grid_;
                const double middle = track_.channel == Channel::position
                                          ? (reach[d].low + reach[d].high) / 2 / grid_
                                          : sum[d] / static_cast<double>(j - a);
                exact = exact && (track_.channel == Channel::position
                                      ? whole(reach[d].low / grid_, reach[d].high / grid_, middle,
                                              trial.n[d])
                                      : whole(-1e9, 1e9, middle, trial.n[d]));
            }
            if (!exact) continue;
        }
        if (fits(a, from, trial)) best = trial;
    }
    return best;
}

std::vector<Segment> SegmentFitter::split(std::size_t a, const State& from,
                                          std::size_t last) const {
    const double rounding =
        grid_ / 2 * (track_.channel == Channel::position ? 1 : std::sqrt(3.0) * 1.01);
    const double allowed = tolerance_ - rounding;
    std::vector<std::size_t> ends{last}, vertices;
    for (std::size_t begin = a; !ends.empty();) {
        const std::size_t end = ends.back();
        const State start = begin == a ? from : chart_.sample(track_, begin);
        const Step whole_step = seen(start, end);
        std::size_t worst_at = end;
        double worst = allowed;
        for (std::size_t i = begin + 1; i < end; ++i) {
            const double share = static_cast<double>(i - begin) / static_cast<double>(end - begin);
            const double e = track_.error(i, chart_.moved(start, times(whole_step, share)).data());
            if (e > worst) {
                worst = e;
                worst_at = i;
            }
        }
        if (worst_at != end) {
            ends.push_back(worst_at);
            continue;
        }
        vertices.push_back(end);
        begin = end;
        ends.pop_back();
    }
    std::vector<Segment> out;
    State at = from;
    for (const std::size_t vertex : vertices) {
        out.push_back({vertex, rounded(seen(at, vertex), grid_)});
        at = chart_.moved(at, scaled(out.back().n, grid_));
    }
    return out;
}

}  // namespace fairlead::sim
