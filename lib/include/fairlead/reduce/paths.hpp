#pragma once
// The paths of a search: each vertex that may still be on the way to the best one knows the vertex
// before it.
//
// Most vertices lead nowhere and are forgotten: when the room is used up, the vertices from which
// no hypothesis goes back are free again. What is left are few, because paths join.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/base/status.hpp"

namespace fairlead::reduce {

/// How the vertex at the end of a piece was reached.
namespace how {
inline constexpr std::uint8_t line = 8;     // a straight line
inline constexpr std::uint8_t jump = 16;    // a jump
inline constexpr std::uint8_t to_end = 32;  // coded as "to the end of the frame"
inline constexpr std::uint8_t rebase = 64;  // a rotation: the anchor moves behind the piece
}  // namespace how

/// A piece as the search commits it; k follows from the walk along the curve.
template <std::size_t N>
struct Step {
    std::array<std::int16_t, N> v{};  // vertex at its end, against the window's origin
    std::uint8_t ticks{};
    std::uint8_t how{};
};

/// Room for Capacity vertices of N components, at most 254.
template <std::size_t N, std::size_t Capacity>
class Paths {
    static_assert(Capacity >= 1 && Capacity < 255, "a vertex has a number of 8 bits");

  public:
    using Index = std::uint8_t;
    static constexpr Index start = 255;  // where the window begins: before all vertices

    void clear() noexcept { used_ = {}, count_ = 0; }
    std::size_t room() const noexcept { return Capacity - count_; }

    /// A vertex behind `before`. There must be room.
    Index add(Index before, const Step<N>& step) noexcept {
        std::size_t word = 0;
        while (word + 1 < words && used_[word] == ~std::uint32_t{0}) ++word;
        const std::uint32_t open = ~used_[word];
        const std::size_t i =
            word * 32 + (open != 0 ? static_cast<std::size_t>(__builtin_ctz(open)) : 0u);
        FAIRLEAD_ASSERT(open != 0 && i < Capacity);
        if (open == 0 || i >= Capacity) return start;
        used_[word] |= open & (~open + 1u);
        ++count_;
        v_[i] = step.v;
        ticks_[i] = step.ticks;
        how_[i] = step.how;
        before_[i] = before;
        return static_cast<Index>(i);
    }

    /// Forgets all vertices but those that are kept behind this, with the paths to them.
    void forget() noexcept { clear(); }
    void keep(Index i) noexcept {
        while (i < Capacity && (used_[i / 32] >> i % 32 & 1u) == 0) {
            used_[i / 32] |= std::uint32_t{1} << i % 32;
            ++count_;
            i = before_[i];
        }
    }

    /// Writes the path to a vertex, in order, from steps[from] on; what does not fit is left out.
    /// @return its length.
    template <class Steps>
    std::size_t trace(Index to, Steps& steps, std::size_t from) const noexcept {
        std::size_t count = 0;
        for (Index i = to; i < Capacity && count < Capacity; i = before_[i]) ++count;
        Index i = to;
        for (std::size_t at = count; at > 0; i = before_[i]) {
            --at;
            if (from + at < steps.size()) steps[from + at] = {v_[i], ticks_[i], how_[i]};
        }
        return count;
    }

  private:
    static constexpr std::size_t words = (Capacity + 31) / 32;

    std::array<std::array<std::int16_t, N>, Capacity> v_{};
    std::array<std::uint8_t, Capacity> ticks_{}, how_{};
    std::array<Index, Capacity> before_{};
    std::array<std::uint32_t, words> used_{};
    std::size_t count_{0};
};

}  // namespace fairlead::reduce
