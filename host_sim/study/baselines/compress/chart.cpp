#include "host_sim/study/baselines/compress/chart.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::sim {
namespace {

State product(const State& a, const State& b) {
    return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

}  // namespace

Step Chart::difference(const State& from, const State& to) const {
    if (channel == Channel::position) return {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const State q = product({from[0], -from[1], -from[2], -from[3]}, to);
    const double n = std::sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double w = std::fabs(q[0]);
    const double s = std::copysign(n > 1e-12 ? 2 * std::atan2(n, w) / n : 2, q[0]);
    return {s * q[1], s * q[2], s * q[3]};
}

State Chart::moved(const State& from, const Step& by) const {
    if (channel == Channel::position) return {from[0] + by[0], from[1] + by[1], from[2] + by[2], 0};
    const double angle = std::sqrt(by[0] * by[0] + by[1] * by[1] + by[2] * by[2]);
    const double s = angle > 1e-12 ? std::sin(angle / 2) / angle : 0.5;
    State q = product(from, {std::cos(angle / 2), s * by[0], s * by[1], s * by[2]});
    double norm2 = 0;
    for (const double v : q) norm2 += v * v;
    for (double& v : q) v /= std::sqrt(norm2);
    return q;
}

State Chart::sample(const Track& track, std::size_t i) const {
    State out{};
    std::copy_n(track.at(i), track.dim(), out.begin());
    return out;
}

Step scaled(const GridSteps& n, double grid) {
    return {grid * static_cast<double>(n[0]), grid * static_cast<double>(n[1]),
            grid * static_cast<double>(n[2])};
}

GridSteps rounded(const Step& step, double grid) {
    return {std::lround(step[0] / grid), std::lround(step[1] / grid), std::lround(step[2] / grid)};
}

Absolute::Absolute(const Track& track, double error_max) : channel_{track.channel} {
    if (channel_ == Channel::position) {
        double reach = 0;
        for (const double x : track.x) reach = std::max(reach, std::fabs(x));
        grid_ = 2 * error_max;
        while (static_cast<double>(1l << bits_) < 2 * reach / grid_ + 2) ++bits_;
        return;
    }
    // three components in [-1/sqrt 2, 1/sqrt 2] err by grid / 2 each, and the fourth, at least 1/2
    // long, by what they take: below 2 sqrt 3 grid in angle
    while (2 * std::sqrt(6.0) / static_cast<double>(1l << bits_) > error_max) ++bits_;
    ++bits_;  // the grid's ends are codes of their own
    grid_ = std::sqrt(2.0) / static_cast<double>((1l << bits_) - 2);
}

void Absolute::put(std::vector<Symbol>& out, std::size_t record, const State& value) const {
    const auto plain = [&](long v, unsigned bits) {
        out.push_back({static_cast<std::uint32_t>(v), 0, static_cast<std::uint8_t>(bits)});
    };
    plain(static_cast<long>(record & 0xffffu), 16);
    std::size_t left_out = 3;
    double sign = 1;
    if (channel_ == Channel::orientation) {
        for (std::size_t d = 0; d < 4; ++d)
            if (std::fabs(value[d]) > std::fabs(value[left_out])) left_out = d;
        sign = std::copysign(1, value[left_out]);
        plain(static_cast<long>(left_out), 2);
    }
    for (std::size_t d = 0; d < 4; ++d)
        if (d != left_out) plain(std::lround(sign * value[d] / grid_) + (1l << (bits_ - 1)), bits_);
}

State Absolute::get(const Symbol*& next) const {
    ++next;  // the record's number
    const std::size_t left_out = channel_ == Channel::orientation ? (next++)->value : 3;
    State out{};
    double rest = 1;
    for (std::size_t d = 0; d < 4; ++d) {
        if (d == left_out) continue;
        out[d] =
            grid_ * static_cast<double>(static_cast<long>((next++)->value) - (1l << (bits_ - 1)));
        rest -= out[d] * out[d];
    }
    if (channel_ == Channel::orientation) out[left_out] = std::sqrt(std::max(rest, 0.0));
    return out;
}

}  // namespace fairlead::sim
