#pragma once
// The samples that the emitted curve does not cover yet, in the coordinates of the last frozen
// span.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fairlead/reduce/channel.hpp"

namespace fairlead {

/// Structure of arrays, oldest first, at most N + 1 samples. Taking samples off the front moves the
/// rest down: O(N), once per advance of the coverage and never per fit.
template <class Channel, std::size_t N>
struct Window {
    static constexpr std::size_t D = Channel::dimension;
    static constexpr std::size_t Order = Channel::order;
    static constexpr std::size_t capacity = N + 1;
    using Value = typename Channel::Value;
    using Vector = std::array<float, D>;

    std::size_t size{0};
    std::array<std::int64_t, capacity> t_ns{};
    std::array<std::uint32_t, capacity> record{};  // index of the record that brought it
    std::array<bool, capacity> starts_curve{};
    std::array<Value, capacity> value{};
    std::array<float, capacity> u{};   // ticks since the last frozen knot
    std::array<Vector, capacity> x{};  // coordinates, curve units

    void push(std::int64_t t, std::uint32_t index, bool starts, const Value& v,
              const Vector& coordinates) noexcept {
        t_ns[size] = t;
        record[size] = index;
        starts_curve[size] = starts;
        value[size] = v;
        x[size] = coordinates;
        ++size;
    }

    void drop(std::size_t n) noexcept {
        for (std::size_t i = n; i < size; ++i) {
            const std::size_t to = i - n;
            t_ns[to] = t_ns[i];
            record[to] = record[i];
            starts_curve[to] = starts_curve[i];
            value[to] = value[i];
            u[to] = u[i];
            x[to] = x[i];
        }
        size -= n;
    }

    /// Sets sample i's time relative to a knot.
    void express(std::size_t i, std::int64_t t0_ns, std::uint32_t tick_ns) noexcept {
        u[i] = ticks_between(t0_ns, t_ns[i], tick_ns);
    }
};

}  // namespace fairlead
