#include "host_sim/study/baselines/knots/certificate.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::sim {
namespace {

constexpr int exchanges_max = 60;

/// Weights of the fourth divided difference: orthogonal to every cubic.
std::array<double, 5> annihilator(const Track& track, const Proof& proof) {
    std::array<double, 5> w{};
    const double scale = 4 / (track.t[proof.samples[4]] - track.t[proof.samples[0]]);
    for (std::size_t i = 0; i < 5; ++i) {
        w[i] = 1;
        for (std::size_t j = 0; j < 5; ++j)
            if (j != i) w[i] /= scale * (track.t[proof.samples[i]] - track.t[proof.samples[j]]);
    }
    return w;
}

double value(const Track& track, std::size_t axis, std::size_t i) { return track.at(i)[axis]; }

/// Signed error that the best cubic on the five samples leaves on the first of them.
double levelled(const Track& track, const Proof& proof) {
    const auto w = annihilator(track, proof);
    double sum = 0, size = 0;
    for (std::size_t i = 0; i < 5; ++i) {
        sum += w[i] * value(track, proof.axis, proof.samples[i]);
        size += std::fabs(w[i]);
    }
    return sum / size * (w[0] > 0 ? 1 : -1);
}

/// The best cubic on the five samples, at t: through four of them less their levelled errors.
double best_cubic(const Track& track, const Proof& proof, double error, double t) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        double l = 1;
        for (std::size_t j = 0; j < 4; ++j)
            if (j != i)
                l *= (t - track.t[proof.samples[j]]) /
                     (track.t[proof.samples[i]] - track.t[proof.samples[j]]);
        sum += l * (value(track, proof.axis, proof.samples[i]) - (i % 2 == 0 ? error : -error));
    }
    return sum;
}

/// Takes sample `at` into the five, keeping signs alternate.
void exchange(Proof& proof, std::size_t at, bool positive, bool first_positive) {
    auto& s = proof.samples;
    const auto sign = [&](std::size_t i) { return (i % 2 == 0) == first_positive; };
    if (at < s[0]) {
        if (sign(0) != positive) std::copy_backward(s.begin(), s.end() - 1, s.end());
        s[0] = at;
        return;
    }
    if (at > s[4]) {
        if (sign(4) != positive) std::copy(s.begin() + 1, s.end(), s.begin());
        s[4] = at;
        return;
    }
    std::size_t i = 0;
    while (i < 3 && s[i + 1] < at) ++i;
    s[sign(i) == positive ? i : i + 1] = at;
}

}  // namespace

double least_error(const Track& track, const Proof& proof) {
    return std::fabs(levelled(track, proof));
}

bool impossible(const Track& track, std::size_t axis, std::size_t a, std::size_t b,
                double tolerance, Proof& proof) {
    if (b < a + 4) return false;
    proof.axis = axis;
    for (std::size_t i = 0; i < 5; ++i) {  // near the extrema of the Chebyshev polynomial
        const double share = (1 - std::cos(3.14159265358979 * static_cast<double>(i) / 4)) / 2;
        proof.samples[i] =
            a + static_cast<std::size_t>(std::lround(share * static_cast<double>(b - a)));
    }
    for (std::size_t i = 1; i < 5; ++i)
        proof.samples[i] = std::max(proof.samples[i], proof.samples[i - 1] + 1);
    for (std::size_t i = 4; i-- > 0;)
        proof.samples[i] = std::min(proof.samples[i], proof.samples[i + 1] - 1);
    for (int round = 0; round < exchanges_max; ++round) {
        const double error = levelled(track, proof);
        proof.missed = std::fabs(error);
        if (proof.missed > tolerance) return true;
        double worst = tolerance;
        std::size_t at = b + 1;
        bool positive = false;
        for (std::size_t i = a; i <= b; ++i) {
            const double e = value(track, axis, i) - best_cubic(track, proof, error, track.t[i]);
            if (std::fabs(e) <= worst) continue;
            worst = std::fabs(e);
            at = i;
            positive = e > 0;
        }
        const auto& s = proof.samples;
        if (at > b || std::find(s.begin(), s.end(), at) != s.end()) return false;
        exchange(proof, at, positive, error > 0);
    }
    return false;  // not proved
}

std::vector<Proof> knots_needed(const Track& track, double tolerance) {
    std::vector<Proof> out;
    Proof proof;
    const auto proved = [&](std::size_t a, std::size_t b) {
        for (std::size_t axis = 0; axis < track.dim(); ++axis)
            if (impossible(track, axis, a, b, tolerance, proof)) return true;
        return false;
    };
    for (std::size_t a = 0; a + 4 < track.size();) {
        std::size_t possible = a + 3, step = 4;
        while (possible + step < track.size() && !proved(a, possible + step)) {
            possible += step;
            step *= 2;
        }
        std::size_t not_possible = std::min(possible + step, track.size() - 1);
        if (!proved(a, not_possible)) break;  // one cubic reaches the end
        while (not_possible - possible > 1) {
            const std::size_t middle = (possible + not_possible) / 2;
            (proved(a, middle) ? not_possible : possible) = middle;
        }
        if (!proved(a, not_possible)) break;
        out.push_back(proof);
        a = not_possible;
    }
    return out;
}

}  // namespace fairlead::sim
