#pragma once
// Finds the pieces of segments.hpp: from a decoded value at record a, how far does one reach?
#include "host_sim/study/baselines/compress/segments.hpp"

namespace fairlead::sim {

/// Value of a piece that starts with `from` at record a, at record i in (a, segment.end].
State value_of(const Chart& chart, Pieces pieces, const State& from, std::size_t a,
               const Segment& segment, std::size_t i, double grid);

class SegmentFitter {
  public:
    SegmentFitter(const Track& track, double tolerance, const SegmentParams& params);

    double grid() const { return grid_; }
    /// Pieces that cover the records a + 1 ... last; `speed` is the last piece's, in grid steps.
    std::vector<Segment> plan(std::size_t a, const State& from, std::size_t last, Step speed) const;

  private:
    Segment longest_swing(std::size_t a, const State& from, std::size_t last, Step speed) const;
    Segment longest_arc(std::size_t a, const State& from, std::size_t last, Step speed) const;
    Segment longest_door(std::size_t a, const State& from, std::size_t last) const;
    Segment longest_hold(std::size_t a, const State& from, std::size_t last) const;
    std::vector<Segment> split(std::size_t a, const State& from, std::size_t last) const;

    Step seen(const State& from, std::size_t i) const {
        return chart_.difference(from, chart_.sample(track_, i));
    }
    bool fits(std::size_t a, const State& from, const Segment& segment) const;
    bool fit_arc(std::size_t a, const State& from, const std::vector<Step>& steps,
                 Segment& segment) const;

    const Track& track_;
    Chart chart_;
    double tolerance_, grid_;
    const SegmentParams& params_;
};

}  // namespace fairlead::sim
