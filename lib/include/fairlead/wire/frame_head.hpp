#pragma once
// The first symbols of a data frame: the time that it covers, and whether a reader may join at it.
//
// A frame covers the sub-ticks from `start` to `end`. It usually starts where the frame before
// ended and lasts the usual number of ticks. A restart frame also tells its end absolutely, by its
// lowest bits; the check of the next frame vouches for the rest. In a stream of independent frames
// each frame tells its start so. docs/stream.md, Frame head.
#include <cstdint>

#include "fairlead/code/range_coder.hpp"
#include "fairlead/wire/header.hpp"

namespace fairlead::wire {

inline constexpr std::int64_t sub_per_tick = 64;
/// Ticks of a frame at most: what a piece may last (curve/lengths.hpp).
inline constexpr std::uint32_t frame_ticks_max = 255;
/// The longest pause between two frames of a run, in sub-ticks; beyond it a new run begins.
inline constexpr std::int64_t jump_max = std::int64_t{1} << 44;
/// A reader that joins tries so many times that have the low bits that it was told; for those
/// beyond the first `unwraps_near` it asks for one check more.
inline constexpr int unwraps = 64, unwraps_near = 4;
/// Sub-ticks of a run at most, on both sides of its base.
inline constexpr std::int64_t run_max = std::int64_t{1} << 56;

struct FrameHead {
    std::int64_t start{0}, end{0};  // sub-ticks since the run's base
    bool restart{false};  // a reader may join at its end, by the absolute values that it carries
};

/// Is the frame behind `since` others likely a restart frame?
constexpr bool restart_due(const FrameTiming& timing, std::uint8_t since) noexcept {
    return timing.restart_frames > 0 && since + 1u >= timing.restart_frames;
}

namespace detail {

/// The time with these low bits, in ticks, that lies at `from` or next behind it; both sub-ticks of
/// the same phase.
constexpr std::int64_t unwrap(std::uint32_t low, unsigned bits, std::int64_t from) noexcept {
    const std::int64_t ticks = (from + sub_per_tick - 1) >> 6;
    const auto ahead = static_cast<std::uint32_t>(low - static_cast<std::uint32_t>(ticks));
    return (ticks + (bits < 32 ? ahead & ((1u << bits) - 1u) : ahead)) * sub_per_tick;
}

/// A time by its low bits: 1 flag and 6 bits of phase within the tick, `bits` of ticks.
template <class Io>
constexpr void code_time(Io& io, std::int64_t& time, unsigned bits, std::int64_t from) noexcept {
    auto sub = static_cast<std::uint32_t>(static_cast<std::uint64_t>(time) & 63u);
    bool off = sub != 0;
    io.flag(off, 1, 4);
    if (off) io.bits(sub, 6);
    if (!off) sub = 0;
    auto low = static_cast<std::uint32_t>(static_cast<std::uint64_t>(time) >> 6);
    if (bits < 32) low &= (1u << bits) - 1u;
    io.bits(low, bits);
    if (!Io::writes) time = unwrap(low, bits, from - sub) + sub;
}

/// Whether the frame is a restart frame: mostly when one is due.
template <class Io>
constexpr void code_restart(Io& io, bool& restart, bool due, bool joining) noexcept {
    bool unusual = restart != due;
    io.flag(unusual, 1, 4);
    restart = joining || unusual != due;
}

/// Ticks of the frame: usual, or the difference as a signed number.
template <class Io>
constexpr bool code_ticks(Io& io, std::uint32_t& ticks, std::uint32_t usual) noexcept {
    bool same = ticks == usual;
    io.flag(same, 7, 3);
    if (same) {
        ticks = usual;
        return true;
    }
    // fewer are likelier: twice the number of missing ticks, or twice the surplus less one
    std::uint32_t v = ticks < usual ? 2 * (usual - ticks) : 2 * (ticks - usual) - 1;
    if (!code::exp_golomb(io, v, 2)) return false;
    if ((v & 1u) != 0 ? v / 2 + 1 > frame_ticks_max : v == 0 || v / 2 > usual) return false;
    ticks = (v & 1u) != 0 ? usual + v / 2 + 1 : usual - v / 2;
    return true;
}

/// Sub-ticks from the end of the frame before to this frame's start, mostly none.
template <class Io>
constexpr bool code_jump(Io& io, std::int64_t& jump) noexcept {
    bool jumps = jump != 0;
    io.flag(jumps, 1, 5);
    if (!jumps) {
        jump = 0;
        return true;
    }
    auto high = static_cast<std::uint32_t>(jump >> 16);
    auto low = static_cast<std::uint32_t>(jump & 0xffff);
    if (!code::exp_golomb(io, high, 0) || (static_cast<std::int64_t>(high) << 16) >= jump_max)
        return false;
    io.bits(low, 16);
    jump = (static_cast<std::int64_t>(high) << 16) + low;
    return jump > 0;
}

}  // namespace detail

/// Writes or reads the head. `before`: end of the frame before; `since`: frames since the latest
/// restart frame. A reader that does not know them (joining) gives the latest time that it knows to
/// have passed, and reads the frame as a restart frame, which tells its end, or as an independent
/// one, which tells both times. @return false: nonsense.
template <class Io>
constexpr bool code_head(Io& io, FrameHead& head, const FrameTiming& timing, std::int64_t before,
                         std::uint8_t since, bool joining = false) noexcept {
    auto ticks = static_cast<std::uint32_t>((head.end - head.start) / sub_per_tick);
    if (timing.independent)
        head.restart = true;
    else
        detail::code_restart(io, head.restart, restart_due(timing, since), joining);
    std::int64_t jump = head.start - before;
    if (!detail::code_jump(io, jump)) return false;
    if (!Io::writes) head.start = before + jump;
    if (!detail::code_ticks(io, ticks, timing.usual_ticks) || ticks > frame_ticks_max) return false;
    const std::int64_t length = ticks * sub_per_tick;
    if (!Io::writes) head.end = head.start + length;
    if (head.restart) {  // an independent frame tells its start, a restart frame its end
        const std::int64_t known = timing.independent ? head.start : head.end;
        std::int64_t told = known;
        detail::code_time(io, told, timing.time_bits, joining ? before : known);
        if (!Io::writes && !joining && told != known) return false;
        if (!Io::writes && timing.independent) head = {told, told + length, true};
        if (!Io::writes && !timing.independent) head = {told - length, told, true};
    }
    return io.ok() && head.end < run_max && head.start > -run_max;
}

}  // namespace fairlead::wire
