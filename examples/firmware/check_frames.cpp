// Reads the bytes that the firmware sent, as a host on the other end of the UART would, and
// compares the decoded curves with the motion that the tracker saw.   usage: check_frames FILE
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

#include "examples/firmware/config.hpp"
#include "examples/firmware/motion.hpp"
#include "host_sim/curve_store.hpp"

namespace {

struct Worst {
    float m{0}, rad{0};
    bool covered{true};
};

/// Over the tracker's records.
Worst worst_error(const fairlead::sim::CurveStore& curves) {
    Worst worst;
    for (std::int64_t n = 0; n < motion::records; ++n) {
        const fairlead::Pose truth = motion::at(n * motion::step_ns), told = curves.at(truth.t_ns);
        const float m = norm(told.p_w_m - truth.p_w_m);
        const float rad = rotation_angle(told.q_wb, truth.q_wb);
        worst.m = m > worst.m ? m : worst.m;
        worst.rad = rad > worst.rad ? rad : worst.rad;
        worst.covered = worst.covered && told.flags == truth.flags;
    }
    return worst;
}

}  // namespace

int main(int argc, char** argv) {
    std::ifstream file{argc > 1 ? argv[1] : "", std::ios::binary};
    const std::string bytes{std::istreambuf_iterator<char>{file}, {}};
    fairlead::sim::CurveStore curves;
    curves.push(bytes);
    const auto& seen = curves.counters();
    const Worst worst = worst_error(curves);
    std::printf("%zu bytes, %u frames, %u damaged; worst error %.2f mm, %.3f deg\n", bytes.size(),
                seen.frames, seen.damaged, static_cast<double>(worst.m) * 1e3,
                static_cast<double>(worst.rad) * 57.29578);
    // sqrt(3) tolerances per axis, and what the filter itself takes off a motion of this speed
    const auto params = Config::params().encoder;
    const float limit_m = 1.8f * params.tol_position_m[0];
    const float limit_rad = 1.2f * params.tol_orientation_rad;
    const bool fine =
        seen.damaged == 0 && worst.covered && worst.m < limit_m && worst.rad < limit_rad;
    std::puts(fine ? "ok the frames tell the motion" : "FAIL the frames do not tell the motion");
    return fine ? 0 : 1;
}
