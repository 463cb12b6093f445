#pragma once
// Search for C2 cubics: a beam over the records of a frame, for an axis or for three components
// that share their vertices.
//
// Each vertex that is kept goes on by all lengths whose intervals of third derivatives, running
// over the samples, are not empty. A C2 piece decides more than the samples under it: its control
// point lies h behind its end. So the beam is ordered by bits and by how far the last two control
// points are from those of the samples around them, as far as they are known.
#include "host_sim/study/bench_cubics/samples.hpp"
#include "host_sim/study/bench_cubics/tables.hpp"

namespace fairlead::sim::cubics {

struct SearchParams {
    std::size_t width{5};        // vertices kept at a record
    std::size_t values{4};       // control points tried for a length
    double control_weight{1.1};  // bits for a control point one step off
    double vertex_weight{0.6};   // the same, of the one at the vertex
    double break_bits{40};       // price of a break, beside what it costs
    double margin_bits{40};      // dearer vertices are dropped
    std::int32_t look{1000};     // ticks that a vertex sees ahead
    int repeats{1};              // of a frame that would break: four times as wide
    double piece_bits{-1};       // 0 or more: what each piece counts instead of its bits
    float chart_rad{1};          // a rotation changes its chart behind a vertex farther out
};

/// Where a track stands: an axis, or three components, about an anchor where they turn.
template <std::size_t N>
struct Place {
    State<N> chart{};
    Quat anchor{};
};

/// Moves the anchor to where the rotation is. @return false: out of bounds.
bool rebase(Place<3>& place, double step);
/// The same where it is farther from its anchor than `chart_rad`, and no run is open.
template <std::size_t N>
bool settle(Place<N>& place, bool rotates, double step, float chart_rad);
/// Begins a run about a rotation of the grid.
bool begin_run(Place<3>& place, const curve::GridQuat& anchor, double step);

/// The stretch that a search is about.
struct Stretch {
    std::int32_t from{}, to{};  // ticks: the first vertex, and where the pieces must end
    std::int32_t known{};       // the last tick whose sample may be looked at, at least `to`
    double radius{};            // tolerance in steps
    std::int32_t commit{
        -1};  // 0 or more: pieces may end behind `to`; those behind this are dropped
};

template <std::size_t N>
struct Found {
    std::vector<Piece<N>> pieces;  // in order; there always are some for an axis
    curve::GridQuat anchor{};      // of a rotation's run
};

/// Pieces from `start`. A rotation with an open run chooses its anchor: `start` stands behind
/// rebase(), restarted, and begin_run() is not called yet.
template <std::size_t N>
Found<N> search(const Subject<N>& subject, const Place<N>& start, const Stretch& stretch,
                const Costs& costs, const SearchParams& params);

}  // namespace fairlead::sim::cubics
