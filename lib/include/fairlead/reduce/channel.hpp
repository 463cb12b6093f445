#pragma once
// The two kinds of signal that are reduced: vectors (tolerance per component) and orientations
// (tolerance on the rotation angle). A channel knows its scale, its curve at both ends of the wire
// and the exact test that every accepted sample must pass.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/reduce/chart.hpp"
#include "fairlead/reduce/span.hpp"

namespace fairlead {

/// floor(log2(x)) of a positive normal float, else -126.
inline int floor_log2(float x) noexcept {
    if (!(x >= 1.2e-38f)) return -126;
    return static_cast<int>((approx::detail::bit_cast<std::uint32_t>(x) >> 23) & 255u) - 127;
}

/// D components, absolute tolerance each, splines of any order 2..6.
template <std::size_t D, std::size_t Order = 4>
struct VectorChannel {
    static_assert(D >= 1 && Order >= 2 && Order <= 6);
    static constexpr std::size_t dimension = D;
    static constexpr std::size_t order = Order;

    using Value = std::array<float, D>;
    using Tolerance = std::array<float, D>;
    struct Witness {};  // what the window keeps of a sample beside its coordinates: nothing

    /// The units of the curve: powers of two just below the tolerances, so that scaling is exact.
    struct Scale {
        std::array<std::int8_t, D> exponent{};
        float unit(std::size_t d) const noexcept { return power_of_two(exponent[d]); }
    };

    static Scale scale(const Tolerance& tol) noexcept {
        Scale s;
        for (std::size_t d = 0; d < D; ++d)
            s.exponent[d] = static_cast<std::int8_t>(floor_log2(tol[d]));
        return s;
    }

    /// A curve as both ends hold it.
    struct Curve {
        Span<D, Order> span{};

        void begin(const Scale&, const Value&) noexcept { span = {}; }

        /// Moves on to the knot `ticks` later and adds the jump of the highest derivative.
        void advance(std::uint32_t ticks, const std::array<std::int32_t, D>& jump, const Scale&,
                     std::uint32_t tick_ns) noexcept {
            span = carried(span, ticks, tick_ns);
            for (std::size_t d = 0; d < D; ++d) span.c[Order - 1][d] += jump[d];
        }

        Value value(const std::array<float, D>& units, const Scale& s) const noexcept {
            Value v;
            for (std::size_t d = 0; d < D; ++d) v[d] = units[d] * s.unit(d);
            return v;
        }

        std::array<float, D> coordinates(const Value& v, const Scale& s, Witness&) const noexcept {
            std::array<float, D> x;
            for (std::size_t d = 0; d < D; ++d) x[d] = v[d] * power_of_two(-s.exponent[d]);
            return x;
        }
    };

    /// Tests samples against a curve; made once from the tolerance.
    struct Judge {
        static constexpr float square_bound =
            static_cast<float>(D);  // |e|^2 over the worst component's

        std::array<float, D> limit{};      // signal units, a rounding margin below the tolerance
        std::array<float, D> per_limit{};  // 1 / tolerance in curve units

        Judge() = default;
        Judge(const Tolerance& tol, const Scale& s) noexcept {
            for (std::size_t d = 0; d < D; ++d) {
                limit[d] = tol[d] * (1 - 1.0f / (1 << 19));
                per_limit[d] = s.unit(d) / tol[d];
            }
        }

        /// The exact test, on the value that a decoder will give out.
        bool accepts(const Value& decoded, const Value& sample) const noexcept {
            for (std::size_t d = 0; d < D; ++d)
                if (!(approx::abs(decoded[d] - sample[d]) <= limit[d])) return false;
            return true;
        }

        /// Error of curve coordinates y at coordinates x, 1 at the tolerance: for planning.
        float error(const std::array<float, D>& y, const std::array<float, D>& x,
                    const Witness&) const noexcept {
            float worst = 0;
            for (std::size_t d = 0; d < D; ++d) {
                const float e = approx::abs(y[d] - x[d]) * per_limit[d];
                worst = e > worst ? e : worst;
            }
            return worst;
        }
    };
};

/// Orientations, tolerance as a rotation angle in radians; C2 cubics in a chart (reduce/chart.hpp).
struct OrientationChannel {
    static constexpr std::size_t dimension = 3;
    static constexpr std::size_t order = 4;

    using Value = Quat;
    using Tolerance = float;
    struct Witness {
        float w{};  // scalar part of conj(anchor) * sample
    };

    struct Scale {
        std::int8_t exponent{};
        float unit() const noexcept { return power_of_two(exponent); }
    };

    static Scale scale(Tolerance tol) noexcept {
        return {static_cast<std::int8_t>(floor_log2(tol))};
    }

    struct Curve {
        Span<3, 4> span{};
        Anchor anchor{};
        Quat anchor_q{};

        void begin(const Scale&, const Quat& at) noexcept {
            span = {};
            set(Anchor::nearest(at));
        }

        void set(const Anchor& a) noexcept {
            anchor = a;
            anchor_q = a.q();
        }

        void advance(std::uint32_t ticks, const std::array<std::int32_t, 3>& jump, const Scale& s,
                     std::uint32_t tick_ns) noexcept {
            span = carried(span, ticks, tick_ns);
            const std::array<float, 3> y = Polynomial<3, 4>{span}.c[0];
            const float unit = s.unit();
            if ((y[0] * y[0] + y[1] * y[1] + y[2] * y[2]) * unit * unit >
                chart_radius * chart_radius) {
                const Quat from = anchor_q;
                set(Anchor::nearest(value(y, s)));
                span = in_chart(span, unit, from, anchor_q);
            }
            for (std::size_t d = 0; d < 3; ++d) span.c[3][d] += jump[d];
        }

        Quat value(const std::array<float, 3>& units, const Scale& s) const noexcept {
            const float unit = s.unit();
            return anchor_q * chart_point({units[0] * unit, units[1] * unit, units[2] * unit});
        }

        std::array<float, 3> coordinates(const Quat& q, const Scale& s,
                                         Witness& witness) const noexcept {
            const auto y = to_chart(anchor_q, q);
            witness.w = approx::abs((conj(anchor_q) * q).w);
            const float per_unit = power_of_two(-s.exponent);
            return {y[0] * per_unit, y[1] * per_unit, y[2] * per_unit};
        }
    };

    struct Judge {
        static constexpr float square_bound = 1;

        float chord2{};      // largest squared chord on S^3, a rounding margin below the tolerance
        float unit{1};       // radians
        float per_chord2{};  // 1 / squared chord at the tolerance
        std::array<float, 3> per_limit{};

        Judge() = default;
        Judge(Tolerance tol, const Scale& s) noexcept {
            const float chord = 2 * approx::sin(tol / 4);  // |p - q| = 2 sin(angle / 4)
            const float kept = chord > 1e-6f ? chord - 5e-7f : chord / 2;
            chord2 = kept * kept;
            unit = s.unit();
            per_chord2 = 1 / (chord * chord);
            per_limit.fill(unit / tol);
        }

        bool accepts(const Quat& decoded, const Quat& sample) const noexcept {
            const Quat q = same_side(decoded, sample);
            const float w = decoded.w - q.w, x = decoded.x - q.x, y = decoded.y - q.y,
                        z = decoded.z - q.z;
            return w * w + x * x + y * y + z * z <= chord2;
        }

        float error(const std::array<float, 3>& y, const std::array<float, 3>& x,
                    const Witness& witness) const noexcept {
            const float s = unit / 2;
            float length2 = 0, apart2 = 0;
            for (std::size_t d = 0; d < 3; ++d) {
                const float v = s * y[d], e = s * (y[d] - x[d]);
                length2 += v * v;
                apart2 += e * e;
            }
            if (!(length2 < 1)) return 1e9f;
            const float w = approx::sqrt(1 - length2) - witness.w;
            return approx::sqrt((apart2 + w * w) * per_chord2);
        }
    };
};

}  // namespace fairlead
