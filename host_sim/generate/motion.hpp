#pragma once
// 6-DOF motions with known truth: rests, min-jerk reaches (Flash and Hogan 1985), oscillations,
// fast turns, teleports. Every motion starts and ends at rest, so position, velocity and
// acceleration are continuous but for teleports, and all derivatives are exact. In double, on the
// library's own elementary functions: the same bits on every compiler.
#include <cstdint>
#include <vector>

#include "fairlead/math/quat.hpp"
#include "host_sim/generate/random.hpp"

namespace fairlead::sim {

using Vec3d = BasicVec3<double>;
using Quatd = BasicQuat<double>;

struct MotionState {
    Vec3d p_w_m{}, accel_w_m_s2{};
    Quatd q_wb{};
    Vec3d rate_b_rad_s{};
    bool moving{false};
};

class Motion {
  public:
    explicit Motion(Random random) : random_{random} {}

    void rest(double s);
    /// To a random place within `reach_m` of the origin, turning by at most `turn_rad`.
    void reach(double s, double reach_m, double turn_rad);
    /// About the present pose, in a random direction and about two random axes.
    void oscillate(double s, double hz, double amplitude_m, double amplitude_rad);
    /// About one random axis, with the given largest rate.
    void turn(double s, double peak_rad_s);
    /// At once, between two records.
    void jump(double by_m, double by_rad);

    double duration_s() const { return end_s_; }
    /// t_s in [0, duration_s()]; clamped outside.
    MotionState at(double t_s) const;

  private:
    struct Segment {
        double start_s{}, duration_s{};
        Vec3d p{};     // at the start
        Quatd q{};     // at the start
        Vec3d move{};  // reach: displacement; oscillation: amplitude
        Vec3d axis{}, second_axis{};
        double angle{};
        double hz{};  // oscillation only
    };
    Segment& append(double duration_s);
    void finish(const Segment& segment);  // the next segment starts where this one ends

    Random random_;
    std::vector<Segment> segments_;
    double end_s_{};
    Vec3d p_{};
    Quatd q_{};
};

}  // namespace fairlead::sim
