#include "examples/gateway/span_maker.hpp"

#include <algorithm>

namespace fairlead::gateway {
namespace {

/// Coefficients of a piece's polynomial about a later time, in lattice steps and ticks.
std::array<double, 4> about(const wire::CurvePiece& piece, std::size_t component,
                            std::int64_t start) noexcept {
    const double t = static_cast<double>(start - piece.start) / curve::subs_per_tick;
    const auto p = piece.polynomial<double>(component);
    const auto v = static_cast<double>(piece.v[component]);
    return {v + p.rise(t), p.rate(t), p.c2 + 3 * p.c3 * t, p.c3};
}

}  // namespace

/// Leaves at the front of each track the piece that holds behind `start`. @return false: a track
/// has none.
bool SpanMaker::align(std::int64_t& start) noexcept {
    for (bool moved = true; moved;) {
        moved = false;
        for (std::size_t k = 0; k < tracks_; ++k) {
            if (track_[k].empty()) return false;
            start = std::max(start, front(k).start);
        }
        for (std::size_t k = 0; k < tracks_; ++k) {
            const bool over = front(k).end < start ||
                              (front(k).end == start && front(k).start < start) ||
                              (front(k).end == start && point_told_ && start == end_);
            if (!over) continue;
            track_[k].pop();
            moved = true;
        }
    }
    return true;
}

bool SpanMaker::next(const curve::Grid& grid, port::CurveSpan& span) noexcept {
    std::int64_t start = joined_ ? end_ : INT64_MIN;
    if (!align(start)) return false;
    bool begins = !joined_ || start != end_, point = false;
    std::int64_t end = INT64_MAX;
    for (std::size_t k = 0; k < tracks_; ++k) {
        const auto& piece = front(k);
        const bool first = piece.begins && piece.start == start;
        begins = begins || first;
        // a curve of one vertex, or one that begins with a jump: another value at its start alone
        point = point || (first && (piece.jumps || piece.end == piece.start));
        end = std::min(end, piece.end);
    }
    if (joined_ && start == end_ && point_told_) begins = point = false;
    span = {};
    span.channel = channel_;
    span.begins = begins;
    point_told_ = point;
    if (point) end = start;
    fill(grid, start, end, point, span);
    end_ = end;
    joined_ = true;
    return true;
}

void SpanMaker::fill(const curve::Grid& grid, std::int64_t start, std::int64_t end, bool at_start,
                     port::CurveSpan& span) const noexcept {
    span.t0_ns = grid.time_ns(start);
    span.sub_ns = grid.sub_ns;
    span.cover = static_cast<std::uint32_t>(end - start);
    if (tracks_ == 1) span.anchor = front(0).anchor;
    const double per_s = 1e9 / static_cast<double>(grid.tick_ns());
    for (std::size_t c = 0; c < 3; ++c) {
        const auto& piece = front(tracks_ == 1 ? 0 : c);
        const std::size_t component = tracks_ == 1 ? c : 0;
        std::array<double, 4> y{};
        if (!at_start || piece.start != start)
            y = about(piece, component, start);
        else
            y[0] = piece.steps_at<double>(0, component);
        double unit = piece.scale.step();
        for (std::size_t k = 0; k < 4; ++k, unit *= per_s) {
            Vec3& power = span.power[k];
            (c == 0 ? power.x : c == 1 ? power.y : power.z) = static_cast<float>(y[k] * unit);
        }
    }
}

}  // namespace fairlead::gateway
