// The fixed-lag strain smoother on the tracker recordings, against the whole-buffer double
// reference: one line a recording and cut-off. usage: strain [FOLDER]
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "fairlead/sense/intake.hpp"
#include "fairlead/smooth/strain.hpp"
#include "host_sim/recording/recording.hpp"
#include "tests/ref/strain.hpp"

namespace fairlead::test {
namespace {

constexpr double position_limit_m = 2e-6, orientation_limit_rad = 1e-5;

std::vector<Pose> admitted(const std::vector<Pose>& poses) {
    Intake<Pose> intake;
    std::vector<Pose> out;
    for (const auto& pose : poses)
        if (const auto p = intake.push(pose)) out.push_back(*p);
    return out;
}

template <std::size_t Lag>
std::vector<Pose> streamed(const std::vector<Pose>& raw, const StrainParams& params) {
    const auto smoother = std::make_unique<StrainSmoother<Lag>>(params);
    std::vector<Pose> out;
    for (const auto& pose : raw)
        if (const auto y = smoother->push(pose)) out.push_back(*y);
    while (const auto y = smoother->flush()) out.push_back(*y);
    return out;
}

template <std::size_t Lag>
bool check(const std::string& name, const std::vector<Pose>& raw, double step_s, double cutoff) {
    const auto label = name + " at " + std::to_string(static_cast<int>(cutoff)) + " Hz";
    const auto params =
        StrainParams::from_cutoff(static_cast<float>(cutoff), static_cast<float>(step_s), 1);
    if (!params || strain_lag(static_cast<float>(cutoff), static_cast<float>(step_s)) > Lag) {
        std::printf("FAIL %s: lag %zu is not the stated one\n", label.c_str(), Lag);
        return false;
    }
    const auto out = streamed<Lag>(raw, *params);
    const auto p = strain_positions(raw, cutoff, step_s);
    std::vector<Quaterniond> start;
    for (const auto& pose : out)
        if (pose.flags & flag::orientation_valid) start.push_back(to_double(pose.q_wb));
    const auto q = StrainOrientations(raw, cutoff, step_s).solve(start);
    double off_m = 0, off_rad = 0;
    std::size_t kp = 0, kq = 0;
    for (const auto& pose : out) {
        if (pose.flags & flag::position_valid)
            off_m = std::max(off_m, (to_double(pose.p_w_m) - p[kp++]).norm());
        if (pose.flags & flag::orientation_valid)
            off_rad = std::max(off_rad, angle_d(to_double(pose.q_wb), q[kq++]));
    }
    const bool ok = out.size() == raw.size() && kp == p.size() && kq == q.size() &&
                    off_m <= position_limit_m && off_rad <= orientation_limit_rad;
    std::printf("%s %s: lag %zu, %zu positions within %.2g m, %zu orientations within %.2g rad\n",
                ok ? "ok" : "FAIL", label.c_str(), Lag, kp, off_m, kq, off_rad);
    std::fflush(stdout);
    return ok;
}

bool check_recording(const std::string& path) {
    const auto recording = sim::read_recording(path);
    const auto raw = admitted(recording.poses);
    const std::string name = sim::stem_of(path);
    bool ok = check<181>(name, raw, recording.period_s, 2);
    ok = check<73>(name, raw, recording.period_s, 5) && ok;
    return check<37>(name, raw, recording.period_s, 10) && ok;
}

}  // namespace
}  // namespace fairlead::test

int main(int argc, char** argv) {
    const std::filesystem::path folder = argc > 1 ? argv[1] : "../shared/recordings/tracker120";
    std::vector<std::string> files;
    if (std::filesystem::is_directory(folder)) {
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            if (entry.path().extension() == ".trk") files.push_back(entry.path().string());
    }
    if (files.empty()) {
        std::printf("skipped strain recordings: no .trk in %s\n", folder.c_str());
        return 0;
    }
    std::sort(files.begin(), files.end());
    bool ok = true;
    for (const auto& file : files) ok = fairlead::test::check_recording(file) && ok;
    return ok ? 0 : 1;
}
