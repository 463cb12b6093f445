#pragma once
// The samples that the emitted curve does not cover yet.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/ring.hpp"
#include "host_sim/study/baselines/earlier/reduce/channel.hpp"

namespace fairlead::earlier {

/// A sample that waits for its curve, and what the fit under way notes beside it.
template <class Channel>
struct Waiting {
    std::int64_t t_ns{};
    typename Channel::Value value{};
    float u{};                // ticks since the knot of the frozen span
    float weight{}, error{};  // of the fit under way; errors in tolerances
    std::uint16_t record{};   // the low bits of the index of its record
    bool starts_curve{};
};

/// Oldest first; one more than the delay, because a sample joins before the oldest leaves.
template <class Channel, std::size_t N>
using Window = Ring<Waiting<Channel>, N + 1>;

/// How many of the first n samples stand at or before u, by halving.
template <class Samples>
std::size_t samples_until(const Samples& samples, std::size_t n, float u) noexcept {
    std::size_t low = 0;
    while (low < n) {
        const std::size_t middle = (low + n) / 2;
        if (samples[middle].u <= u)
            low = middle + 1;
        else
            n = middle;
    }
    return low;
}

}  // namespace fairlead::earlier
