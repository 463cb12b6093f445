#pragma once
// Where the control points of a curve should be: an estimate from the samples around them.
//
// The control point of a uniform cubic spline with knots h ticks apart is x - h^2 / 6 x'' of the
// spline's middle. Value and bend come from means of the samples over three boxes within h ticks on
// both sides, which prefix sums give in constant time. Behind the newest sample they come from a
// parabola over the last ones, whose bend fades. Estimates only order the hypotheses of a search:
// no guarantee rests on them.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/compiler.hpp"
#include "fairlead/curve/grid.hpp"
#include "fairlead/curve/scale.hpp"

namespace fairlead::reduce {

/// Estimates for one axis, in steps against an origin. View: size(); time(i), ticks from the
/// window's start, rising; before(i), the sum of the samples before i modulo 2^32, of 1/1024 steps;
/// value(i), in 1/1024 steps modulo 2^32.
template <class View>
class CubicGuide {
  public:
    CubicGuide(const View& view, std::int32_t origin) noexcept
        : view_{view},
          origin_{static_cast<std::uint32_t>(origin) * static_cast<std::uint32_t>(curve::fine)} {
        const std::size_t n = view_.size();
        if (n == 0) return;
        first_ = view_.time(0);
        last_ = view_.time(n - 1);
        density_ = last_ > first_ ? static_cast<float>(n - 1) / (last_ - first_) : 0.0f;
        short_ = parabola(8);
        long_ = parabola(20);
    }

    /// The control point at tick t of knots h ticks apart.
    float control(float t, float h) const noexcept {
        const float usual = h > 2.0f ? h : 2.0f;
        const float least = usual * 0.5f > 3.0f ? usual * 0.5f : usual < 3.0f ? usual : 3.0f;
        if (t + least > last_) return behind(h < 12.0f ? short_ : long_, t, h);
        float half = usual;
        if (half > last_ - t) half = last_ - t;
        if (half > t - first_ && t - first_ >= 1.0f) half = t - first_;
        // boxes that overlap a little where few samples lie in them
        const float reach = half * (1.0f / 3.0f) > 0.5f ? half * (1.0f / 3.0f) : 0.5f;
        const float apart = half - reach > 1.0f ? half - reach : 1.0f;
        const Mean a = mean(t - apart, reach), b = mean(t, reach), c = mean(t + apart, reach);
        const float ab = b.time - a.time, bc = c.time - b.time;
        if (!(ab > 0.0f && bc > 0.0f)) return b.value;
        // the parabola through the three means, at t
        const float rate = (b.value - a.value) / ab;
        const float half_bend = ((c.value - b.value) / bc - rate) / (ab + bc);
        const float value = a.value + (t - a.time) * (rate + half_bend * (t - b.time));
        return value - half_bend * (reach * reach + h * h) * (1.0f / 3.0f);
    }

  private:
    /// Value, rate and bend at the last sample.
    struct Parabola {
        float value{}, rate{}, bend{};
    };
    struct Mean {
        float value{}, time{};
    };
    static constexpr int steps_most = 12;   // of the search for a sample
    static constexpr float fading = 12.0f;  // ticks

    float steps(std::uint32_t sum, std::size_t n) const noexcept {
        const auto off = static_cast<std::int32_t>(sum - static_cast<std::uint32_t>(n) * origin_);
        return static_cast<float>(off) * (1.0f / static_cast<float>(curve::fine));
    }
    /// The first sample that is not before t; of samples that are very uneven, one near it.
    std::size_t at(float t) const noexcept {
        const std::size_t n = view_.size();
        if (!(t > first_)) return 0;
        if (t > last_) return n;
        auto i = static_cast<std::size_t>((t - first_) * density_);
        if (i >= n) i = n - 1;
        for (int k = 0; k < steps_most && i < n && view_.time(i) < t; ++k) ++i;
        for (int k = 0; k < steps_most && i > 0 && !(view_.time(i - 1) < t); ++k) --i;
        return i;
    }
    /// Of the samples within reach of t; of none, the one behind.
    Mean mean(float t, float reach) const noexcept {
        const std::size_t n = view_.size();
        std::size_t from = at(t - reach), to = at(t + reach + 1e-3f);
        if (from >= n) from = n - 1;
        if (to <= from) to = from + 1;
        const std::uint32_t end =
            to < n ? view_.before(to) : view_.before(n - 1) + view_.value(n - 1);
        return {steps(end - view_.before(from), to - from) / static_cast<float>(to - from),
                (view_.time(from) + view_.time(to - 1)) * 0.5f};
    }
    /// Least squares over the last `most` samples, as if they were evenly apart: value, rate and
    /// bend at the last one. Of few samples the bend is damped.
    Parabola parabola(std::size_t most) const noexcept {
        const std::size_t n = view_.size(), m = n < most ? n : most;
        Parabola p;
        p.value = steps(view_.value(n - 1), 1);
        if (m < 3) return p;
        const auto count = static_cast<float>(m);
        const float middle = (count - 1.0f) * 0.5f;
        float s0 = 0, s1 = 0, s2 = 0;
        for (std::size_t i = 0; i < m; ++i) {
            const float u = static_cast<float>(i) - middle;
            const float x = steps(view_.value(n - m + i), 1) - p.value;
            s0 += x;
            s1 += u * x;
            s2 += u * u * x;
        }
        const float q2 = count * (count * count - 1.0f) * (1.0f / 12.0f);
        const float q4 = q2 * (3.0f * count * count - 7.0f) * (1.0f / 20.0f);
        const float spacing = (last_ - view_.time(n - m)) / (count - 1.0f);
        const float rate = s1 / q2;
        const float bend = m > 3 ? (count * s2 - q2 * s0) / (count * q4 - q2 * q2) : 0.0f;
        p.value += (s0 - bend * q2) / count + rate * middle + bend * middle * middle;
        p.rate = (rate + 2.0f * bend * middle) / spacing;
        p.bend = 2.0f * bend * count / ((count + 4.0f) * spacing * spacing);
        return p;
    }
    float behind(const Parabola& p, float t, float h) const noexcept {
        const float h6 = h * h * (1.0f / 6.0f), after = t - last_;
        if (after < 0.0f) return p.value + after * (p.rate + after * p.bend * 0.5f) - h6 * p.bend;
        const float y = after * (1.0f / fading);
        const float rest = 1.0f / (1.0f + y * (1.0f + y * 0.5f));  // about exp(-y)
        return p.value + p.rate * after +
               p.bend * (fading * (after - fading * (1.0f - rest)) - h6 * rest);
    }

    const View& view_;
    std::uint32_t origin_;
    float first_{0}, last_{0}, density_{0};  // density: samples a tick
    Parabola short_{}, long_{};              // over the last samples
};

}  // namespace fairlead::reduce
