#pragma once
// The two kinds of signal that are reduced: vectors (tolerance per component) and orientations
// (tolerance on the rotation angle). A channel knows its scale, its curve at both ends of the wire
// and the exact test that every accepted sample must pass.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/math/quat.hpp"
#include "host_sim/study/baselines/earlier/reduce/span.hpp"

namespace fairlead::earlier {

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

    static const Value& continued(const Value&, const Value& v) noexcept { return v; }

    static Value value(const std::array<float, D>& units, const Scale& s) noexcept {
        Value v;
        for (std::size_t d = 0; d < D; ++d) v[d] = units[d] * s.unit(d);
        return v;
    }

    /// A jump of the highest coefficient as it is sent, and back: as it is.
    static constexpr const std::array<float, D>& to_wire(const std::array<float, D>& jump,
                                                         const std::array<float, D>&) noexcept {
        return jump;
    }
    static constexpr const std::array<float, D>& from_wire(const std::array<float, D>& sent,
                                                           const std::array<float, D>&) noexcept {
        return sent;
    }
    /// Which of a jump's components share an adaptive code: all.
    static constexpr std::size_t model(std::size_t) noexcept { return 0; }

    /// Tests samples against a curve; made once from the tolerance.
    struct Judge {
        static constexpr std::size_t parts = D;  // each component is judged on its own

        std::array<float, D> limit{};      // signal units, a rounding margin below the tolerance
        std::array<float, D> per_limit{};  // 1 / tolerance in curve units
        std::array<float, D> per_unit{};   // 1 / unit

        Judge() = default;
        Judge(const Tolerance& tol, const Scale& s) noexcept {
            for (std::size_t d = 0; d < D; ++d) {
                per_unit[d] = power_of_two(-s.exponent[d]);
                limit[d] = tol[d] * (1 - 1.0f / (1 << 19));
                per_limit[d] = s.unit(d) / tol[d];
            }
        }

        /// W components of a value in curve units, after the first `from`.
        template <std::size_t W = D>
        std::array<float, W> coordinates(const Value& v, std::size_t from = 0) const noexcept {
            std::array<float, W> x;
            each<W>([&](std::size_t d)
                        FAIRLEAD_INLINE { x[d] = v[from + d] * per_unit[from + d]; });
            return x;
        }

        /// The exact test, on the value that a decoder will give out.
        bool accepts(const Value& decoded, const Value& sample) const noexcept {
            for (std::size_t d = 0; d < D; ++d)
                if (!(approx::absolute(decoded[d] - sample[d]) <= limit[d])) return false;
            return true;
        }

        /// b - a in tolerances, seen from b.
        std::array<float, D> difference(const Value& a, const Value& b) const noexcept {
            std::array<float, D> out;
            for (std::size_t d = 0; d < D; ++d) out[d] = (b[d] - a[d]) / limit[d];
            return out;
        }
        /// b, `change` tolerances on.
        Value moved(const Value& b, const std::array<float, D>& change) const noexcept {
            Value out;
            for (std::size_t d = 0; d < D; ++d) out[d] = b[d] + change[d] * limit[d];
            return out;
        }

        /// Errors of curve coordinates y at a sample, 1 at the tolerance, part by part: for
        /// planning.
        std::array<float, parts> errors(const std::array<float, D>& y,
                                        const Value& v) const noexcept {
            std::array<float, parts> e;
            each<D>([&](std::size_t d) FAIRLEAD_INLINE {
                e[d] = approx::absolute(y[d] - v[d] * per_unit[d]) * per_limit[d];
            });
            return e;
        }
        /// The same of one part alone.
        float error(std::size_t part, const std::array<float, 1>& y,
                    const Value& v) const noexcept {
            return approx::absolute(y[0] - v[part] * per_unit[part]) * per_limit[part];
        }
    };
};

/// Orientations, tolerance as a rotation angle in radians: cubics in the space of quaternions,
/// taken to unit length when they are evaluated. That is linear to fit, turns with either frame,
/// and needs no charts. Jumps are sent in the frame of the curve itself: their radial part is the
/// smallest.
struct OrientationChannel {
    static constexpr std::size_t dimension = 4;
    static constexpr std::size_t order = 4;

    using Value = Quat;
    using Tolerance = float;
    using Vector = std::array<float, 4>;

    struct Scale {
        std::int8_t exponent{};
        float unit() const noexcept { return power_of_two(exponent); }
    };

    static Scale scale(Tolerance tol) noexcept {
        return {
            static_cast<std::int8_t>(floor_log2(tol / 2))};  // on S^3 a rotation is half its angle
    }

    static Quat continued(const Quat& before, const Quat& q) noexcept {
        return same_side(before, q);
    }

    static Quat value(const Vector& p, const Scale&) noexcept {
        return normalised(Quat{p[0], p[1], p[2], p[3]});
    }

    /// A jump of the highest coefficient as it is sent at a knot where the curve stands at p, and
    /// back.
    static Vector to_wire(const Vector& jump, const Vector& p) noexcept {
        const Quat q = conj(value(p, {})) * Quat{jump[0], jump[1], jump[2], jump[3]};
        return {q.w, q.x, q.y, q.z};
    }
    static Vector from_wire(const Vector& sent, const Vector& p) noexcept {
        const Quat q = value(p, {}) * Quat{sent[0], sent[1], sent[2], sent[3]};
        return {q.w, q.x, q.y, q.z};
    }
    /// Which of a jump's components share an adaptive code: the radial one has its own.
    static constexpr std::size_t model(std::size_t d) noexcept { return d == 0 ? 1 : 0; }

    struct Judge {
        static constexpr std::size_t parts = 1;  // all components are judged together

        float chord2{};      // largest squared chord on S^3, a rounding margin below the tolerance
        float per_chord{};   // 1 / chord at the tolerance
        Vector per_limit{};  // 1 / tolerance in curve units
        Vector limit{};      // tolerance on S^3
        float unit{1}, per_unit{1};

        Judge() = default;
        Judge(Tolerance tol, const Scale& s) noexcept {
            const float chord = 2 * approx::sin(tol / 4);  // |p - q| = 2 sin(angle / 4)
            const float kept = chord > 1e-6f ? chord - 5e-7f : chord / 2;
            chord2 = kept * kept;
            per_chord = 1 / chord;
            unit = s.unit();
            per_unit = 1 / unit;
            per_limit.fill(unit / (tol / 2));
            limit.fill(tol / 2);
        }

        template <std::size_t W = 4>
        Vector coordinates(const Quat& q, std::size_t = 0) const noexcept {
            return {q.w * per_unit, q.x * per_unit, q.y * per_unit, q.z * per_unit};
        }

        bool accepts(const Quat& decoded, const Quat& sample) const noexcept {
            const Quat q = same_side(decoded, sample);
            const float w = decoded.w - q.w, x = decoded.x - q.x, y = decoded.y - q.y,
                        z = decoded.z - q.z;
            return w * w + x * x + y * y + z * z <= chord2;
        }

        /// Error of curve coordinates y at a sample, 1 at the tolerance: for planning. The radial
        /// part of the difference is left out, as taking y to unit length will.
        std::array<float, 1> errors(const Vector& y, const Quat& q) const noexcept {
            const float w = y[0] * unit - q.w, x = y[1] * unit - q.x, u = y[2] * unit - q.y,
                        z = y[3] * unit - q.z;
            const float radial = w * q.w + x * q.x + u * q.y + z * q.z;
            const float apart = w * w + x * x + u * u + z * z - radial * radial;
            if (!(radial > -0.5f)) return {1e9f};
            return {apart > 0 ? approx::sqrt(apart) * per_chord / (1 + radial) : 0.0f};
        }
        float error(std::size_t, const Vector& y, const Quat& q) const noexcept {
            return errors(y, q)[0];
        }

        Vector difference(const Quat& a, const Quat& b) const noexcept {
            return {(b.w - a.w) / limit[0], (b.x - a.x) / limit[1], (b.y - a.y) / limit[2],
                    (b.z - a.z) / limit[3]};
        }
        Quat moved(const Quat& b, const Vector& change) const noexcept {
            return {b.w + change[0] * limit[0], b.x + change[1] * limit[1],
                    b.y + change[2] * limit[2], b.z + change[3] * limit[3]};
        }
    };
};

/// A curve as both ends of the wire hold it: its last polynomial, moved on knot by knot.
template <class Channel>
struct Curve {
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    using Jump = std::array<std::int32_t, D>;

    Span<D, Order> span{};

    /// On to the knot `ticks` later, where the highest coefficient jumps by jump << shift.
    void advance(std::uint32_t ticks, const Jump& jump, std::uint32_t shift,
                 std::uint32_t tick_ns) noexcept {
        span = carried(span, ticks, tick_ns);
        turn(jump, shift);
    }

    /// The jump alone, where the curve stands at its knot.
    void turn(const Jump& jump, std::uint32_t shift) noexcept {
        std::array<float, D> sent;
        for (std::size_t d = 0; d < D; ++d)
            sent[d] = static_cast<float>(jump[d]) * power_of_two(static_cast<int>(shift));
        const auto step = Channel::from_wire(sent, Polynomial<D, Order>{span}.c[0]);
        for (std::size_t d = 0; d < D; ++d)
            span.c[Order - 1][d] = clamped_sum(span.c[Order - 1][d], to_integer(step[d]));
    }

    /// On to a knot at which everything but the value ends.
    void stop(std::uint32_t ticks, std::uint32_t tick_ns) noexcept {
        span = carried(span, ticks, tick_ns);
        halt();
    }
    void halt() noexcept {
        for (std::size_t m = 1; m < Order; ++m) span.c[m] = {};
    }
};

}  // namespace fairlead::earlier
