#pragma once
// Buttons and trigger contacts: edges in, clean events with exact times out, ready for a discrete
// channel. An event carries the time of the first edge of a bounce, not of its end.
#include <cstdint>
#include <optional>

#include "port/linux/gpio.hpp"

namespace fairlead::port {

struct Event {
    std::int64_t t_ns{};
    bool on{};
};

/// A change is believed at once; what follows within hold_ns is bounce. Where the contact comes to
/// rest in the other state, poll() tells so, with the time of the last edge.
class Debounce {
  public:
    explicit constexpr Debounce(std::int64_t hold_ns, bool active_low = false) noexcept
        : hold_ns_{hold_ns}, active_low_{active_low} {}

    constexpr std::optional<Event> push(const Edge& edge) noexcept {
        level_ = edge.rising != active_low_;
        level_ns_ = edge.t_ns;
        if (level_ == told_ || edge.t_ns - told_ns_ < hold_ns_) return std::nullopt;
        return tell(edge.t_ns);
    }
    constexpr std::optional<Event> poll(std::int64_t now_ns) noexcept {
        if (level_ == told_ || now_ns - told_ns_ < hold_ns_) return std::nullopt;
        return tell(level_ns_);
    }

  private:
    constexpr Event tell(std::int64_t t_ns) noexcept {
        told_ = level_;
        told_ns_ = t_ns;
        return {t_ns, told_};
    }

    std::int64_t hold_ns_;
    bool active_low_;
    bool level_{false};
    bool told_{false};
    std::int64_t level_ns_{0};
    std::int64_t told_ns_{INT64_MIN / 2};
};

}  // namespace fairlead::port
