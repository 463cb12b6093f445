#pragma once
// The rotation primitives that every later stage is built of.
#include "fairlead/math/quat.hpp"
#include "tests/target/subject.hpp"

struct Subject {
    static constexpr const char* text = "log, exp, slerp, rotate, rotation_angle, one of each";
    static constexpr unsigned latency = 0;
    static constexpr bool takes_samples = false;
    static constexpr bool takes_anything = false;
    struct Output {
        fairlead::Vec3 log, turned;
        fairlead::Quat exp, between;
        float angle;
    };
    fairlead::Quat before{};

    std::optional<Output> push(const fairlead::target::Record& in) {
        const fairlead::Quat& q = in.pose.q_wb;
        Output out;
        out.log = fairlead::log(conj(before) * q);
        out.exp = fairlead::exp(out.log);
        out.between = fairlead::slerp(before, q, 0.25f);
        out.turned = fairlead::rotate(q, in.pose.p_w_m);
        out.angle = fairlead::rotation_angle(before, q);
        before = q;
        return out;
    }
    std::optional<Output> flush() { return std::nullopt; }
};

inline void mix(fairlead::target::Digest& d, const Subject::Output& out) {
    using fairlead::target::mix;
    mix(d, out.log);
    mix(d, out.turned);
    mix(d, out.exp);
    mix(d, out.between);
    mix(d, out.angle);
}
