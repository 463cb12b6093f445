#include "host_sim/study/baselines/knots/windowed.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/study/baselines/knots/removal.hpp"

namespace fairlead::sim {
namespace {

using Difference = std::ptrdiff_t;

/// Knots [from, from + count) with the control points that live on them.
Spline section(const Spline& g, std::size_t from, std::size_t count) {
    Spline out{g.order, g.dim, {}, {}};
    const auto knot = g.knots.begin() + static_cast<Difference>(from);
    out.knots.assign(knot, knot + static_cast<Difference>(count));
    const auto c = g.c.begin() + static_cast<Difference>(from * g.dim);
    out.c.assign(c, c + static_cast<Difference>((count - g.order) * g.dim));
    return out;
}

void splice(Spline& g, std::size_t from, std::size_t count, const Spline& piece) {
    const auto replace = [](std::vector<double>& all, std::size_t at, std::size_t size,
                            const std::vector<double>& by) {
        const auto begin = all.begin() + static_cast<Difference>(at);
        all.insert(all.erase(begin, begin + static_cast<Difference>(size)), by.begin(), by.end());
    };
    replace(g.knots, from, count, piece.knots);
    replace(g.c, from * g.dim, (count - g.order) * g.dim, piece.c);
}

/// The part of the first curve that Banks compares a window with: its control points whose support
/// meets the window's interval.
Spline part_of(const Spline& f, double begin, double end) {
    std::size_t lo = f.span(begin) + 1 - f.order, hi = f.span(end) + 1;
    while (hi < f.size() && f.knots[hi] < end) ++hi;
    return section(f, lo, hi - lo + f.order);
}

class Window {
  public:
    Window(const Spline& reference, const Spline& head, std::size_t fixed,
           const WindowParams& params, bool last)
        : reference_{reference}, head_{head}, fixed_{fixed}, params_{params}, last_{last} {}

    /// Least squares over the reference's control points on fewer knots, checked on them.
    bool approximate(const std::vector<double>& knots, Spline& out) const {
        const std::size_t k = reference_.order, dim = reference_.dim;
        out = {k, dim, knots, {}};
        const std::size_t fixed = std::min(fixed_, out.size());
        out.c.assign(out.size() * dim, 0);
        std::copy_n(head_.c.begin(), fixed * dim, out.c.begin());
        const std::size_t count = reference_.size();
        std::vector<InsertionRow> rows(count);
        BandSystem system{out.size() - fixed, k, dim};
        for (std::size_t i = 0; i < count; ++i) {
            rows[i] = insertion_row(knots, reference_.knots, k, i);
            std::vector<double> rest(&reference_.c[i * dim], &reference_.c[i * dim] + dim);
            std::size_t skip = 0;
            for (; skip < k && rows[i].first + skip < fixed; ++skip)
                for (std::size_t d = 0; d < dim; ++d)
                    rest[d] -= rows[i].value[skip] * out.c[(rows[i].first + skip) * dim + d];
            const double weight = 1 / (share(i) * share(i));
            if (skip < k)
                system.add(rows[i].first + skip - fixed, rows[i].value + skip, k - skip,
                           rest.data(), weight);
        }
        if (out.size() > fixed) {
            if (!system.solve()) return false;
            std::copy(system.solution().begin(), system.solution().end(),
                      out.c.begin() + static_cast<Difference>(fixed * dim));
        }
        return within(rows, out);
    }

  private:
    double share(std::size_t i) const {
        const bool tail = !last_ && i + reference_.order >= reference_.size();
        return tail ? params_.tail_share : 1;
    }
    bool within(const std::vector<InsertionRow>& rows, const Spline& out) const {
        const std::size_t dim = out.dim;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            for (std::size_t d = 0; d < dim; ++d) {
                double v = -reference_.c[i * dim + d];
                for (std::size_t j = 0; j < out.order; ++j)
                    v += rows[i].value[j] * out.c[(rows[i].first + j) * dim + d];
                if (!(std::fabs(v) <= share(i) * params_.tolerance)) return false;
            }
        }
        return true;
    }

    const Spline& reference_;  // what the fit is compared with
    const Spline& head_;       // whose first control points stay
    std::size_t fixed_;        // so many of them
    const WindowParams& params_;
    bool last_;
};

/// Removes the most knots from `first` on, lightest first; false where none goes.
bool remove_most(Spline& h, std::size_t first, const Window& window) {
    std::vector<std::pair<double, std::size_t>> ranked;
    for (std::size_t i = first; i + h.order < h.knots.size(); ++i)
        if (h.knots[i] < h.knots[i + 1]) ranked.push_back({knot_weight(h, i), i});
    std::sort(ranked.begin(), ranked.end());
    for (std::size_t count = ranked.size(); count > 0; --count) {
        std::vector<char> gone(h.knots.size(), 0);
        for (std::size_t r = 0; r < count; ++r) gone[ranked[r].second] = 1;
        std::vector<double> left;
        for (std::size_t i = 0; i < h.knots.size(); ++i)
            if (gone[i] == 0) left.push_back(h.knots[i]);
        Spline trial;
        if (!window.approximate(left, trial)) continue;
        h = trial;
        return true;
    }
    return false;
}

}  // namespace

Spline samples_as_control_points(const Track& track, std::size_t order) {
    const std::size_t n = track.size(), skip = order / 2;
    const auto begin = track.t.begin() + static_cast<Difference>(skip);
    const std::vector<double> inner(begin, begin + static_cast<Difference>(n - order));
    return {order, track.dim(), clamped(track, order, inner), track.x};
}

Spline reduce_windowed(const Spline& first, const WindowParams& params) {
    Spline g = first;
    const std::size_t k = g.order;
    for (std::size_t p = 0; g.knots.size() > p + 2 * k;) {
        const std::size_t left = g.knots.size() - p;
        const std::size_t count = std::min(left, 2 * k + params.window);
        const bool last = count == left;
        // Banks re-solves the head: what that moves lies up to k knots back and is compared too
        const std::size_t back = params.against_first ? std::min(p, k) : 0;
        const Spline from = section(g, p - back, count + back);
        const Spline reference = params.against_first ? part_of(first, from.knots[k - 1],
                                                                from.knots[from.knots.size() - k])
                                                      : from;
        const Window window{reference, from, params.head_anchored ? k : back, params, last};
        Spline h = from;
        while (remove_most(h, k + back, window) && !params.against_first) {
        }
        const std::size_t removed = from.knots.size() - h.knots.size();
        if (removed > 0) splice(g, p - back, count + back, h);
        if (last) break;
        p += count - 2 * k - removed;  // stays where nothing is left inside: fresh knots follow
    }
    return g;
}

}  // namespace fairlead::sim
