#pragma once
// Strain smoothing of a whole recording at once [Hsieh et al. 1998]; what it minimises, and how:
// smooth/strain.hpp, the same for streams. Bridges records in which a channel is invalid, however
// many; gap flags start a segment anew.
//
// Cost: per record, 70 flops and one division for the position; 500 flops, two logs and an exp for
// each step of an orientation. RAM: about 320 bytes a record.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/types.hpp"
#include "fairlead/smooth/strain_orientation.hpp"
#include "fairlead/smooth/strain_position.hpp"
#include "fairlead/smooth/strain_weight.hpp"

namespace fairlead {

/// Smooths up to N records at once. Large: keep it static, or on the heap of a host.
template <std::size_t N>
class StrainBuffer {
    using Position = detail::StrainPosition<float>;
    using Orientation = detail::StrainOrientation<float>;

  public:
    /// n <= N records of `in` into `out`, which may be the same place.
    void smooth(const Pose* in, Pose* out, std::size_t n, const StrainParams& params) noexcept {
        FAIRLEAD_ASSERT(n <= N && check(params));
        for (std::size_t i = 0; i < n; ++i) out[i] = in[i];
        smooth_positions(out, n, params.position);
        smooth_orientations(out, n, params.orientation, params.steps);
    }

  private:
    void smooth_positions(Pose* poses, std::size_t n, const StrainWeight& weight) noexcept {
        constexpr std::uint32_t gap = flag::gap_before | flag::position_gap;
        std::size_t m = 0;
        bool anew = true;
        for (std::size_t i = 0; i < n; ++i) {
            const Pose& pose = poses[i];
            anew = anew || (pose.flags & gap);
            if (!(pose.flags & flag::position_valid)) continue;
            positions_[m] = anew ? Position::start(pose.p_w_m)
                                 : Position::next(positions_[m - 1], pose.p_w_m,
                                                  detail::nominal_steps(poses[origin_[m - 1]].t_ns,
                                                                        pose.t_ns, weight.step_s()),
                                                  weight.lambda());
            origin_[m++] = i;
            anew = false;
        }
        typename Position::State state;
        for (std::size_t i = m; i-- > 0;) {
            const bool ends = i + 1 == m || positions_[i + 1].first;
            state = ends ? Position::last(positions_[i])
                         : Position::back(positions_[i], positions_[i + 1], state);
            poses[origin_[i]].p_w_m = positions_[i].y + state.u;
        }
    }

    void smooth_orientations(Pose* poses, std::size_t n, const StrainWeight& weight,
                             std::size_t steps) noexcept {
        constexpr std::uint32_t gap = flag::gap_before | flag::orientation_gap;
        std::size_t m = 0;
        bool anew = true;
        for (std::size_t i = 0; i < n; ++i) {
            const Pose& pose = poses[i];
            anew = anew || (pose.flags & gap);
            if (!(pose.flags & flag::orientation_valid)) continue;
            orientations_[m] =
                anew ? Orientation::node(pose.q_wb, nullptr, 1)
                     : Orientation::node(pose.q_wb, &orientations_[m - 1],
                                         detail::nominal_steps(poses[origin_[m - 1]].t_ns,
                                                               pose.t_ns, weight.step_s()));
            origin_[m++] = i;
            anew = false;
        }
        for (std::size_t i = 0; i < m;) {
            const std::size_t end = detail::segment_end(orientations_, i, m);
            const auto at = [ this, i ](std::size_t j) -> auto& { return orientations_[i + j]; };
            Orientation::solve(at, end - i, weight.lambda(), steps);
            i = end;
        }
        for (std::size_t i = 0; i < m; ++i) {
            Pose& pose = poses[origin_[i]];
            pose.q_wb = same_side(pose.q_wb, orientations_[i].now);
        }
    }

    std::array<Position::Node, N> positions_{};
    std::array<Orientation::Node, N> orientations_{};
    std::array<std::size_t, N> origin_{};  // the record of each node
};

}  // namespace fairlead
