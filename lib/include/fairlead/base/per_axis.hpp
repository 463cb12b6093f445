#pragma once
// A number for each axis of a vector, or one for all.
#include <array>
#include <cstddef>

#include "fairlead/base/compiler.hpp"

namespace fairlead {

/// One value for each axis; one number alone holds for all.
template <std::size_t D>
struct PerAxis : std::array<float, D> {
    constexpr PerAxis() noexcept : PerAxis{0.0f} {}
    constexpr PerAxis(float all) noexcept : std::array<float, D>{} {  // NOLINT(*-explicit-*)
        for (std::size_t i = 0; i < D; ++i) (*this)[i] = all;
    }
    constexpr PerAxis(const std::array<float, D>& each) noexcept  // NOLINT(*-explicit-*)
        : std::array<float, D>{each} {}

    /// Of the first N axes.
    template <std::size_t N>
    constexpr PerAxis<N> first() const noexcept {
        static_assert(N <= D);
        PerAxis<N> some;
        for (std::size_t i = 0; i < N; ++i) some[i] = (*this)[i];
        return some;
    }
};

}  // namespace fairlead
