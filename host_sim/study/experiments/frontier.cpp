#include "host_sim/study/experiments/frontier.hpp"

#include <algorithm>
#include <limits>

namespace fairlead::sim {
namespace {

constexpr double lag_slack = 0.05;  // samples: two lags that the measurement cannot tell apart

std::vector<Point> points_of(const std::vector<Entry>& entries, bool ours,
                             ChannelFigures Figures::*channel) {
    std::vector<Point> points;
    for (const auto& entry : entries) {
        const auto& f = entry.figures.*channel;
        if (entry.ours == ours) points.push_back({f.lag, f.noise, f.error, &entry});
    }
    return points;
}

}  // namespace

std::vector<Point> frontier(const std::vector<Entry>& entries, bool ours,
                            ChannelFigures Figures::*channel) {
    auto points = points_of(entries, ours, channel);
    std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) {
        return a.lag != b.lag ? a.lag < b.lag : a.noise < b.noise;
    });
    std::vector<Point> best;
    double least = std::numeric_limits<double>::max();
    for (const auto& point : points) {
        if (point.noise >= least) continue;
        least = point.noise;
        best.push_back(point);
    }
    return best;
}

std::vector<Match> matches(const std::vector<Entry>& entries, ChannelFigures Figures::*channel) {
    const auto ours = points_of(entries, true, channel);
    std::vector<Match> out;
    for (const auto& rival : frontier(entries, false, channel)) {
        Match match{rival, {}, {}};
        for (const auto& point : ours) {
            if (point.error > rival.error) continue;
            const auto& quiet = match.same_lag;
            const auto& early = match.same_noise;
            if (point.lag <= rival.lag + lag_slack && (!quiet.entry || point.noise < quiet.noise))
                match.same_lag = point;
            if (point.noise <= rival.noise && (!early.entry || point.lag < early.lag))
                match.same_noise = point;
        }
        out.push_back(match);
    }
    return out;
}

}  // namespace fairlead::sim
