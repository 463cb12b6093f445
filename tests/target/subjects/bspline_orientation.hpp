#pragma once
// A cubic orientation curve over the newest four orientations: orientation, rate, acceleration.
#include "fairlead/math/orientation_spline.hpp"
#include "tests/target/subject.hpp"

template <class Real>
struct Curve {
    std::array<fairlead::BasicQuat<Real>, 4> newest{};

    fairlead::Turning<Real> push(const fairlead::Pose& pose) {
        for (std::size_t i = 0; i + 1 < newest.size(); ++i) newest[i] = newest[i + 1];
        const fairlead::Quat& q = pose.q_wb;
        newest.back() = {Real{q.w}, Real{q.x}, Real{q.y}, Real{q.z}};
        std::array<Real, 8> knots{};
        for (std::size_t i = 0; i < knots.size(); ++i) knots[i] = static_cast<Real>(i);
        fairlead::OrientationSpline<Real, 4, 4> spline;
        (void)spline.set(knots.data(), newest.data(), newest.size());
        return spline.at(static_cast<Real>(3.5));
    }
};

struct Subject {
    static constexpr const char* text =
        "OrientationSpline<float, 4, 4>: set, orientation, rate and acceleration";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = false;
    using Output = fairlead::Turning<float>;
    Curve<float> curve{};

    std::optional<Output> push(const fairlead::target::Record& in) { return curve.push(in.pose); }
    std::optional<Output> flush() { return std::nullopt; }
};

inline void mix(fairlead::target::Digest& d, const Subject::Output& out) {
    fairlead::target::mix(d, out.q);
    fairlead::target::mix(d, out.rate);
    fairlead::target::mix(d, out.acceleration);
}
