#pragma once
// From the pieces of a stream's tracks to the spans of a channel: a span goes from one vertex of
// any axis to the next of any. Pieces come track by track, a frame at a time.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/ring.hpp"
#include "fairlead/wire/decoder.hpp"
#include "port/linux/registers_curve.hpp"

namespace fairlead::gateway {

class SpanMaker {
  public:
    explicit SpanMaker(port::CurveChannel channel) noexcept
        : channel_{channel}, tracks_{channel == port::CurveChannel::position ? 3u : 1u} {}

    /// The pieces of one frame fit; where other tracks lack theirs, the oldest one gives way.
    void take(const wire::CurvePiece& piece) noexcept {
        if (piece.axis >= tracks_) return;
        if (piece.start == piece.end && !piece.begins) return;  // tells only that a curve ended
        auto& track = track_[piece.axis];
        if (track.full()) track.pop();
        track.push(piece);
    }
    /// @return false: none is complete.
    bool next(const curve::Grid& grid, port::CurveSpan& span) noexcept;
    void clear() noexcept {
        for (auto& track : track_) track.clear();
        joined_ = point_told_ = false;
    }

  private:
    // a frame has at most 255 ticks, and at most 1,976 bits for jumps of 16 bits and more
    static constexpr std::size_t pieces_max = 512;

    const wire::CurvePiece& front(std::size_t track) const noexcept {
        return track_[track].oldest();
    }
    bool align(std::int64_t& start) noexcept;
    void fill(const curve::Grid& grid, std::int64_t start, std::int64_t end, bool at_start,
              port::CurveSpan& span) const noexcept;

    port::CurveChannel channel_;
    std::size_t tracks_;
    std::array<Ring<wire::CurvePiece, pieces_max>, 3> track_{};
    std::int64_t end_{0};     // of the span before, in sub-ticks
    bool joined_{false};      // there is one
    bool point_told_{false};  // the value at a curve's start was told by a span of its own
};

}  // namespace fairlead::gateway
