#include "host_sim/report/allan.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::sim {

std::vector<AllanPoint> allan_deviation(const std::vector<double>& values, double period_s) {
    std::vector<double> angle{0};  // integral of the values
    for (const double v : values) angle.push_back(angle.back() + v * period_s);
    std::vector<AllanPoint> out;
    std::size_t m_before = 0;
    for (int step = 0;; ++step) {
        const auto m = static_cast<std::size_t>(std::llround(std::pow(10.0, step / 10.0)));
        if (3 * m >= values.size()) break;
        if (m == m_before) continue;
        m_before = m;
        double sum = 0;
        const std::size_t n = angle.size() - 2 * m;
        for (std::size_t i = 0; i < n; ++i) {
            const double d = angle[i + 2 * m] - 2 * angle[i + m] + angle[i];
            sum += d * d;
        }
        const double tau = static_cast<double>(m) * period_s;
        out.push_back({tau, std::sqrt(sum / (2 * tau * tau * static_cast<double>(n)))});
    }
    return out;
}

AllanFigures allan_figures(const std::vector<AllanPoint>& points) {
    AllanFigures out;
    if (points.empty()) return out;
    // white noise falls with slope -1/2: the median of sqrt(tau) * deviation over the first decade
    std::vector<double> white;
    for (const AllanPoint& p : points)
        if (p.tau_s <= 10 * points.front().tau_s) white.push_back(p.deviation * std::sqrt(p.tau_s));
    std::nth_element(white.begin(), white.begin() + static_cast<std::ptrdiff_t>(white.size() / 2),
                     white.end());
    out.density = white[white.size() / 2];
    const auto least = std::min_element(
        points.begin(), points.end(),
        [](const AllanPoint& a, const AllanPoint& b) { return a.deviation < b.deviation; });
    constexpr double flicker = 0.664;  // sqrt(2 ln 2 / pi)
    out.instability = least->deviation / flicker;
    out.instability_tau_s = least->tau_s;
    const AllanPoint& last = points.back();
    if (last.deviation > 1.5 * least->deviation)
        out.walk = last.deviation * std::sqrt(3 / last.tau_s);
    return out;
}

Stretch longest_rest(const std::vector<double>& values, double period_s, double limit) {
    const auto second = std::max<std::size_t>(2, static_cast<std::size_t>(1 / period_s));
    Stretch best, now;
    for (std::size_t i = 0; i + second <= values.size(); i += second) {
        double mean = 0;
        for (std::size_t k = i; k < i + second; ++k) mean += values[k];
        mean /= static_cast<double>(second);
        bool quiet = true;
        for (std::size_t k = i; k < i + second; ++k)
            quiet = quiet && std::abs(values[k] - mean) <= limit;
        if (!quiet) {
            now = {i + second, i + second};
            continue;
        }
        now.last = i + second;
        if (now.last - now.first > best.last - best.first) best = now;
    }
    return best;
}

}  // namespace fairlead::sim
