#pragma once
// Buttons and trigger contacts: edges in, clean events with exact times out, on a discrete channel
// of a pipeline (docs/discrete.md). An event carries the time of the first edge of a bounce, not of
// its end.
#include <cstdint>
#include <optional>

#include "fairlead/base/types.hpp"
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

/// A debounced contact as a discrete channel with values 1 and 0. Edges: as of gpio.hpp.
template <class Edges>
class Contact {
  public:
    Contact(Edges& edges, std::uint16_t channel, const Debounce& debounce) noexcept
        : edges_{&edges}, debounce_{debounce}, channel_{channel} {}

    /// Once a turn of the sampling loop: takes the edges that have come, and never waits.
    /// tell(fairlead::Event) is the pipeline's push_event, or what keeps count of its refusals.
    template <class Tell>
    void step(std::int64_t now_ns, Tell tell) noexcept {
        for (std::size_t i = 0; i < Edges::queue_max; ++i) {
            const auto edge = edges_->wait(0);
            if (!edge) break;
            if (const auto event = debounce_.push(*edge)) pass(*event, tell);
        }
        if (const auto event = debounce_.poll(now_ns)) pass(*event, tell);
    }

  private:
    template <class Tell>
    void pass(const Event& event, Tell& tell) noexcept {
        const bool missed = edges_->dropped() != dropped_;
        dropped_ = edges_->dropped();
        tell(fairlead::Event{event.t_ns, channel_, static_cast<std::uint16_t>(event.on),
                             missed ? flag::gap_before : 0});
    }

    Edges* edges_;
    Debounce debounce_;
    std::uint16_t channel_;
    std::uint64_t dropped_{0};
};

}  // namespace fairlead::port
