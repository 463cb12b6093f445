#include "host_sim/study/baselines/track.hpp"

#include <algorithm>
#include <cmath>

namespace fairlead::sim {
namespace {

struct Range {
    std::size_t begin{}, size{};
};

Range longest(const Recording& recording, Channel channel, double seconds_max) {
    const auto& poses = poses_of(recording);
    const auto valid =
        channel == Channel::position ? flag::position_valid : flag::orientation_valid;
    Range best, run;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const double step =
            i == 0 ? 0 : static_cast<double>(poses[i].t_ns - poses[i - 1].t_ns) * 1e-9;
        const bool missing = step < 0 || step > 1.5 * recording.period_s;
        if (missing || (poses[i].flags & valid) == 0) run = {i, 0};
        if ((poses[i].flags & valid) == 0) continue;
        if (run.size == 0) run.begin = i;
        if (++run.size > best.size) best = run;
    }
    best.size = std::min(best.size, static_cast<std::size_t>(seconds_max / recording.period_s));
    return best;
}

}  // namespace

const char* to_string(Channel channel) {
    return channel == Channel::position ? "position" : "orientation";
}

double rotation_angle(const double* a, const double* b) {
    double aa = 0, bb = 0, ab = 0;
    for (int d = 0; d < 4; ++d) {
        aa += a[d] * a[d];
        bb += b[d] * b[d];
        ab += a[d] * b[d];
    }
    const double sa = 1 / std::sqrt(aa), sb = std::copysign(1 / std::sqrt(bb), ab);
    double chord = 0;
    for (int d = 0; d < 4; ++d) {
        const double e = a[d] * sa - b[d] * sb;
        chord += e * e;
    }
    return 4 * std::asin(std::min(1.0, std::sqrt(chord) / 2));
}

double Track::error(std::size_t i, const double* value) const {
    if (channel == Channel::orientation) return rotation_angle(at(i), value);
    double e = 0;
    for (std::size_t d = 0; d < 3; ++d) e = std::max(e, std::fabs(value[d] - at(i)[d]));
    return e;
}

Track longest_run(const Recording& recording, Channel channel, double seconds_max) {
    const Range range = longest(recording, channel, seconds_max);
    Track track;
    track.name = recording.name;
    track.channel = channel;
    track.period_s = recording.period_s;
    for (std::size_t i = 0; i < range.size; ++i) {
        const Pose& pose = recording.poses[range.begin + i];
        const Pose& first = recording.poses[range.begin];
        track.t.push_back(static_cast<double>(pose.t_ns - first.t_ns) * 1e-9);
        if (channel == Channel::position) {
            for (const float v : {pose.p_w_m.x, pose.p_w_m.y, pose.p_w_m.z})
                track.x.push_back(static_cast<double>(v));
            continue;
        }
        double q[4] = {static_cast<double>(pose.q_wb.w), static_cast<double>(pose.q_wb.x),
                       static_cast<double>(pose.q_wb.y), static_cast<double>(pose.q_wb.z)};
        double norm2 = 0, side = i == 0 ? 1 : 0;
        for (std::size_t d = 0; d < 4; ++d) {
            norm2 += q[d] * q[d];
            if (i > 0) side += q[d] * track.at(i - 1)[d];
        }
        for (const double v : q) track.x.push_back(std::copysign(1 / std::sqrt(norm2), side) * v);
    }
    return track;
}

Recording cut(const Recording& recording, Channel channel, double seconds_max) {
    const Range range = longest(recording, channel, seconds_max);
    Recording out = recording;
    const auto first = recording.poses.begin() + static_cast<std::ptrdiff_t>(range.begin);
    out.poses.assign(first, first + static_cast<std::ptrdiff_t>(range.size));
    for (Pose& pose : out.poses) {
        if (channel == Channel::position) {
            pose.flags = flag::position_valid;
            pose.q_wb = {};
        } else {
            pose.flags = flag::orientation_valid;
            pose.p_w_m = {};
        }
    }
    return out;
}

}  // namespace fairlead::sim
