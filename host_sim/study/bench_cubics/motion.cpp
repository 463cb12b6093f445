#include "host_sim/study/bench_cubics/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "fairlead/math/quat.hpp"
#include "host_sim/study/bench_cubics/samples.hpp"

namespace fairlead::sim::cubics {
namespace {

using Vectors = std::vector<std::array<double, 3>>;

/// Differences of neighbouring records: m, or rad in the body's axes.
Vectors steps(const Track& track, const std::vector<double>& x) {
    Vectors out;
    const std::size_t dim = track.dim();
    for (std::size_t i = 0; i + 1 < track.size(); ++i) {
        const double *a = &x[i * dim], *b = a + dim;
        if (dim == 3) {
            out.push_back({b[0] - a[0], b[1] - a[1], b[2] - a[2]});
            continue;
        }
        const auto unit = [](const double* q) {
            const double f = 1 / std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
            return BasicQuat<double>{f * q[0], f * q[1], f * q[2], f * q[3]};
        };
        out.push_back(log_of(conj(unit(a)) * unit(b)));
    }
    return out;
}

Vectors differences(const Vectors& x) {
    Vectors out;
    for (std::size_t i = 0; i + 1 < x.size(); ++i)
        out.push_back({x[i + 1][0] - x[i][0], x[i + 1][1] - x[i][1], x[i + 1][2] - x[i][2]});
    return out;
}

/// Means over 2 half + 1 neighbours; the ends stay as they are.
Vectors averaged(const Vectors& x, std::size_t half) {
    Vectors out = x;
    for (std::size_t i = half; i + half < x.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            double sum = 0;
            for (std::size_t k = i - half; k <= i + half; ++k) sum += x[k][c];
            out[i][c] = sum / static_cast<double>(2 * half + 1);
        }
    return out;
}

constexpr std::size_t half = 4, margin = half + 1;

MotionError errors(const Vectors& found, const Vectors& wanted, double unit) {
    MotionError e;
    std::size_t n = 0;
    for (std::size_t i = margin; i + margin < found.size(); ++i, ++n) {
        double square = 0;
        for (std::size_t c = 0; c < 3; ++c) square += std::pow(found[i][c] - wanted[i][c], 2);
        e.rms += square;
        e.most = std::max(e.most, std::sqrt(square));
    }
    return n > 0 ? MotionError{std::sqrt(e.rms / static_cast<double>(n)) * unit, e.most * unit}
                 : MotionError{};
}

}  // namespace

MotionErrors motion_errors(const Track& track, const std::vector<double>& decoded,
                           const std::vector<double>& truth) {
    const Vectors found = steps(track, decoded);
    const Vectors wanted =
        truth.empty() ? averaged(steps(track, track.x), half) : steps(track, truth);
    const double rate = 1 / track.period_s;
    return {errors(found, wanted, rate),
            errors(differences(found), differences(wanted), rate * rate)};
}

}  // namespace fairlead::sim::cubics
