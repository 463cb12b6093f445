#include "examples/gateway/source.hpp"

#include <algorithm>

#include "port/linux/clock.hpp"

namespace fairlead::gateway {
namespace {

constexpr std::int64_t slice_ns = 50 * port::ms;
constexpr std::int64_t silence_ns = 10 * port::second;

}  // namespace

void Source::start(UnitFeed& feed, std::uint32_t epoch) {
    stop_ = false;
    heartbeat_ns_ = port::now_ns();
    thread_ = std::thread{[this, &feed, epoch] {
        UnitState state;
        state.epoch = epoch;
        run(feed, state);
    }};
}

void Source::stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
}

bool Source::is_alive(std::int64_t now_ns) const noexcept {
    const std::int64_t heard_ns = heartbeat_ns_.load(std::memory_order_relaxed);
    return heard_ns == 0 || now_ns - heard_ns < silence_ns;
}

bool Source::stopping() noexcept {
    heartbeat_ns_.store(port::now_ns(), std::memory_order_relaxed);
    return stop_;
}

bool Source::sleep_until(std::int64_t t_ns) noexcept {
    while (!stopping()) {
        const std::int64_t now = port::now_ns();
        if (now >= t_ns) return true;
        port::sleep_until(std::min(t_ns, now + slice_ns));
    }
    return false;
}

void Source::publish(UnitFeed& feed, UnitState& state) noexcept {
    ++state.sequence;
    ++state.publications;
    const std::int64_t late_us = (port::now_ns() - state.arrival_ns) / port::us;
    state.publish_us = static_cast<std::uint32_t>(std::clamp<std::int64_t>(late_us, 0, UINT32_MAX));
    state.publish_max_us = std::max(state.publish_max_us, state.publish_us);
    if (state.period_us > 0 && state.publish_us > 2 * state.period_us) ++state.deadline_misses;
    feed.state.write(state);
}

}  // namespace fairlead::gateway
