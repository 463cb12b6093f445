#include "host_sim/replay/attitude_smooth.hpp"

#include <algorithm>
#include <cmath>

#include "fairlead/sense/attitude.hpp"
#include "fairlead/sense/intake.hpp"
#include "host_sim/recording/progress.hpp"
#include "host_sim/recording/spec.hpp"

namespace fairlead::sim {
namespace {

using Q4 = BasicQuat<double>;
using V3 = BasicVec3<double>;

/// What one direction says of one sample's time.
struct Told {
    Q4 q_wb;
    double tilt{1}, heading{3};  // variances, rad^2
    std::uint32_t flags{flag::settling};
    bool known{false};
};

template <AttitudeMode mode>
class Smoother {
    using Filter = BasicAttitude<double, mode>;
    using State = typename Filter::State;
    static constexpr bool has_field = mode == AttitudeMode::imu_mag;

  public:
    Smoother(const std::vector<Sample>& samples, const AttitudeParams& params)
        : params_{params}, forward_{samples}, backward_{reversed(samples)} {}

    std::vector<Pose> run() {
        const auto first = pass(forward_, State{}, false);
        State known = found_;
        const auto back = pass(backward_, known, true);
        known = found_;
        const auto again = pass(forward_, known, true);
        return together(first, again, back);
    }

  private:
    /// Time runs the other way, and so does every turn. A reading is a mean over the interval
    /// before its stamp: seen from behind, over the interval that ends at the stamp of the one
    /// before.
    static std::vector<Sample> reversed(const std::vector<Sample>& samples) {
        std::vector<Sample> out;
        const std::int64_t end_ns = samples.back().t_ns + samples.front().t_ns;
        for (std::size_t i = samples.size(); i-- > 0;) {
            Sample s = samples[i];
            const bool gap = (s.flags & flag::gap_before) != 0;
            s.t_ns = end_ns - samples[i > 0 ? i - 1 : 0].t_ns;
            if (i == 0) s.t_ns += 1;
            s.gyro_rad_s = -s.gyro_rad_s;
            s.flags &= ~static_cast<std::uint32_t>(flag::gap_before);
            if (gap) s.flags |= flag::gap_before;
            out.push_back(s);
        }
        return out;
    }

    /// Bias, matrix and field as they were found, with the uncertainty of a start: nothing counts
    /// twice. The bias turns its sign with the time.
    State started_with(const State& known) const {
        Filter fresh{params_};
        State s = fresh.state();
        s.bias_rad_s = -known.bias_rad_s;
        s.gyro_matrix = known.gyro_matrix;
        s.still.rested = known.still.rested;
        return s;
    }

    std::vector<Told> pass(const std::vector<Sample>& samples, const State& known, bool use) {
        Filter filter{params_};
        if (use) filter.restore_all(started_with(known));
        std::vector<Told> out(samples.size());
        Progress progress{use ? "smooth, again" : "smooth, first of three passes", samples.size()};
        for (std::size_t i = 0; i < samples.size(); ++i) {
            progress.show(i);
            const auto pose = filter.push(samples[i]);
            if (!pose || (pose->flags & flag::orientation_valid) == 0) continue;
            const State& s = filter.state();
            Told& t = out[i];
            t.known = s.phase == AttitudePhase::running;
            t.q_wb = s.q_wb;
            t.flags = pose->flags;
            t.tilt = (s.covariance(State::tilt, State::tilt) +
                      s.covariance(State::tilt + 1, State::tilt + 1)) /
                     2;
            if constexpr (has_field) t.heading = s.covariance(State::heading, State::heading);
        }
        found_ = filter.state();
        return out;
    }

    std::vector<Pose> together(const std::vector<Told>& first, const std::vector<Told>& again,
                               const std::vector<Told>& back) const {
        const std::size_t n = forward_.size();
        const auto ahead = [&](std::size_t i) { return again[i].known ? again[i] : first[i]; };
        // the state after the backward reading of sample i + 1 is the orientation at sample i
        const auto behind = [&](std::size_t i) { return i + 1 < n ? back[n - 2 - i] : Told{}; };
        // without a field both headings are relative, each to its own start
        double relative = 0;
        for (std::size_t i = 0; !has_field && i < n; ++i)
            if (ahead(i).known && behind(i).known) {
                relative = turn_of(behind(i).q_wb * conj(ahead(i).q_wb));
                break;
            }
        std::vector<Pose> out;
        for (std::size_t i = 0; i < n; ++i) {
            Told f = ahead(i), b = behind(i);
            b.q_wb = about_up(-relative) * b.q_wb;
            if (!f.known && !b.known) continue;
            const Told best = !b.known ? f : !f.known ? b : weighted(f, b);
            Pose pose;
            pose.t_ns = forward_[i].t_ns;
            pose.q_wb = {static_cast<float>(best.q_wb.w), static_cast<float>(best.q_wb.x),
                         static_cast<float>(best.q_wb.y), static_cast<float>(best.q_wb.z)};
            pose.flags = flag::orientation_valid |
                         (best.flags & (flag::settling | flag::rest | flag::mag_rejected));
            out.push_back(pose);
        }
        return out;
    }

    /// Tilt and heading by their own variances; relative headings count alike.
    static Told weighted(const Told& f, const Told& b) {
        const Q4 e = b.q_wb * conj(f.q_wb);
        const double turn = turn_of(e);
        const V3 tilt = rotation_vector(about_up(-turn) * e);
        const double w = f.tilt / std::max(f.tilt + b.tilt, 1e-12);
        const double h = has_field ? f.heading / std::max(f.heading + b.heading, 1e-12) : 0.5;
        Told out = f;
        out.q_wb = normalised(about_up(h * turn) *
                              from_rotation_vector(V3{w * tilt.x, w * tilt.y, 0}) * f.q_wb);
        out.flags = f.flags & b.flags;
        return out;
    }

    /// Rotation about the vertical, of a rotation of the world.
    static double turn_of(const Q4& e) {
        return 2 * std::atan2(std::copysign(1.0, e.w) * e.z, std::abs(e.w));
    }

    AttitudeParams params_;
    std::vector<Sample> forward_, backward_;
    State found_{};
};

}  // namespace

std::vector<Pose> smooth_attitude(const Recording& recording, AttitudeMode mode,
                                  const AttitudeParams& params) {
    if (mode == AttitudeMode::gyro) throw BadSpec("smoothing needs an accelerometer");
    Intake<Sample> intake;
    std::vector<Sample> samples;
    for (const Sample& raw : recording.samples)
        if (const auto sample = intake.push(raw)) samples.push_back(*sample);
    if (samples.empty()) throw BadData(recording.name + ": holds no IMU samples");
    if (mode == AttitudeMode::imu) return Smoother<AttitudeMode::imu>{samples, params}.run();
    return Smoother<AttitudeMode::imu_mag>{samples, params}.run();
}

}  // namespace fairlead::sim
