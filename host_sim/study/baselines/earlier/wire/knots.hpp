#pragma once
// Knots in few bits: what a jump is likely to be, and how large its surprise.
//
// After a knot the third derivative tends to lead the second back to zero within the interval that
// follows: the jump is expected to cancel it and to go `leading_back` of that way. The rounding
// of a jump is chosen for its interval, so it tells of the interval: `reach`, the rounding for
// that interval, is sent, and how much finer the jump was rounded. Surprises are in Rice codes
// [R. F. Rice, 1979] for the rounding that their reach asks for.
#include <array>
#include <cstddef>
#include <cstdint>

#include "host_sim/study/baselines/earlier/reduce/reducer.hpp"
#include "host_sim/study/baselines/earlier/wire/numbers.hpp"

namespace fairlead::earlier::wire {

/// Adaptive codes of one channel; reset to a few bits of themselves at restart points.
struct Models {
    RiceModel ticks{}, reach{16 * 2}, finer{16};
    std::array<RiceModel, 2> jump{};
    std::uint32_t last_reach{12};
};

/// Instead of a place in finer_places.
inline constexpr std::uint32_t stop_sign = finer_places.size();
inline constexpr std::uint32_t reach_max = 31;
inline constexpr float leading_back = 0.45f;

/// 2^(n / Parts), n from -64 to 64.
template <std::size_t Parts>
float root_of_power(int n) noexcept {
    static_assert(Parts >= 1 && Parts <= 5);
    constexpr std::array<float, 5> step{2, 1.41421356f, 1.25992105f, 1.18920712f, 1.14869835f};
    constexpr int parts = static_cast<int>(Parts);
    const int whole = (n + 64 * parts) / parts - 64;
    float out = power_of_two(whole);
    for (int i = whole * parts; i < n; ++i) out *= step[Parts - 1];
    return out;
}

/// The length in ticks of the interval that a rounding is for, its inverse: of 0 places one tick's.
template <class Channel>
float per_length(std::uint32_t reach) noexcept {
    constexpr int of_one_tick = fraction_bits(Channel::order - 1) - rounding_places;
    return root_of_power<Channel::order - 1>(static_cast<int>(reach) - of_one_tick);
}

/// Intervals to come may be about as long as the one that the latest rounding was for.
template <class Channel>
std::uint32_t mean16_of_reach(std::uint32_t reach) noexcept {
    return static_cast<std::uint32_t>(to_integer(0.5f * 16 / per_length<Channel>(reach)));
}

/// What the state of a curve at a knot lets one expect of the jump there.
template <class Channel>
class Outlook {
  public:
    static constexpr std::size_t D = Channel::dimension, last = Channel::order - 1;
    using Jump = std::array<std::int32_t, D>;

    explicit Outlook(const Span<D, last + 1>& at) noexcept {
        std::array<float, D> value;
        for (std::size_t d = 0; d < D; ++d) {
            value[d] = static_cast<float>(at.c[0][d]) * power_of_two(-fraction_bits(0));
            cancelling_[d] = -static_cast<float>(at.c[last][d]);
            if (last > 1) leading_[d] = -leading_back * 64 * static_cast<float>(at.c[last - 1][d]);
        }
        cancelling_ = Channel::to_wire(cancelling_, value);
        leading_ = Channel::to_wire(leading_, value);
    }

    /// In multiples of 2^shift.
    Jump expected(std::uint32_t reach, int shift) const noexcept {
        const float per_tick = per_length<Channel>(reach);
        const float places = power_of_two(-shift);
        Jump out;
        for (std::size_t d = 0; d < D; ++d)
            out[d] = to_integer((cancelling_[d] + leading_[d] * per_tick) * places);
        return out;
    }

  private:
    std::array<float, D> cancelling_{}, leading_{};
};

/// What a jump adds to what was expected, modulo 2^32; and back.
inline std::uint32_t surprise(std::int32_t jump, std::int32_t expected) noexcept {
    return zigzag(static_cast<std::int32_t>(static_cast<std::uint32_t>(jump) -
                                            static_cast<std::uint32_t>(expected)));
}
inline std::int32_t surprised(std::uint32_t surprise, std::int32_t expected) noexcept {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(unzigzag(surprise)) +
                                     static_cast<std::uint32_t>(expected));
}
inline std::uint32_t reach_change(std::uint32_t reach, const Models& models) noexcept {
    return zigzag(static_cast<std::int32_t>(reach - models.last_reach));
}

/// Bits that a number takes with a model, and `places` more as they are.
inline std::uint32_t cost(std::uint32_t v, const RiceModel& model, unsigned places = 0) noexcept {
    const std::uint32_t quotient = (v >> places) >> model.k();
    return places +
           (quotient < BitWriter::escape ? quotient + 1 + model.k() : BitWriter::escape + 32);
}
template <class Io>
void split(Io& io, std::uint32_t& v, RiceModel& model, unsigned places) noexcept {
    std::uint32_t high = v >> places, low = v & ((1u << places) - 1u);
    io.rice(high, model);
    io.bits(low, places);
    v = high << places | low;
}

/// Which of finer_places makes a knot cheapest?
template <class Channel>
std::uint32_t cheapest(const typename Outlook<Channel>::Jump& jump, std::uint32_t shift,
                       const Outlook<Channel>& outlook, const Models& models) noexcept {
    std::uint32_t best = 0, least = ~0u;
    for (std::uint32_t f = 0; f < finer_places.size(); ++f) {
        const std::uint32_t reach = shift + finer_places[f];
        if (reach > reach_max) break;
        const auto expected = outlook.expected(reach, static_cast<int>(shift));
        std::uint32_t bits =
            cost(f, models.finer) + cost(reach_change(reach, models), models.reach);
        for (std::size_t d = 0; d < Channel::dimension; ++d)
            bits += cost(surprise(jump[d], expected[d]), models.jump[Channel::model(d)],
                         finer_places[f]);
        if (bits >= least) continue;
        least = bits;
        best = f;
    }
    return best;
}

/// The jump of a knot where the curve stands `at`.
template <class Channel, class Io, class Knot>
void jump(Io& io, Knot& k, const Span<Channel::dimension, Channel::order>& at,
          Models& models) noexcept {
    const Outlook<Channel> outlook{at};
    std::uint32_t finer = stop_sign;
    if constexpr (Io::writes)
        if (k.shift != stop_shift) finer = cheapest(k.jump, k.shift, outlook, models);
    io.rice(finer, models.finer);
    if (finer >= stop_sign) {
        k.shift = stop_shift;
        k.jump = {};
        return;
    }
    const std::uint32_t places = finer_places[finer];
    std::uint32_t change = reach_change(k.shift + places, models);
    io.rice(change, models.reach);
    const std::uint32_t reach =
        (models.last_reach + static_cast<std::uint32_t>(unzigzag(change))) & reach_max;
    models.last_reach = reach;
    k.shift = static_cast<std::uint8_t>(reach > places ? reach - places : 0);
    const auto expected = outlook.expected(reach, k.shift);
    for (std::size_t d = 0; d < Channel::dimension; ++d) {
        std::uint32_t z = surprise(k.jump[d], expected[d]);
        split(io, z, models.jump[Channel::model(d)], places);
        k.jump[d] = surprised(z, expected[d]);
    }
}

}  // namespace fairlead::earlier::wire
