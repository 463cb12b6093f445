#include "host_sim/study/bench_cubics/samples.hpp"

#include <algorithm>
#include <cmath>

#include "fairlead/math/quat.hpp"

namespace fairlead::sim::cubics {
namespace {

constexpr std::int32_t looked_back = 64;  // ticks that a parabola may reach before a chart's first

}  // namespace

Samples::Samples(std::vector<double> x, std::int32_t first)
    : first_{first}, x_{std::move(x)}, sum_(1), sum1_(1), sum2_(1) {
    for (std::size_t i = 0; i < x_.size(); ++i) {
        const auto t = static_cast<double>(i) + first_;
        sum_.push_back(sum_[i] + x_[i]);
        sum1_.push_back(sum1_[i] + x_[i] * t);
        sum2_.push_back(sum2_[i] + x_[i] * t * t);
    }
}

Samples::Parabola Samples::fit(std::int32_t first, std::int32_t last, double t) const {
    const auto from = static_cast<std::size_t>(first - first_);
    const auto to = static_cast<std::size_t>(last - first_) + 1;
    const double n = last - first + 1, middle = (first + last) / 2.0;
    const double s0 = sum_[to] - sum_[from];
    const double raw = sum1_[to] - sum1_[from], s1 = raw - middle * s0;
    const double s2 = sum2_[to] - sum2_[from] - 2 * middle * raw + middle * middle * s0;
    const double q2 = n * (n * n - 1) / 12, q4 = q2 * (3 * n * n - 7) / 20, u = t - middle;
    if (n < 2) return {s0, 0, 0};
    const double b = s1 / q2;
    if (n < 3) return {s0 / 2 + b * u, b, 0};
    const double c = (n * s2 - q2 * s0) / (n * q4 - q2 * q2);
    return {(s0 - c * q2) / n + b * u + c * u * u, b + 2 * c * u, 2 * c};
}

double Samples::control(std::int32_t t, std::int32_t h, std::int32_t known) const {
    // the second derivative is x'' of the spline's middle: c = x - h^2 / 6 x''
    const double h6 = h * h / 6.0;
    const std::int32_t half = (std::max)(h, 2);
    if (t + (std::min)(half, (std::max)(3, half / 2)) <= known) {
        const Parabola p = fit((std::max)(first_, t - half), (std::min)(known, t + half), t);
        return p.value - h6 * p.bend;
    }
    // from the last samples on; their bend is damped, and fades within some ticks
    constexpr double fading = 12;
    const std::int32_t last = (std::min)(20, (std::max)(6, h));
    Parabola p = fit((std::max)(first_, known - last), known, known);
    p.bend *= last / (last + 4.0);
    const double after = t - known;
    if (after < 0) return p.value + p.rate * after + p.bend * after * after / 2 - h6 * p.bend;
    const double rest = std::exp(-after / fading);
    return p.value + p.rate * after + p.bend * fading * (after - fading * (1 - rest)) -
           h6 * p.bend * rest;
}

BasicQuat<double> wide(const Quat& q) { return {q.w, q.x, q.y, q.z}; }

BasicQuat<double> exp_of(const std::array<double, 3>& r) {
    const double n = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    const double s = n > 1e-9 ? std::sin(n / 2) / n : 0.5;
    return {std::cos(n / 2), s * r[0], s * r[1], s * r[2]};
}

std::array<double, 3> log_of(const BasicQuat<double>& q) {
    const double n = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z);
    const double s = (q.w < 0 ? -1 : 1) * (n > 1e-12 ? 2 * std::atan2(n, std::fabs(q.w)) / n : 2);
    return {s * q.x, s * q.y, s * q.z};
}

template <std::size_t N>
Subject<N>::Subject(const Track& track, std::size_t first, double step)
    : track_{&track}, step_{step} {
    if (rotates()) return;
    auto chart = std::make_shared<Chart<N>>();
    for (std::size_t c = 0; c < N; ++c) {
        std::vector<double> x;
        for (std::size_t i = 0; i < track.size(); ++i) x.push_back(track.at(i)[first + c] / step);
        chart->x[c] = Samples{std::move(x)};
    }
    all_ = std::move(chart);
}

template <std::size_t N>
std::shared_ptr<const Chart<N>> Subject<N>::chart(const Quat& anchor, std::int32_t from,
                                                  std::int32_t to) const {
    if (all_) return all_;
    auto chart = std::make_shared<Chart<N>>();
    chart->anchor = anchor;
    const std::int32_t first = (std::max)(0, from - looked_back);
    std::array<std::vector<double>, N> x;
    for (std::int32_t t = first; t <= to; ++t) {
        const double* q = track_->at(static_cast<std::size_t>(t));
        const auto r = log_of(conj(wide(anchor)) * BasicQuat<double>{q[0], q[1], q[2], q[3]});
        for (std::size_t c = 0; c < N; ++c) x[c].push_back(r[c] / step_);
    }
    for (std::size_t c = 0; c < N; ++c) chart->x[c] = Samples{std::move(x[c]), first};
    return chart;
}

template class Subject<1>;
template class Subject<3>;

}  // namespace fairlead::sim::cubics
