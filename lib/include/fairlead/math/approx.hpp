#pragma once
// Elementary functions on our own polynomials: the same bits with every compiler and on every core.
// libm's sinf, atan2f, expf... differ between C libraries; sqrt does not (IEEE 754) and is used as
// is.
//
// Each is a fixed leading part plus a Chebyshev interpolant of the rest, so that small arguments
// come out exact to rounding. Coefficients: tests/ref/approx_coefficients.py. Errors, held by
// tests/unit/test_approx.cpp: docs/math.md. Cost: no loops, no tables.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

template <class Real>
inline constexpr Real pi_v = static_cast<Real>(3.14159265358979323846);

namespace approx {

namespace detail {

template <class Real, std::size_t N>
constexpr Real polynomial(const Real (&c)[N], Real x) noexcept {
    Real sum = c[N - 1];
    for (std::size_t i = N - 1; i > 0; --i) sum = sum * x + c[i - 1];
    return sum;
}

template <class Real>
struct Coefficients;

template <>
struct Coefficients<float> {
    static constexpr float sin[] = {-0.1666666466f, 0.008332748271f, -0.0001958789088f};
    static constexpr float cos[] = {0.04166666466f, -0.001388830304f, 2.454794209e-5f};
    static constexpr float atan[] = {-0.333333329f, 0.1999987525f,   -0.142798011f,
                                     0.1100688068f, -0.08235505764f, 0.04225685963f};
    static constexpr float exp[] = {0.5f, 0.1666657703f, 0.04166655466f, 0.008363173075f,
                                    0.001392617612f};
    static constexpr float log[] = {0.6666668504f, 0.3998878057f, 0.2957994939f};
    // pi/2 and ln 2 in parts whose products with small integers are exact
    static constexpr float half_pi[] = {1.5703125f, 4.837512969970703125e-4f, 7.549789954891e-8f};
    // k pi/4 and what its rounding left out
    static constexpr float eighths[] = {0, 0.785398185f, 1.57079637f, 2.3561945f, 3.14159274f};
    static constexpr float eighths_rest[] = {0, -2.18556941e-8f, -4.37113883e-8f, -5.96244032e-9f,
                                             -8.74227766e-8f};
    static constexpr float ln2[] = {0.693359375f, -2.12194440e-4f};
    static constexpr float round_to_integer = 12582912.0f;  // 1.5 * 2^23
    static constexpr int mantissa_bits = 23;
    static constexpr int exponent_bias = 127;
    using Bits = std::uint32_t;
};

template <>
struct Coefficients<double> {  // the reference instance of the tests
    static constexpr double sin[] = {-0.166666666666666667,    0.00833333333333333149,
                                     -0.000198412698412650649, 2.75573192193391665e-6,
                                     -2.50521062324475773e-8,  1.60585316189861468e-10,
                                     -7.58669711770691798e-13};
    static constexpr double cos[] = {0.0416666666666666667,    -0.00138888888888888879,
                                     0.0000248015873015846464, -2.75573192214028244e-7,
                                     2.08767557910804238e-9,   -1.14704608876099591e-11,
                                     4.74587190204329154e-14};
    static constexpr double atan[] = {
        -0.33333333333333333,   0.199999999999994879,   -0.14285714285599188,
        0.111111111009173751,   -0.0909090862032252225, 0.0769229471254028448,
        -0.0666643567723594782, 0.0587957842958242486,  -0.0524009950799471311,
        0.0462802486857015324,  -0.0380665367205736591, 0.0250065035664895075,
        -0.0092157920470898591};
    static constexpr double exp[] = {0.5,
                                     0.16666666666666671,
                                     0.0416666666666666698,
                                     0.00833333333332614088,
                                     0.00138888888888837524,
                                     0.00019841269874800492,
                                     0.0000248015873255333638,
                                     2.75572554257464343e-6,
                                     2.75572736613486362e-7,
                                     2.51052063739570111e-8,
                                     2.09146793765839351e-9};
    static constexpr double log[] = {
        0.666666666666666969, 0.399999999998995045, 0.285714286259754849, 0.222222111347950799,
        0.181828891252617221, 0.153317216005560413, 0.146164496850434059};
    static constexpr double half_pi[] = {1.57079632673412561417, 6.07710050630396597660e-11,
                                         2.02226624879595063154e-21};
    static constexpr double eighths[] = {0, 0.78539816339744828, 1.5707963267948966,
                                         2.3561944901923448, 3.1415926535897931};
    static constexpr double eighths_rest[] = {0, 3.061616997868383e-17, 6.123233995736766e-17,
                                              9.1848509936051484e-17, 1.2246467991473532e-16};
    static constexpr double ln2[] = {6.93147180369123816490e-1, 1.90821492927058770002e-10};
    static constexpr double round_to_integer = 6755399441055744.0;  // 1.5 * 2^52
    static constexpr int mantissa_bits = 52;
    static constexpr int exponent_bias = 1023;
    using Bits = std::uint64_t;
};

/// Nearest integer of |x| < 2^(mantissa_bits - 2), as a Real.
template <class Real>
constexpr Real nearest(Real x) noexcept {
    constexpr Real c = Coefficients<Real>::round_to_integer;
    return (x + c) - c;
}

template <class To, class From>
inline To bit_cast(const From& from) noexcept {
    static_assert(sizeof(To) == sizeof(From));
    To to;
    __builtin_memcpy(&to, &from, sizeof to);
    return to;
}

}  // namespace detail

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wfloat-equal"
/// Exact equality of two floats, where that is what is meant: the only `==` on floats here.
template <class Real>
constexpr bool same(Real a, Real b) noexcept {
    return a == b;
}
#pragma GCC diagnostic pop

template <class Real>
constexpr bool is_nan(Real x) noexcept {
    return !same(x, x);
}

template <class Real>
constexpr bool is_finite(Real x) noexcept {
    return same(x - x, Real{0});
}

constexpr float absolute(float x) noexcept { return __builtin_fabsf(x); }
constexpr double absolute(double x) noexcept { return __builtin_fabs(x); }

inline float sqrt(float x) noexcept { return __builtin_sqrtf(x); }
inline double sqrt(double x) noexcept { return __builtin_sqrt(x); }

template <class Real>
struct SinCos {
    Real sin, cos;
};

/// Sine and cosine of x rad, |x| <= 8192. Beyond: still finite, accuracy fades with the reduction.
/// NaN and infinities give NaN.
template <class Real>
constexpr SinCos<Real> sin_cos(Real x) noexcept {
    using C = detail::Coefficients<Real>;
    constexpr Real two_over_pi = static_cast<Real>(0.63661977236758134308);
    constexpr Real limit = static_cast<Real>(1 << 20);
    if (!(absolute(x) <= limit)) {
        if (!is_finite(x)) return {x - x, x - x};
        x = 0;  // no accuracy is promised out there; a bounded answer is
    }
    const Real turns = detail::nearest(x * two_over_pi);
    const Real r = ((x - turns * C::half_pi[0]) - turns * C::half_pi[1]) - turns * C::half_pi[2];
    const Real z = r * r;
    const Real s = r + r * z * detail::polynomial(C::sin, z);
    const Real half = z / 2, one_less = 1 - half;
    const Real c = one_less + (((1 - one_less) - half) + z * z * detail::polynomial(C::cos, z));
    switch (static_cast<std::int32_t>(turns) & 3) {
        case 0: return {s, c};
        case 1: return {c, -s};
        case 2: return {-s, -c};
        default: return {-c, s};
    }
}

template <class Real>
constexpr Real sin(Real x) noexcept {
    return sin_cos(x).sin;
}

template <class Real>
constexpr Real cos(Real x) noexcept {
    return sin_cos(x).cos;
}

/// Angle of the vector (x, y) in (-pi, pi]. atan2(0, 0) = 0. NaN in, NaN out.
template <class Real>
constexpr Real atan2(Real y, Real x) noexcept {
    using C = detail::Coefficients<Real>;
    if (is_nan(x) || is_nan(y)) return x + y;
    const Real ax = absolute(x), ay = absolute(y);
    const bool steep = ay > ax;
    const Real low = steep ? ax : ay, high = steep ? ay : ax;
    if (same(high, Real{0})) return 0;
    // first octant, then |t| <= 1/2 by atan(t) = pi/4 + atan((t - 1) / (t + 1)): from 1/2 on the
    // numerator is exact
    const bool infinite = !is_finite(high);
    const Real lo = infinite ? (is_finite(low) ? Real{0} : Real{1}) : low;
    const Real hi = infinite ? Real{1} : high;
    const bool folded = lo > hi / 2;
    const Real t = folded ? (lo - hi) / (lo + hi) : lo / hi;
    // the angle is a multiple of pi/4, in two parts, and plus or minus atan(t)
    std::size_t eighths = folded ? 1 : 0;
    bool minus = false;
    if (steep) eighths = 2 - eighths, minus = !minus;
    if (x < 0) eighths = 4 - eighths, minus = !minus;
    const Real z = t * t, r = minus ? -t : t;
    const Real angle = C::eighths[eighths] +
                       (r + (C::eighths_rest[eighths] + r * z * detail::polynomial(C::atan, z)));
    return y < 0 ? -angle : angle;
}

/// Arcus sine; arguments beyond [-1, 1] (rounding) are clamped.
template <class Real>
inline Real asin(Real x) noexcept {
    const Real r = (1 - x) * (1 + x);
    return atan2(x, r > 0 ? sqrt(r) : Real{0});
}

/// Arcus cosine; arguments beyond [-1, 1] (rounding) are clamped.
template <class Real>
inline Real acos(Real x) noexcept {
    const Real r = (1 - x) * (1 + x);
    return atan2(r > 0 ? sqrt(r) : Real{0}, x);
}

/// e^x; below the normal range 0, above it the largest finite number.
template <class Real>
inline Real exp(Real x) noexcept {
    using C = detail::Coefficients<Real>;
    constexpr Real log2_e = static_cast<Real>(1.44269504088896340736);
    if (is_nan(x)) return x;
    const Real scaled = x * log2_e;
    if (scaled > static_cast<Real>(C::exponent_bias)) return (std::numeric_limits<Real>::max)();
    if (scaled < static_cast<Real>(1 - C::exponent_bias)) return 0;
    const Real n = detail::nearest(scaled);
    const Real r = (x - n * C::ln2[0]) - n * C::ln2[1];
    const Real y = 1 + (r + r * r * detail::polynomial(C::exp, r));
    // 2^n in two factors: n may be bias + 1 after rounding up
    const auto n_int = static_cast<std::int32_t>(n);
    const auto half = n_int / 2;
    const auto power = [](std::int32_t e) {
        using Bits = typename C::Bits;
        return detail::bit_cast<Real>(
            static_cast<Bits>(static_cast<Bits>(e + C::exponent_bias) << C::mantissa_bits));
    };
    return y * power(half) * power(n_int - half);
}

/// Natural logarithm of a normal positive number; 0 and below give the lowest finite number.
template <class Real>
inline Real log(Real x) noexcept {
    using C = detail::Coefficients<Real>;
    using Bits = typename C::Bits;
    if (is_nan(x)) return x;
    if (!(x >= (std::numeric_limits<Real>::min)())) return std::numeric_limits<Real>::lowest();
    if (!is_finite(x)) return (std::numeric_limits<Real>::max)();
    const Bits bits = detail::bit_cast<Bits>(x);
    constexpr Bits mantissa = (Bits{1} << C::mantissa_bits) - 1;
    auto exponent = static_cast<std::int32_t>(bits >> C::mantissa_bits) - C::exponent_bias;
    Real m = detail::bit_cast<Real>(static_cast<Bits>(
        (bits & mantissa) | (static_cast<Bits>(C::exponent_bias) << C::mantissa_bits)));
    if (m > static_cast<Real>(1.41421356237309504880)) {
        m /= 2;
        ++exponent;
    }
    // log(1 + f) = 2 s + s R with s = f / (2 + f), written so that the rounding of s hardly counts
    const Real f = m - 1, s = f / (2 + f), z = s * s, half = f * f / 2;
    const auto e = static_cast<Real>(exponent);
    const Real rest = s * (half + z * detail::polynomial(C::log, z)) + e * C::ln2[1];
    return e * C::ln2[0] - ((half - rest) - f);
}

}  // namespace approx
}  // namespace fairlead
