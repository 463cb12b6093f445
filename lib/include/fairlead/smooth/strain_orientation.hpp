#pragma once
// Strain smoothing of orientations [Hsieh et al. 1998, eq. (23)]: Gauss-Newton in the tangent
// space, each step an exact block elimination.
//
//   minimise  F = sum |d_i|^2 + lambda sum |r_{i+1} - r_i|^2 / tbar_i,
//   d_i the rotation vector from the measurement to q_i, r_i = rotation vector(q_{i-1}^-1 q_i) /
//   t_i
// the body rate a nominal step (the sums over 1..n-2, as they must run).
//
// Deviation: no gradient descent. A sample's unknowns are its turn delta_i (world frame) and the
// change s_i of its rate r_i; they hang together by delta_i = delta_{i-1} + G_i s_i with
// G_i = t_i R_i J(r_i t_i), J the right Jacobian of the rotation group. The cost of all samples up
// to i is a quadratic in (delta_i, s_i), carried forwards like a square-root-free Kalman filter in
// information form: nothing cancels in float32 (smooth/strain_position.hpp). The data term's
// Jacobian is taken as the identity; the gradient stays exact, since it leaves d_i in place, and
// the steps stay good to |d|^2 / 12. A step that does not lower F is halved, at most three times,
// and then not taken; one below blind_rad is taken anyway.
//
// Cost of a step and sample: about 500 flops, two logs, one exp. In: neighbours closer than pi.
#include <cstddef>

#include "fairlead/base/types.hpp"
#include "fairlead/math/mat3.hpp"
#include "fairlead/math/quat.hpp"

namespace fairlead::detail {

/// Compensated sum: a long recording's cost keeps its digits.
template <class Real>
class LongSum {
  public:
    constexpr void add(Real x) noexcept {
        const Real y = x - lost_, t = sum_ + y;
        lost_ = (t - sum_) - y;
        sum_ = t;
    }
    constexpr Real value() const noexcept { return sum_; }

  private:
    Real sum_{0}, lost_{0};
};

template <class Real>
class StrainOrientation {
    using V = BasicVec3<Real>;
    using Q = BasicQuat<Real>;
    using M = BasicMat3<Real>;
    using S = BasicSym3<Real>;

  public:
    /// The cost up to a sample: x.Ax + 2 x.Bs + s.Cs + 2 p.x + 2 q.s, x its turn, s its rate
    /// change.
    struct Cost {
        S a{};
        M b{};
        S c{};
        V p{}, q{};
    };
    struct Node {
        Q raw{};        // measured
        Q now{};        // smoothed so far
        Q trial{};      // the candidate of the step under way
        V rate{};       // of now into this sample, a nominal step, body frame
        V off{};        // rotation vector from raw to now, world frame
        V turn{};       // the step's unknowns: the turn of this sample
        V rate_turn{};  // and the change of its rate
        M lead{};       // G: from the change of rate into this sample to its turn
        M back_x{};     // the rate change before the next one, as the backward pass has it:
        S back_s{};     //   s_i = back_s s_{i+1} + back_0 - back_x x_i
        V back_0{};
        Real step{1};  // into this sample, in nominal steps
        bool first{true};
    };
    /// What the samples before a window say about its first one: their cost, linearised at a point.
    struct Prior {
        Cost cost{};
        Q at{};
        V rate{};
        bool any{false};
    };

    /// A new sample, not yet smoothed; `before` is the sample before it in its segment, or null.
    static Node node(const Q& raw, const Node* before, Real step) noexcept {
        Node n;
        n.raw = n.now = normalised(raw);
        n.first = before == nullptr;
        n.step = step;
        if (before) n.rate = rate_of(before->now, n.now, step);
        return n;
    }

    /// Up to `steps` Gauss-Newton steps over one segment, or the known part of one. at(i) is node i
    /// of n. Returns the last cost.
    template <class At>
    static Real solve(const At& at, std::size_t n, Real lambda, std::size_t steps,
                      const Prior& prior = {}) noexcept {
        Real cost = cost_of(at, n, lambda, prior);
        for (std::size_t k = 0; k < steps; ++k) {
            eliminate(at, n, lambda, prior);
            Real part = 1;
            bool taken = false;
            for (int halving = 0; halving < 4 && !taken; ++halving, part /= 2) {
                try_step(at, n, part, prior);
                const Real trial = cost_of(at, n, lambda, prior);
                taken = trial <= cost + cost * rounding || negligible(at, n, part);
                if (taken) cost = trial;
            }
            if (!taken) {
                undo(at, n, prior);
                break;
            }
        }
        return cost;
    }

    /// What `leaving` and the samples before it say about `head`, the sample after it.
    static Prior hand_over(const Node& leaving, const Node& head, Real lambda,
                           const Prior& prior) noexcept {
        Prior out;
        Node passed = leaving;  // its gains are of no more use
        out.cost = onwards(arrival(leaving, prior), passed, head, lead_of(head), lambda);
        out.at = head.now;
        out.rate = head.rate;
        out.any = true;
        return out;
    }

  private:
    static constexpr Real rounding = static_cast<Real>(2e-6);  // of a cost: no loss is seen below
    static constexpr Real blind_rad = static_cast<Real>(1e-3);

    /// Is the step one that needs no proof? So near the minimum it is good to parts in a million,
    /// and what it gains may drown in the rounding of a cost that happened to come out low.
    template <class At>
    static bool negligible(const At& at, std::size_t n, Real part) noexcept {
        for (std::size_t i = 0; i < n; ++i)
            if (dot(at(i).turn, at(i).turn) * part * part > blind_rad * blind_rad) return false;
        return true;
    }

    static V rate_of(const Q& from, const Q& to, Real step) noexcept {
        return (1 / step) * rotation_vector(conj(from) * to);
    }

    /// The cost at the first sample of a window, its own measurement included.
    static Cost arrival(const Node& head, const Prior& prior) noexcept {
        Cost cost;
        if (prior.any) {
            const V x = rotation_vector(head.now * conj(prior.at)), s = head.rate - prior.rate;
            cost = prior.cost;
            cost.p += cost.a * x + cost.b * s;
            cost.q += transposed_times(cost.b, x) + cost.c * s;
        }
        return measured(cost, head);
    }
    static Cost measured(Cost cost, const Node& node) noexcept {
        cost.a = cost.a + S::diagonal(1);
        cost.p += node.off;
        return cost;
    }

    /// From the cost at `node` to that at `next`, without next's measurement. Leaves the gains of
    /// the backward pass in `node`.
    static Cost onwards(const Cost& cost, Node& node, const Node& next, const M& lead,
                        Real lambda) noexcept {
        Cost out;
        if (node.first) {
            out.a = cost.a;
            out.p = cost.p;
        } else {
            const Real weight = 2 * lambda / (node.step + next.step);
            const S inv = inverse(cost.c + S::diagonal(weight));
            const V bend = next.rate - node.rate;
            const M gain = cost.b * inv;
            node.back_s = weight * inv;
            node.back_x = transposed(gain);
            node.back_0 = inv * (weight * bend - cost.q);
            out.a = cost.a - symmetric_product(gain, cost.b);
            out.b = weight * gain;
            out.c = weight * symmetric_product(inv, cost.c);
            out.p = cost.p + gain * (weight * bend - cost.q);
            out.q = weight * (inv * (cost.c * bend + cost.q));
        }
        const M lead_t = transposed(lead), b_t = transposed(out.b);
        out.b = out.b - out.a * lead;
        out.c =
            out.c - symmetric_product(b_t, lead_t) - symmetric_product(lead_t, transposed(out.b));
        out.q = out.q - transposed_times(lead, out.p);
        return out;
    }

    /// t R J(r t), the right Jacobian by its series; exact to rounding below 1 rad a step.
    static M lead_of(const Node& node) noexcept {
        const V v = node.step * node.rate;
        const Real z = dot(v, v);
        const auto k = [](double x) { return static_cast<Real>(x); };
        const Real f = k(1.0 / 2) - z * (k(1.0 / 24) - z * (k(1.0 / 720) - z * k(1.0 / 40320)));
        const Real g = k(1.0 / 6) - z * (k(1.0 / 120) - z * (k(1.0 / 5040) - z * k(1.0 / 362880)));
        // J = (1 - g z) I - f [v] + g v v^T; its columns, turned into the world
        const Real d = 1 - g * z;
        const V x{d + g * v.x * v.x, g * v.x * v.y - f * v.z, g * v.x * v.z + f * v.y};
        const V y{g * v.x * v.y + f * v.z, d + g * v.y * v.y, g * v.y * v.z - f * v.x};
        const V w{g * v.x * v.z - f * v.y, g * v.y * v.z + f * v.x, d + g * v.z * v.z};
        return transposed(node.step *
                          M{rotate(node.now, x), rotate(node.now, y), rotate(node.now, w)});
    }

    /// The step at full length, into turn and rate_turn.
    template <class At>
    static void eliminate(const At& at, std::size_t n, Real lambda, const Prior& prior) noexcept {
        Cost cost = arrival(at(0), prior);
        for (std::size_t i = 1; i < n; ++i) {
            at(i).lead = lead_of(at(i));
            cost = measured(onwards(cost, at(i - 1), at(i), at(i).lead, lambda), at(i));
        }
        Node& newest = at(n - 1);
        last(newest, cost);
        V x = newest.turn, s = newest.rate_turn;
        for (std::size_t i = n - 1; i > 0; --i) {
            x = x - at(i).lead * s;
            Node& node = at(i - 1);
            s = node.first ? V{} : node.back_s * s + node.back_0 - node.back_x * x;
            node.turn = x;
            node.rate_turn = s;
        }
    }
    static void last(Node& node, const Cost& cost) noexcept {
        if (node.first) {
            node.turn = -(inverse(cost.a) * cost.p);
            node.rate_turn = {};
            return;
        }
        const S inv = inverse(cost.c);
        const M gain = cost.b * inv;
        node.turn = -(inverse(cost.a - symmetric_product(gain, cost.b)) * (cost.p - gain * cost.q));
        node.rate_turn = -(inv * (cost.q + transposed_times(cost.b, node.turn)));
    }

    template <class At>
    static void try_step(const At& at, std::size_t n, Real part, const Prior& prior) noexcept {
        const bool halved = part < 1;
        for (std::size_t i = 0; i < n; ++i) {
            Node& node = at(i);
            const Q from = halved ? node.trial : node.now;  // trial holds the start of the step
            node.trial = from;
            node.now = normalised(from_rotation_vector(part * node.turn) * from);
        }
        if (prior.any) at(0).rate += (halved ? -part : part) * at(0).rate_turn;
    }
    template <class At>
    static void undo(const At& at, std::size_t n, const Prior& prior) noexcept {
        for (std::size_t i = 0; i < n; ++i) at(i).now = at(i).trial;
        if (prior.any) at(0).rate += -(Real{1} / 8) * at(0).rate_turn;
        for (std::size_t i = 0; i < n; ++i) refresh(at, i);
    }

    /// Rate and offset of a sample that has moved.
    template <class At>
    static void refresh(const At& at, std::size_t i) noexcept {
        Node& node = at(i);
        if (i > 0) node.rate = rate_of(at(i - 1).now, node.now, node.step);
        node.off = rotation_vector(node.now * conj(node.raw));
    }

    template <class At>
    static Real cost_of(const At& at, std::size_t n, Real lambda, const Prior& prior) noexcept {
        LongSum<Real> sum;
        if (prior.any) {
            const V x = rotation_vector(at(0).now * conj(prior.at)), s = at(0).rate - prior.rate;
            const Cost& c = prior.cost;
            sum.add(dot(x, c.a * x) + 2 * dot(x, c.b * s) + dot(s, c.c * s) +
                    2 * (dot(c.p, x) + dot(c.q, s)));
        }
        for (std::size_t i = 0; i < n; ++i) {
            refresh(at, i);
            const Node& node = at(i);
            sum.add(dot(node.off, node.off));
            if (i == 0 || at(i - 1).first) continue;
            const V bend = node.rate - at(i - 1).rate;
            sum.add(2 * lambda / (at(i - 1).step + node.step) * dot(bend, bend));
        }
        return sum.value();
    }
};

}  // namespace fairlead::detail
