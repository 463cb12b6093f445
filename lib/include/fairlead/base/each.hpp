#pragma once
// Loops of a small constant length: written out by the compiler where it optimises for speed.
#include <cstddef>
#include <type_traits>
#include <utility>

#include "fairlead/base/compiler.hpp"

/// Before a function, or after a lambda's parameters: written out wherever it is called, however
/// long it is, unless the compiler optimises for size.
#ifdef __OPTIMIZE_SIZE__
#define FAIRLEAD_INLINE
#else
#define FAIRLEAD_INLINE __attribute__((always_inline))
#endif

namespace fairlead {

namespace detail {
template <class Body, std::size_t... Index>
[[gnu::always_inline]] constexpr void each(Body&& body, std::index_sequence<Index...>) noexcept {
    (body(std::integral_constant<std::size_t, Index>{}), ...);
}

/// Does a lambda say what it takes? One with an `auto` does not.
template <class Body, class = void>
struct TakesNumber : std::false_type {};
template <class Body>
struct TakesNumber<Body, std::void_t<decltype(&Body::operator())>> : std::true_type {};
}  // namespace detail

/// body(0), body(1), ... body(N - 1). A body that takes a std::size_t is written out for speed, and
/// remains a loop where the compiler optimises for size; one that takes `auto` gets constants, and
/// is always written out.
template <std::size_t N, class Body>
[[gnu::always_inline]] constexpr void each(Body&& body) noexcept {
#ifdef __OPTIMIZE_SIZE__
    constexpr bool loop = detail::TakesNumber<std::remove_reference_t<Body>>::value;
#else
    constexpr bool loop = false;
#endif
    if constexpr (loop)
        for (std::size_t i = 0; i < N; ++i) body(i);
    else
        detail::each(body, std::make_index_sequence<N>{});
}

}  // namespace fairlead
