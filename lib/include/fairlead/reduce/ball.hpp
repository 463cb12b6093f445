#pragma once
// The search of rotations: samples are places in a chart, the tolerance is a ball.
//
// The running bounds hold for each component apart, so that they are necessary. A vertex must lie
// in the ball of the tolerance about the sample at its column, and before it is offered, the whole
// piece is compared with the other samples. These comparisons are the dear part: the cheapest
// candidates come first, and a budget a column bounds them.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/curve/rotation.hpp"
#include "fairlead/reduce/beam.hpp"

namespace fairlead::reduce {

/// In lattice steps, in the chart about an anchor.
using Place = std::array<float, 3>;

template <class AKind>
class Ball {
  public:
    using Kind = AKind;
    static constexpr std::size_t components = 3;
    using Sample = Place;
    static constexpr int tries_max = 6;   // candidates of a hypothesis that are compared
    static constexpr int offers_max = 3;  // of these, how many it may offer

  protected:
    using Open = Hypothesis<3>;
    static constexpr Cost step_cost_min = 2 * reduce::step_cost_min;

    void begin(std::int32_t) noexcept {}
    /// tests: comparisons with samples until the column's budget is spent.
    void begin_column(int tests) noexcept { left_ = tests; }
    /// As many again for the newest hypotheses, where the budget is spent and none fits.
    bool renew(int tests) noexcept {
        const bool was_spent = spent();
        if (was_spent) left_ = tests;
        return was_spent;
    }

    static float from(float y, std::int16_t v) noexcept { return y - static_cast<float>(v); }
    static float room(float radius, float, float) noexcept { return radius; }
    /// A fresh piece is compared where it ends.
    static bool bound_fresh(const Open&, float, const Place&, float) noexcept { return true; }

    /// Offers some of the cheapest rises of the box that hold all samples.
    template <class Search, class Source>
    void offer(Search& search, const Open& o, const Ending<3>& ending, const Column<3>& at,
               const Source& source) noexcept {
        if (spent()) return;
        if (at.told != nullptr) {
            offer_told(search, o, ending, at, source);
            return;
        }
        Box box;
        Triple &first = box.first, &last = box.last;
        Candidate<3> middle{};
        for (std::size_t a = 0; a < 3; ++a) {
            Range range;
            if (ending.before.fresh) {
                const float here = static_cast<float>(o.v[a]);
                range.within(at.middle[a] - search.radius() - here,
                             at.middle[a] + search.radius() - here);
            }
            if (!search.box(o, ending, at, a, range)) return;
            first[a] = range.first();
            last[a] = range.last();
            if (first[a] > last[a]) return;
            const float half = (range.low + range.high) * 0.5f;
            middle.p[a] = static_cast<std::int32_t>(half < 0 ? half - 0.5f : half + 0.5f);
            if (last[a] - first[a] > 2) {
                first[a] = middle.p[a] - 1;
                last[a] = middle.p[a] + 1;
            }
            float off = static_cast<float>(o.v[a] + first[a]) - at.middle[a];
            for (float& off2 : box.off2[a]) {
                off2 = at.known ? off * off : 0.0f;
                off += 1.0f;
            }
        }
        std::array<std::uint32_t, tries_max> keys;
        const int n = cheapest(search, ending, box, keys);
        // none of them may fit: the middle of the bounds is likely to
        const int tries = n == tries_max ? n + 1 : n;
        int offered = 0;
        for (int i = 0; i < tries && offered < offers_max; ++i) {
            if (i == tries_max && offered > 0) break;
            Candidate<3> c = middle;
            if (i < n)
                unpack(c, keys[static_cast<std::size_t>(i)], first, ending);
            else
                price(c, ending);
            if (c.cost >= search.worst() || spent()) break;
            const Place p{static_cast<float>(c.p[0]), static_cast<float>(c.p[1]),
                          static_cast<float>(c.p[2])};
            if (!fits(search, o, p, ending.h, at, source)) continue;
            const auto child = search.make(o, ending, c);
            if (!leads_on(child, at, search.radius())) continue;
            if (search.bounded(child)) search.place(child);
            ++offered;
        }
    }

  private:
    using Triple = std::array<std::int32_t, 3>;
    /// At most 3 x 3 x 3 rises.
    struct Box {
        Triple first, last;
        /// (vertex - sample of the column)^2 of each component; 0 where there is no such sample.
        std::array<std::array<float, 3>, 3> off2;

        float off(std::size_t a, std::int32_t p) const noexcept {
            return off2[a][static_cast<std::size_t>(p - first[a])];
        }
    };

    bool spent() const noexcept { return left_ < 0; }

    /// The frame tells where it ends: the piece leads there.
    template <class Search, class Source>
    void offer_told(Search& search, const Open& o, const Ending<3>& ending, const Column<3>& at,
                    const Source& source) noexcept {
        Place p;
        const auto hf = static_cast<float>(ending.h);
        for (std::size_t a = 0; a < 3; ++a) {
            p[a] = (*at.told)[a] - static_cast<float>(o.v[a]);
            const float bend = (p[a] - o.slope(a) * hf) / (o.shape == Shape::line ? hf : hf * hf);
            if (o.shape != Shape::fresh && (bend < o.low[a] || bend > o.high[a])) return;
        }
        if (!fits(search, o, p, ending.h, at, source)) return;
        auto child = search.make(o, ending, {ending.base, {}, {}});
        for (std::size_t a = 0; a < 3; ++a)
            child.s[a] =
                curve::slope_onto(o.slope_units(a), o.shape != Shape::quadratic, p[a], ending.h);
        search.place(child);
    }

    static const auto& row(const Ending<3>& ending, std::size_t a, bool before) noexcept {
        return code::costs<Kind, 3>.value[code::value_row<Kind>(ending.before, ending.code,
                                                                ending.h, a, before)];
    }

    /// The cheapest rises of the box that end in the ball about the column's sample, in order of
    /// cost, as keys: the cost, and in the lowest byte the place in the box. @return their number.
    template <class Search>
    static int cheapest(const Search& search, const Ending<3>& ending, const Box& box,
                        std::array<std::uint32_t, tries_max>& keys) noexcept {
        const Cost most = search.worst();
        const float limit = search.radius() * search.radius();
        const auto& sign = ending.before.sign;
        const Triple &first = box.first, &last = box.last;
        const std::array<const std::uint8_t(*)[code::value_symbols], 5> rows{
            &row(ending, 0, false), &row(ending, 1, false), &row(ending, 1, true),
            &row(ending, 2, false), &row(ending, 2, true)};
        int n = 0;
        Triple k;
        for (std::int32_t x = first[0]; x <= last[0]; ++x) {
            k[0] = x - ending.predicted[0];
            const Cost one = ending.base + code::value_cost(*rows[0], k[0], sign[0]);
            if (one >= most) continue;
            const bool some = k[0] != 0;
            for (std::int32_t y = first[1]; y <= last[1]; ++y) {
                const float off = box.off(0, x) + box.off(1, y);
                if (off > limit) continue;
                k[1] = y - ending.predicted[1];
                const Cost two = one + code::value_cost(some ? *rows[2] : *rows[1], k[1], sign[1]);
                if (two >= most) continue;
                const bool any = some || k[1] != 0;
                const std::int32_t place = 16 * (x - first[0]) + 4 * (y - first[1]);
                for (std::int32_t z = first[2]; z <= last[2]; ++z) {
                    if (off + box.off(2, z) > limit) continue;
                    k[2] = z - ending.predicted[2];
                    const Cost all =
                        two + code::value_cost(any ? *rows[4] : *rows[3], k[2], sign[2]);
                    if (all >= most) continue;
                    n = insert(keys, n, all << 8 | static_cast<Cost>(place + z - first[2]));
                }
            }
        }
        return n;
    }
    static int insert(std::array<std::uint32_t, tries_max>& keys, int n,
                      std::uint32_t key) noexcept {
        int i = n;
        if (n == tries_max) {
            if (keys[tries_max - 1] <= key) return n;
            i = tries_max - 1;
        } else {
            ++n;
        }
        for (; i > 0 && keys[static_cast<std::size_t>(i - 1)] > key; --i)
            keys[static_cast<std::size_t>(i)] = keys[static_cast<std::size_t>(i - 1)];
        keys[static_cast<std::size_t>(i)] = key;
        return n;
    }
    static void unpack(Candidate<3>& c, std::uint32_t key, const Triple& first,
                       const Ending<3>& ending) noexcept {
        const auto place = static_cast<std::int32_t>(key & 0xffu);
        c.cost = key >> 8;
        c.p = {first[0] + place / 16, first[1] + place / 4 % 4, first[2] + place % 4};
        for (std::size_t a = 0; a < 3; ++a) c.k[a] = c.p[a] - ending.predicted[a];
    }
    static void price(Candidate<3>& c, const Ending<3>& ending) noexcept {
        c.cost = ending.base;
        bool before = false;
        for (std::size_t a = 0; a < 3; ++a) {
            c.k[a] = c.p[a] - ending.predicted[a];
            c.cost += code::value_cost(row(ending, a, before), c.k[a], ending.before.sign[a]);
            before = before || c.k[a] != 0;
        }
    }

    /// Does the piece that rises by p in h ticks hold all samples behind its start?
    template <class Search, class Source>
    bool fits(const Search& search, const Open& o, const Place& p, std::int32_t h,
              const Column<3>& at, const Source& source) noexcept {
        // x = c0 + t (c1 + t (c2 + t c3)), t from the start of the piece
        Place c0, c1, c2;
        Place c3{};
        const auto hf = static_cast<float>(h);
        const float i1 = 1.0f / hf, i2 = i1 * i1;
        for (std::size_t a = 0; a < 3; ++a) {
            const float s = o.slope(a), rest = p[a] - s * hf;
            c0[a] = static_cast<float>(o.v[a]);
            c1[a] = o.shape == Shape::line ? p[a] * i1 : s;
            c2[a] = o.shape == Shape::line ? 0.0f : rest * i2;
            if (o.shape == Shape::fresh) {
                c3[a] = -c2[a] * i1;
                c2[a] *= 2.0f;
            }
        }
        const float limit = search.radius() * search.radius();
        // begins with the sample that refuted the piece before: it is likely to refute this one too
        const std::size_t first = o.first;
        const bool again = refuted_by_ >= first && refuted_by_ < at.last;
        std::size_t i = again ? refuted_by_ + 1 : at.last;
        for (std::size_t left = at.last - first; left > 0; --left) {
            if (i == first) i = at.last;
            --i;
            const curve::Moment m = source.when(i);
            const float t = static_cast<float>(m.tick - source.start_tick() - o.tick) + m.part;
            if (!(t > 0.0f)) continue;  // before the window
            --left_;
            const Place& y = source.place(i);
            float n = 0;
            for (std::size_t a = 0; a < 3; ++a) {
                const float e = (y[a] - c0[a]) - t * (c1[a] + t * (c2[a] + t * c3[a]));
                n += e * e;
            }
            if (n <= limit) continue;
            refuted_by_ = i;
            return false;
        }
        return true;
    }

    /// Does the vertex leave a way to the sample behind it?
    template <class Child>
    static bool leads_on(const Child& c, const Column<3>& at, float radius) noexcept {
        if (!(at.after > 0.0f)) return true;
        const float most = radius + bend_likely * at.after * at.after;
        float sum = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const float there =
                static_cast<float>(c.v[a]) + static_cast<float>(c.s[a]) * slope_steps * at.after;
            sum += (at.later[a] - there) * (at.later[a] - there);
        }
        return sum <= most * most;
    }

    int left_{0};                // comparisons, of the budget of the column
    std::size_t refuted_by_{0};  // the sample that did not hold last
};

}  // namespace fairlead::reduce
