#include "host_sim/recording/evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace fairlead::sim {
namespace {

using Vector = std::array<double, 3>;

Vector operator-(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Mean rate and mean force over a stretch of about a tenth of a second.
struct Window {
    double t_s{};
    Vector rate{}, force{};
};

std::vector<Window> windows_of(const std::vector<double>& t_s, const std::vector<Numbers>& gyro,
                               const std::vector<Numbers>& accel) {
    std::vector<Window> out;
    constexpr double length_s = 0.1;
    for (std::size_t i = 0; i < t_s.size();) {
        Window w;
        double n = 0;
        std::size_t j = i;
        for (; j < t_s.size() && t_s[j] < t_s[i] + length_s && t_s[j] >= t_s[i]; ++j) {
            Vector g{gyro[0][j], gyro[1][j], gyro[2][j]}, a{accel[0][j], accel[1][j], accel[2][j]};
            if (!std::isfinite(dot(g, g) + dot(a, a))) continue;
            w.t_s += t_s[j];
            for (std::size_t k = 0; k < 3; ++k) w.rate[k] += g[k], w.force[k] += a[k];
            n += 1;
        }
        i = std::max(j, i + 1);
        if (n < 1) continue;
        w.t_s /= n;
        for (std::size_t k = 0; k < 3; ++k) w.rate[k] /= n, w.force[k] /= n;
        out.push_back(w);
    }
    return out;
}

}  // namespace

double median(Numbers values) {
    values.erase(
        std::remove_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }),
        values.end());
    if (values.empty()) return NAN;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double median_length(const Numbers& x, const Numbers& y, const Numbers& z) {
    Numbers lengths;
    for (std::size_t i = 0; i < x.size(); ++i) lengths.push_back(std::hypot(x[i], y[i], z[i]));
    return median(std::move(lengths));
}

bool steady_length(const Numbers& x, const Numbers& y, const Numbers& z) {
    Numbers apart;
    const double middle = median_length(x, y, z);
    for (std::size_t i = 0; i < x.size(); ++i)
        apart.push_back(std::fabs(std::hypot(x[i], y[i], z[i]) - middle));
    return median(std::move(apart)) < 0.25 * middle;
}

bool unit_quaternions(const Numbers& a, const Numbers& b, const Numbers& c, const Numbers& d) {
    std::size_t good = 0, bad = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double square = a[i] * a[i] + b[i] * b[i] + c[i] * c[i] + d[i] * d[i];
        if (std::isfinite(square)) ++(std::fabs(std::sqrt(square) - 1) < 0.02 ? good : bad);
    }
    return good > 0 && 100 * bad <= good + bad;
}

std::optional<Unit> gravity_unit(double length) {
    if (length > 8.5 && length < 11.5) return unit_of(Quantity::accel, "m/s2");
    if (length > 0.85 && length < 1.2) return unit_of(Quantity::accel, "g");
    if (length > 850 && length < 1200) return unit_of(Quantity::accel, "mg");
    return {};
}

std::optional<Unit> field_unit(double length) {
    if (length > 15 && length < 110) return unit_of(Quantity::mag, "uT");
    if (length > 0.15 && length < 1.1) return unit_of(Quantity::mag, "gauss");
    if (length > 150 && length < 1100) return unit_of(Quantity::mag, "mgauss");
    if (length > 15000 && length < 110000) return unit_of(Quantity::mag, "nT");
    if (length > 0.015 && length < 0.11) return unit_of(Quantity::mag, "mT");
    return {};
}

double typical_step(const Numbers& times) {
    if (times.size() < 2) return 0;
    const std::size_t apart = std::min<std::size_t>(32, times.size() - 1);
    Numbers steps;
    for (std::size_t i = apart; i < times.size(); ++i) {
        const double step = (times[i] - times[i - apart]) / static_cast<double>(apart);
        if (step > 0) steps.push_back(step);
    }
    const double middle = median(std::move(steps));
    return std::isfinite(middle) ? middle : 0;
}

std::optional<Unit> time_unit(const Numbers& times, const TimeRange& range, std::string& why) {
    const double step = typical_step(times);
    std::optional<Unit> fits, recent;
    int fit_count = 0, recent_count = 0, recent_fit_count = 0;
    std::optional<Unit> recent_fit;
    for (const char* name : {"ns", "us", "ms", "s"}) {
        const Unit unit = *unit_of(Quantity::time, name);
        const double to_s = std::pow(10.0, unit.time_shift - 9);
        const double rate = step > 0 ? 1 / (step * to_s) : 0;
        const bool fit = rate >= range.low_hz && rate < range.high_hz;
        // 1990 to 2100: a stamp of the calendar, not of a clock that began at zero
        const double first_s = times.empty() ? 0 : times.front() * to_s;
        const bool epoch = first_s > 6.3e8 && first_s < 4.1e9;
        char text[64];
        std::snprintf(text, sizeof text, "%s%s: %.3g Hz", why.empty() ? "" : ", ", name, rate);
        why += text;
        if (fit) fits = unit, ++fit_count;
        if (epoch) recent = unit, ++recent_count;
        if (fit && epoch) recent_fit = unit, ++recent_fit_count;
    }
    if (fit_count == 1) return fits;
    if (fit_count > 1) return recent_fit_count == 1 ? recent_fit : std::nullopt;
    return step > 0 && recent_count == 1 ? recent : std::nullopt;
}

std::optional<double> turning_factor(const std::vector<double>& t_s,
                                     const std::vector<Numbers>& gyro,
                                     const std::vector<Numbers>& accel) {
    const auto windows = windows_of(t_s, gyro, accel);
    double predicted2 = 0, seen2 = 0, both = 0;
    for (std::size_t i = 1; i < windows.size(); ++i) {
        const Window &a = windows[i - 1], &b = windows[i];
        const double step_s = b.t_s - a.t_s;
        if (!(step_s > 0) || step_s > 0.5) continue;
        const double force2 = std::sqrt(dot(a.force, a.force) * dot(b.force, b.force));
        if (force2 < 70 || force2 > 130) continue;  // gravity with little motion: 96 (m/s^2)^2
        Vector rate{}, force{};
        for (std::size_t k = 0; k < 3; ++k) {
            rate[k] = (a.rate[k] + b.rate[k]) / 2;
            force[k] = (a.force[k] + b.force[k]) / 2;
        }
        // a constant vector of the world, seen from a body that turns: d/dt = -w x v
        Vector predicted = cross(force, rate);
        for (double& p : predicted) p *= step_s;
        const Vector seen = b.force - a.force;
        predicted2 += dot(predicted, predicted);
        seen2 += dot(seen, seen);
        both += dot(predicted, seen);
    }
    if (!(predicted2 > 0) || !(seen2 > 0)) return {};
    const double correlation = both / std::sqrt(predicted2 * seen2);
    if (correlation < 0.8 || seen2 < 0.5) return {};  // seen2: (m/s^2)^2, some degrees in all
    return both / predicted2;
}

}  // namespace fairlead::sim
