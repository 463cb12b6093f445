#pragma once
// Strain smoothing of positions [Hsieh et al. 1998, eq. (22)], exact, one elimination.
//
//   minimise  sum |p_i - y_i|^2 + lambda sum |s_{i+1} - s_i|^2 / tbar_i,
//   s_i = (p_i - p_{i-1}) / t_i,  tbar_i = (t_i + t_{i+1}) / 2,  t_i the time steps over the
//   nominal
// one: the paper's sums at even steps (over 1..n-2, as they must run), the trapezoid rule for the
// strain integral at uneven ones.
//
// Deviation: no gradient descent, and no pentadiagonal matrix either. The unknown is the CORRECTION
// u = p - y, and it is eliminated sample by sample in the pair (u_i, slope of u): the quadratic
// cost of everything up to sample i as a function of that pair is a 2 x 2 matrix and a vector. In
// these terms nothing cancels, where the pivots of I + lambda D^T D lose all digits of float32 at
// low cut-offs (a 1 m motion: millimetres); no refinement step is needed. The forward pass depends
// on the past alone: a stream keeps it for ever, exactly, in constant work a sample.
//
// Cost: about 50 flops and one division a sample forwards, 20 back.
#include "fairlead/base/types.hpp"
#include "fairlead/math/vec.hpp"

namespace fairlead::detail {

template <class Real>
class StrainPosition {
    using V = BasicVec3<Real>;

  public:
    /// A sample, and the cost of its segment up to it:
    /// a |u|^2 + 2 b u.s + c |s|^2 + 2 p.u + 2 q.s, with s the slope of u into the sample.
    struct Node {
        V y{};      // measured
        V slope{};  // of y into this sample, a nominal step
        V p{}, q{};
        V bend{};  // change of slope at this sample, once the next one is known
        Real a{1}, b{}, c{};
        Real step{1};   // into this sample, in nominal steps
        Real gain{};    // 1 / (c + weight)
        Real weight{};  // of the change of slope at this sample: lambda / tbar
        bool first{true};
    };
    /// The correction at a sample, and its slope into it.
    struct State {
        V u{}, s{};
    };

    /// The first sample of a segment.
    static constexpr Node start(const V& y) noexcept {
        Node node;
        node.y = y;
        return node;
    }

    /// The next one, `step` nominal steps later; completes `before`.
    static constexpr Node next(Node& before, const V& y, Real step, Real lambda) noexcept {
        Node node;
        node.first = false;
        node.y = y;
        node.step = step;
        node.slope = (1 / step) * (y - before.y);
        Real a = before.a, b = 0, c = 0;
        V p = before.p, q{};
        if (!before.first) {
            before.weight = 2 * lambda / (before.step + step);
            before.gain = 1 / (before.c + before.weight);
            before.bend = node.slope - before.slope;
            const Real w = before.gain * before.weight;
            a -= before.gain * before.b * before.b;
            b = w * before.b;
            c = w * before.c;
            p += before.gain * before.b * (before.weight * before.bend - before.q);
            q = w * (before.c * before.bend + before.q);
        }
        node.a = a + 1;
        node.b = b - step * a;
        node.c = c - step * b - step * node.b;
        node.p = p;
        node.q = q - step * p;
        return node;
    }

    /// The correction at the last sample of a segment, or of what is known of it.
    static constexpr State last(const Node& node) noexcept {
        const Real det = node.a * node.c - node.b * node.b;
        if (node.first || !(det > 0)) return {(-1 / node.a) * node.p, {}};
        return {(-1 / det) * (node.c * node.p - node.b * node.q),
                (-1 / det) * (node.a * node.q - node.b * node.p)};
    }

    /// From the sample after `node` to `node`.
    static constexpr State back(const Node& node, const Node& after, const State& state) noexcept {
        State out;
        out.u = state.u - after.step * state.s;
        if (!node.first)
            out.s = node.gain * (node.weight * (state.s + node.bend) - node.b * out.u - node.q);
        return out;
    }
};

}  // namespace fairlead::detail
