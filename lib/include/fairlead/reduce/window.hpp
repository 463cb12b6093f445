#pragma once
// The samples that the emitted curve does not cover yet.
#include <cstddef>
#include <cstdint>

#include "fairlead/base/ring.hpp"
#include "fairlead/reduce/channel.hpp"

namespace fairlead {

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

}  // namespace fairlead
