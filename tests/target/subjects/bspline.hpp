#pragma once
// A cubic through the newest positions: one knot more, then value, velocity and acceleration.
#include "fairlead/math/bspline.hpp"
#include "tests/target/subject.hpp"

template <class Real>
struct Curve {
    using Spline = fairlead::BSpline<Real, 4, 3, 9>;
    using Point = typename Spline::Point;
    std::array<Point, 8> newest{};  // control points, the newest last

    std::array<Point, 3> push(const fairlead::Pose& pose) {
        for (std::size_t i = 0; i + 1 < newest.size(); ++i) newest[i] = newest[i + 1];
        newest.back() = {Real{pose.p_w_m.x}, Real{pose.p_w_m.y}, Real{pose.p_w_m.z}};
        std::array<Real, 12> knots{};
        for (std::size_t i = 0; i < knots.size(); ++i) knots[i] = static_cast<Real>(i);
        Spline spline;
        (void)spline.set(knots.data(), newest.data(), newest.size());
        const auto phase = static_cast<std::int32_t>(pose.t_ns >> 10 & 0xFFFF);
        const Real t = 3 + 5 * static_cast<Real>(phase) / 65536;
        (void)spline.insert(t);
        return {spline.at(t), spline.at(t, 1), spline.at(t, 2)};
    }
};

struct Subject {
    static constexpr const char* text =
        "BSpline<float, 4, 3, 9>: set, insert a knot, value and two derivatives";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = false;
    using Output = std::array<std::array<float, 3>, 3>;
    Curve<float> curve{};

    std::optional<Output> push(const fairlead::target::Record& in) { return curve.push(in.pose); }
    std::optional<Output> flush() { return std::nullopt; }
};
