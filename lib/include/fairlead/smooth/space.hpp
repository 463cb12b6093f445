#pragma once
// What filters need to know of a channel's space: the step from one value to the next, a value
// moved by a step, and the true size of a step. Steps are vectors, so that a filter may weigh and
// add them: that is the transformation between angular and linear signals of [Lee & Shin 2002].
#include "fairlead/base/types.hpp"
#include "fairlead/math/quat.hpp"

namespace fairlead::detail {

/// Steps are half-angle vectors in the body frame, the short way round.
template <class Number>
struct OrientationSpace {
    using Real = Number;
    using Value = BasicQuat<Real>;
    using Step = BasicVec3<Real>;
    static Value continued(const Value& from, const Value& to) noexcept {
        return same_side(from, to);
    }
    static Step step(const Value& from, const Value& to) noexcept { return log(conj(from) * to); }
    static Value moved(const Value& from, const Step& by) noexcept { return from * exp(by); }
    static Real size(const Step& step) noexcept { return 2 * norm(step); }  // rad
};

template <class Number>
struct PositionSpace {
    using Real = Number;
    using Value = BasicVec3<Real>;
    using Step = BasicVec3<Real>;
    static Value continued(const Value&, const Value& to) noexcept { return to; }
    static Step step(const Value& from, const Value& to) noexcept { return to - from; }
    static Value moved(const Value& from, const Step& by) noexcept { return from + by; }
    static Real size(const Step& step) noexcept { return norm(step); }  // m
};

}  // namespace fairlead::detail
