#pragma once
// Motions with a known truth, for attitude: hands, walkers, runners, drones, vehicles, turntables.
// Every motion is a function of its plan and seed alone. Lengths in m, times in s, angles in rad;
// q takes the body to east-north-up.
#include <string>
#include <vector>

#include "fairlead/math/quat.hpp"
#include "host_sim/generate/random.hpp"

namespace fairlead::sim {

using V3 = BasicVec3<double>;
using Q4 = BasicQuat<double>;

struct MotionPlan {
    std::string kind;          // motion_kinds() names them
    double seconds{120};       //
    double turn_deg_s{1.5};    // turntable: the steady rate
    double radius_m{3};        // circle
    double rate_hz_max{0.25};  // drone: highest frequency of its velocity
};

struct Motion {
    double rate_hz{};  // of the vectors below
    std::vector<Q4> q_wb;
    std::vector<V3> p_m;
    std::vector<V3> shake_m_s2;     // acceleration beside that of p: heel strikes; or empty
    std::vector<double> speed_m_s;  // along `forward`; vehicles and walkers, else empty
    std::vector<std::uint8_t> moving;
    V3 forward{};  // body axis of the speed
};

const std::vector<std::string>& motion_kinds();

/// Throws BadSpec for an unknown kind.
Motion make_motion(const MotionPlan& plan, Random& random, double rate_hz);

}  // namespace fairlead::sim
