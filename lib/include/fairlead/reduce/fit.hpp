#pragma once
// Banded least squares of a plan's jumps, reweighted towards the largest error, in small portions.
//
// The knots of a plan's head stay as they are; beyond, the curve is a C^(Order - 2) continuation.
// Its B-splines have the first Order - 1 control points given (the blossom of the polynomial that
// is continued), which turns the ill-conditioned problem of jumps into a banded system that float
// solves. Errors are those of the polynomials that would be frozen, at every sample. Weights after
// Lawson: multiplied by the error, so that the fit leans towards the smallest largest error. What
// is judged apart is weighted apart: a vector is fitted as a whole first, then those of its
// components that miss their tolerance, one by one.
// A fit may be interrupted after any sample and any row; what it has used up is counted in
// instructions of a Cortex-M4F, about. RAM: sizeof; no loop runs further than window and knots.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/each.hpp"
#include "fairlead/reduce/plan.hpp"
#include "fairlead/reduce/window.hpp"

namespace fairlead {

/// Work that may still be done in this push, in instructions of a Cortex-M4F, about.
using Credit = std::int32_t;

template <class Channel, std::size_t N, std::size_t MaxKnots, std::size_t Horizons>
class Fit {
  public:
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    using Samples = Window<Channel, N>;
    using KnotPlan = Plan<Channel, MaxKnots>;
    using Walk = PlanWalk<Channel, MaxKnots>;
    using Ahead = Future<Channel, Horizons>;
    using Vector = std::array<float, D>;
    // what is judged on its own: every component, or all together
    static constexpr std::size_t parts = Channel::Judge::parts, Width = D / parts;
    using Part = std::array<float, Width>;

    struct Problem {
        Samples& samples;   // weights and errors are noted there
        std::size_t count;  // samples to serve, from the front
        const Ahead& ahead;
        const Polynomial<D, Order>& frozen;
        const typename Channel::Judge& judge;
        bool free;  // nothing is frozen yet: the fit may leave `frozen` from u = 0 on
        std::size_t wanted;  // a plan that serves more samples than these is of use, though it fails
    };

    bool busy() const noexcept { return phase_ != Phase::done; }
    /// Is every sample within the limit?
    bool succeeded() const noexcept { return succeeded_; }
    void cancel() noexcept { phase_ = Phase::done; }

    /// Begins to fit the jumps of the knots after the first `head`, which stay as they are; fills
    /// the rest of the plan. The samples that the head serves are taken as served.
    void start(const Problem& problem, std::size_t head, std::size_t passes, float limit,
               KnotPlan& plan) noexcept {
        plan.landing = 0;
        if (head == 0) plan.settled = -1;
        open(problem, head, passes, limit, plan);
        if (fixed_ != 0 && plan.size == head) {
            passes_ = 0;
            return start_check(problem, plan);
        }
        lay_knots(problem, plan);
        start_pass();
    }

    /// Begins to test a plan as it stands.
    void start_test(const Problem& problem, float limit, KnotPlan& plan) noexcept {
        open(problem, 0, 0, limit, plan);
        if (problem.free) base_.p.c = plan.start;
        start_check(problem, plan);
    }

    /// Begins to look for better places of the knots after the first `head`: a plain fit in which
    /// each of them is double, so that the curve may bend there, too. See shift().
    void start_shifts(const Problem& problem, std::size_t head, KnotPlan& plan) noexcept {
        open(problem, head, 0, 1, plan);
        doubled_ = true;
        if (fixed_) --fixed_;
        lay_knots(problem, plan);
        start_pass();
    }
    /// May so many knots be doubled?
    static constexpr std::size_t shifts_max = MaxKnots / 2;
    /// Then: by how much knot i should move, by the step of Gauss and Newton.
    float shift(std::size_t i) const noexcept { return shift_[i]; }

    /// Goes on with what was begun, until it is done or the credit is used up.
    void run(const Problem& problem, KnotPlan& plan, Credit& credit) noexcept {
        while (busy() && credit > 0) {
            switch (phase_) {
                case Phase::assemble: assemble(problem, credit); break;
                case Phase::factor: factor(credit); break;
                case Phase::substitute: substitute(problem, plan, credit); break;
                case Phase::check: check(problem, plan, credit); break;
                case Phase::done: break;
            }
        }
    }

    /// The first n samples left the window.
    void drop(std::size_t n) noexcept {
        for (std::size_t* i : {&count_, &first_, &cursor_, &covers_, &worst_at_})
            *i -= n < *i ? n : *i;
        if (count_ == 0) cancel();
    }

    // what a portion costs, in instructions of a Cortex-M4F, about
    static constexpr Credit visit_cost = 70 + 25 * D, lone_visit_cost = 70 + 25 * Width,
                            test_cost = 35 + 33 * Width, span_cost = 500 + 60 * D,
                            interval_cost = 100 + 50 * Width, row_cost = 150 + 50 * D,
                            pass_cost = 60 + 40 * D, start_cost = 800 + 100 * D;

  private:
    static constexpr float unrepresentable = 10;  // stands for the error of such a polynomial
    enum class Phase : std::uint8_t { done, assemble, factor, substitute, check };
    static constexpr std::size_t Unknowns = MaxKnots + Order;
    static constexpr std::size_t Pairs = Order * (Order + 1) / 2;

    void open(const Problem& problem, std::size_t head, std::size_t passes, float limit,
              const KnotPlan& plan) noexcept {
        fixed_ = problem.free && head == 0 ? 0 : Order - 1;
        head_ = head;
        passes_ = passes;
        limit_ = limit;
        count_ = problem.count;
        pass_ = 0;
        succeeded_ = false;
        lone_ = false;
        doubled_ = false;
        scale_ = 0;
        future_ = 1;
        base_ = Walk{problem.frozen, problem.free && head > 0, plan};
        for (std::size_t q = 0; q < head; ++q) base_.pass_knot(plan);
        first_ = head > 0 ? samples_until(problem, base_.origin) : 0;
    }

    /// How many leading samples stand at or before u, by halving.
    std::size_t samples_until(const Problem& problem, float u) const noexcept {
        std::size_t low = 0, high = count_;
        while (low < high) {
            const std::size_t middle = (low + high) / 2;
            if (problem.samples[middle].u <= u)
                low = middle + 1;
            else
                high = middle;
        }
        return low;
    }

    // ---- the system
    void lay_knots(const Problem& problem, const KnotPlan& plan) noexcept {
        // the first knot of a continued curve is the boundary
        const std::size_t from = head_ + (fixed_ ? 1 : 0), times = doubled_ ? 2 : 1;
        interior_ = (plan.size - from) * times;
        const float begin = fixed_ ? static_cast<float>(plan.knot[head_]) : 0.0f;
        // ahead of the samples the last polynomial goes on: basis functions made for the samples'
        // range keep the system well conditioned in float
        const float last = problem.samples[count_ - 1].u;
        const float end = (last > begin ? last : begin) + 2;
        const std::size_t total = interior_ + Order;
        for (std::size_t j = 0; j < Order; ++j) {
            t_[j] = begin;
            t_[total + j] = end;
        }
        for (std::size_t j = 0; j < interior_; ++j)
            t_[Order + j] = static_cast<float>(plan.knot[from + j / times]);
        rows_ = total - fixed_;
        anchor_ = problem.frozen.c[0];
        if (fixed_) give_control_points();
    }

    /// The first control points: the blossom of the polynomial that is continued.
    void give_control_points() noexcept {
        const auto at = base_.p.shifted(t_[0] - base_.origin);
        for (std::size_t j = 0; j < fixed_; ++j) {
            std::array<float, Order> e{};  // elementary symmetric polynomials of the knots
            e[0] = 1;
            for (std::size_t k = 1; k < Order; ++k)
                for (std::size_t m = k; m > 0; --m) e[m] += (t_[j + k] - t_[0]) * e[m - 1];
            float binomial = 1;
            Vector sum{};
            for (std::size_t m = 0; m < Order; ++m) {
                const float f = e[m] / binomial;
                for (std::size_t d = 0; d < D; ++d) sum[d] += f * at.c[m][d];
                binomial = binomial * static_cast<float>(Order - 1 - m) / static_cast<float>(m + 1);
            }
            for (std::size_t d = 0; d < D; ++d) given_[j][d] = sum[d] - anchor_[d];
        }
        before_ = at.c[doubled_ ? Order - 2 : Order - 1];
    }

    void start_pass() noexcept {
        for (std::size_t i = 0; i < rows_; ++i) {
            a_[i].fill(0);
            c_[i + fixed_].fill(0);
        }
        for (std::size_t i = 0; i < fixed_; ++i) c_[i] = given_[i];
        span_ = Order - 1;
        cursor_ = first_;
        phase_ = Phase::assemble;
    }

    /// The components that are being solved for.
    std::size_t low() const noexcept { return lone_ ? part_ * Width : 0; }
    std::size_t high() const noexcept { return lone_ ? (part_ + 1) * Width : D; }

    /// B-splines of the interval t_[span_] <= u < t_[span_ + 1] as polynomials in
    /// s = (u - t_[span_]) / length (Cox, de Boor).
    struct Basis {
        std::array<std::array<float, Order>, Order> c{};
        float begin{0}, per_length{0};
    };
    Basis basis() const noexcept {
        Basis out;
        out.begin = t_[span_];
        const float length = t_[span_ + 1] - out.begin;
        out.per_length = length > 0 ? 1 / length : 0;
        out.c[0][0] = 1;
        for (std::size_t k = 1; k < Order; ++k) {
            std::array<float, Order> carry{};
            for (std::size_t i = 0; i < k; ++i) {
                const float right = t_[span_ + 1 + i], left = t_[span_ + 1 + i - k];
                const float per = right > left ? 1 / (right - left) : 0;
                const float r = (right - out.begin) * per, l = (out.begin - left) * per,
                            slope = length * per;
                std::array<float, Order> next{};
                for (std::size_t m = 0; m < k; ++m) {
                    const float b = out.c[i][m];
                    out.c[i][m] = carry[m] + r * b;
                    next[m] += l * b;
                    next[m + 1] += slope * b;
                    carry[m + 1] -= slope * b;
                }
                out.c[i][k] = carry[k];
                carry = next;
            }
            out.c[k] = carry;
        }
        return out;
    }

    /// Sums over samples of one interval, with W right sides.
    template <std::size_t W>
    struct Sums {
        std::array<float, Pairs> a{};
        std::array<std::array<float, W>, Order> r{};
    };

    template <std::size_t W>
    [[gnu::always_inline]] static void add(Sums<W>& sums, const Basis& basis, float u, float weight,
                                           const std::array<float, W>& x) noexcept {
        const float s = (u - basis.begin) * basis.per_length;
        std::array<float, Order> b;
        each<Order>([&](auto i) {
            b[i] = basis.c[i][Order - 1];
            each<Order - 1>([&](auto m) { b[i] = b[i] * s + basis.c[i][Order - 2 - m]; });
        });
        each<Order>([&](auto i) {
            const float wb = weight * b[i];
            constexpr std::size_t row = i * (2 * Order + 1 - i) / 2;
            each<Order - i>([&](auto k) { sums.a[row + k] += wb * b[i + k]; });
            each<W>([&](auto d) { sums.r[i][d] += wb * x[d]; });
        });
    }

    /// Puts the sums of an interval into the band; given control points go to the right side.
    template <std::size_t W>
    void gather(const Sums<W>& sums) noexcept {
        const std::size_t base = span_ + 1 - Order, from = W == D ? 0 : part_ * Width;
        std::size_t pair = 0;
        for (std::size_t i = 0; i < Order; ++i) {
            const bool given = base + i < fixed_;
            for (std::size_t k = i; k < Order; ++k, ++pair) {
                if (base + k < fixed_) continue;
                if (given)
                    for (std::size_t d = from; d < from + W; ++d)
                        c_[base + k][d] -= sums.a[pair] * given_[base + i][d];
                else
                    a_[base + i - fixed_][k - i] += sums.a[pair];
            }
            if (!given)
                for (std::size_t d = 0; d < W; ++d) c_[base + i][from + d] += sums.r[i][d];
        }
    }

    /// Of a value, what is being solved for, from the anchor.
    template <std::size_t W>
    std::array<float, W> wanted_part(const Vector& x) const noexcept {
        const std::size_t from = W == D ? 0 : part_ * Width;
        std::array<float, W> out;
        each<W>([&](auto d) { out[d] = x[from + d] - anchor_[from + d]; });
        return out;
    }

    void assemble(const Problem& problem, Credit& credit) noexcept {
        if constexpr (parts > 1)
            if (lone_) return assemble<Width>(problem, credit, lone_visit_cost);
        assemble<D>(problem, credit, visit_cost);
    }

    template <std::size_t W>
    void assemble(const Problem& problem, Credit& credit, Credit visit) noexcept {
        const std::size_t last = interior_ + Order - 1;
        while (credit > 0) {
            const Basis b = basis();
            Sums<W> sums;
            const float end = span_ < last ? t_[span_ + 1] : 1e30f;
            for (; cursor_ < count_ && credit > 0; ++cursor_) {
                auto& sample = problem.samples[cursor_];
                if (sample.u <= t_[0] && fixed_) continue;
                if (sample.u >= end) break;
                float weight = 1;
                if (scale_ > 0)
                    weight = (pass_ > 1 ? sample.weight : 1.0f) * scale_ *
                             (0.02f + sample.error * lean_);
                sample.weight = weight;
                add<W>(sums, b, sample.u, weight,
                       wanted_part<W>(problem.judge.coordinates(sample.value)));
                credit -= visit;
            }
            credit -= span_cost;
            const bool over = cursor_ == count_ && span_ == last;
            if (over) look_ahead<W>(problem, b, sums);
            gather<W>(sums);
            if (over) {
                credit -= visit * static_cast<Credit>(problem.ahead.size);
                return start_factor();
            }
            if (cursor_ == count_ || problem.samples[cursor_].u >= end) ++span_;
        }
    }

    template <std::size_t W>
    void look_ahead(const Problem& problem, const Basis& b, Sums<W>& sums) const noexcept {
        for (std::size_t i = 0; i < problem.ahead.size; ++i) {
            const float w = problem.ahead.weight[i] * future_;
            add<W>(sums, b, problem.ahead.u[i], w > 1e-6f ? w : 1e-6f,
                   wanted_part<W>(problem.ahead.x[i]));
        }
    }

    // ---- its solution: L D L^T, row by row
    void start_factor() noexcept {
        float largest = 0;
        for (std::size_t i = 0; i < rows_; ++i) largest = a_[i][0] > largest ? a_[i][0] : largest;
        ridge_ = 1e-7f * largest + 1e-12f;
        cursor_ = 0;
        phase_ = Phase::factor;
    }

    void factor(Credit& credit) noexcept {
        for (; cursor_ < rows_ && credit > 0; ++cursor_) {
            auto& row = a_[cursor_];
            row[0] += ridge_;
            if (!(row[0] > ridge_)) row[0] = ridge_;
            const float per = 1 / row[0];
            for (std::size_t j = 1; j < Order && cursor_ + j < rows_; ++j) {
                const float f = row[j] * per;
                for (std::size_t k = j; k < Order; ++k) a_[cursor_ + j][k - j] -= f * row[k];
                for (std::size_t d = low(); d < high(); ++d)
                    c_[cursor_ + j + fixed_][d] -= f * c_[cursor_ + fixed_][d];
            }
            credit -= row_cost;
        }
        if (cursor_ == rows_) phase_ = Phase::substitute;
    }

    void substitute(const Problem& problem, KnotPlan& plan, Credit& credit) noexcept {
        for (; cursor_ > 0 && credit > 0; --cursor_) {
            const std::size_t i = cursor_ - 1;
            const float per = 1 / a_[i][0];
            for (std::size_t d = low(); d < high(); ++d) {
                float v = c_[i + fixed_][d];
                for (std::size_t j = 1; j < Order && i + j < rows_; ++j)
                    v -= a_[i][j] * c_[i + j + fixed_][d];
                c_[i + fixed_][d] = v * per;
            }
            credit -= row_cost;
        }
        if (cursor_ > 0) return;
        if (doubled_) {
            to_shifts(problem, plan);
            phase_ = Phase::done;
            return;
        }
        to_jumps(plan);
        credit -= row_cost * static_cast<Credit>(rows_);
        if (fixed_ == 0) base_.p.c = plan.start;
        if (lone_) return start_part(problem, plan);
        start_check(problem, plan);
    }

    /// Control points -> jumps of the highest coefficient (and the free start), by differencing.
    void to_jumps(KnotPlan& plan) noexcept {
        const bool free = fixed_ == 0;
        const std::size_t total = interior_ + Order;
        float factorial = 1;
        if (free)
            for (std::size_t d = low(); d < high(); ++d) plan.start[0][d] = anchor_[d] + c_[0][d];
        for (std::size_t k = 1; k < Order; ++k) {
            for (std::size_t j = total; j-- > k;) {
                const float width = t_[j + Order - k] - t_[j];
                const float f = width > 0 ? static_cast<float>(Order - k) / width : 0;
                for (std::size_t d = low(); d < high(); ++d)
                    c_[j][d] = f * (c_[j][d] - c_[j - 1][d]);
            }
            factorial *= static_cast<float>(k);
            if (free)
                for (std::size_t d = low(); d < high(); ++d) plan.start[k][d] = c_[k][d] / factorial;
        }
        const float per = 1 / factorial;
        for (std::size_t q = head_; q < plan.size; ++q) {
            const std::size_t j = Order - 1 + (q - head_) + (free ? 1 : 0);
            for (std::size_t d = low(); d < high(); ++d)
                plan.jump[q][d] =
                    c_[j][d] * per - (j > Order - 1 ? c_[j - 1][d] * per : before_[d]);
        }
    }

    /// Where the curve wants to bend at a knot, it should be moved: J (u - t - s)^n, less
    /// J (u - t)^n, is -n s J (u - t)^(n - 1) to first order.
    void to_shifts(const Problem& problem, const KnotPlan& plan) noexcept {
        const bool free = fixed_ == 0 && problem.free && head_ == 0;
        const std::size_t total = interior_ + Order;
        float factorial = 1;
        for (std::size_t k = 1; k + 1 < Order; ++k) {
            for (std::size_t j = total; j-- > k;) {
                const float width = t_[j + Order - k] - t_[j];
                const float f = width > 0 ? static_cast<float>(Order - k) / width : 0;
                for (std::size_t d = 0; d < D; ++d) c_[j][d] = f * (c_[j][d] - c_[j - 1][d]);
            }
            factorial *= static_cast<float>(k);
        }
        const float per = 1 / factorial;
        for (std::size_t q = head_; q < plan.size; ++q) {
            const std::size_t j = Order - 2 + 2 * (q - head_ + (free ? 1 : 0));
            float bend = 0, jump = 1e-12f;
            for (std::size_t d = 0; d < D; ++d) {
                const float p = problem.judge.per_limit[d] * problem.judge.per_limit[d];
                const float a =
                    c_[j][d] * per - (j > Order - 2 ? c_[j - 1][d] * per : before_[d]);
                bend += p * a * plan.jump[q][d];
                jump += p * plan.jump[q][d] * plan.jump[q][d];
            }
            shift_[q] = -bend / (static_cast<float>(Order - 1) * jump);
        }
    }

    // ---- its errors: the very polynomials that would be frozen, over the samples beyond the head
    void start_check(const Problem& problem, KnotPlan& plan) noexcept {
        plan.worst = 0;
        plan.worst_at = first_;
        plan.covers = count_;
        plan.objective = 0;
        part_ = hardest_;
        parts_left_ = parts;
        start_part(problem, plan);
    }

    void start_part(const Problem& problem, const KnotPlan& plan) noexcept {
        walk_ = PartWalk<Channel, MaxKnots, Width>{base_, part_ * Width};
        (void)plan;
        (void)problem;
        if (pass_ == 0) best_ = 1e30f;
        worst_ = 0;
        worst_at_ = first_;
        covers_ = count_;
        tally_ = {};
        cursor_ = first_;
        phase_ = Phase::check;
    }

    /// Sums over the tested samples: e^2, w, w e, w e^2.
    struct Tally {
        float squares{0}, weights{0}, leaning{0}, weighted{0};
    };

    void check(const Problem& problem, KnotPlan& plan, Credit& credit) noexcept {
        Tally tally = tally_;
        float worst = worst_;
        std::size_t i = cursor_, worst_at = worst_at_;
        const bool even = !lone_ && pass_ == 0;
        Credit left = credit;
        while (i < count_ && left > 0) {  // interval by interval
            walk_.to(problem.samples[i].u, plan);
            const Polynomial<Width, Order> p = walk_.p;
            const float origin = walk_.origin, end = walk_.end(plan);
            if (!p.representable()) {
                covers_ = i < covers_ ? i : covers_;
                worst = worst > unrepresentable ? worst : unrepresentable;
            }
            const auto judge = problem.judge.part(part_);
            for (; i < count_ && left > 0; ++i) {
                auto& sample = problem.samples[i];
                if (sample.u > end) break;
                const float e = judge(p(sample.u - origin), sample.value);
                const float w = even ? 1.0f : sample.weight;
                const float we = w * e;
                sample.error = e;
                tally.squares += e * e;
                tally.weights += w;
                tally.leaning += we;
                tally.weighted += we * e;
                if (!(e <= worst)) {
                    worst = e;
                    worst_at = i;
                    if (!(e <= limit_) && covers_ == count_) covers_ = i;
                }
                left -= test_cost;
            }
            left -= interval_cost;
        }
        credit = left;
        worst_ = worst;
        worst_at_ = worst_at;
        tally_ = tally;
        cursor_ = i;
        if (cursor_ < count_) return;
        if (pass_ == 0) {
            plan.objective += tally_.squares + misfit(problem);
            credit -= test_cost * static_cast<Credit>(problem.ahead.size);
        }
        decide(problem, plan);
    }

    /// Another pass over this part?
    void decide(const Problem& problem, KnotPlan& plan) noexcept {
        const bool served = covers_ == count_;
        best_ = worst_ < best_ ? worst_ : best_;
        const float n = static_cast<float>(count_ - first_);
        // the weighted mean square is a lower bound of the squared minimax error
        const bool over =
            served || pass_ >= passes_ || worst_ > 4 ||
            (pass_ >= 2 && tally_.weighted > n * limit_ * limit_) ||
            (pass_ >= 3 && best_ > 1 + 2.0f / static_cast<float>(pass_));
        if (over) return judged(problem, plan, served);
        ++pass_;
        lone_ = parts > 1;
        future_ *= 0.3f;
        lean_ = 1 / worst_;
        scale_ = n / (0.02f * tally_.weights + tally_.leaning * lean_);
        start_pass();
    }

    /// On to the next part, unless it is plain that the plan is of no use.
    void judged(const Problem& problem, KnotPlan& plan, bool served) noexcept {
        const float worst = served ? worst_ : best_;
        if (!(worst <= plan.worst)) {
            plan.worst = worst;
            plan.worst_at = worst_at_;
            if (!served) hardest_ = part_;
        }
        plan.covers = covers_ < plan.covers ? covers_ : plan.covers;
        const bool tried = pass_ > 0 || passes_ > 0;
        if (!served && tried) {
            if (plan.covers <= problem.wanted) {
                plan.covers = 0;
                phase_ = Phase::done;
                return;
            }
            passes_ = 0;  // it fails, but how far does it serve?
        }
        if (--parts_left_ == 0) {
            succeeded_ = plan.covers == count_;
            phase_ = Phase::done;
            return;
        }
        part_ = part_ + 1 < parts ? part_ + 1 : 0;
        pass_ = 0;
        lone_ = false;
        scale_ = 0;
        future_ = 1;
        start_part(problem, plan);
    }

    float misfit(const Problem& problem) const noexcept {
        float sum = 0;
        for (std::size_t i = 0; i < problem.ahead.size; ++i) {
            const Part y = walk_.p(problem.ahead.u[i] - walk_.origin);
            for (std::size_t d = 0; d < Width; ++d) {
                const std::size_t k = part_ * Width + d;
                const float e = (problem.ahead.x[i][k] - y[d]) * problem.judge.per_limit[k];
                sum += problem.ahead.weight[i] * e * e;
            }
        }
        return sum;
    }

    std::array<float, Unknowns + Order> t_{};
    std::array<std::array<float, Order>, Unknowns> a_{};  // upper band of the normal matrix
    std::array<Vector, Unknowns> c_{};                    // right sides, then control points
    std::array<Vector, Order - 1> given_{};
    std::array<float, MaxKnots> shift_{};
    Vector anchor_{}, before_{};
    Walk base_{};
    PartWalk<Channel, MaxKnots, Width> walk_{};
    float limit_{0}, ridge_{0}, future_{1}, lean_{0}, scale_{0}, best_{0}, worst_{0};
    Tally tally_{};
    std::size_t count_{0}, first_{0}, cursor_{0}, head_{0}, interior_{0}, rows_{0}, fixed_{0},
        span_{0}, passes_{0}, pass_{0};
    std::size_t part_{0}, parts_left_{0}, hardest_{0}, worst_at_{0}, covers_{0};
    Phase phase_{Phase::done};
    bool succeeded_{false};
    bool doubled_{false};
    bool lone_{false};  // only one part is being solved for
};

}  // namespace fairlead
