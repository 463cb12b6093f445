#include "host_sim/study/bench_peers/ours.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "host_sim/recording/writers.hpp"

namespace fairlead::sim {
namespace {

std::string quoted(const std::string& path) { return '\'' + path + '\''; }

/// Standard output of a command; empty where it fails.
std::optional<std::string> output_of(const std::string& command) {
    std::FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return {};
    std::string out;
    char part[4096];
    for (std::size_t n = 0; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) out.append(part, n);
    const int status = pclose(pipe);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return {};
    return out;
}

/// The number after "name": at or beyond `from`; NaN where there is none.
double number_after(const std::string& json, const std::string& name, std::size_t from) {
    const std::size_t at = json.find('"' + name + '"', from);
    const std::size_t colon = at == std::string::npos ? at : json.find(':', at);
    if (colon == std::string::npos) return std::nan("");
    return std::strtod(json.c_str() + colon + 1, nullptr);
}

/// From one value to another: a chord, or an angle.
double apart(const Cell& cell, const double* a, const double* b) {
    if (cell.track.channel == Channel::orientation) return rotation_angle(a, b);
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// The values of t_ns,px,py,pz,qw,qx,qy,qz at the records of a cell; NaN where there is none.
std::vector<double> values_of(const std::string& csv, const Cell& cell) {
    std::istringstream lines{csv};
    std::string line;
    std::getline(lines, line);
    std::vector<double> values(cell.track.x.size(), std::nan(""));
    for (std::size_t i = 0; i < cell.track.size() && std::getline(lines, line); ++i) {
        std::istringstream fields{line};
        std::string field;
        for (int skip = cell.track.dim() == 3 ? 1 : 4; skip > 0; --skip)
            std::getline(fields, field, ',');
        for (std::size_t d = 0; d < cell.track.dim(); ++d) {
            if (!std::getline(fields, field, ',') || field.empty()) break;
            values[i * cell.track.dim() + d] = std::strtod(field.c_str(), nullptr);
        }
    }
    return values;
}

/// Compares values with the track.
void check(const std::vector<double>& values, const Cell& cell, Ours& ours) {
    const double* before = nullptr;
    double square = 0, off_square = 0;
    std::size_t steps = 0;
    for (std::size_t i = 0; i < cell.track.size(); ++i) {
        const double* value = &values[i * cell.track.dim()];
        const bool empty =
            std::any_of(value, value + cell.track.dim(), [](double x) { return std::isnan(x); });
        if (empty)
            ++ours.samples_missing;
        else
            ours.error = std::max(ours.error, cell.track.error(i, value) / cell.tolerance);
        if (before != nullptr && !empty) {
            const double step_s = cell.track.t[i] - cell.track.t[i - 1];
            const double speed = apart(cell, cell.track.at(i - 1), cell.track.at(i)) / step_s;
            const double off = apart(cell, before, value) / step_s - speed;
            square += speed * speed;
            off_square += off * off;
            ++steps;
        }
        before = empty ? nullptr : value;
    }
    if (steps > 0) {
        ours.speed = std::sqrt(square / static_cast<double>(steps));
        ours.speed_error = std::sqrt(off_square / static_cast<double>(steps));
    }
}

void say_once(const std::string& what) {
    static bool said = false;
    if (!said) std::fprintf(stderr, "skipped our reducer: %s\n", what.c_str());
    said = true;
}

}  // namespace

std::optional<std::string> Program::stream_of(const std::string& in, const Tolerances& tolerances,
                                              std::size_t delay, const std::string& channels,
                                              const Setting& setting) const {
    if (access(path.c_str(), X_OK) != 0) {
        say_once("no program " + path);
        return {};
    }
    char limits[128];
    std::snprintf(limits, sizeof limits, " --tol-pos %.9g --tol-rot %.9g --max-delay %zu %s ",
                  tolerances.position_m, tolerances.orientation_rad, delay, setting.arguments);
    auto json = output_of(quoted(path) + " reduce " + quoted(in) + limits + channels + " --out " +
                          quoted(stream()) + " --json " + extra_arguments);
    if (!json) say_once(path + " reduce failed on " + in);
    return json;
}

std::optional<std::string> Program::decoded(const std::string& in, const Setting& setting) const {
    const std::string csv = folder + "/ours.csv";
    if (output_of(quoted(path) + " decode " + quoted(stream()) + " --at " + quoted(in) + " --out " +
                  quoted(csv) + (setting.earlier ? " --earlier" : "")))
        return read_bytes(csv);
    say_once(path + " decode failed on " + stream());
    return {};
}

std::optional<std::string> Program::reduced(const Cell& cell, std::size_t delay,
                                            const Setting& setting) const {
    const std::string in = folder + "/cut/" + cell.file_name();
    const bool position = cell.track.channel == Channel::position;
    const Tolerances tolerances{position ? cell.tolerance : 0.001,
                                position ? 0.01 : cell.tolerance};
    return stream_of(in, tolerances, delay,
                     std::string{"--channel "} + to_string(cell.track.channel), setting);
}

std::optional<std::vector<double>> Program::values(const Cell& cell, std::size_t delay,
                                                   const Setting& setting) const {
    if (!reduced(cell, delay, setting)) return {};
    const auto csv = decoded(folder + "/cut/" + cell.file_name(), setting);
    if (!csv) return {};
    return values_of(*csv, cell);
}

std::optional<Ours> Program::reduce(const Cell& cell, std::size_t delay,
                                    const Setting& setting) const {
    const auto json = reduced(cell, delay, setting);
    if (!json) return {};
    const std::string name = to_string(cell.track.channel);
    const std::size_t block = json->find('"' + name + '"');
    Ours ours;
    ours.bytes = static_cast<std::size_t>(number_after(*json, "bytes", 0));
    ours.control_points = static_cast<std::size_t>(number_after(*json, "control_points", block));
    ours.max_delay = number_after(*json, "max_delay_samples", block);
    ours.mean_delay = number_after(*json, "mean_delay_samples", block);
    const auto csv = decoded(folder + "/cut/" + cell.file_name(), setting);
    if (!csv) return {};
    check(values_of(*csv, cell), cell, ours);
    return ours;
}

std::optional<Ours> Program::reduce_both(const Cell& position, const Cell& orientation,
                                         std::size_t delay, const Setting& setting) const {
    Recording recording;
    recording.name = position.track.name;
    recording.period_s = position.track.period_s;
    for (std::size_t i = 0; i < position.track.size(); ++i) {
        const double *p = position.track.at(i), *q = orientation.track.at(i);
        Pose pose;
        pose.t_ns = std::llround(position.track.t[i] * 1e9);
        pose.p_w_m = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
        pose.q_wb = {static_cast<float>(q[0]), static_cast<float>(q[1]), static_cast<float>(q[2]),
                     static_cast<float>(q[3])};
        pose.flags = flag::position_valid | flag::orientation_valid;
        recording.poses.push_back(pose);
    }
    const std::string in = folder + "/cut/" + position.track.name + ".6dof.trk";
    write_bytes(in, to_trk(recording));
    const auto json =
        stream_of(in, {position.tolerance, orientation.tolerance}, delay, "", setting);
    if (!json) return {};
    Ours ours;
    ours.bytes = static_cast<std::size_t>(number_after(*json, "bytes", 0));
    for (const char* channel : {"\"position\"", "\"orientation\""})
        ours.max_delay =
            std::max(ours.max_delay, number_after(*json, "max_delay_samples", json->find(channel)));
    const auto csv = decoded(in, setting);
    if (!csv) return {};
    check(values_of(*csv, position), position, ours);
    check(values_of(*csv, orientation), orientation, ours);
    return ours;
}

}  // namespace fairlead::sim
