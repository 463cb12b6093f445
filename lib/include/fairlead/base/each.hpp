#pragma once
// Loops of a small constant length, written out by the compiler wherever it optimises.
#include <cstddef>
#include <type_traits>
#include <utility>

namespace fairlead {

namespace detail {
template <class Body, std::size_t... I>
[[gnu::always_inline]] constexpr void each(Body&& body, std::index_sequence<I...>) noexcept {
    (body(std::integral_constant<std::size_t, I>{}), ...);
}
}  // namespace detail

/// body(0), body(1), ... body(N - 1).
template <std::size_t N, class Body>
[[gnu::always_inline]] constexpr void each(Body&& body) noexcept {
    detail::each(body, std::make_index_sequence<N>{});
}

}  // namespace fairlead
