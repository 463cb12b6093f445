#pragma once
// A covariance matrix that stays symmetric by construction: the lower triangle, row by row.
//
// Two operations carry the whole filter: a shear, x_r += a z for some states r and a combination z
// of others, and the scalar measurement of one state. Cost: N^2/2 + O(N) multiply-adds each.
// Positive over a day of data in float, and why a square-root form is not needed: docs/attitude.md.
#include <array>
#include <cstddef>
#include <utility>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

template <class Real, std::size_t N>
struct Covariance {
    static constexpr std::size_t size = N;
    using Column = std::array<Real, N>;

    /// The least noise of a measurement over the variance of what is measured: with less, what is
    /// left of a variance would be rounding, and could be negative.
    static constexpr Real noise_least = Real{1} / 65536;

    std::array<Real, N*(N + 1) / 2> packed{};

    static constexpr std::size_t row(std::size_t i) noexcept { return i * (i + 1) / 2; }

    constexpr Real& operator()(std::size_t i, std::size_t j) noexcept {
        return i >= j ? packed[row(i) + j] : packed[row(j) + i];
    }
    constexpr Real operator()(std::size_t i, std::size_t j) const noexcept {
        return i >= j ? packed[row(i) + j] : packed[row(j) + i];
    }

    /// out += factor * column i.
    constexpr void add_column(std::size_t i, Real factor, Column& out) const noexcept {
        const Real* p = packed.data() + row(i);
        for (std::size_t j = 0; j <= i; ++j) out[j] += factor * p[j];
        p += i + i + 1;
        for (std::size_t j = i + 1; j < N; p += ++j) out[j] += factor * *p;
    }
    constexpr Column column(std::size_t i) const noexcept {
        Column out{};
        const Real* p = packed.data() + row(i);
        for (std::size_t j = 0; j <= i; ++j) out[j] = p[j];
        p += i + i + 1;
        for (std::size_t j = i + 1; j < N; p += ++j) out[j] = *p;
        return out;
    }

    /// x_r += a z, where z has covariances `with` to the states and variance `variance`; both are
    /// brought up to date, so that further rows may follow. z must not contain x_r.
    constexpr void shear(std::size_t r, Real a, Column& with, Real variance) noexcept {
        Real* p = packed.data() + row(r);
        for (std::size_t j = 0; j < r; ++j) p[j] += a * with[j];
        const Real moved = with[r] + a * variance;
        p[r] += a * (with[r] + moved);
        p += r + r + 1;
        for (std::size_t j = r + 1; j < N; p += ++j) *p += a * with[j];
        with[r] = moved;
    }

    /// What measuring a quantity with covariances `with` to the states takes away: with with' / s.
    /// Unrolled: half the instructions of a loop over so short rows, for 2 kB of code.
    [[gnu::noinline]] void shrink(const Column& with, Real one_by_s) noexcept {
        shrink_rows(with, one_by_s, std::make_index_sequence<N>{});
    }

  private:
    template <std::size_t... Index>
    void shrink_rows(const Column& with, Real one_by_s, std::index_sequence<Index...>) noexcept {
        (shrink_row(packed.data() + row(Index), with[Index] * one_by_s, with,
                    std::make_index_sequence<Index + 1>{}),
         ...);
    }
    template <std::size_t... J>
    static void shrink_row(Real* p, Real gain, const Column& with,
                           std::index_sequence<J...>) noexcept {
        ((p[J] -= gain * with[J]), ...);
    }
};

}  // namespace fairlead
