#include "host_sim/study/baselines/knots/sisl.hpp"

#include <fcntl.h>
#include <sisl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace fairlead::sim {
namespace {

constexpr unsigned seconds_max = 120;  // a call that takes longer has failed
constexpr int rounds_max = 20, order = 4, open_curve = 1;

Spline adopt(const SISLCurve& curve) {
    Spline out{static_cast<std::size_t>(curve.ik), static_cast<std::size_t>(curve.idim), {}, {}};
    const auto n = static_cast<std::size_t>(curve.in);
    out.knots.assign(curve.et, curve.et + n + out.order);
    out.c.assign(curve.ecoef, curve.ecoef + n * out.dim);
    return out;
}

SISLCurve* reduce(const Track& track, SislMethod method, double tolerance) {
    std::vector<double> x = track.x, t = track.t;
    std::vector<double> tolerances(track.dim(), tolerance), largest(track.dim());
    const int n = static_cast<int>(track.size()), dim = static_cast<int>(track.dim());
    int status = -1;
    SISLCurve* reduced = nullptr;
    if (method != SislMethod::s1940) {
        const int given_parameter = 3;
        s1961(x.data(), n, dim, given_parameter, t.data(), tolerances.data(), 0, 0, open_curve,
              method == SislMethod::s1961 ? 0.0 : 0.1, rounds_max, order, &reduced, largest.data(),
              &status);
        return status < 0 ? nullptr : reduced;
    }
    std::vector<int> ordinary_point(track.size(), 1);
    SISLCurve* interpolant = nullptr;
    double end = 0;
    double* parameters = nullptr;
    int parameter_count = 0;
    s1357(x.data(), n, dim, ordinary_point.data(), t.data(), 0, 0, open_curve, order, t[0], &end,
          &interpolant, &parameters, &parameter_count, &status);
    if (status < 0 || interpolant == nullptr) return nullptr;
    s1940(interpolant, tolerances.data(), 0, 0, open_curve, rounds_max, &reduced, largest.data(),
          &status);
    return status < 0 ? nullptr : reduced;
}

[[noreturn]] void child(const Track& track, SislMethod method, double tolerance, int out) {
    const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);  // the library prints on failure
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
    alarm(seconds_max);
    SislResult result;
    if (const SISLCurve* curve = reduce(track, method, tolerance); curve != nullptr) {
        const Spline spline = adopt(*curve);
        result = {spline.size(), largest_error(track, spline)};
    }
    const bool whole = write(out, &result, sizeof result) == sizeof result;
    _exit(whole ? 0 : 1);
}

}  // namespace

const char* to_string(SislMethod method) {
    switch (method) {
        case SislMethod::s1961: return "s1961";
        case SislMethod::s1961_shared: return "s1961 (0.1 for the linear stage)";
        case SislMethod::s1940: return "s1940";
    }
    return "";
}

SislResult sisl(const Track& track, SislMethod method, double tolerance) {
    int ends[2];
    if (pipe(ends) != 0) return {};
    const pid_t pid = fork();
    if (pid == 0) child(track, method, tolerance, ends[1]);
    close(ends[1]);
    SislResult result;
    if (pid < 0 || read(ends[0], &result, sizeof result) != sizeof result) result = {};
    close(ends[0]);
    if (pid > 0) waitpid(pid, nullptr, 0);
    return result;
}

}  // namespace fairlead::sim
