#pragma once
// The live pose of a source that has the poses themselves: rates are differences to the one before.
#include "examples/gateway/feed.hpp"
#include "fairlead/math/quat.hpp"
#include "port/linux/registers.hpp"

namespace fairlead::gateway {

class LivePose {
  public:
    void reset() noexcept { before_ = {}; }

    void show(const Pose& pose, UnitState& state) noexcept {
        namespace bit = port::registers::status_bit;
        struct Bit {
            flag::Bits of_pose;
            std::uint16_t of_unit;
        };
        constexpr std::array<Bit, 6> bits{{{flag::position_valid, bit::valid_position},
                                           {flag::orientation_valid, bit::valid_orientation},
                                           {flag::rest, bit::rest},
                                           {flag::settling, bit::settling},
                                           {flag::mag_rejected, bit::mag_rejected},
                                           {flag::clipped, bit::clipped}}};
        for (const Bit& b : bits) {
            const unsigned others = state.status & ~unsigned{b.of_unit};
            state.status =
                static_cast<std::uint16_t>((pose.flags & b.of_pose) ? others | b.of_unit : others);
        }
        const flag::Bits both = before_.flags & pose.flags;
        const float per_second = 1e9f / static_cast<float>(pose.t_ns - before_.t_ns);
        if (pose.flags & flag::position_valid) {
            state.p_w_m = pose.p_w_m;
            state.v_w_m_s = per_second * (pose.p_w_m - before_.p_w_m);
        }
        if (pose.flags & flag::orientation_valid) {
            state.q_wb = pose.q_wb;
            state.rate_rad_s = per_second * rotation_vector(conj(before_.q_wb) * pose.q_wb);
        }
        if (!(both & flag::position_valid)) state.v_w_m_s = {};
        if (!(both & flag::orientation_valid)) state.rate_rad_s = {};
        before_ = pose;
        state.source_ns = pose.t_ns;
    }

  private:
    Pose before_{};
};

}  // namespace fairlead::gateway
