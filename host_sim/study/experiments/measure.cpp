#include "host_sim/study/experiments/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "fairlead/math/quat.hpp"
#include "fairlead/sense/intake.hpp"
#include "host_sim/generate/random.hpp"

namespace fairlead::sim {
namespace {

constexpr std::uint32_t both = flag::position_valid | flag::orientation_valid;
constexpr std::uint32_t any_gap = flag::gap_before | flag::position_gap | flag::orientation_gap;
constexpr std::size_t lag_max = 60, early = 3;  // lags looked at: -early ... lag_max
constexpr std::size_t warm_up = 150;

using Vec3d = BasicVec3<double>;

Vec3d wide(const Vec3& v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
BasicQuat<double> wide(const Quat& q) {
    return normalised(BasicQuat<double>{static_cast<double>(q.w), static_cast<double>(q.x),
                                        static_cast<double>(q.y), static_cast<double>(q.z)});
}
Quat narrow(const BasicQuat<double>& q) {
    return {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
            static_cast<float>(q.z)};
}

struct PositionSpace {
    static Vec3d difference(const Pose& a, const Pose& b) { return wide(b.p_w_m - a.p_w_m); }
};
struct OrientationSpace {
    static Vec3d difference(const Pose& a, const Pose& b) {
        return rotation_vector(conj(wide(a.q_wb)) * wide(b.q_wb));
    }
};

double rms(const std::vector<Vec3d>& v) {
    double sum = 0;
    for (const auto& x : v) sum += dot(x, x);
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(v.size(), 1)));
}

/// Second-order Butterworth low-pass forwards and backwards; what it takes away is returned.
std::vector<Vec3d> above(const std::vector<Vec3d>& v, double hz, double step_s) {
    const double k = std::tan(3.14159265358979 * std::min(hz * step_s, 0.45));
    const double norm = 1 / (1 + std::sqrt(2.0) * k + k * k);
    const double b0 = k * k * norm, a1 = 2 * (k * k - 1) * norm,
                 a2 = (1 - std::sqrt(2.0) * k + k * k) * norm;
    auto low = v;
    const auto pass = [&](auto begin, auto end) {
        Vec3d x1 = *begin, x2 = x1, y1 = x1, y2 = x1;
        for (auto it = begin; it != end; ++it) {
            const Vec3d x = *it;
            const Vec3d y = b0 * (x + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
            x2 = x1, x1 = x, y2 = y1, y1 = y;
            *it = y;
        }
    };
    pass(low.begin(), low.end());
    pass(low.rbegin(), low.rend());
    auto high = v;
    for (std::size_t i = 0; i < v.size(); ++i) high[i] = v[i] - low[i];
    return high;
}

/// out(i) against truth(i - lag).
template <class Space>
std::vector<Vec3d> differences(const std::vector<Pose>& truth, const std::vector<Pose>& out,
                               long lag) {
    std::vector<Vec3d> d;
    for (std::size_t i = warm_up; i + early < out.size(); ++i)
        d.push_back(
            Space::difference(truth[static_cast<std::size_t>(static_cast<long>(i) - lag)], out[i]));
    return d;
}

template <class Space>
ChannelFigures figures(const NoisyMotion& motion, const std::vector<Pose>& out, double above_hz) {
    ChannelFigures f;
    std::vector<double> square;
    const long first = -static_cast<long>(early);
    for (long lag = first; lag <= static_cast<long>(lag_max); ++lag) {
        const double e = rms(differences<Space>(motion.truth, out, lag));
        square.push_back(e * e);
        // the match is a single valley: past it, enough is seen
        if (square.size() > 6 && square.back() > 4 * square[square.size() - 5]) break;
    }
    const auto best = std::min_element(square.begin(), square.end());
    const auto k = static_cast<std::size_t>(best - square.begin());
    double part = 0;  // of the parabola through the three lowest
    if (k > 0 && k + 1 < square.size()) {
        const double bend = square[k - 1] - 2 * square[k] + square[k + 1];
        if (bend > 0) part = (square[k - 1] - square[k + 1]) / (2 * bend);
    }
    const long whole = first + static_cast<long>(k);
    f.lag = static_cast<double>(whole) + part;
    // the difference at a lag between two samples, linearly between theirs
    auto d = differences<Space>(motion.truth, out, whole);
    const auto side = differences<Space>(motion.truth, out, part > 0 ? whole + 1 : whole - 1);
    for (std::size_t i = 0; i < d.size(); ++i) d[i] += std::abs(part) * (side[i] - d[i]);
    f.error = rms(d);
    f.noise = rms(above(d, above_hz, motion.step_s));
    f.late_error = rms(differences<Space>(motion.truth, out, 0));
    return f;
}

std::vector<Pose> run(CausalFilter& filter, const std::vector<Pose>& in) {
    std::vector<Pose> out;
    out.reserve(in.size());
    for (const auto& pose : in) out.push_back(filter.push(pose));
    return out;
}

/// A reach of 0.3 m and 1 rad in 0.3 s, minimum jerk, rests before and after.
std::pair<double, double> overshoot(const Candidate& candidate, double step_s) {
    std::vector<Pose> in;
    for (double t = -2; t < 3; t += step_s) {
        const double x = std::clamp(t / 0.3, 0.0, 1.0);
        const double s = x * x * x * (10 + x * (6 * x - 15));
        Pose pose;
        pose.t_ns = std::llround((t + 10) * 1e9);
        pose.flags = both;
        pose.p_w_m.x = static_cast<float>(0.3 * s);
        pose.q_wb = narrow(from_rotation_vector(Vec3d{0, 0, s}));
        in.push_back(pose);
    }
    const auto filter = candidate.make();
    double p = 0, q = 0;
    for (const auto& pose : run(*filter, in)) {
        p = std::max(p, static_cast<double>(pose.p_w_m.x) / 0.3 - 1);
        q = std::max(q, static_cast<double>(rotation_vector(pose.q_wb).z) - 1);
    }
    return {p, q};
}

double nanoseconds(const Candidate& candidate, const std::vector<Pose>& in) {
    using Clock = std::chrono::steady_clock;
    double best = 1e18;
    for (int round = 0; round < 3; ++round) {
        const auto filter = candidate.make();
        float sink = 0;
        const auto start = Clock::now();
        for (const auto& pose : in) sink += filter->push(pose).q_wb.w;
        const std::chrono::duration<double, std::nano> took = Clock::now() - start;
        best = std::min(best, took.count() + (sink > 1e30f ? 1.0 : 0.0));
    }
    return best / static_cast<double>(in.size());
}

/// The stretch of at most `most` records that travels and turns furthest: a lag shows in motion.
std::vector<Pose> liveliest(const std::vector<Pose>& poses, std::size_t most) {
    if (poses.size() <= most) return poses;
    constexpr double metre = 5;  // counts as so many radians
    std::vector<double> way{0};
    for (std::size_t i = 1; i < poses.size(); ++i)
        way.push_back(way.back() + metre * norm(wide(poses[i].p_w_m - poses[i - 1].p_w_m)) +
                      norm(OrientationSpace::difference(poses[i - 1], poses[i])));
    std::size_t best = 0;
    for (std::size_t i = 0; i + most < poses.size(); ++i)
        if (way[i + most] - way[i] > way[best + most] - way[best]) best = i;
    const auto first = poses.begin() + static_cast<std::ptrdiff_t>(best);
    return {first, first + static_cast<std::ptrdiff_t>(most)};
}

}  // namespace

NoisyMotion noisy(const Recording& recording, const NoisePlan& plan) {
    const auto& poses = poses_of(recording);
    Intake<Pose> intake;
    std::vector<Pose> run_now, longest;
    for (const auto& pose : poses) {
        const auto p = intake.push(pose);
        if (!p) continue;
        if ((p->flags & both) != both || (p->flags & any_gap)) run_now.clear();
        if ((p->flags & both) == both) run_now.push_back(*p);
        if (run_now.size() > longest.size()) longest = run_now;
    }
    const double step_s = recording.period_s;
    const auto most = static_cast<std::size_t>(plan.seconds_max / step_s);
    longest = liveliest(longest, most);
    if (static_cast<double>(longest.size()) * step_s < 2)
        throw BadData(recording.name + ": no two seconds with both channels and without a gap");
    longest.front().flags = both;
    NoisyMotion motion{longest, longest, step_s};
    Random random{plan.seed};
    for (auto& pose : motion.input) {
        const Vec3d p = wide(pose.p_w_m) + random.normal3(plan.noise_m);
        pose.p_w_m = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
        pose.q_wb = narrow(wide(pose.q_wb) * from_rotation_vector(random.normal3(plan.noise_rad)));
    }
    return motion;
}

Figures measure(const Candidate& candidate, const NoisyMotion& motion, double above_hz) {
    const auto filter = candidate.make();
    const auto out = run(*filter, motion.input);
    Figures f;
    f.position = figures<PositionSpace>(motion, out, above_hz);
    f.orientation = figures<OrientationSpace>(motion, out, above_hz);
    const auto [p, q] = overshoot(candidate, motion.step_s);
    f.position.overshoot = p;
    f.orientation.overshoot = q;
    const std::size_t timed = std::min<std::size_t>(motion.input.size(), 1000);
    f.ns_per_sample = nanoseconds(
        candidate,
        {motion.input.begin(), motion.input.begin() + static_cast<std::ptrdiff_t>(timed)});
    return f;
}

}  // namespace fairlead::sim
