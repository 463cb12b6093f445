#pragma once
// Where a body will be, from its last two poses, however they were filtered. A filter that keeps a
// rate of its own predicts better: AdaptivePoseFilter::predict (smooth/adaptive.hpp).
#include <cstdint>

#include "fairlead/base/types.hpp"
#include "fairlead/smooth/space.hpp"

namespace fairlead {

/// The pose at t_ns if the rates between `older` and `newer` stay as they are. Of exact poses h
/// apart under constant acceleration a (angular: about one axis) the error, dt after the newer one,
/// is a dt (dt + h) / 2. Valid: what is valid in both and has no gap between.
inline Pose predicted(const Pose& older, const Pose& newer, std::int64_t t_ns) noexcept {
    Pose out{t_ns, {}, {}, 0};
    if (newer.t_ns <= older.t_ns || (newer.flags & flag::gap_before)) return out;
    const float ratio =
        static_cast<float>(t_ns - newer.t_ns) / static_cast<float>(newer.t_ns - older.t_ns);
    const std::uint32_t valid = older.flags & newer.flags;
    const auto extended = [ratio](auto space, const auto& from, const auto& to) {
        using Space = decltype(space);
        return Space::moved(to, ratio * Space::step(from, to));
    };
    if ((valid & flag::orientation_valid) && !(newer.flags & flag::orientation_gap)) {
        out.q_wb = extended(detail::OrientationSpace<float>{}, older.q_wb, newer.q_wb);
        out.flags |= flag::orientation_valid;
    }
    if ((valid & flag::position_valid) && !(newer.flags & flag::position_gap)) {
        out.p_w_m = extended(detail::PositionSpace<float>{}, older.p_w_m, newer.p_w_m);
        out.flags |= flag::position_valid;
    }
    return out;
}

}  // namespace fairlead
