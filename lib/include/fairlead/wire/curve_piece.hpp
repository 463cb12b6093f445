#pragma once
// What a decoder tells: a piece of a curve between two vertices, and its values.
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "fairlead/curve/cubic_state.hpp"
#include "fairlead/curve/rotation.hpp"
#include "fairlead/curve/scale.hpp"
#include "fairlead/math/quat.hpp"

namespace fairlead::wire {

namespace detail {
struct NoCubic {};
/// What a reader of C2 cubics tells beside.
struct CubicPart {
    bool cubic{false};           // the curve is that of `span`; a jump holds v
    curve::CubicSpan<1> span{};  // exact (curve/cubic.hpp)
};
}  // namespace detail

/// A piece of one track, an axis or a rotation, between two vertices of its curve. start < end but
/// for a curve of a single vertex. Cubics: may it be a C2 cubic? A decoder's Piece says it.
template <bool Cubics>
struct BasicCurvePiece : std::conditional_t<Cubics, detail::CubicPart, detail::NoCubic> {
    std::uint8_t channel{0};
    std::uint8_t axis{0};             // of the channel; 0 for a rotation
    bool rotates{false};              // 3 components about the anchor; else 1
    bool begins{false};               // a curve starts: nothing joins it to what was before
    bool jumps{false};                // the value jumped at the piece's start: a break
    bool ends{false};                 // the curve ends with this piece
    bool fresh{false};                // a cubic leads from the slope to that of the chord
    std::uint8_t code{0};             // curve/lengths.hpp
    std::int64_t start{0}, end{0};    // sub-ticks since the run's base; Grid::time_ns() gives ns
    std::array<std::int32_t, 3> v{};  // lattice steps at the start; of a cubic, the nearest there
    std::array<std::int32_t, 3> s{};  // slope there, 1/960 step a tick; of a jump: its size, steps
    std::array<float, 3> rise{};      // steps from start to end
    Quat anchor{};                    // of a rotation
    curve::Scale scale{};             // of the lattice: value = steps * scale.step()

    /// Lattice steps of component c, `ticks` after the piece's start, which may have a fraction;
    /// with Real = double the encoder's guarantee holds for it. A piece holds for times behind its
    /// start up to its end, the first one of a curve also at its start.
    template <class Real>
    Real steps_at(Real ticks, std::size_t c = 0) const noexcept {
        // a curve that begins with a jump has its first value at its start alone
        if (jumps && begins && !(ticks > 0)) return static_cast<Real>(v[c] - s[c]);
        if constexpr (Cubics)
            if (this->cubic) return curve::value_at<Real>(this->span, 0, ticks);
        return static_cast<Real>(v[c]) + polynomial<Real>(c).rise(ticks);
    }
    /// Steps a tick, and steps a tick^2.
    template <class Real>
    Real rate_at(Real ticks, std::size_t c = 0) const noexcept {
        return polynomial<Real>(c).rate(ticks);
    }
    template <class Real>
    Real bend_at(Real ticks, std::size_t c = 0) const noexcept {
        return polynomial<Real>(c).bend(ticks);
    }
    template <class Real>
    curve::Polynomial<Real> polynomial(std::size_t c) const noexcept {
        if (start == end) return {};
        if constexpr (Cubics)
            if (this->cubic) return curve::cubic<Real>(this->span.start[0], this->span.j[0]);
        const std::int32_t h = subs() / curve::subs_per_tick;
        return curve::polynomial<Real>(code, fresh, s[c], static_cast<Real>(rise[c]), h);
    }
    /// From the start to the end.
    template <class Real = double>
    Real ticks() const noexcept {
        return static_cast<Real>(subs()) / static_cast<Real>(curve::subs_per_tick);
    }
    std::int32_t subs() const noexcept { return static_cast<std::int32_t>(end - start); }
};
using CurvePiece = BasicCurvePiece<false>;

/// The rotation of a piece, `ticks` after its start.
template <bool Cubics, class Real>
BasicQuat<Real> rotation_at(const BasicCurvePiece<Cubics>& p, Real ticks) noexcept {
    const Real step = p.scale.template step<Real>();
    const BasicVec3<Real> theta{step * p.steps_at(ticks, 0), step * p.steps_at(ticks, 1),
                                step * p.steps_at(ticks, 2)};
    const BasicQuat<Real> anchor{static_cast<Real>(p.anchor.w), static_cast<Real>(p.anchor.x),
                                 static_cast<Real>(p.anchor.y), static_cast<Real>(p.anchor.z)};
    if constexpr (std::is_same_v<Real, float>)
        return anchor * curve::chart_exp(theta);  // the decoder's own: no second sine and cosine
    else
        return anchor * from_rotation_vector(theta);
}

}  // namespace fairlead::wire
