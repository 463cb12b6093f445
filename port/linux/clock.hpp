#pragma once
// CLOCK_MONOTONIC in integer nanoseconds: the only clock in the tree. GPIO edges carry the same
// one.
#include <cerrno>
#include <cstdint>
#include <ctime>

namespace fairlead::port {

inline constexpr std::int64_t us = 1000;
inline constexpr std::int64_t ms = 1000 * us;
inline constexpr std::int64_t second = 1000 * ms;

inline std::int64_t now_ns() noexcept {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return static_cast<std::int64_t>(t.tv_sec) * second + t.tv_nsec;
}

/// The same as a type, for stages that are given their clock.
struct MonotonicClock {
    static std::int64_t now() noexcept { return now_ns(); }
};

/// Sleeps until the absolute time; a signal does not shorten it.
inline void sleep_until(std::int64_t t_ns) noexcept {
    const timespec t{static_cast<time_t>(t_ns / second), static_cast<long>(t_ns % second)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
    }
}

/// What is left until a deadline, as poll() wants it: whole milliseconds, rounded up, 0 when past.
inline int poll_ms(std::int64_t deadline_ns) noexcept {
    const std::int64_t left = deadline_ns - now_ns();
    if (left <= 0) return 0;
    const std::int64_t rounded = (left + ms - 1) / ms;
    return rounded > 1000000 ? 1000000 : static_cast<int>(rounded);
}

/// As ppoll() wants it.
inline timespec remaining(std::int64_t deadline_ns) noexcept {
    const std::int64_t left = deadline_ns - now_ns();
    if (left <= 0) return {0, 0};
    return {static_cast<time_t>(left / second), static_cast<long>(left % second)};
}

}  // namespace fairlead::port
