#pragma once
// Which part of a frame belongs to a channel's curve, and how much of that lies in a part of the
// frame.
#include <cstdint>

#include "fairlead/base/compiler.hpp"

namespace fairlead::reduce {

/// A stretch of a frame, in ticks: [from, to]; last: it ends where the frame does.
struct Stretch {
    std::int32_t from{}, to{};
    bool last{};
};

struct Extent {
    std::int32_t start_tick{};  // in the frame; other than 0 only where `starts`
    std::int32_t end_tick{};    // in the frame; before its end only where `ends`
    bool present{};             // false: the channel has no curve in this frame
    bool starts{};              // a new curve: nothing is known before
    bool ends{};                // the curve ends at end_tick

    /// The same of a stretch of the frame, still in ticks of the frame. A curve that begins where a
    /// stretch ends belongs to the next one; a curve that ends there does not.
    constexpr Extent within(const Stretch& s) const noexcept {
        Extent part;
        const bool point = start_tick == end_tick && start_tick >= s.from;
        part.present = present && (end_tick > s.from || point) && (start_tick < s.to || s.last);
        if (!part.present) return part;
        part.start_tick = start_tick > s.from ? start_tick : s.from;
        part.end_tick = end_tick < s.to ? end_tick : s.to;
        part.starts = starts && start_tick >= s.from;
        part.ends = ends && end_tick <= s.to;
        return part;
    }
};

/// Part of the tolerance that the steps of a frame use which leaves as exact steps: a lattice value
/// is always as near as that, and what float places lose beside it is less than the rest.
inline constexpr float exact_part = 0.95f;

}  // namespace fairlead::reduce
