#include "host_sim/study/bench_peers/rotations.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "fairlead/math/quat.hpp"
#include "host_sim/recording/writers.hpp"

namespace fairlead::sim {
namespace {

using Rotation = BasicQuat<double>;
constexpr double last_digit = 1e-7;
constexpr std::size_t delay = 120;
constexpr unsigned seed = 4;

Rotation any_rotation(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
    const double size = std::sqrt(w * w + x * x + y * y + z * z);
    return {w / size, x / size, y / size, z / size};
}

template <class Change>
std::optional<Ours> changed(const Cell& cell, const Program& program, Change change) {
    Cell other = cell;
    other.track.name = "in_another_frame";
    Recording recording;
    recording.name = other.track.name;
    recording.period_s = cell.track.period_s;
    for (std::size_t i = 0; i < cell.track.size(); ++i) {
        double* x = &other.track.x[4 * i];
        const Rotation q = change(Rotation{x[0], x[1], x[2], x[3]});
        Pose pose;
        pose.t_ns = std::llround(cell.track.t[i] * 1e9);
        pose.q_wb = {static_cast<float>(q.w), static_cast<float>(q.x), static_cast<float>(q.y),
                     static_cast<float>(q.z)};
        pose.flags = flag::orientation_valid;
        recording.poses.push_back(pose);
        const double stored[] = {pose.q_wb.w, pose.q_wb.x, pose.q_wb.y, pose.q_wb.z};
        std::copy(stored, stored + 4, x);
    }
    write_bytes(program.folder + "/cut/" + other.file_name(), to_trk(recording));
    return program.reduce(other, delay, settings[medium]);
}

/// Gathers changes of one figure.
struct Sum {
    double sum{}, squares{}, worst{};
    void add(std::size_t figure, std::size_t before) {
        const double change = static_cast<double>(figure) / static_cast<double>(before) - 1;
        sum += change;
        squares += change * change;
        worst = std::max(worst, std::abs(change));
    }
    Spread over(int runs) const { return {sum / runs, std::sqrt(squares / runs), worst}; }
};

/// In percent: mean, root mean square, and the worst in brackets.
std::string shown(const Spread& s) {
    char line[128];
    std::snprintf(line, sizeof line, " %+.1f %.1f (%.1f) |", 100 * s.mean, 100 * s.rms,
                  100 * s.worst);
    return line;
}

}  // namespace

std::optional<RotationResult> in_other_frames(const Cell& cell, const Program& program) {
    const auto before = changed(cell, program, [](const Rotation& q) { return q; });
    if (!before) return {};
    std::mt19937_64 random{seed};
    std::normal_distribution<double> digit{0, last_digit};
    Sum turned_points, turned_bytes, digit_points, digit_bytes;
    for (int run = 0; run < rotations; ++run) {
        const Rotation world = any_rotation(random), body = any_rotation(random);
        const auto turned =
            changed(cell, program, [&](const Rotation& q) { return world * q * body; });
        const auto noisy = changed(cell, program, [&](const Rotation& q) {
            return Rotation{q.w + digit(random), q.x + digit(random), q.y + digit(random),
                            q.z + digit(random)};
        });
        if (!turned || !noisy) return {};
        turned_points.add(turned->control_points, before->control_points);
        turned_bytes.add(turned->bytes, before->bytes);
        digit_points.add(noisy->control_points, before->control_points);
        digit_bytes.add(noisy->bytes, before->bytes);
    }
    return RotationResult{cell.track.name,
                          cell.coarse,
                          before->control_points,
                          before->bytes,
                          turned_points.over(rotations),
                          turned_bytes.over(rotations),
                          digit_points.over(rotations),
                          digit_bytes.over(rotations)};
}

std::string to_markdown(const std::vector<RotationResult>& results) {
    if (results.empty()) return {};
    std::string out =
        "### Orientations in other frames\n\n"
        "| recording, tolerance | control points | bytes | control points, 20 frames | bytes | "
        "control points, 20 last digits | bytes |\n|---|---|---|---|---|---|---|\n";
    Spread all[4];
    for (const RotationResult& r : results) {
        const Spread* const each[] = {&r.turned_points, &r.turned_bytes, &r.digit_points,
                                      &r.digit_bytes};
        out += "| " + r.name + ", " + tolerance_name(Channel::orientation, r.coarse) + " | " +
               std::to_string(r.control_points) + " | " + std::to_string(r.bytes) + " |";
        for (std::size_t i = 0; i < 4; ++i) {
            out += shown(*each[i]);
            all[i].mean += each[i]->mean / static_cast<double>(results.size());
            all[i].rms += each[i]->rms * each[i]->rms / static_cast<double>(results.size());
            all[i].worst = std::max(all[i].worst, each[i]->worst);
        }
        out += '\n';
    }
    out += "| **all** | | |";
    for (Spread& s : all) {
        s.rms = std::sqrt(s.rms);
        out += shown(s);
    }
    return out + "\n\n";
}

}  // namespace fairlead::sim
